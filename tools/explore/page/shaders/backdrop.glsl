// One more sample of each pixel of what is seen past a mesh. In front of this text is surface.glsl.

uniform vec3 eye;
uniform float half_height;
uniform vec2 shift;

void main()
{
#ifdef LIGHT_IS_SKY
    vec3 back = normalize(eye);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    vec2 place = (2.0 * gl_FragCoord.xy - size) / size.y - shift;
    add_light(sky_along(normalize(-back + half_height * (place.x * vec3(1.0, 0.0, 0.0) + place.y * up))));
#else
    add_light(vec3(0.0));
#endif
}
