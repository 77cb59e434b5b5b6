// One more sample of each pixel: a unit sphere. In front of this text is surface.glsl.

// The camera of merlkit render for one sphere, which has the radius 1 and rests on y = 0.
const vec3 CENTRE = vec3(0.0, 1.0, 0.0);
const vec3 TARGET = vec3(0.0, 0.95, 0.0);
const float HALF_HEIGHT = 0.21255656;

vec3 trace(vec3 eye, vec3 direction)
{
    // Step 1: the foot of the perpendicular from the centre, and half of the chord.
    float along = dot(CENTRE - eye, direction);
    vec3 perpendicular = CENTRE - eye - along * direction;
    float chord2 = 1.0 - dot(perpendicular, perpendicular);
    if (chord2 < 0.0) {
#ifdef LIGHT_IS_SKY
        return sky_along(direction);
#else
        return vec3(0.0);
#endif
    }
    // Step 2: the normal at the near end, and wo in the frame there.
    vec3 normal = normalize(-perpendicular - sqrt(chord2) * direction);
    mat3 frame = make_frame(normal);
    return reflect_light(-direction * frame, frame);
}

void main()
{
    vec3 back = normalize(vec3(0.0, 0.22, 1.0));
    vec3 eye = TARGET + back * (1.12 * 1.1 / HALF_HEIGHT + 1.0);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    // The first sample is at the pixel's centre, so that a moving picture does not tremble.
    vec2 jitter = count == 0u ? vec2(0.5) : vec2(draw_point(0u), draw_point(1u));
    vec2 place = (2.0 * (floor(gl_FragCoord.xy) + jitter) - size) / size.y;
    add_light(trace(eye, normalize(-back + HALF_HEIGHT * (place.x * vec3(1.0, 0.0, 0.0) + place.y * up))));
}
