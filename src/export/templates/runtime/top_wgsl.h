// merlkit.wgsl: measured materials from files at run time, for WGSL, written by merlkit @VERSION@
//
//     let nickel = merlkit_open(0u);                           // the file that begins at word 0
//     let draw = merlkit_sample(nickel, wo, u1, u2);           // from a point of [0, 1)^2, random or well spread
//     let f = merlkit_eval(nickel, wo, draw.wi);               // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     let pdf = merlkit_pdf(nickel, wo, wi);                   // of any direction, for multiple importance sampling
//
// Add this text to yours, which says where the words of the files are, one file after the other:
//
//     @AT@group(0) @AT@binding(0) var<storage, read> merlkit_words: array<u32>;
//     fn merlkit_word(i: u32) -> u32 { return merlkit_words[i]; }
//
// Files are not checked here; the host does that with merlkit_load of merlkit.h.
//
