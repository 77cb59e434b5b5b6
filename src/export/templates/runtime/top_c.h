// merlkit.h: measured materials from files at run time, for C99, C++11 and CUDA, written by merlkit @VERSION@
//
//     merlkit_table nickel;
//     int status = merlkit_load(bytes, length, &nickel);       // of nickel.merlkit; merlkit_message(status) says what is wrong
//     merlkit_draw draw = merlkit_sample(&nickel, wo, u1, u2); // from a point of [0, 1)^2, random or well spread
//     merlkit_vec3 f = merlkit_eval(&nickel, wo, draw.wi);     // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     float pdf = merlkit_pdf(&nickel, wo, wi);                // of any direction, for multiple importance sampling
//
// `bytes` is the whole file in memory that is aligned to 4 bytes: malloc and mmap return such memory. It is neither copied nor
// changed, so it must outlive the table. Nothing is allocated and nothing is global: any number of threads may use a table.
// merlkit_load reads every byte once and accepts only files with which no later call reads outside of them.
//
// Define MERLKIT_STDIO before including this file for merlkit_load_file(path, &table) and merlkit_free(&table), which use
// stdio and malloc.
//
// Directions leave the surface in a frame whose +z is the normal: wo to the viewer (given), wi to the light (drawn).
// They are merlkit_vec3, a struct of x, y and z; merlkit_v(x, y, z) makes one. Other lengths than 1 are renormalised. f is f_r,
// linear RGB in 1/sr without the cosine; pdf is in 1/sr. Both are 0 for what is no direction above the horizon, and for NaN.
// No draw fails for a wo above the horizon. Many draws with one wo are cheaper with merlkit_about about =
// merlkit_prepare(&table, wo), then merlkit_draw_prepared(&table, about, u1, u2) and merlkit_pdf_prepared(&table, about, wi).
//
// Macros that may be defined before: MERLKIT_FN (what functions of the maths begin with, static inline; in CUDA
// `static inline __host__ __device__`), MERLKIT_SQRT(x) and MERLKIT_ABS(x) of floats (with both, math.h is not included), and
// MERLKIT_BITS(x) (the float whose bits are the uint32_t x).
//
// On a GPU the maths needs the words of the file there: load the table on the host, upload the bytes, and give the kernel a
// copy of the merlkit_table whose member `words` points to the upload. merlkit.glsl, merlkit.hlsl and merlkit.wgsl are the
// same maths as shaders.
//
// The code is licensed as merlkit, MIT or Apache-2.0. The numbers in a file are the material's, under the terms of its data.

#ifndef MERLKIT_H
#define MERLKIT_H

