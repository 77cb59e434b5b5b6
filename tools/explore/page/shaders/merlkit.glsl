#ifndef MERLKIT_GLSL_INCLUDED
#define MERLKIT_GLSL_INCLUDED 1
// merlkit.glsl: measured materials from files at run time, for GLSL 3.30 and GLSL ES 3.00 and later, written by merlkit 0.1.0
//
//     merlkit_table nickel = merlkit_open(0u);                 // the file that begins at word 0
//     merlkit_draw draw = merlkit_sample(nickel, wo, u1, u2);  // from a point of [0, 1)^2, random or well spread
//     vec3 f = merlkit_eval(nickel, wo, draw.wi);              // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     float pdf = merlkit_pdf(nickel, wo, wi);                 // of any direction, for multiple importance sampling
//
// Paste or include this text after #version. The words of the files, one file after the other, are texels of the texture
// merlkit_words: format R32UI, 2048 texels wide, NEAREST. Define MERLKIT_WORD(i) before to have them elsewhere, such as in a
// storage buffer: i is a uint. Files are not checked here; the host does that with merlkit_load of merlkit.h.
//
// Directions leave the surface in a frame whose +z is the normal: wo to the viewer (given), wi to the light (drawn).
// Other lengths than 1 are renormalised. f is f_r, linear RGB in 1/sr without the cosine; pdf is in 1/sr. Both are 0 for what
// is no direction above the horizon. No draw fails for a wo above the horizon. Many draws with one wo are cheaper with
// merlkit_about about = merlkit_prepare(table, wo), then merlkit_draw_prepared(table, about, u1, u2) and
// merlkit_pdf_prepared(table, about, wi).
//
// The code is licensed as merlkit, MIT or Apache-2.0. The numbers in a file are the material's, under the terms of its data.

#ifdef GL_ES
precision highp float;
precision highp int;
#endif
#define MERLKIT_GLSL 1
#define MERLKIT_FN
#define MERLKIT_CONST const
#define MERLKIT_ARRAY(type) type[](
#define MERLKIT_ARRAY_END )
#define MERLKIT_UINT uint
#define MERLKIT_TO_UINT(x) uint(x)
#define MERLKIT_TO_INT(x) int(x)
#define MERLKIT_TO_FLOAT(x) float(x)
#define MERLKIT_SQRT(x) sqrt(x)
#define MERLKIT_ABS(x) abs(x)
#define MERLKIT_VALUES
#define merlkit_vec3 vec3
#define merlkit_v(x, y, z) vec3(x, y, z)

// ---- What functions return ----

// A direction and its density; pdf is 0 where the draw failed.
struct merlkit_draw {
    merlkit_vec3 wi;
    float pdf;
};

// What depends on wo alone: its polar angle, the cosine and sine of its azimuth, the cap of the largest theta_h, and two
// tables with the weight of the second in 1/65536. cos_o is 0 for a wo that is not above the horizon.
struct merlkit_about {
    float sin_o;
    float cos_o;
    float c;
    float s;
    float top;
    MERLKIT_UINT first;
    MERLKIT_UINT second;
    MERLKIT_UINT weight;
};

// Where a direction lies: its cap, its fraction b of the widest azimuth in [-1, 1], and dsigma(wi) per dcap db.
struct merlkit_place {
    float cap;
    float b;
    float jacobian;
};

// Density over the azimuth at both ends of a segment.
struct merlkit_segment {
    float index;
    float low;
    float high;
};

// Half and difference angles in units of MERL's bins, from the lower edge of bin 0.
struct merlkit_bins {
    float theta_h;
    float theta_d;
    float phi_d;
};

// Two neighbouring bins and the weight of the second.
struct merlkit_pair {
    int low;
    int high;
    float weight;
};

// A weighted mean of bins, and the sum of the weights of those that hold a value.
struct merlkit_cell {
    float r;
    float g;
    float b;
    float valid;
};

// ---- Numbers ----

MERLKIT_FN float merlkit_pick(bool condition, float yes, float no)
{
    if (condition) {
        return yes;
    }
    return no;
}

MERLKIT_FN int merlkit_pick_int(bool condition, int yes, int no)
{
    if (condition) {
        return yes;
    }
    return no;
}

MERLKIT_FN float merlkit_min(float a, float b)
{
    return merlkit_pick(a < b, a, b);
}

MERLKIT_FN float merlkit_max(float a, float b)
{
    return merlkit_pick(a > b, a, b);
}

// x in [0, 1), 0 for NaN.
MERLKIT_FN float merlkit_point(float x)
{
    return merlkit_pick(x > 0.0f, merlkit_min(x, 0.99999994f), 0.0f);
}

MERLKIT_FN MERLKIT_UINT merlkit_mix(MERLKIT_UINT a, MERLKIT_UINT b, MERLKIT_UINT weight)
{
    return a * (65536u - weight) + b * weight;
}

// floor(x * 65535 * 65536) of x in [0, 1), exact without f64: x is (a + (b + q) / 65536) / 65536.
MERLKIT_FN MERLKIT_UINT merlkit_row_target(float x)
{
    float scaled = x * 65536.0f;
    MERLKIT_UINT a = MERLKIT_TO_UINT(scaled);
    float r = scaled - MERLKIT_TO_FLOAT(a);
    MERLKIT_UINT b = MERLKIT_TO_UINT(r * 65536.0f);
    float q = r * 65536.0f - MERLKIT_TO_FLOAT(b);
    return a * 65535u + b - MERLKIT_TO_UINT(q < r);
}

// floor(x * 65534 * 65536) of x in [0, 1].
MERLKIT_FN MERLKIT_UINT merlkit_node_target(float x)
{
    float scaled = x * 65536.0f;
    MERLKIT_UINT a = MERLKIT_TO_UINT(scaled);
    float r = scaled - MERLKIT_TO_FLOAT(a);
    MERLKIT_UINT b = MERLKIT_TO_UINT(r * 65536.0f);
    float q = r * 65536.0f - MERLKIT_TO_FLOAT(b);
    return a * 65534u + b - MERLKIT_TO_UINT(q < 2.0f * r) - MERLKIT_TO_UINT(q < 2.0f * r - 1.0f);
}

// ---- Directions ----

// w at unit length: itself where it is so up to rounding. (0, 0, 0) unless it is finite and above the horizon.
MERLKIT_FN merlkit_vec3 merlkit_unit(merlkit_vec3 w)
{
    float length2 = w.x * w.x + w.y * w.y + w.z * w.z;
    float largest = merlkit_max(merlkit_max(MERLKIT_ABS(w.x), MERLKIT_ABS(w.y)), w.z);
    if (w.z > 0.0f && MERLKIT_ABS(length2 - 1.0f) <= 1e-5f) {
        return w;
    }
    if (!(w.z > 0.0f && MERLKIT_ABS(w.x) <= 3.4028234e38f && MERLKIT_ABS(w.y) <= 3.4028234e38f
          && w.z <= 3.4028234e38f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    float x = w.x / largest;
    float y = w.y / largest;
    float z = w.z / largest;
    float scale = 1.0f / MERLKIT_SQRT(x * x + y * y + z * z);
    return merlkit_v(x * scale, y * scale, z * scale);
}

// Step 6: the largest tan(phi/4) that reflects above the horizon.
MERLKIT_FN float merlkit_widest(merlkit_about about, float sin_h, float cos_h)
{
    float sines = 2.0f * sin_h * cos_h * about.sin_o;
    float cosines = (cos_h - sin_h) * (cos_h + sin_h) * about.cos_o;
    float beyond = merlkit_max(sines - cosines, 0.0f);
    float within = merlkit_max(cosines + sines, 1.1754944e-38f);
    return merlkit_max(MERLKIT_SQRT(within) / (MERLKIT_SQRT(beyond) + MERLKIT_SQRT(within + beyond)), 1e-6f);
}

// Steps 1 and 2, of a unit wo above the horizon; the tables are left for step 4.
MERLKIT_FN merlkit_about merlkit_square(merlkit_vec3 wo)
{
    merlkit_about about;
    float rho2 = wo.x * wo.x + wo.y * wo.y;
    float rho = MERLKIT_SQRT(rho2);
    float scale = 1.0f / MERLKIT_SQRT(rho2 + wo.z * wo.z);
    about.c = 1.0f;
    about.s = 0.0f;
    if (rho > 0.0f) {
        float turn = 1.0f / rho;
        about.c = wo.x * turn;
        about.s = wo.y * turn;
    }
    about.sin_o = rho * scale;
    about.cos_o = wo.z * scale;
    about.top = 0.5f * (1.0f - about.cos_o / MERLKIT_SQRT(2.0f * (1.0f + about.sin_o)));
    about.first = 0u;
    about.second = 0u;
    about.weight = 0u;
    return about;
}

// Steps 15 to 17: the direction at a cap and a fraction b of the azimuth.
MERLKIT_FN merlkit_vec3 merlkit_direction(merlkit_about about, float cap, float b)
{
    float sin_h = 2.0f * MERLKIT_SQRT(cap * (1.0f - cap));
    float cos_h = 1.0f - 2.0f * cap;
    float q = b * merlkit_widest(about, sin_h, cos_h);
    float scale = 1.0f / (1.0f + q * q);
    float sin_half = 2.0f * q * scale;
    float cos_half = (1.0f - q * q) * scale;
    float hx = sin_h * ((cos_half - sin_half) * (cos_half + sin_half));
    float hy = sin_h * (2.0f * sin_half * cos_half);
    float twice = 2.0f * (about.sin_o * hx + about.cos_o * cos_h);
    float x = twice * hx - about.sin_o;
    float y = twice * hy;
    float z = twice * cos_h - about.cos_o;
    return merlkit_v(about.c * x - about.s * y, about.s * x + about.c * y, merlkit_max(z, 1e-9f));
}

// Steps 18 to 20, of a unit wi above the horizon.
MERLKIT_FN merlkit_place merlkit_place_of(merlkit_about about, merlkit_vec3 wi)
{
    merlkit_place place;
    float x = about.sin_o + (about.c * wi.x + about.s * wi.y);
    float y = about.c * wi.y - about.s * wi.x;
    float z = about.cos_o + wi.z;
    float rho2 = x * x + y * y;
    float rho = MERLKIT_SQRT(rho2);
    float len = MERLKIT_SQRT(rho2 + z * z);
    float inverse = 1.0f / len;
    float widest = merlkit_widest(about, rho * inverse, z * inverse);
    float sum = rho + MERLKIT_ABS(x);
    float scale = 1.0f / merlkit_max(MERLKIT_SQRT(2.0f * rho * sum), 1.1754944e-38f);
    float big = sum * scale;
    float little = MERLKIT_ABS(y) * scale;
    // Both are at least 0: the azimuth is beyond 90 degrees where x is below 0.
    float over = merlkit_pick(x < 0.0f, big, little);
    float under = merlkit_pick(x < 0.0f, little, big);
    float q = merlkit_min(over / (1.0f + under), 1.0f);
    float b = merlkit_min(q / widest, 1.0f);
    place.cap = 0.5f * rho2 * inverse / (len + z);
    place.b = merlkit_pick(y < 0.0f, -b, b);
    place.jacobian = 16.0f * len * widest / (1.0f + q * q);
    return place;
}

// Step 8: where the probability of a density 1 + slope (2x - 1) passes u.
MERLKIT_FN float merlkit_find_on_slope(float slope, float u)
{
    float start = 1.0f - slope;
    float root = MERLKIT_SQRT(merlkit_max(start * start + 4.0f * slope * u, 0.0f));
    return merlkit_min(2.0f * u / (start + root), 1.0f);
}

// Step 13: where a segment's probability passes rest.
MERLKIT_FN float merlkit_find_in(merlkit_segment segment, float rest)
{
    float low = segment.low;
    float root = MERLKIT_SQRT(merlkit_max(low * low + (segment.high - low) * rest, 0.0f));
    return merlkit_min(rest / (low + root), 1.0f);
}

// ---- MERL's bins ----

// Angle of (x, y), both at least 0, in degrees; 0 for (0, 0) and exact for x = 0. Abramowitz and Stegun 4.4.49: GLSL's own
// arc tangent may be off by a thousand times as much.
MERLKIT_FN float merlkit_degrees(float y, float x)
{
    float high = merlkit_max(x, y);
    float t = 0.0f;
    if (high > 0.0f) {
        t = merlkit_min(x, y) / high;
    }
    float s = t * t;
    float tail = 2.4585398f + s * (-0.9262285f + s * 0.16422264f);
    float a = t * (57.29578f + s * (-19.098485f + s * (11.455461f + s * (-8.1410999f + s * (6.1055895f
                + s * (-4.3137787f + s * tail))))));
    return merlkit_pick(y > x, 90.0f - a, a);
}

// Degrees from 0 to bins of the azimuth of wi, which is phi_d where the half vector is the normal. Opposite azimuths are one
// in a table of 180.
MERLKIT_FN float merlkit_azimuth(merlkit_vec3 wi, int bins)
{
    bool turned = bins == 180 && (wi.y < 0.0f || (wi.y == 0.0f && wi.x < 0.0f));
    float x = merlkit_pick(turned, -wi.x, wi.x);
    float y = merlkit_pick(turned, -wi.y, wi.y);
    float a = merlkit_degrees(MERLKIT_ABS(y), MERLKIT_ABS(x));
    float upper = merlkit_pick(x < 0.0f, 180.0f - a, a);
    return merlkit_pick(y < 0.0f, 360.0f - upper, upper);
}

// Angles of a pair of unit directions above the horizon. Sums and differences of the directions keep their digits where
// products of their components would lose them: f32 is enough.
MERLKIT_FN merlkit_bins merlkit_bins_of(merlkit_vec3 wo, merlkit_vec3 wi, int phi_d_bins)
{
    merlkit_bins at;
    float sx = wo.x + wi.x;
    float sy = wo.y + wi.y;
    float sz = wo.z + wi.z;
    float dx = wo.x - wi.x;
    float dy = wo.y - wi.y;
    float dz = wo.z - wi.z;
    float rho2 = sx * sx + sy * sy;
    float len = MERLKIT_SQRT(rho2 + sz * sz);
    float across = dx * sy - dy * sx;
    float along = dz * len;
    at.theta_h = MERLKIT_SQRT(90.0f * merlkit_degrees(MERLKIT_SQRT(rho2), sz));
    at.theta_d = merlkit_degrees(MERLKIT_SQRT(dx * dx + dy * dy + dz * dz), len);
    if (sx == 0.0f && sy == 0.0f) {
        at.phi_d = merlkit_azimuth(wi, phi_d_bins);
    } else {
        float a = merlkit_degrees(MERLKIT_ABS(across), MERLKIT_ABS(along));
        bool rising = across == 0.0f || ((across > 0.0f) == (dz > 0.0f) && dz != 0.0f);
        bool second = across < 0.0f || (across == 0.0f && dz < 0.0f);
        float half_turn = merlkit_pick(phi_d_bins == 360 && second, 180.0f, 0.0f);
        at.phi_d = merlkit_pick(rising, a, 180.0f - a) + half_turn;
    }
    return at;
}

// The bin that holds x.
MERLKIT_FN int merlkit_bin(float x, int bins)
{
    int bin = MERLKIT_TO_INT(x);
    return merlkit_pick_int(bin < bins, bin, bins - 1);
}

// The bins on both sides of x, held at the ends of the axis.
MERLKIT_FN merlkit_pair merlkit_clamped(float x, int bins)
{
    merlkit_pair pair;
    float held = merlkit_min(merlkit_max(x, 0.0f), MERLKIT_TO_FLOAT(bins - 1));
    pair.low = MERLKIT_TO_INT(held);
    pair.high = merlkit_pick_int(pair.low + 1 < bins, pair.low + 1, pair.low);
    pair.weight = held - MERLKIT_TO_FLOAT(pair.low);
    return pair;
}

// The bins on both sides of x, at least -1, on an axis that closes on itself.
MERLKIT_FN merlkit_pair merlkit_periodic(float x, int bins)
{
    merlkit_pair pair;
    float held = merlkit_pick(x < 0.0f, x + MERLKIT_TO_FLOAT(bins), x);
    int low = MERLKIT_TO_INT(held);
    pair.weight = held - MERLKIT_TO_FLOAT(low);
    pair.low = merlkit_pick_int(low < bins, low, low - bins);
    pair.high = merlkit_pick_int(pair.low + 1 < bins, pair.low + 1, 0);
    return pair;
}

MERLKIT_FN merlkit_cell merlkit_mix_cells(merlkit_cell low, merlkit_cell high, float weight)
{
    merlkit_cell mean;
    mean.r = low.r * (1.0f - weight) + high.r * weight;
    mean.g = low.g * (1.0f - weight) + high.g * weight;
    mean.b = low.b * (1.0f - weight) + high.b * weight;
    mean.valid = low.valid * (1.0f - weight) + high.valid * weight;
    return mean;
}

#ifndef MERLKIT_WORD
uniform highp usampler2D merlkit_words;
#define MERLKIT_WORD(i) merlkit_texel(i)
uint merlkit_texel(uint i)
{
    return texelFetch(merlkit_words, ivec2(int(i % 2048u), int(i / 2048u)), 0).r;
}
#endif
#define MERLKIT_BITS(x) uintBitsToFloat(x)

// ---- The table: docs/export.md of merlkit describes its file ----

// Settings of a table, and the words of its file at which its arrays begin.
struct merlkit_table {
    MERLKIT_UINT tables;
    MERLKIT_UINT rows;
    MERLKIT_UINT segments;
    MERLKIT_UINT fold;
    MERLKIT_UINT rule;
    int phi_bins;
    MERLKIT_UINT cosines;
    MERLKIT_UINT edges_fixed;
    MERLKIT_UINT edges_weight;
    MERLKIT_UINT cdf;
    MERLKIT_UINT slopes;
    MERLKIT_UINT density;
    MERLKIT_UINT values;
    float node_unit;
    float per_segment;
    float offset;
};

// The table of the file that begins at word `first`.
MERLKIT_FN merlkit_table merlkit_open(MERLKIT_UINT first)
{
    merlkit_table table;
    table.tables = MERLKIT_WORD(first + 5u);
    table.rows = MERLKIT_WORD(first + 6u);
    table.segments = MERLKIT_WORD(first + 7u);
    table.fold = MERLKIT_WORD(first + 8u);
    table.rule = MERLKIT_WORD(first + 9u);
    table.phi_bins = MERLKIT_TO_INT(MERLKIT_WORD(first + 10u));
    MERLKIT_UINT rows = table.tables * table.rows;
    MERLKIT_UINT nodes = rows * (table.segments + 1u);
    table.cosines = first + 32u;
    table.edges_fixed = table.cosines + table.tables;
    table.edges_weight = table.edges_fixed + table.rows + 1u;
    table.cdf = table.edges_weight + table.rows + 1u;
    table.slopes = table.cdf + ((rows + 1u) >> 1u);
    table.density = table.slopes + ((rows + 3u) >> 2u);
    table.values = table.density + ((nodes + 1u) >> 1u);
    float segments = MERLKIT_TO_FLOAT(table.segments);
    table.node_unit = 0.5f * (2.0f * segments * 2.3283775e-10f);
    table.per_segment = 1.0f / segments;
    table.offset = merlkit_pick(table.rule == 2u, 0.5f, 0.0f);
    return table;
}

MERLKIT_FN float merlkit_table_cosine(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.cosines + i));
}

MERLKIT_FN float merlkit_table_edge_fixed(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.edges_fixed + i));
}

MERLKIT_FN float merlkit_table_edge_weight(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.edges_weight + i));
}

MERLKIT_FN float merlkit_table_value(merlkit_table table, int i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.values + MERLKIT_TO_UINT(i)));
}

// ---- Drawing: the numbered steps of merlkit's docs/half-vector-table.md ----

// Number i of those of 16 bits from word `start` on.
MERLKIT_FN MERLKIT_UINT merlkit_table_u16(merlkit_table table, MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (MERLKIT_WORD(start + (i >> 1u)) >> ((i & 1u) << 4u)) & 0xffffu;
}

// Number i of those of 8 bits from word `start` on.
MERLKIT_FN MERLKIT_UINT merlkit_table_u8(merlkit_table table, MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (MERLKIT_WORD(start + (i >> 2u)) >> ((i & 3u) << 3u)) & 0xffu;
}

// Cap at the lower edge of a row.
MERLKIT_FN float merlkit_table_cap(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    return merlkit_table_edge_fixed(table, row) + merlkit_table_edge_weight(table, row) * about.top;
}

// Probability of the rows up to and with this one, in 1/(65535 * 65536).
MERLKIT_FN MERLKIT_UINT merlkit_table_to(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * table.rows + row;
    MERLKIT_UINT b = about.second * table.rows + row;
    return merlkit_mix(merlkit_table_u16(table, table.cdf, a), merlkit_table_u16(table, table.cdf, b), about.weight);
}

MERLKIT_FN MERLKIT_UINT merlkit_table_below(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    if (row == 0u) {
        return 0u;
    }
    return merlkit_table_to(table, about, row - 1u);
}

MERLKIT_FN float merlkit_table_slope(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * table.rows + row;
    MERLKIT_UINT b = about.second * table.rows + row;
    // Stored slopes are 128 too large, so their mix is 128 * 65536 too large.
    MERLKIT_UINT mixed = merlkit_mix(merlkit_table_u8(table, table.slopes, a), merlkit_table_u8(table, table.slopes, b), about.weight);
    return MERLKIT_TO_FLOAT(MERLKIT_TO_INT(mixed) - 8388608) * 1.1920929e-7f;
}

MERLKIT_FN MERLKIT_UINT merlkit_table_node(merlkit_table table, merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT node)
{
    MERLKIT_UINT a = (about.first * table.rows + row) * (table.segments + 1u) + node;
    MERLKIT_UINT b = (about.second * table.rows + row) * (table.segments + 1u) + node;
    return merlkit_mix(merlkit_table_u16(table, table.density, a), merlkit_table_u16(table, table.density, b), about.weight);
}

MERLKIT_FN merlkit_segment merlkit_table_segment(merlkit_table table, merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT index)
{
    merlkit_segment segment;
    segment.index = MERLKIT_TO_FLOAT(index);
    segment.low = MERLKIT_TO_FLOAT(merlkit_table_node(table, about, row, index));
    segment.high = MERLKIT_TO_FLOAT(merlkit_table_node(table, about, row, index + 1u));
    return segment;
}

// Steps 1 to 5: what depends on wo alone, for many draws or densities with one wo.
MERLKIT_FN merlkit_about merlkit_prepare(merlkit_table table, merlkit_vec3 wo)
{
    merlkit_vec3 unit = merlkit_unit(wo);
    merlkit_about about = merlkit_square(merlkit_v(0.0f, 0.0f, 1.0f));
    if (!(unit.z > 0.0f)) {
        about.cos_o = 0.0f;
        return about;
    }
    about = merlkit_square(unit);
    MERLKIT_UINT low = 0u;
    MERLKIT_UINT high = table.tables - 1u;
    while (low < high) {
        MERLKIT_UINT middle = (low + high) >> 1u;
        if (merlkit_table_cosine(table, middle) > about.cos_o) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    about.second = low;
    about.first = low;
    if (low > 0u) {
        about.first = low - 1u;
    }
    float above = merlkit_table_cosine(table, about.first);
    float below = merlkit_table_cosine(table, about.second);
    if (above > below) {
        float weight = merlkit_min(merlkit_max((above - about.cos_o) / (above - below), 0.0f), 1.0f);
        about.weight = MERLKIT_TO_UINT(weight * 65536.0f + 0.5f);
    }
    return about;
}

// Steps 18 to 22: merlkit_pdf for the wo that `about` was made of.
MERLKIT_FN float merlkit_pdf_prepared(merlkit_table table, merlkit_about about, merlkit_vec3 wi)
{
    merlkit_vec3 unit = merlkit_unit(wi);
    if (!(about.cos_o > 0.0f && unit.z > 0.0f)) {
        return 0.0f;
    }
    merlkit_place place = merlkit_place_of(about, unit);
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT end = table.rows;
    while (row + 1u < end) {
        MERLKIT_UINT middle = (row + end) >> 1u;
        if (merlkit_table_cap(table, about, middle) <= place.cap) {
            row = middle;
        } else {
            end = middle;
        }
    }
    float low = merlkit_table_cap(table, about, row);
    float width = merlkit_table_cap(table, about, row + 1u) - low;
    float y = 0.5f * (place.b + 1.0f);
    if (table.fold == 1u) {
        y = MERLKIT_ABS(place.b);
    }
    float at = y * MERLKIT_TO_FLOAT(table.segments);
    MERLKIT_UINT index = MERLKIT_TO_UINT(at);
    if (index >= table.segments) {
        index = table.segments - 1u;
    }
    merlkit_segment segment = merlkit_table_segment(table, about, row, index);
    float x = merlkit_min(merlkit_max((place.cap - low) / width, 0.0f), 1.0f);
    float along = MERLKIT_TO_FLOAT(merlkit_table_to(table, about, row) - merlkit_table_below(table, about, row)) * 2.328342e-10f
            * (1.0f + merlkit_table_slope(table, about, row) * (2.0f * x - 1.0f));
    float across = segment.low + (segment.high - segment.low) * (at - segment.index);
    return merlkit_min(along * across * table.node_unit / (width * place.jacobian), 3.4028234e38f);
}

// Steps 7 to 17: merlkit_sample for the wo that `about` was made of.
MERLKIT_FN merlkit_draw merlkit_draw_prepared(merlkit_table table, merlkit_about about, float u1, float u2)
{
    merlkit_draw draw;
    draw.wi = merlkit_v(0.0f, 0.0f, 0.0f);
    draw.pdf = 0.0f;
    if (!(about.cos_o > 0.0f)) {
        return draw;
    }
    float v = merlkit_point(u2);
    float side = 2.0f * v - 1.0f;
    if (table.fold == 1u) {
        v = MERLKIT_ABS(side);
    }
    MERLKIT_UINT goal = merlkit_row_target(merlkit_point(u1));
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT last = table.rows - 1u;
    while (row < last) {
        MERLKIT_UINT middle = (row + last) >> 1u;
        if (merlkit_table_to(table, about, middle) <= goal) {
            row = middle + 1u;
        } else {
            last = middle;
        }
    }
    MERLKIT_UINT below = merlkit_table_below(table, about, row);
    float fraction = MERLKIT_TO_FLOAT(goal - below) / MERLKIT_TO_FLOAT(merlkit_table_to(table, about, row) - below);
    float low = merlkit_table_cap(table, about, row);
    float cap = merlkit_find_on_slope(merlkit_table_slope(table, about, row), merlkit_min(fraction, 1.0f));
    cap = low + (merlkit_table_cap(table, about, row + 1u) - low) * cap;
    goal = merlkit_node_target(v);
    below = 0u;
    MERLKIT_UINT sum = 0u;
    MERLKIT_UINT index = 0u;
    MERLKIT_UINT node = merlkit_table_node(table, about, row, 0u);
    while (index + 1u < table.segments) {
        MERLKIT_UINT next = merlkit_table_node(table, about, row, index + 1u);
        sum += node + next;
        if (sum > goal) {
            break;
        }
        node = next;
        below = sum;
        index += 1u;
    }
    merlkit_segment segment = merlkit_table_segment(table, about, row, index);
    float b = (segment.index + merlkit_find_in(segment, MERLKIT_TO_FLOAT(goal - below))) * table.per_segment;
    if (table.fold == 1u) {
        b = merlkit_pick(side < 0.0f, -b, b);
    } else {
        b = 2.0f * b - 1.0f;
    }
    draw.wi = merlkit_direction(about, cap, merlkit_min(merlkit_max(b, -1.0f), 1.0f));
    draw.pdf = merlkit_pdf_prepared(table, about, draw.wi);
    return draw;
}

// A direction wi for wo, from a point of [0, 1)^2; pdf 0 where wo is not above the horizon, and never otherwise.
MERLKIT_FN merlkit_draw merlkit_sample(merlkit_table table, merlkit_vec3 wo, float u1, float u2)
{
    return merlkit_draw_prepared(table, merlkit_prepare(table, wo), u1, u2);
}

// Density of drawing wi for wo, per solid angle; 0 unless both are above the horizon.
MERLKIT_FN float merlkit_pdf(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    return merlkit_pdf_prepared(table, merlkit_prepare(table, wo), wi);
}

// f_r by the bin that holds the angles, as MERL's own reader: 1/sr, without the cosine; 0 unless both directions are above
// the horizon, and where nothing was measured.
MERLKIT_FN merlkit_vec3 merlkit_eval_floor(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, table.phi_bins);
    int cell = merlkit_bin(at.theta_d, 90) + 90 * merlkit_bin(at.theta_h, 90);
    cell = 3 * (merlkit_bin(at.phi_d, table.phi_bins) + table.phi_bins * cell);
    return merlkit_v(merlkit_max(merlkit_table_value(table, cell), 0.0f), merlkit_max(merlkit_table_value(table, cell + 1), 0.0f),
                     merlkit_max(merlkit_table_value(table, cell + 2), 0.0f));
}

// A bin's value and the weight 1 where it holds one, zeros elsewhere.
MERLKIT_FN merlkit_cell merlkit_table_bin(merlkit_table table, int theta_h, int theta_d, int phi_d)
{
    merlkit_cell cell;
    int at = 3 * (phi_d + table.phi_bins * (theta_d + 90 * theta_h));
    bool valid = merlkit_table_value(table, at) >= 0.0f;
    cell.r = merlkit_pick(valid, merlkit_table_value(table, at), 0.0f);
    cell.g = merlkit_pick(valid, merlkit_table_value(table, at + 1), 0.0f);
    cell.b = merlkit_pick(valid, merlkit_table_value(table, at + 2), 0.0f);
    cell.valid = merlkit_pick(valid, 1.0f, 0.0f);
    return cell;
}

MERLKIT_FN merlkit_cell merlkit_table_row(merlkit_table table, int theta_h, int theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(merlkit_table_bin(table, theta_h, theta_d, phi_d.low),
                             merlkit_table_bin(table, theta_h, theta_d, phi_d.high), phi_d.weight);
}

MERLKIT_FN merlkit_cell merlkit_table_plane(merlkit_table table, int theta_h, merlkit_pair theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(merlkit_table_row(table, theta_h, theta_d.low, phi_d),
                             merlkit_table_row(table, theta_h, theta_d.high, phi_d), theta_d.weight);
}

// f_r, linear between bins; those where nothing was measured are left out. 1/sr, without the cosine; 0 unless both
// directions are above the horizon, and where no bin around them holds a value.
MERLKIT_FN merlkit_vec3 merlkit_eval_linear(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, table.phi_bins);
    merlkit_pair theta_h = merlkit_clamped(at.theta_h - table.offset, 90);
    merlkit_pair theta_d = merlkit_clamped(at.theta_d - table.offset, 90);
    merlkit_pair phi_d = merlkit_periodic(at.phi_d - table.offset, table.phi_bins);
    merlkit_cell mean = merlkit_mix_cells(merlkit_table_plane(table, theta_h.low, theta_d, phi_d),
                                          merlkit_table_plane(table, theta_h.high, theta_d, phi_d), theta_h.weight);
    if (!(mean.valid > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    return merlkit_v(merlkit_min(mean.r / mean.valid, 3.4028234e38f), merlkit_min(mean.g / mean.valid, 3.4028234e38f),
                     merlkit_min(mean.b / mean.valid, 3.4028234e38f));
}

// f_r of wo and wi in 1/sr by the table's lookup rule, without the cosine; 0 unless both are above the horizon, and where
// nothing was measured.
MERLKIT_FN merlkit_vec3 merlkit_eval(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    if (table.rule == 0u) {
        return merlkit_eval_floor(table, wo, wi);
    }
    return merlkit_eval_linear(table, wo, wi);
}
#endif
