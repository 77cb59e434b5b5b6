// @FILE@.h: a measured material for C99, C++11, GLSL 4.30 and GLSL ES 3.00 or later, written by merlkit @VERSION@
//
// Define MERLKIT_STDIO before including it for NAME_load, which uses stdio; nothing else does.
//
//     float *values = NAME_load("@FILE@.f32");         // NULL if it can't be read; free() it at the end
//     merlkit_draw draw = NAME_sample(wo, u1, u2);     // from a point of [0, 1)^2, random or well spread
//     merlkit_vec3 f = NAME_eval(values, wo, draw.wi); // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     float pdf = NAME_pdf(wo, wi);                    // of any direction, for multiple importance sampling
//
// In GLSL, say where the values of @FILE@.f32 are, then include or paste this text; eval is without `values`:
//
//     layout(std430, binding = 0) readonly buffer NAME_block { float NAME_values[]; };
//     #define NAME_VALUE(i) NAME_values[i]
//
// A table of more than some 8 KB should go in a buffer, too: drivers take minutes to compile large constants. Upload the array
// NAME_words of this header as C or C++ has it, and say where its words are; the text then leaves the array out:
//
//     layout(std430, binding = 1) readonly buffer NAME_tables { uint NAME_table[]; };
//     #define NAME_WORD(i) NAME_table[i]
//
// GLSL ES 3.00 has no buffers: let both macros read a texture by texelFetch. merlkit export --format runtime writes files that
// one header and one shader load, instead of a header for each material.
//
// Directions leave the surface in a frame whose +z is the normal: wo to the viewer (given), wi to the light (drawn).
// They are merlkit_vec3, a struct of x, y, z; vec3 in GLSL. Other lengths than 1 are renormalised. f is f_r, linear RGB
// in 1/sr without the cosine; pdf is in 1/sr. Both are 0 for what is no direction above the horizon, and for NaN. No
// draw fails for a wo above the horizon. For many draws about one wo: merlkit_about about = NAME_about(wo), then
// NAME_draw(about, u1, u2) and NAME_density_of(about, wi).
//
// @FILE@.f32 holds @FLOATS@ little-endian f32 without a header: f_r in 1/sr, MERL's factors applied, as
// [theta_h (90), theta_d (90), phi_d (@PHI_BINS@), red green blue], the last index the fastest. -1 stands where
// nothing was measured, in all three channels or, if they were kept apart, in some.
//
// Made of @FILE@, SHA-256 @SHA256@,
// by the @LOOKUP@ lookup. Draws are in proportion to the @IMPORTANCE@ of the channels and the cosine, by @TABLES@ tables of
// @ROWS@ rows and @SEGMENTS@ segments@FOLDED@.
//
// The code is licensed as merlkit, MIT or Apache-2.0. The numbers are the material's, under the terms of its data:
// @LICENCE@

