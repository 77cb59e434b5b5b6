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
