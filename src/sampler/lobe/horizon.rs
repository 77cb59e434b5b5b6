//! The mass above the horizon of a cosine lobe about the mirror direction.
//!
//! Spherical coordinates about the axis that lies both on the horizon and in the plane across the mirror direction turn the
//! half space of the lobe and that above the horizon into ranges of one angle ψ, in which the density is cosⁿψ times a function of the other:
//!
//! ```text
//! M(θ) = ∫ cosⁿψ dψ over [θ − π/2, π/2] / ∫ cosⁿψ dψ over [−π/2, π/2]
//! ```

use std::f64::consts::FRAC_PI_2;

/// M at equal steps of s = cosθ·√(n + 1), the scale on which it rises from ½ to 1.
#[derive(Clone, Debug)]
pub(super) struct HorizonMass(Vec<f64>);

/// Steps of s up to √(n + 1), which belongs to θ = 0, but not beyond the s at which nothing is below the horizon any more.
const STEPS: usize = 1024;
const FARTHEST: f64 = 8.0;
/// Points between two steps, by which cosⁿψ is integrated.
const POINTS: usize = 8;

impl HorizonMass {
    /// For the exponent `n` ≥ 1.
    pub fn new(n: f64) -> Self {
        let scale = (n + 1.0).sqrt();
        let reach = FARTHEST.min(scale);
        // Step 1: ∫ cosⁿψ dψ from 0 to the angle of elevation whose sine is s/√(n + 1), by midpoints.
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        let mut below = 0.0;
        for step in 1..=STEPS {
            let sine = (reach * step as f64 / STEPS as f64 / scale).min(1.0);
            let above = sine.asin();
            for point in 0..POINTS {
                let width = (above - below) / POINTS as f64;
                let psi: f64 = below + (point as f64 + 0.5) * width;
                sum += width * psi.cos().max(0.0).powf(n);
            }
            sums.push(sum);
            below = above;
        }
        // Step 2: M = (∫ over half of the range + ∫ up to the elevation)/∫ over the whole. At the last step little is left.
        let rest = (FRAC_PI_2 - below).max(0.0);
        let half = sum + rest * 0.5 * below.cos().max(0.0).powf(n);
        Self(sums.into_iter().map(|s| 0.5 + 0.5 * s / half).collect())
    }

    /// M at `cos_theta` > 0 for the exponent `n` that it was made with.
    #[inline]
    pub fn at_cosine(&self, cos_theta: f64, n: f64) -> f64 {
        let scale = (n + 1.0).sqrt();
        let steps = cos_theta * scale * (STEPS as f64 / FARTHEST.min(scale));
        let k = (steps as usize).min(STEPS - 1);
        let t = (steps - k as f64).min(1.0);
        self.0[k] + t * (self.0[k + 1] - self.0[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M = (1 + cosθ)/2 for n = 1.
    #[test]
    fn closed_forms_are_met() {
        for k in 1..90 {
            let theta = f64::from(k).to_radians();
            let cosine = HorizonMass::new(1.0).at_cosine(theta.cos(), 1.0);
            assert!(
                (cosine - 0.5 - 0.5 * theta.cos()).abs() < 2e-5,
                "{k}: {cosine}"
            );
        }
        for n in [1.0, 30.0, 1e7] {
            let mass = HorizonMass::new(n);
            assert_eq!(mass.at_cosine(0.0, n), 0.5);
            assert!((mass.at_cosine(1.0, n) - 1.0).abs() < 1e-6);
        }
    }
}
