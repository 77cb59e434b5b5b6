//! Sums of formulas: "lambert:reflectance=0.2+ggx:ax=0.1,ay=0.1".

use std::sync::Arc;

use glam::Vec3;

use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::Symmetry;

/// The formulas of a sum: what lies between those `+` that a letter follows, so that the exponent of 1e+5 is no sum.
pub(super) fn split_terms(argument: &str) -> Vec<&str> {
    let bytes = argument.as_bytes();
    let mut terms = Vec::new();
    let mut start = 0;
    for (i, byte) in bytes.iter().enumerate() {
        let letter_follows = bytes.get(i + 1).is_some_and(u8::is_ascii_alphabetic);
        if *byte == b'+' && i > start && letter_follows {
            terms.push(&argument[start..i]);
            start = i + 1;
        }
    }
    terms.push(&argument[start..]);
    terms
}

/// f_r as the sum of those of several BRDFs.
pub(super) struct SumBrdf {
    pub(super) terms: Vec<Arc<dyn Brdf>>,
}

impl Brdf for SumBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let mut sum = glam::DVec3::ZERO;
        for term in &self.terms {
            sum += term.eval(wo, wi).as_dvec3();
        }
        sum.as_vec3().min(Rgb::splat(f32::MAX))
    }

    fn mirror(&self, wo: Vec3) -> Option<Rgb> {
        let mut sum: Option<Rgb> = None;
        for term in &self.terms {
            if let Some(part) = term.mirror(wo) {
                sum = Some(sum.unwrap_or_default() + part);
            }
        }
        sum
    }

    fn is_isotropic(&self) -> bool {
        self.symmetry() == Symmetry::Isotropic
    }

    /// The least symmetry of the terms.
    fn symmetry(&self) -> Symmetry {
        let mut least = Symmetry::Isotropic;
        for term in &self.terms {
            if term.symmetry().span() > least.span() {
                least = term.symmetry();
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_is_split_at_its_signs_alone() {
        for (text, terms) in [
            ("nickel", vec!["nickel"]),
            ("lambert+ggx:ax=0.1", vec!["lambert", "ggx:ax=0.1"]),
            (
                "blinn:n=1e+5,ks=0.1+ward",
                vec!["blinn:n=1e+5,ks=0.1", "ward"],
            ),
            ("c++", vec!["c++"]),
            ("+ggx", vec!["+ggx"]),
        ] {
            assert_eq!(split_terms(text), terms);
        }
    }
}
