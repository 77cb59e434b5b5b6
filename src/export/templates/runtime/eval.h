
// f_r of wo and wi in 1/sr by the table's lookup rule, without the cosine; 0 unless both are above the horizon, and where
// nothing was measured.
MERLKIT_FN merlkit_vec3 merlkit_eval(@TABLE@merlkit_vec3 wo, merlkit_vec3 wi)
{
    if (@T@rule == 0u) {
        return merlkit_eval_floor(@PASS@wo, wi);
    }
    return merlkit_eval_linear(@PASS@wo, wi);
}
