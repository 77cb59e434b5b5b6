#version 300 es
// The surface of a lobe, lit from the upper left in front.
precision highp float;
in vec3 seen;
uniform vec3 colour;
out vec4 painted;

void main()
{
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float light = 0.45 + 0.55 * abs(dot(normal, normalize(vec3(-0.4, 0.6, 0.7))));
    painted = vec4(colour * light, 1.0);
}
