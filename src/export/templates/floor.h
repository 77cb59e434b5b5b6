// f_r by the bin that holds the angles, as MERL's own reader: 1/sr, without the cosine; 0 unless both directions are above
// the horizon, and where nothing was measured.
MERLKIT_FN merlkit_vec3 @EVAL_FLOOR@(@VALUES@merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, NAME_PHI_BINS);
    int cell = merlkit_bin(at.theta_d, 90) + 90 * merlkit_bin(at.theta_h, 90);
    cell = 3 * (merlkit_bin(at.phi_d, NAME_PHI_BINS) + NAME_PHI_BINS * cell);
    return merlkit_v(merlkit_max(NAME_VALUE(cell), 0.0f), merlkit_max(NAME_VALUE(cell + 1), 0.0f),
                     merlkit_max(NAME_VALUE(cell + 2), 0.0f));
}
