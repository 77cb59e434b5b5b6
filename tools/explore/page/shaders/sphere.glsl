// One more sample of each pixel: a unit sphere with a measured material, under parallel light or an environment.
//
// In front of this text are #version, LIGHT_IS_SKY for an environment, and merlkit.glsl.

uniform highp usampler2D cells;
uniform float unit;
uniform int phi_bins;
uniform highp sampler2D before;
uniform vec2 size;
uniform uint count;
#ifdef LIGHT_IS_SKY
uniform highp sampler2D sky;
uniform bool has_table;
#else
uniform vec3 towards;
#endif
out vec4 mean;

const float PI = 3.14159265;
// The camera of merlkit render for one sphere, which has the radius 1 and rests on y = 0.
const vec3 CENTRE = vec3(0.0, 1.0, 0.0);
const vec3 TARGET = vec3(0.0, 0.95, 0.0);
const float HALF_HEIGHT = 0.21255656;

// f_r by the bin that holds the angles, as the library's floor lookup.
vec3 look_up(vec3 wo, vec3 wi)
{
    vec3 o = merlkit_unit(wo);
    vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0 && i.z > 0.0)) {
        return vec3(0.0);
    }
    merlkit_bins bins = merlkit_bins_of(o, i, phi_bins);
    int cell = merlkit_bin(bins.theta_d, 90) + 90 * merlkit_bin(bins.theta_h, 90);
    cell = merlkit_bin(bins.phi_d, phi_bins) + phi_bins * cell;
    uint word = texelFetch(cells, ivec2(cell % 1620, cell / 1620), 0).r;
    if (word == 0xf8000000u) {
        return vec3(0.0);
    }
    float scale = unit * uintBitsToFloat(((word >> 27) + 127u) << 23);
    return scale * vec3(float(word & 511u), float((word >> 9) & 511u), float((word >> 18) & 511u));
}

// A number of 32 bits that depends on every bit of x (Jarzynski and Olano 2020).
uint mix_bits(uint x)
{
    uint state = x * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Coordinate `axis` of point `count` of a lattice in four dimensions, shifted at random for each pixel.
float draw_point(uint axis)
{
    const uint STEPS[4] = uint[4](3679390609u, 3152041523u, 2700274806u, 2313257605u);
    uint pixel = uint(gl_FragCoord.x) + 8192u * uint(gl_FragCoord.y);
    return float((mix_bits(4u * pixel + axis) + count * STEPS[axis]) >> 8) * (1.0 / 16777216.0);
}

#ifdef LIGHT_IS_SKY
// Radiance from a direction: rows from +y to -y, the middle is -z, the right half is +x; bilinear between centres.
vec3 sky_along(vec3 w)
{
    ivec2 extent = textureSize(sky, 0);
    vec2 place = vec2(atan(w.x, -w.z) / (2.0 * PI) + 0.5, acos(clamp(w.y, -1.0, 1.0)) / PI);
    vec2 from = place * vec2(extent) - 0.5;
    ivec2 low = ivec2(floor(from));
    vec2 t = from - vec2(low);
    int left = (low.x + extent.x) % extent.x;
    int right = (low.x + 1) % extent.x;
    int upper = max(low.y, 0);
    int lower = min(low.y + 1, extent.y - 1);
    vec3 above = mix(texelFetch(sky, ivec2(left, upper), 0).rgb, texelFetch(sky, ivec2(right, upper), 0).rgb, t.x);
    vec3 below = mix(texelFetch(sky, ivec2(left, lower), 0).rgb, texelFetch(sky, ivec2(right, lower), 0).rgb, t.x);
    return mix(above, below, t.y);
}

// One path: a direction by the half-vector table or by the cosine, and f cos L / pdf.
vec3 reflect_light(vec3 wo, mat3 frame)
{
    float u1 = draw_point(2u);
    float u2 = draw_point(3u);
    merlkit_draw draw;
    if (has_table) {
        draw = merlkit_sample(merlkit_open(0u), wo, u1, u2);
    } else {
        float rho = sqrt(u1);
        draw.wi = vec3(rho * cos(2.0 * PI * u2), rho * sin(2.0 * PI * u2), sqrt(1.0 - u1));
        draw.pdf = draw.wi.z / PI;
    }
    if (!(draw.pdf > 0.0)) {
        return vec3(0.0);
    }
    return look_up(wo, draw.wi) * (draw.wi.z / draw.pdf) * sky_along(frame * draw.wi);
}
#else
// Parallel light of irradiance pi on a surface that faces it.
vec3 reflect_light(vec3 wo, mat3 frame)
{
    vec3 wi = towards * frame;
    return look_up(wo, wi) * (PI * max(wi.z, 0.0));
}
#endif

// A frame whose x runs along the circle about the vertical.
mat3 make_frame(vec3 normal)
{
    vec3 along = vec3(normal.z, 0.0, -normal.x);
    float length2 = dot(along, along);
    vec3 x = length2 < 1e-12 ? vec3(1.0, 0.0, 0.0) : along * inversesqrt(length2);
    return mat3(x, cross(normal, x), normal);
}

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
    vec3 light = trace(eye, normalize(-back + HALF_HEIGHT * (place.x * vec3(1.0, 0.0, 0.0) + place.y * up)));
    vec3 past = texelFetch(before, ivec2(gl_FragCoord.xy), 0).rgb;
    mean = vec4(count == 0u ? light : mix(past, light, 1.0 / float(count + 1u)), 1.0);
}
