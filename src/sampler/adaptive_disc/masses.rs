//! ∫ f over a leaf of a BRDF that is not a table, and that of min(f, bound), by which densities are divided.
//!
//! Gauss's rules in x and y where the square keeps away from the rim of the disc. At the rim f may depend on cosθ, which has
//! a root there; polar coordinates on the hemisphere are smooth: dx dy = sinθ cosθ dθ dφ.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3, Vec3};

use super::quad_cell::{DEEPEST, QuadCell};
use super::scouts::{Scouts, about_disc};
use super::slice::{BATCH, Slice};

/// Gauss's points on [−1, 1] and their weights: three points, and five.
const GAUSS_3: [[f64; 2]; 3] = [
    [-0.774_596_669_241_483_4, 5.0 / 9.0],
    [0.0, 8.0 / 9.0],
    [0.774_596_669_241_483_4, 5.0 / 9.0],
];
const GAUSS_5: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
];

/// How far the two rules may differ, relative to the square's integral. The better one is off by a hundredth of that.
const TOLERANCE: f64 = 1e-4;
/// The same relative to ∫ f over the disc.
const NEGLIGIBLE: f64 = 1e-8;
/// A scout that met this many times the largest value at the points has seen what they have not.
const UNSEEN: f64 = 2.0;
/// Subdivisions below a leaf, and the depth down to which they go at least.
const FINER: u32 = 3;
const FINE: u32 = 10;

/// The integrals of one square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Masses {
    /// ∫ f dx dy.
    pub whole: f64,
    /// ∫ min(f, bound) dx dy.
    pub bounded: f64,
    /// Largest f at the points.
    largest: f64,
}

/// Integrates f over squares.
pub(super) struct MassRule<'a> {
    pub slice: &'a Slice<'a>,
    pub scouts: &'a Scouts,
}

impl MassRule<'_> {
    /// The integrals over the part of `square` inside the disc.
    pub fn integrate(&self, square: QuadCell, bound: f64) -> Masses {
        let depth = square.code() >> 28;
        let deepest = (depth + FINER).clamp(FINE, DEEPEST);
        self.refine(square, bound, depth, deepest)
    }

    fn refine(&self, square: QuadCell, bound: f64, depth: u32, deepest: u32) -> Masses {
        if square.inside_disc().is_none() {
            return Masses::default();
        }
        // Step 1: both rules. A square about the centre lies in no quadrant and is divided unseen.
        if depth > 0 {
            let rough = self.apply(square, bound, &GAUSS_3);
            let fine = self.apply(square, bound, &GAUSS_5);
            if depth >= deepest || self.is_settled(square, &rough, &fine) {
                return fine;
            }
        }
        // Step 2: where they differ, the sum over the quarters.
        let mut sum = Masses::default();
        for i in 0..4 {
            let part = self.refine(square.child(i), bound, depth + 1, deepest);
            sum.whole += part.whole;
            sum.bounded += part.bounded;
        }
        sum
    }

    fn is_settled(&self, square: QuadCell, rough: &Masses, fine: &Masses) -> bool {
        let allowed = TOLERANCE * fine.whole + NEGLIGIBLE * self.scouts.integral();
        let agree = (rough.whole - fine.whole).abs() <= allowed
            && (rough.bounded - fine.bounded).abs() <= allowed;
        let met = self
            .scouts
            .largest(about_disc(square.corner), 0.5 * square.side);
        let area = square.side * square.side;
        agree && (met <= UNSEEN * fine.largest || met * area <= allowed)
    }

    fn apply(&self, square: QuadCell, bound: f64, rule: &[[f64; 2]]) -> Masses {
        let far = square.corner.abs().max((square.corner + square.side).abs());
        let is_at_rim = far.length_squared() > 1.0 - 2.0 * square.side;
        let mut sum = PartialMasses::new(self.slice, bound);
        if is_at_rim {
            add_polar(square, rule, &mut sum);
        } else {
            add_cartesian(square, rule, &mut sum);
        }
        sum.finish()
    }
}

/// Sums over points in the order in which they are visited; a few of them are evaluated together.
struct PartialMasses<'a> {
    slice: &'a Slice<'a>,
    bound: f64,
    masses: Masses,
    wi: [Vec3; BATCH],
    weights: [f64; BATCH],
    waiting: usize,
}

impl<'a> PartialMasses<'a> {
    fn new(slice: &'a Slice<'a>, bound: f64) -> Self {
        Self {
            slice,
            bound,
            masses: Masses::default(),
            wi: [Vec3::ZERO; BATCH],
            weights: [0.0; BATCH],
            waiting: 0,
        }
    }

    fn add(&mut self, wi: DVec3, weight: f64) {
        self.wi[self.waiting] = wi.as_vec3();
        self.weights[self.waiting] = weight;
        self.waiting += 1;
        if self.waiting == BATCH {
            self.add_waiting();
        }
    }

    fn add_waiting(&mut self) {
        let mut values = [0.0; BATCH];
        let values = &mut values[..self.waiting];
        self.slice.values(&self.wi[..self.waiting], values);
        for (f, weight) in values.iter().zip(&self.weights) {
            self.masses.whole += weight * f;
            self.masses.bounded += weight * f.min(self.bound);
            self.masses.largest = self.masses.largest.max(*f);
        }
        self.waiting = 0;
    }

    fn finish(mut self) -> Masses {
        self.add_waiting();
        self.masses
    }
}

/// ∫∫ f dx dy over a square inside the disc.
fn add_cartesian(square: QuadCell, rule: &[[f64; 2]], sum: &mut PartialMasses<'_>) {
    let half = 0.5 * square.side;
    for &[x, wx] in rule {
        for &[y, wy] in rule {
            let p = square.corner + half * DVec2::new(1.0 + x, 1.0 + y);
            let z = (1.0 - p.length_squared()).max(0.0).sqrt();
            sum.add(p.extend(z), wx * wy * half * half);
        }
    }
}

/// ∫ dφ ∫ f sinθ cosθ dθ over the part of a square of one quadrant that lies inside the disc.
fn add_polar(square: QuadCell, rule: &[[f64; 2]], sum: &mut PartialMasses<'_>) {
    // Step 1: the square mirrored into the first quadrant.
    let middle = square.corner + 0.5 * square.side;
    let sign = DVec2::new(1f64.copysign(middle.x), 1f64.copysign(middle.y));
    let (a, b) = (square.corner * sign, (square.corner + square.side) * sign);
    let (low, high) = (a.min(b).max(DVec2::ZERO), a.max(b));
    // Step 2: the azimuths at which a ray from the centre enters or leaves it by another side, ascending.
    let azimuths = azimuth_cuts(low, high);
    for pair in azimuths.windows(2) {
        let half = 0.5 * (pair[1] - pair[0]);
        if half < 1e-14 {
            continue;
        }
        for &[x, wx] in rule {
            let (sin, cos) = (pair[0] + half * (1.0 + x)).sin_cos();
            // Step 3: the polar angles of the ray within the square and the disc.
            let near = (low.x / cos).max(low.y / sin).min(1.0).asin();
            let far = (high.x / cos).min(high.y / sin).min(1.0).asin();
            let reach = 0.5 * (far - near);
            if reach <= 0.0 {
                continue;
            }
            for &[y, wy] in rule {
                let (r, z) = (near + reach * (1.0 + y)).sin_cos();
                let wi = (sign * DVec2::new(r * cos, r * sin)).extend(z);
                sum.add(wi, wx * half * wy * reach * r * z);
            }
        }
    }
}

/// The azimuths of the corners of a square of the first quadrant, and of the points at which its sides cross the unit circle.
fn azimuth_cuts(low: DVec2, high: DVec2) -> Vec<f64> {
    let first = low.y.atan2(high.x);
    let last = high.y.atan2(low.x);
    let mut cuts = vec![first, last, high.y.atan2(high.x)];
    if low.length_squared() > 0.0 {
        cuts.push(low.y.atan2(low.x));
    }
    for x in [low.x, high.x] {
        if x < 1.0 {
            cuts.push(x.acos());
        }
    }
    for y in [low.y, high.y] {
        if y < 1.0 {
            cuts.push(y.asin());
        }
    }
    cuts.retain(|cut| (first..=last).contains(cut) && (0.0..=FRAC_PI_2).contains(cut));
    cuts.sort_unstable_by(f64::total_cmp);
    cuts
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_PI, PI};
    use std::sync::Arc;

    use super::*;
    use crate::brdf::Brdf;
    use crate::geometry::unit_upper;
    use crate::sampler::AdaptiveDiscSettings;

    /// A value of one direction alone.
    struct Sky(fn(Vec3) -> f32);

    impl Brdf for Sky {
        fn eval(&self, _: Vec3, wi: Vec3) -> Vec3 {
            unit_upper(wi).map_or(Vec3::ZERO, |wi| Vec3::splat((self.0)(wi)))
        }

        fn is_isotropic(&self) -> bool {
            true
        }
    }

    type ValueAndIntegral = (fn(Vec3) -> f32, f64);

    fn total(value: fn(Vec3) -> f32, bound: f64) -> Masses {
        let settings = AdaptiveDiscSettings::default();
        let brdf: Arc<dyn Brdf> = Arc::new(Sky(value));
        let slice = Slice::new(&*brdf, &settings, None, 0.7);
        let scouts = Scouts::send(&slice, about_disc);
        let rule = MassRule {
            slice: &slice,
            scouts: &scouts,
        };
        rule.integrate(QuadCell::ROOT, bound)
    }

    /// ∫ z^k dx dy = 2π/(k + 2), and ∫ min(1/z, b) dx dy = 2π (1 − 1/(2b)).
    #[test]
    fn closed_forms_are_met_at_the_rim_too() {
        let cases: [ValueAndIntegral; 5] = [
            (|_| 1.0, PI),
            (|wi| wi.z, 2.0 * PI / 3.0),
            (|wi| 1.0 / wi.z.max(1e-20), 2.0 * PI),
            (|wi| wi.z.max(1e-20).powf(-0.5), 2.0 * PI / 1.5),
            (|wi| 1.0 + wi.x * wi.x - 0.5 * wi.y, PI + PI / 4.0),
        ];
        for (number, (value, expected)) in cases.into_iter().enumerate() {
            let found = total(value, f64::INFINITY);
            assert!(
                (found.whole / expected - 1.0).abs() < 2e-5,
                "{number}: {found:?}, {expected}"
            );
            assert_eq!(found.whole, found.bounded);
        }
        let cut = total(|wi| 1.0 / wi.z.max(1e-20), 5.0);
        let expected = 2.0 * PI * (1.0 - 0.1);
        assert!((cut.bounded / expected - 1.0).abs() < 2e-4, "{cut:?}");
    }

    /// cosⁿα about the mirror direction has the mass of its density: what grids miss, scouts meet.
    #[test]
    fn narrow_lobes_are_met() {
        let found = total(
            |wi| {
                let mirror = Vec3::new(-(0.7f32.sin()), 0.0, 0.7f32.cos());
                let chord = f64::from((wi - mirror).length_squared());
                let cos = (1.0 - 0.5 * chord).max(0.0);
                cos.powf(1e5) as f32 / wi.z
            },
            f64::INFINITY,
        );
        // dσ = dx dy/z, and ∫ cosⁿα dσ = 2π/(n + 1).
        let ratio = found.whole * 100_001.0 * 0.5 * FRAC_1_PI;
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    }
}
