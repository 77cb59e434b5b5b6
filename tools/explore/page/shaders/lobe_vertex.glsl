#version 300 es
// A point of a lobe, seen from infinitely far away.
layout(location = 0) in vec3 position;
uniform mat3 view;
uniform vec2 scale;
uniform float base;
out vec3 seen;

void main()
{
    seen = view * position;
    gl_Position = vec4(scale * (seen.xy + vec2(0.0, base)), -0.25 * seen.z, 1.0);
}
