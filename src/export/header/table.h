// ---- Drawing: the numbered steps of merlkit's docs/half-vector-table.md ----

#define NAME_TABLES @TABLES@u
#define NAME_ROWS @ROWS@u
#define NAME_SEGMENTS @SEGMENTS@u
#define NAME_NODES @NODES@u
#define NAME_FOLD @FOLD@

// cos(theta_o) of each table.
MERLKIT_CONST float NAME_cosine[@TABLES@] = {
@COSINE@};

// Caps at the edges of rows: cap = fixed + share * top.
MERLKIT_CONST float NAME_edge_fixed[@EDGES@] = {
@EDGE_FIXED@};
MERLKIT_CONST float NAME_edge_share[@EDGES@] = {
@EDGE_SHARE@};

// Three arrays in words of 32 bits, the first number of each in the lowest bits. [table, row], 16 bits each: probability of
// the rows up to and with this one, in 1/65535. From NAME_SLOPES on [table, row], 8 bits each: slope of the density over the
// cap in 1/128, and 128 more. From NAME_DENSITY on [table, row, node], 16 bits each: density over the azimuth; the trapezoids
// of a row sum to 65534.
#define NAME_SLOPES @CDF_WORDS@u
#define NAME_DENSITY @DENSITY_FROM@u
#ifndef NAME_WORD
#define NAME_WORD(i) NAME_words[i]
MERLKIT_CONST MERLKIT_UINT NAME_words[@WORDS@] = {
@CDF@@SLOPE@@DENSITY@};
#endif
#define NAME_U16(start, i) ((NAME_WORD((start) + ((i) >> 1u)) >> (((i) & 1u) << 4u)) & 0xffffu)
#define NAME_U8(start, i) ((NAME_WORD((start) + ((i) >> 2u)) >> (((i) & 3u) << 3u)) & 0xffu)

// Cap at the lower edge of a row.
MERLKIT_FN float NAME_cap(merlkit_about about, MERLKIT_UINT row)
{
    return NAME_edge_fixed[row] + NAME_edge_share[row] * about.top;
}

// Probability of the rows up to and with this one, in 1/(65535 * 65536).
MERLKIT_FN MERLKIT_UINT NAME_to(merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * NAME_ROWS + row, b = about.second * NAME_ROWS + row;
    return merlkit_mix(NAME_U16(0u, a), NAME_U16(0u, b), about.share);
}

MERLKIT_FN MERLKIT_UINT NAME_below(merlkit_about about, MERLKIT_UINT row)
{
    return row == 0u ? 0u : NAME_to(about, row - 1u);
}

MERLKIT_FN float NAME_slope(merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * NAME_ROWS + row, b = about.second * NAME_ROWS + row;
    // Of what is 128 too large, 128 * 65536 is too much.
    MERLKIT_UINT mixed = merlkit_mix(NAME_U8(NAME_SLOPES, a), NAME_U8(NAME_SLOPES, b), about.share);
    return MERLKIT_TO_FLOAT(MERLKIT_TO_INT(mixed) - 8388608) * 1.1920929e-7f;
}

MERLKIT_FN MERLKIT_UINT NAME_node(merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT node)
{
    MERLKIT_UINT a = (about.first * NAME_ROWS + row) * NAME_NODES + node;
    MERLKIT_UINT b = (about.second * NAME_ROWS + row) * NAME_NODES + node;
    return merlkit_mix(NAME_U16(NAME_DENSITY, a), NAME_U16(NAME_DENSITY, b), about.share);
}

MERLKIT_FN merlkit_segment NAME_segment(merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT index)
{
    merlkit_segment segment;
    segment.index = MERLKIT_TO_FLOAT(index);
    segment.low = MERLKIT_TO_FLOAT(NAME_node(about, row, index));
    segment.high = MERLKIT_TO_FLOAT(NAME_node(about, row, index + 1u));
    return segment;
}

// Steps 1 to 5: what depends on wo alone, for many draws or densities about it.
MERLKIT_FN merlkit_about NAME_about(merlkit_vec3 wo)
{
    merlkit_vec3 unit = merlkit_unit(wo);
    merlkit_about about;
    MERLKIT_UINT low = 0u, high = NAME_TABLES - 1u;
    float above, below;
    if (!(unit.z > 0.0f)) {
        about.sin_o = about.cos_o = about.c = about.s = about.top = 0.0f;
        about.first = about.second = about.share = 0u;
        return about;
    }
    about = merlkit_square(unit);
    while (low < high) {
        MERLKIT_UINT middle = (low + high) >> 1u;
        if (NAME_cosine[middle] > about.cos_o) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    about.second = low;
    about.first = low == 0u ? 0u : low - 1u;
    above = NAME_cosine[about.first];
    below = NAME_cosine[about.second];
    if (above > below) {
        float share = merlkit_min(merlkit_max((above - about.cos_o) / (above - below), 0.0f), 1.0f);
        about.share = MERLKIT_TO_UINT(share * 65536.0f + 0.5f);
    }
    return about;
}

// Steps 18 to 22: NAME_pdf of the wo that `about` is of.
MERLKIT_FN float NAME_density_of(merlkit_about about, merlkit_vec3 wi)
{
    merlkit_vec3 unit = merlkit_unit(wi);
    merlkit_place place;
    merlkit_segment segment;
    MERLKIT_UINT row = 0u, end = NAME_ROWS, index;
    float low, width, x, y, at, along, across;
    if (!(about.cos_o > 0.0f && unit.z > 0.0f)) {
        return 0.0f;
    }
    place = merlkit_place_of(about, unit);
    while (row + 1u < end) {
        MERLKIT_UINT middle = (row + end) >> 1u;
        if (NAME_cap(about, middle) <= place.cap) {
            row = middle;
        } else {
            end = middle;
        }
    }
    low = NAME_cap(about, row);
    width = NAME_cap(about, row + 1u) - low;
#if NAME_FOLD
    y = MERLKIT_ABS(place.b);
#else
    y = 0.5f * (place.b + 1.0f);
#endif
    at = y * MERLKIT_TO_FLOAT(NAME_SEGMENTS);
    index = MERLKIT_TO_UINT(at);
    index = index < NAME_SEGMENTS ? index : NAME_SEGMENTS - 1u;
    segment = NAME_segment(about, row, index);
    x = merlkit_min(merlkit_max((place.cap - low) / width, 0.0f), 1.0f);
    along = MERLKIT_TO_FLOAT(NAME_to(about, row) - NAME_below(about, row)) * @ROW_UNIT@f
            * (1.0f + NAME_slope(about, row) * (2.0f * x - 1.0f));
    across = segment.low + (segment.high - segment.low) * (at - segment.index);
    return merlkit_min(along * across * @NODE_UNIT@f / (width * place.jacobian), 3.4028234e38f);
}

// Steps 7 to 17: NAME_sample of the wo that `about` is of.
MERLKIT_FN merlkit_draw NAME_draw(merlkit_about about, float u1, float u2)
{
    merlkit_draw draw;
    merlkit_segment segment;
    MERLKIT_UINT target = merlkit_row_target(merlkit_point(u1));
    MERLKIT_UINT row = 0u, last = NAME_ROWS - 1u, below, sum = 0u, index = 0u, node;
    float share, low, cap, b;
#if NAME_FOLD
    float side = 2.0f * merlkit_point(u2) - 1.0f;
    float v = MERLKIT_ABS(side);
#else
    float v = merlkit_point(u2);
#endif
    draw.wi = merlkit_v(0.0f, 0.0f, 0.0f);
    draw.pdf = 0.0f;
    if (!(about.cos_o > 0.0f)) {
        return draw;
    }
    while (row < last) {
        MERLKIT_UINT middle = (row + last) >> 1u;
        if (NAME_to(about, middle) <= target) {
            row = middle + 1u;
        } else {
            last = middle;
        }
    }
    below = NAME_below(about, row);
    share = MERLKIT_TO_FLOAT(target - below) / MERLKIT_TO_FLOAT(NAME_to(about, row) - below);
    low = NAME_cap(about, row);
    cap = merlkit_find_on_slope(NAME_slope(about, row), merlkit_min(share, 1.0f));
    cap = low + (NAME_cap(about, row + 1u) - low) * cap;
    target = merlkit_node_target(v);
    below = 0u;
    node = NAME_node(about, row, 0u);
    while (index + 1u < NAME_SEGMENTS) {
        MERLKIT_UINT next = NAME_node(about, row, index + 1u);
        sum += node + next;
        if (sum > target) {
            break;
        }
        node = next;
        below = sum;
        index += 1u;
    }
    segment = NAME_segment(about, row, index);
    b = (segment.index + merlkit_find_in(segment, MERLKIT_TO_FLOAT(target - below))) * @PER_SEGMENT@f;
#if NAME_FOLD
    b = side < 0.0f ? -b : b;
#else
    b = 2.0f * b - 1.0f;
#endif
    draw.wi = merlkit_direction(about, cap, merlkit_min(merlkit_max(b, -1.0f), 1.0f));
    draw.pdf = NAME_density_of(about, draw.wi);
    return draw;
}

// A direction wi for wo, from a point of [0, 1)^2; pdf 0 where wo is not above the horizon, and never otherwise.
MERLKIT_FN merlkit_draw NAME_sample(merlkit_vec3 wo, float u1, float u2)
{
    return NAME_draw(NAME_about(wo), u1, u2);
}

// Density of drawing wi for wo, per solid angle; 0 unless both are above the horizon.
MERLKIT_FN float NAME_pdf(merlkit_vec3 wo, merlkit_vec3 wi)
{
    return NAME_density_of(NAME_about(wo), wi);
}
