// A bin's value and the weight 1 where it holds one, zeros elsewhere.
MERLKIT_FN merlkit_cell NAME_bin(@VALUES@int theta_h, int theta_d, int phi_d)
{
    merlkit_cell cell;
    int at = 3 * (phi_d + NAME_PHI_BINS * (theta_d + 90 * theta_h));
    bool valid = NAME_VALUE(at) >= 0.0f;
    cell.r = merlkit_pick(valid, NAME_VALUE(at), 0.0f);
    cell.g = merlkit_pick(valid, NAME_VALUE(at + 1), 0.0f);
    cell.b = merlkit_pick(valid, NAME_VALUE(at + 2), 0.0f);
    cell.valid = merlkit_pick(valid, 1.0f, 0.0f);
    return cell;
}

MERLKIT_FN merlkit_cell NAME_row(@VALUES@int theta_h, int theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(NAME_bin(@PASS_VALUES@theta_h, theta_d, phi_d.low),
                             NAME_bin(@PASS_VALUES@theta_h, theta_d, phi_d.high), phi_d.weight);
}

MERLKIT_FN merlkit_cell NAME_plane(@VALUES@int theta_h, merlkit_pair theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(NAME_row(@PASS_VALUES@theta_h, theta_d.low, phi_d),
                             NAME_row(@PASS_VALUES@theta_h, theta_d.high, phi_d), theta_d.weight);
}

// f_r, linear between bins; those where nothing was measured are left out. 1/sr, without the cosine; 0 unless both
// directions are above the horizon, and where no bin around them holds a value.
MERLKIT_FN merlkit_vec3 @EVAL_LINEAR@(@VALUES@merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, NAME_PHI_BINS);
    merlkit_pair theta_h = merlkit_clamped(at.theta_h - NAME_OFFSET, 90);
    merlkit_pair theta_d = merlkit_clamped(at.theta_d - NAME_OFFSET, 90);
    merlkit_pair phi_d = merlkit_periodic(at.phi_d - NAME_OFFSET, NAME_PHI_BINS);
    merlkit_cell mean = merlkit_mix_cells(NAME_plane(@PASS_VALUES@theta_h.low, theta_d, phi_d),
                                          NAME_plane(@PASS_VALUES@theta_h.high, theta_d, phi_d), theta_h.weight);
    if (!(mean.valid > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    return merlkit_v(merlkit_min(mean.r / mean.valid, 3.4028234e38f), merlkit_min(mean.g / mean.valid, 3.4028234e38f),
                     merlkit_min(mean.b / mean.valid, 3.4028234e38f));
}
