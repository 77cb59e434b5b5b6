// ---- Drawing: the numbered steps of merlkit's docs/half-vector-table.md ----

// Number i of those of 16 bits from word `start` on.
MERLKIT_FN MERLKIT_UINT NAME_u16(@TABLE@MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (NAME_WORD(start + (i >> 1u)) >> ((i & 1u) << 4u)) & 0xffffu;
}

// Number i of those of 8 bits from word `start` on.
MERLKIT_FN MERLKIT_UINT NAME_u8(@TABLE@MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (NAME_WORD(start + (i >> 2u)) >> ((i & 3u) << 3u)) & 0xffu;
}

// Cap at the lower edge of a row.
MERLKIT_FN float NAME_cap(@TABLE@merlkit_about about, MERLKIT_UINT row)
{
    return NAME_edge_fixed(@PASS@row) + NAME_edge_weight(@PASS@row) * about.top;
}

// Probability of the rows up to and with this one, in 1/(65535 * 65536).
MERLKIT_FN MERLKIT_UINT NAME_to(@TABLE@merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * NAME_ROWS + row;
    MERLKIT_UINT b = about.second * NAME_ROWS + row;
    return merlkit_mix(NAME_u16(@PASS@NAME_CDF, a), NAME_u16(@PASS@NAME_CDF, b), about.weight);
}

MERLKIT_FN MERLKIT_UINT NAME_below(@TABLE@merlkit_about about, MERLKIT_UINT row)
{
    if (row == 0u) {
        return 0u;
    }
    return NAME_to(@PASS@about, row - 1u);
}

MERLKIT_FN float NAME_slope(@TABLE@merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * NAME_ROWS + row;
    MERLKIT_UINT b = about.second * NAME_ROWS + row;
    // Stored slopes are 128 too large, so their mix is 128 * 65536 too large.
    MERLKIT_UINT mixed = merlkit_mix(NAME_u8(@PASS@NAME_SLOPES, a), NAME_u8(@PASS@NAME_SLOPES, b), about.weight);
    return MERLKIT_TO_FLOAT(MERLKIT_TO_INT(mixed) - 8388608) * 1.1920929e-7f;
}

MERLKIT_FN MERLKIT_UINT NAME_node(@TABLE@merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT node)
{
    MERLKIT_UINT a = (about.first * NAME_ROWS + row) * (NAME_SEGMENTS + 1u) + node;
    MERLKIT_UINT b = (about.second * NAME_ROWS + row) * (NAME_SEGMENTS + 1u) + node;
    return merlkit_mix(NAME_u16(@PASS@NAME_DENSITY, a), NAME_u16(@PASS@NAME_DENSITY, b), about.weight);
}

MERLKIT_FN merlkit_segment NAME_segment(@TABLE@merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT index)
{
    merlkit_segment segment;
    segment.index = MERLKIT_TO_FLOAT(index);
    segment.low = MERLKIT_TO_FLOAT(NAME_node(@PASS@about, row, index));
    segment.high = MERLKIT_TO_FLOAT(NAME_node(@PASS@about, row, index + 1u));
    return segment;
}

// Steps 1 to 5: what depends on wo alone, for many draws or densities with one wo.
MERLKIT_FN merlkit_about NAME_about(@TABLE@merlkit_vec3 wo)
{
    merlkit_vec3 unit = merlkit_unit(wo);
    merlkit_about about = merlkit_square(merlkit_v(0.0f, 0.0f, 1.0f));
    if (!(unit.z > 0.0f)) {
        about.cos_o = 0.0f;
        return about;
    }
    about = merlkit_square(unit);
    MERLKIT_UINT low = 0u;
    MERLKIT_UINT high = NAME_TABLES - 1u;
    while (low < high) {
        MERLKIT_UINT middle = (low + high) >> 1u;
        if (NAME_cosine(@PASS@middle) > about.cos_o) {
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
    float above = NAME_cosine(@PASS@about.first);
    float below = NAME_cosine(@PASS@about.second);
    if (above > below) {
        float weight = merlkit_min(merlkit_max((above - about.cos_o) / (above - below), 0.0f), 1.0f);
        about.weight = MERLKIT_TO_UINT(weight * 65536.0f + 0.5f);
    }
    return about;
}

// Steps 18 to 22: NAME_pdf for the wo that `about` was made of.
MERLKIT_FN float NAME_density_of(@TABLE@merlkit_about about, merlkit_vec3 wi)
{
    merlkit_vec3 unit = merlkit_unit(wi);
    if (!(about.cos_o > 0.0f && unit.z > 0.0f)) {
        return 0.0f;
    }
    merlkit_place place = merlkit_place_of(about, unit);
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT end = NAME_ROWS;
    while (row + 1u < end) {
        MERLKIT_UINT middle = (row + end) >> 1u;
        if (NAME_cap(@PASS@about, middle) <= place.cap) {
            row = middle;
        } else {
            end = middle;
        }
    }
    float low = NAME_cap(@PASS@about, row);
    float width = NAME_cap(@PASS@about, row + 1u) - low;
    float y = 0.5f * (place.b + 1.0f);
    if (NAME_FOLD == 1u) {
        y = MERLKIT_ABS(place.b);
    }
    float at = y * MERLKIT_TO_FLOAT(NAME_SEGMENTS);
    MERLKIT_UINT index = MERLKIT_TO_UINT(at);
    if (index >= NAME_SEGMENTS) {
        index = NAME_SEGMENTS - 1u;
    }
    merlkit_segment segment = NAME_segment(@PASS@about, row, index);
    float x = merlkit_min(merlkit_max((place.cap - low) / width, 0.0f), 1.0f);
    float along = MERLKIT_TO_FLOAT(NAME_to(@PASS@about, row) - NAME_below(@PASS@about, row)) * @ROW_UNIT@f
            * (1.0f + NAME_slope(@PASS@about, row) * (2.0f * x - 1.0f));
    float across = segment.low + (segment.high - segment.low) * (at - segment.index);
    return merlkit_min(along * across * NAME_NODE_UNIT / (width * place.jacobian), 3.4028234e38f);
}

// Steps 7 to 17: NAME_sample for the wo that `about` was made of.
MERLKIT_FN merlkit_draw NAME_draw(@TABLE@merlkit_about about, float u1, float u2)
{
    merlkit_draw draw;
    draw.wi = merlkit_v(0.0f, 0.0f, 0.0f);
    draw.pdf = 0.0f;
    if (!(about.cos_o > 0.0f)) {
        return draw;
    }
    float v = merlkit_point(u2);
    float side = 2.0f * v - 1.0f;
    if (NAME_FOLD == 1u) {
        v = MERLKIT_ABS(side);
    }
    MERLKIT_UINT goal = merlkit_row_target(merlkit_point(u1));
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT last = NAME_ROWS - 1u;
    while (row < last) {
        MERLKIT_UINT middle = (row + last) >> 1u;
        if (NAME_to(@PASS@about, middle) <= goal) {
            row = middle + 1u;
        } else {
            last = middle;
        }
    }
    MERLKIT_UINT below = NAME_below(@PASS@about, row);
    float fraction = MERLKIT_TO_FLOAT(goal - below) / MERLKIT_TO_FLOAT(NAME_to(@PASS@about, row) - below);
    float low = NAME_cap(@PASS@about, row);
    float cap = merlkit_find_on_slope(NAME_slope(@PASS@about, row), merlkit_min(fraction, 1.0f));
    cap = low + (NAME_cap(@PASS@about, row + 1u) - low) * cap;
    goal = merlkit_node_target(v);
    below = 0u;
    MERLKIT_UINT sum = 0u;
    MERLKIT_UINT index = 0u;
    MERLKIT_UINT node = NAME_node(@PASS@about, row, 0u);
    while (index + 1u < NAME_SEGMENTS) {
        MERLKIT_UINT next = NAME_node(@PASS@about, row, index + 1u);
        sum += node + next;
        if (sum > goal) {
            break;
        }
        node = next;
        below = sum;
        index += 1u;
    }
    merlkit_segment segment = NAME_segment(@PASS@about, row, index);
    float b = (segment.index + merlkit_find_in(segment, MERLKIT_TO_FLOAT(goal - below))) * NAME_PER_SEGMENT;
    if (NAME_FOLD == 1u) {
        b = merlkit_pick(side < 0.0f, -b, b);
    } else {
        b = 2.0f * b - 1.0f;
    }
    draw.wi = merlkit_direction(about, cap, merlkit_min(merlkit_max(b, -1.0f), 1.0f));
    draw.pdf = NAME_density_of(@PASS@about, draw.wi);
    return draw;
}

// A direction wi for wo, from a point of [0, 1)^2; pdf 0 where wo is not above the horizon, and never otherwise.
MERLKIT_FN merlkit_draw NAME_sample(@TABLE@merlkit_vec3 wo, float u1, float u2)
{
    return NAME_draw(@PASS@NAME_about(@PASS@wo), u1, u2);
}

// Density of drawing wi for wo, per solid angle; 0 unless both are above the horizon.
MERLKIT_FN float NAME_pdf(@TABLE@merlkit_vec3 wo, merlkit_vec3 wi)
{
    return NAME_density_of(@PASS@NAME_about(@PASS@wo), wi);
}
