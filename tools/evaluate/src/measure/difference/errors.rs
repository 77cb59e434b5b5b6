//! Relative errors of luminance.

use serde::{Deserialize, Serialize};

/// How far a picture is from its reference, by luminance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PictureErrors {
    /// Mean of |picture − reference|/reference over the pixels that are lit in the reference (thesis 6.4).
    pub mean_relative: f64,
    /// Mean of (picture − reference)²/(reference² + ε) over all pixels, ε a hundredth of the squared mean of the reference.
    pub rel_mse: f64,
}

/// Fraction of the reference's mean luminance from which on a pixel counts as lit.
pub const LIT_FROM: f64 = 1e-4;

/// Mean of some numbers; 0 of none.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Errors of luminances against those of a reference of the same size; 0 for a black reference.
pub(crate) fn luminance_errors(found: &[f64], reference: &[f64]) -> PictureErrors {
    let level = mean(reference.iter().copied());
    if level <= 0.0 {
        return PictureErrors::default();
    }
    let floor = 0.01 * level * level;
    let (mut relative, mut lit, mut squared) = (0.0, 0u64, 0.0);
    for (f, r) in found.iter().zip(reference) {
        if *r > LIT_FROM * level {
            relative += (f - r).abs() / r;
            lit += 1;
        }
        squared += (f - r).powi(2) / (r * r + floor);
    }
    PictureErrors {
        mean_relative: relative / lit.max(1) as f64,
        rel_mse: squared / reference.len() as f64,
    }
}
