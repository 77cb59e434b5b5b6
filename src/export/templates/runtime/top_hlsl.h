// merlkit.hlsl: measured materials from files at run time, for HLSL of shader model 5 and later, written by merlkit @VERSION@
//
//     merlkit_table nickel = merlkit_open(0u);                 // the file that begins at word 0
//     merlkit_draw draw = merlkit_sample(nickel, wo, u1, u2);  // from a point of [0, 1)^2, random or well spread
//     float3 f = merlkit_eval(nickel, wo, draw.wi);            // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     float pdf = merlkit_pdf(nickel, wo, wi);                 // of any direction, for multiple importance sampling
//
// The words of the files, one file after the other, are the elements of StructuredBuffer<uint> merlkit_words. Define
// MERLKIT_WORD(i) before to have them elsewhere, such as in a ByteAddressBuffer: i is a uint. Files are not checked here; the
// host does that with merlkit_load of merlkit.h.
//
