// Directions leave the surface in a frame whose +z is the normal: wo to the viewer (given), wi to the light (drawn).
// Other lengths than 1 are renormalised. f is f_r, linear RGB in 1/sr without the cosine; pdf is in 1/sr. Both are 0 for what
// is no direction above the horizon. No draw fails for a wo above the horizon. Many draws with one wo are cheaper with
// merlkit_about about = merlkit_prepare(table, wo), then merlkit_draw_prepared(table, about, u1, u2) and
// merlkit_pdf_prepared(table, about, wi).
//
// The code is licensed as merlkit, MIT or Apache-2.0. The numbers in a file are the material's, under the terms of its data.

