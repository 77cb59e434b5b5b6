
// ---- Values: @POSITIONS@ ----

#define NAME_PHI_BINS @PHI_BINS@
#define NAME_OFFSET @OFFSET@f
#ifdef MERLKIT_GLSL
#define NAME_VALUES
#else
#define NAME_VALUE(i) values[i]
#define NAME_VALUES values,
#endif
#ifdef NAME_VALUE
