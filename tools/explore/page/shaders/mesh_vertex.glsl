#version 300 es
// A corner of a mesh, whose surrounding sphere is the unit sphere about the origin.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform vec3 eye;
uniform float half_height;
uniform vec2 shift;
out vec3 at;
out vec3 bent;

void main()
{
    at = position;
    bent = normal;
    vec3 back = normalize(eye);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    vec3 seen = position - eye;
    float ahead = -dot(seen, back);
    // Nothing is nearer or farther than the sphere.
    float near = length(eye) - 1.01;
    float far = length(eye) + 1.01;
    float depth = ((far + near) * ahead - 2.0 * far * near) / (far - near);
    vec2 place = vec2(seen.x, dot(seen, up)) / half_height;
    gl_Position = vec4(place + shift * ahead, depth, ahead);
}
