// One more sample of each pixel that a mesh covers. It is seen from both sides, and hides no light from itself.
// In front of this text is surface.glsl.

in vec3 at;
in vec3 bent;
uniform vec3 eye;
uniform bool is_smooth;

void main()
{
    // Step 1: the normal of the triangle, on the side of the eye.
    vec3 wo = normalize(eye - at);
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    normal = dot(normal, wo) < 0.0 ? -normal : normal;
    // Step 2: that of its corners, where it is on the same side and faces the eye.
    vec3 smooth_normal = length(bent) > 1e-6 ? normalize(bent) : normal;
    smooth_normal = dot(smooth_normal, normal) < 0.0 ? -smooth_normal : smooth_normal;
    if (is_smooth && dot(smooth_normal, wo) > 0.0) {
        outside = normal;
        normal = smooth_normal;
    }
    mat3 frame = make_frame(normal);
    add_light(reflect_light(wo * frame, frame));
}
