//! What a sampler costs and whether it is right: quadrature, spread and bias of its weights, chi-square, checks.
//!
//! Everything here returns plain results; printing and files are [`crate`]'s report's business. Results are the same bits
//! for any number of threads.

pub mod accuracy;
pub mod check;
pub mod chi_square;
mod expected;
mod half_vectors;
mod probe;
pub mod quadrature;
