#ifndef MERLKIT_SHARED
#define MERLKIT_SHARED 2

// ---- What languages spell differently ----

@SPELLING@
@MATHS@#endif
#if MERLKIT_SHARED != 2
#error "these headers are of different versions of merlkit: export them together"
#endif

