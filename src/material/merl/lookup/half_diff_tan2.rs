//! Squared tangents of a pair's half and difference angles, in arithmetic that a compiler turns into vector code.

use glam::Vec3;

/// The squared tangents of θh, θd and φd, in f64: ratios of polynomials in the directions' components (see
/// [`crate::geometry::HalfDiff::from_directions`]), without a branch, a square root or trigonometry.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::material::merl) struct HalfDiffTan2 {
    /// tan²θh, 0 to infinity; NaN unless both directions are finite and above the horizon.
    pub theta_h: f64,
    /// tan²θd, 0 to infinity.
    pub theta_d: f64,
    /// tan²φd, negated where tan φd < 0. NaN where wi = wo, which counts as φd = 0.
    pub phi_d: f64,
    /// Negative in the second half turn of φd: −π < φd < 0, and φd = π, which counts as part of it.
    pub half_turn: f64,
}

impl HalfDiffTan2 {
    /// Squared tangents of a pair. Where `theta_h` is 0, `phi_d` and `half_turn` mean nothing: φd is the azimuth of `wi`.
    ///
    /// Products of two f32 are exact in f64, so the difference of products keeps its digits where it cancels.
    #[inline(always)]
    pub fn from_directions(wo: Vec3, wi: Vec3) -> Self {
        let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
        let (sum, difference) = (o + i, o - i);
        let across = o.x * i.y - o.y * i.x;
        let rho2 = sum.x * sum.x + sum.y * sum.y;
        let z2 = sum.z * sum.z;
        let length2 = rho2 + z2;
        let dz2 = difference.z * difference.z;
        let tan2_phi = 4.0 * across * across / (length2 * dz2);
        // No finite f32 overflows or underflows here: the sum of squares is finite exactly where all components are, and
        // both heights are positive where their product and their sum are. Asked of f64 values alone, this lets the
        // conversions work in place; else each call would wait for whatever the last one left in a register.
        let valid = (o.z * i.z > 0.0) & (sum.z > 0.0) & (length2 < f64::INFINITY);
        // In one plane with the normal φd is 0, or π, of which the tangent counts as positive.
        let rising = (across * difference.z > 0.0) | (across == 0.0);
        Self {
            theta_h: if valid { rho2 / z2 } else { f64::NAN },
            theta_d: (difference.x * difference.x + difference.y * difference.y + dz2) / length2,
            phi_d: if rising { tan2_phi } else { -tan2_phi },
            half_turn: if across != 0.0 { across } else { difference.z },
        }
    }
}
