// How a surface reflects and what lights it, for one more sample of each pixel.
//
// In front of this text are #version, merlkit.glsl, LIGHT_IS_SKY for an environment, and VALUES_ARE_GRID for values over four angles.

#ifdef VALUES_ARE_GRID
uniform highp sampler3D grid;
#else
uniform highp usampler2D cells;
uniform float unit;
uniform int phi_bins;
#endif
uniform highp sampler2D before;
uniform vec2 size;
uniform uint count;
#ifdef LIGHT_IS_SKY
uniform highp sampler2D sky;
#ifndef VALUES_ARE_GRID
uniform bool has_table;
#endif
#else
uniform vec3 towards;
#endif
out vec4 mean;

const float PI = 3.14159265;
// The normal of the triangle where another one reflects: what is below it finds the mesh itself.
vec3 outside = vec3(0.0);

#ifdef VALUES_ARE_GRID
// Nodes of the grid over theta_h, phi_h, theta_d and phi_d.
const int THETA_H_NODES = 64;
const float PHI_H_NODES = 64.0;
const int THETA_D_NODES = 20;
const int PHI_D_NODES = 24;
// How many blocks over theta_h lie side by side in the texture, and so many times as many over theta_d behind one another.
const int BLOCKS_ACROSS = 4;

// Logarithms at a node of phi_d, between the nodes of the other angles, by the texture's filter.
vec3 read_block(int node, vec3 place)
{
    vec3 block = vec3(0.0, node % BLOCKS_ACROSS * THETA_H_NODES, node / BLOCKS_ACROSS * THETA_D_NODES);
    vec3 size = vec3(PHI_H_NODES, BLOCKS_ACROSS * THETA_H_NODES, PHI_D_NODES / BLOCKS_ACROSS * THETA_D_NODES);
    return texture(grid, (block + place + 0.5) / size).rgb;
}

// f_r between the nodes of the grid, linear in its logarithm.
vec3 look_up(vec3 wo, vec3 wi)
{
    vec3 o = merlkit_unit(wo);
    vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0 && i.z > 0.0)) {
        return vec3(0.0);
    }
    // Step 1: the angles, as HalfDiff of the library. About the normal phi_h is undefined, and phi_d is the azimuth of wi.
    vec3 sum = o + i;
    float rho = length(sum.xy);
    bool is_pole = rho < 1e-5;
    float theta_h = atan(rho, sum.z);
    float phi_h = is_pole ? 0.0 : atan(sum.y, sum.x);
    float theta_d = atan(length(o - i), length(sum));
    float phi_d = is_pole ? atan(i.y, i.x) : atan(o.x * i.y - o.y * i.x, 0.5 * (o.z - i.z) * length(sum));
    // Step 2: positions among the nodes. The texture repeats over phi_h.
    vec3 place;
    place.x = phi_h / (2.0 * PI) * PHI_H_NODES;
    place.y = min(sqrt(theta_h / (0.5 * PI)), 1.0) * float(THETA_H_NODES - 1);
    place.z = min(theta_d / (0.5 * PI), 1.0) * float(THETA_D_NODES - 1);
    float turn = fract(phi_d / (2.0 * PI)) * float(PHI_D_NODES);
    int low = min(int(turn), PHI_D_NODES - 1);
    // Step 3: the two nodes of phi_d.
    vec3 below = read_block(low, place);
    vec3 above = read_block((low + 1) % PHI_D_NODES, place);
    return exp2(mix(below, above, turn - float(low)));
}
#else
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
#endif

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
    float rho = sqrt(u1);
    merlkit_draw draw;
    draw.wi = vec3(rho * cos(2.0 * PI * u2), rho * sin(2.0 * PI * u2), sqrt(1.0 - u1));
    draw.pdf = draw.wi.z / PI;
#ifndef VALUES_ARE_GRID
    if (has_table) {
        draw = merlkit_sample(merlkit_open(0u), wo, u1, u2);
    }
#endif
    if (!(draw.pdf > 0.0) || dot(outside, frame * draw.wi) < 0.0) {
        return vec3(0.0);
    }
    return look_up(wo, draw.wi) * (draw.wi.z / draw.pdf) * sky_along(frame * draw.wi);
}
#else
// Parallel light of irradiance pi on a surface that faces it.
vec3 reflect_light(vec3 wo, mat3 frame)
{
    if (dot(outside, towards) < 0.0) {
        return vec3(0.0);
    }
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

// Takes light into the mean of the pixel's samples.
void add_light(vec3 light)
{
    vec3 past = texelFetch(before, ivec2(gl_FragCoord.xy), 0).rgb;
    mean = vec4(count == 0u ? light : mix(past, light, 1.0 / float(count + 1u)), 1.0);
}
