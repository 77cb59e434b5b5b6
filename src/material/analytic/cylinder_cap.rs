//! The integral of Poulin and Fournier's model over the visible part of a cylinder.

use std::f64::consts::{FRAC_1_PI, PI};

use super::pair::clamped_power;
use super::phong::Phong;

/// The points of Gauss and Legendre's rule of 20 points on [−1, 1] that are positive, and their weights.
const RULE: [(f64, f64); 10] = [
    (0.993_128_599_185_094_9, 0.017_614_007_139_152_118),
    (0.963_971_927_277_913_8, 0.040_601_429_800_386_94),
    (0.912_234_428_251_326, 0.062_672_048_334_109_06),
    (0.839_116_971_822_218_8, 0.083_276_741_576_704_75),
    (0.746_331_906_460_150_8, 0.101_930_119_817_240_43),
    (0.636_053_680_726_515, 0.118_194_531_961_518_42),
    (0.510_867_001_950_827_1, 0.131_688_638_449_176_63),
    (0.373_706_088_715_419_55, 0.142_096_109_318_382_05),
    (0.227_785_851_141_645_08, 0.149_172_986_472_603_75),
    (0.076_526_521_133_497_33, 0.152_753_387_130_725_85),
];

/// The lobe is integrated where it is at least e^(−20) of its largest value, so that the points of the rule are where it is.
const LARGEST_FALL: f64 = 20.0;
/// A lobe that falls by more than e^(−8) up to s = ±1 is narrow: the square root in ds hardly counts there.
const NARROW: f64 = 8.0;

/// Both directions in the plane across the cylinders, at the normals (0, sin ψ, cos ψ).
///
/// With P the product of their lengths in that plane and x = ψ − `middle`, their cosines have the product
/// (n·u)(n·v) = ½P·(cos 2x + `cos_between`), and the cosine of Phong's lobe is cosα = 2(n·u)(n·v) − u·v = P·cos 2x − `along`.
pub(super) struct CylinderCap {
    /// P.
    pub(super) product: f64,
    /// The mean of the angles of both directions in that plane, from the normal of the surface.
    pub(super) middle: f64,
    /// Cosine of the difference of these angles.
    pub(super) cos_between: f64,
    /// ux·vx, the product of both components along the cylinders.
    pub(super) along: f64,
}

impl CylinderCap {
    /// ∫ f0(n)(n·u)(n·v) dψ from `low` to `high`, where both directions are above the cylinder's tangent plane; 0 if `low` is not
    /// less than `high`.
    pub(super) fn integrate(&self, local: &Phong, [low, high]: [f64; 2]) -> f64 {
        if low >= high {
            return 0.0;
        }
        let ends = [low - self.middle, high - self.middle];
        local.kd * FRAC_1_PI * self.integrate_cosines(ends)
            + local.ks * (local.n + 2.0) / (2.0 * PI) * self.integrate_lobe(local.n, ends)
    }

    /// ∫ ½P·(cos 2x + c) dx = ½P·(½ sin 2x + c·x).
    fn integrate_cosines(&self, [low, high]: [f64; 2]) -> f64 {
        let sines = (2.0 * high).sin() - (2.0 * low).sin();
        0.5 * self.product * (0.5 * sines + self.cos_between * (high - low))
    }

    /// ∫ max(cosα, 0)ⁿ·½P·(cos 2x + c) dx.
    fn integrate_lobe(&self, n: f64, ends: [f64; 2]) -> f64 {
        // cosα = peak·(1 − sin²x/κ²) with κ² = peak/2P; the lobe is black where no normal reaches a positive cosine.
        let peak = self.product - self.along;
        if peak <= 0.0 {
            return 0.0;
        }
        let kappa2 = 0.5 * peak / self.product;
        // s = sin x/k with k = min(κ, 1) makes the lobe peak·(1 − r·s²), r = k²/κ², and s at most 1.
        let k = kappa2.sqrt().min(1.0);
        let r = (1.0 / kappa2).min(1.0);
        let mut ends = cut_tails(n, r, ends.map(|x| (x.sin() / k).clamp(-1.0, 1.0)));
        // Where the lobe is not small at s = ±1, s = sin w makes it smooth there.
        let is_narrow = n * r > NARROW;
        if !is_narrow {
            ends = ends.map(f64::asin);
        }
        let (centre, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        // Rounding can leave nothing of a part near s = ±1.
        if half <= 0.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for (point, weight) in RULE {
            for t in [centre - half * point, centre + half * point] {
                let (s, slope) = if is_narrow { (t, 1.0) } else { t.sin_cos() };
                // dx = k/√(1 − k²·s²) ds, and cos 2x = 1 − 2·sin²x.
                let sin2_x = (k * s).powi(2);
                let width = k * slope / (1.0 - sin2_x).sqrt();
                let lobe = clamped_power(peak * (1.0 - r * s * s), n);
                sum += weight * width * lobe * (1.0 - 2.0 * sin2_x + self.cos_between);
            }
        }
        0.5 * self.product * half * sum
    }
}

/// The part of a range of s where (1 − r·s²)ⁿ is at least e^(−20) of its largest value there.
fn cut_tails(n: f64, r: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    // The lobe is largest at the s nearest to 0.
    let nearest = low.max(-high).max(0.0).powi(2);
    // 1 − r·s² = (1 − r·nearest)·e^(−20/n), solved for s.
    let fall = -(-LARGEST_FALL / n).exp_m1();
    let farthest = nearest + (1.0 / r - nearest) * fall;
    let end = farthest.min(1.0).sqrt();
    [low.max(-end), high.min(end)]
}
