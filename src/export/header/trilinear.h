
// ---- Values: linear between bins, which stand at @STANDING@; bins where nothing was measured are left out ----

#define NAME_PHI_BINS @PHI_BINS@
#ifndef MERLKIT_GLSL
#define NAME_VALUE(i) values[i]
#define NAME_VALUES values,
#else
#define NAME_VALUES
#endif
#ifdef NAME_VALUE
// A bin's value by a share, and the share itself where the bin holds one.
MERLKIT_FN merlkit_cell NAME_bin(MERLKIT_VALUES int theta_h, int theta_d, int phi_d)
{
    merlkit_cell cell;
    int at = 3 * (phi_d + NAME_PHI_BINS * (theta_d + 90 * theta_h));
    bool valid = NAME_VALUE(at) >= 0.0f;
    cell.r = valid ? NAME_VALUE(at) : 0.0f;
    cell.g = valid ? NAME_VALUE(at + 1) : 0.0f;
    cell.b = valid ? NAME_VALUE(at + 2) : 0.0f;
    cell.valid = valid ? 1.0f : 0.0f;
    return cell;
}

MERLKIT_FN merlkit_cell NAME_row(MERLKIT_VALUES int theta_h, int theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(NAME_bin(NAME_VALUES theta_h, theta_d, phi_d.low),
                             NAME_bin(NAME_VALUES theta_h, theta_d, phi_d.high), phi_d.share);
}

MERLKIT_FN merlkit_cell NAME_plane(MERLKIT_VALUES int theta_h, merlkit_pair theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(NAME_row(NAME_VALUES theta_h, theta_d.low, phi_d),
                             NAME_row(NAME_VALUES theta_h, theta_d.high, phi_d), theta_d.share);
}

// f_r of wo and wi in 1/sr, without the cosine; 0 unless both are above the horizon, and where nothing was measured.
MERLKIT_FN merlkit_vec3 NAME_eval(MERLKIT_VALUES merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    merlkit_bins at;
    merlkit_pair theta_h, theta_d, phi_d;
    merlkit_cell mean;
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    at = merlkit_bins_of(o, i, NAME_PHI_BINS);
    theta_h = merlkit_clamped(at.theta_h - @OFFSET@f, 90);
    theta_d = merlkit_clamped(at.theta_d - @OFFSET@f, 90);
    phi_d = merlkit_periodic(at.phi_d - @OFFSET@f, NAME_PHI_BINS);
    mean = merlkit_mix_cells(NAME_plane(NAME_VALUES theta_h.low, theta_d, phi_d),
                             NAME_plane(NAME_VALUES theta_h.high, theta_d, phi_d), theta_h.share);
    if (!(mean.valid > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    return merlkit_v(merlkit_min(mean.r / mean.valid, 3.4028234e38f), merlkit_min(mean.g / mean.valid, 3.4028234e38f),
                     merlkit_min(mean.b / mean.valid, 3.4028234e38f));
}
#endif
