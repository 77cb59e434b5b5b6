//! ∫ f dx dy over the disc for one `wo`, where f comes from a MERL table: exact in the azimuth.
//!
//! A table jumps (or its slope does) at the edges of its bins, of which half vectors about one `wo` cross hundreds: a lattice
//! converges as n⁻¹ there, and a bin that no point meets is missed altogether. At one θh, however, both other angles are
//! functions of the half vector's azimuth φ against `wo`,
//!
//! ```text
//! cos θd = wo·h = cos θo cos θh + sin θo sin θh cos φ
//! tan φd = sin θo sin φ / (cos θo sin θh − sin θo cos θh cos φ)
//! ```
//!
//! and the φ of every edge has a closed form. Between two edges f is constant, and the integral has a closed form too
//! ([`super::bin_circle`]), or it is smooth, so that two points integrate it. What is left is a continuous function of θh, which is
//! integrated adaptively in each bin.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::bin_circle::BinCircles;
use super::merl_axes::{THETA_D_BINS, THETA_H_BINS, theta_h};
use super::quadrature::{Piece, piece};
use super::{HalfVectorDomain, reflect_about};

/// Where a table's values jump or bend, and what they are between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BinShape {
    /// Distance of the jumps or bends from the lower edges of bins, in bins: 0 or ½.
    pub offset: f64,
    /// Whether values are constant between them.
    pub is_constant: bool,
}

impl BinShape {
    /// The angle of θd or φd, radians, at which the values of bin `edge` begin; bins are a degree wide.
    fn angle(self, edge: usize) -> f64 {
        (edge as f64 + self.offset).to_radians()
    }
}

/// Longest step of the azimuth, radians: over it two points integrate the change of variables to 10⁻⁷.
const LONGEST: f64 = PI / 32.0;
/// Angle of `wo` below which bins of θh are cut where those of θd end: a degree, the width of the latter.
const NEAR_NORMAL: f64 = PI / 180.0;
/// Most halvings of a bin of θh.
const HALVINGS: u32 = 6;
/// √(1/3): Gauss's two points on [−1, 1].
const GAUSS_2: f64 = 0.577_350_269_189_625_8;
/// √(3/5): the outer two of Gauss's three points on [−1, 1].
const GAUSS_3: f64 = 0.774_596_669_241_483_4;
/// The points of both rules, those of the rule of two first.
const POINTS: [f64; 5] = [-GAUSS_2, GAUSS_2, -GAUSS_3, 0.0, GAUSS_3];

/// Integrals over the disc for one `wo` in the plane of φ = 0.
pub(crate) struct BinQuadrature {
    domain: HalfVectorDomain,
    wo: DVec3,
    shape: BinShape,
    pieces: Vec<Piece>,
    is_near_normal: bool,
}

/// What the points of one θh are collected in.
struct DirectionRow<F> {
    values: F,
    /// cos θd at the edges of its bins.
    theta_d_edges: Vec<f64>,
    /// Sine and cosine of φd at the edges of its bins in half a turn.
    phi_d_edges: Vec<(f64, f64)>,
    cuts: Vec<f64>,
    wi: Vec<Vec3>,
    weights: Vec<f64>,
    found: Vec<f64>,
}

/// A range of one piece's unit interval, its integral and how far that may be off.
#[derive(Clone, Copy)]
struct Part {
    piece: usize,
    low: f64,
    high: f64,
    halvings: u32,
    value: f64,
    error: f64,
}

impl BinQuadrature {
    /// The quadrature for `wo`, whose y must be 0; `None` unless `wo` is above the horizon.
    pub fn new(wo: Vec3, shape: BinShape) -> Option<Self> {
        let domain = HalfVectorDomain::new(wo)?;
        let (cut, end) = (domain.theta_full(), domain.theta_max());
        // Step 1: the θh at which the integral over the azimuth jumps or bends. These are the edges of bins, θfull, from
        // which on the horizon cuts azimuths, and θmax, where it leaves none.
        let mut edges = vec![0.0, cut, end];
        for bin in 0..=THETA_H_BINS {
            let edge = theta_h(bin as f64 + shape.offset);
            if edge < end {
                edges.push(edge);
            }
        }
        // Next to the normal all azimuths have nearly the same θd, from |θh − θo| to θh + θo: where an edge of its bins comes and
        // goes, the integral over the azimuth all but jumps.
        let theta_o = f64::from(wo.x).atan2(f64::from(wo.z));
        let is_near_normal = theta_o < NEAR_NORMAL;
        if is_near_normal {
            for bin in 0..THETA_D_BINS {
                let edge = (bin as f64 + shape.offset).to_radians();
                for theta_h in [edge - theta_o, edge + theta_o] {
                    if theta_h > 0.0 && theta_h < end {
                        edges.push(theta_h);
                    }
                }
            }
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        debug_assert!(edges.is_sorted_by(|a, b| a < b));
        // Step 2: each range gets the map θh(t) that makes its integrand smooth in t.
        let pieces = edges
            .windows(2)
            .map(|pair| piece(pair[0], pair[1], cut, end))
            .collect();
        Some(Self {
            domain,
            wo: wo.as_dvec3().normalize(),
            shape,
            pieces,
            is_near_normal,
        })
    }

    /// Whether `wo` is within a degree of the normal.
    pub fn is_near_normal(&self) -> bool {
        self.is_near_normal
    }

    /// ∫ f cos θi dσ(wi) for f ≥ 0 that jumps where the table does, to `tolerance`: the errors of all parts, each the difference of
    /// Gauss's rules of two and of three points, add up to at most `tolerance` of the integral, or parts are as small as they may be.
    ///
    /// `values` writes f of each direction to the place of the same number.
    pub fn integrate(&self, tolerance: f64, values: impl FnMut(&[Vec3], &mut [f64])) -> f64 {
        let shape = self.shape;
        let mut row = DirectionRow {
            values,
            theta_d_edges: (0..THETA_D_BINS)
                .map(|edge| shape.angle(edge).cos())
                .collect(),
            phi_d_edges: (0..180).map(|edge| shape.angle(edge).sin_cos()).collect(),
            cuts: Vec::new(),
            wi: Vec::new(),
            weights: Vec::new(),
            found: Vec::new(),
        };
        self.refine(tolerance, |theta_h| self.row(theta_h, &mut row))
    }

    /// [`Self::integrate`] for an f that has the value of each bin anywhere in it; `cells` has values by θh, θd and `phi_d_bins` (180 or
    /// 360) bins of φd. `wo` must not be near the normal, about which rounding decides on φd.
    pub fn integrate_cells(&self, tolerance: f64, cells: &[f32], phi_d_bins: usize) -> f64 {
        let mut circles = BinCircles::new(self.wo, cells, phi_d_bins);
        self.refine(tolerance, |theta_h| {
            circles.integrate(theta_h, self.domain.phi_max(theta_h))
        })
    }

    /// The integral over all θh of `row`, which is that over the azimuths.
    fn refine(&self, tolerance: f64, mut row: impl FnMut(f64) -> f64) -> f64 {
        // Step 1: one part for each piece.
        let mut parts = Vec::new();
        for piece in 0..self.pieces.len() {
            parts.push(self.part(piece, [0.0, 1.0], 0, &mut row));
        }
        loop {
            let total: f64 = parts.iter().map(|p| p.value).sum();
            let error: f64 = parts.iter().map(|p| p.error).sum();
            if error <= tolerance * total {
                return total;
            }
            // Step 2: halve the parts whose error exceeds an equal part of what is allowed in all.
            let allowed = tolerance * total / parts.len() as f64;
            let mut finer = Vec::with_capacity(2 * parts.len());
            let mut is_finer = false;
            for part in parts {
                if part.error <= allowed || part.halvings >= HALVINGS {
                    finer.push(part);
                    continue;
                }
                let middle = 0.5 * (part.low + part.high);
                for range in [[part.low, middle], [middle, part.high]] {
                    let halvings = part.halvings + 1;
                    finer.push(self.part(part.piece, range, halvings, &mut row));
                }
                is_finer = true;
            }
            parts = finer;
            // Every part is within its allowance or as short as it may be.
            if !is_finer {
                return parts.iter().map(|p| p.value).sum();
            }
        }
    }

    /// The integral over a range of a piece by three points, and its difference from that by two.
    fn part(
        &self,
        piece: usize,
        [low, high]: [f64; 2],
        halvings: u32,
        row: &mut impl FnMut(f64) -> f64,
    ) -> Part {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        // The integrand g at Gauss's points: the integral over the azimuth times dθh/dt.
        let mut rows = [0.0; 5];
        for (integrand, x) in rows.iter_mut().zip(POINTS) {
            let (theta_h, slope) = self.pieces[piece].theta_h(middle + half * x);
            *integrand = slope * row(theta_h);
        }
        // Two points: ½w (g(−√⅓) + g(√⅓)) for a range of width w. Three: w/18 (5 g(−√⅗) + 8 g(0) + 5 g(√⅗)).
        let two = half * (rows[0] + rows[1]);
        let three = half / 9.0 * (5.0 * rows[2] + 8.0 * rows[3] + 5.0 * rows[4]);
        Part {
            piece,
            low,
            high,
            halvings,
            value: three,
            error: (three - two).abs(),
        }
    }

    /// ∫ f cos θi·dσ(wi)/dθh over the azimuth at one θh: 4 (wo·h) sin θh cos θi dφ.
    fn row(&self, theta_h: f64, row: &mut DirectionRow<impl FnMut(&[Vec3], &mut [f64])>) -> f64 {
        // Step 1: the azimuths between which the values are constant or smooth.
        self.azimuth_cuts(theta_h, row);
        let circle = HalfVectorCircle::new(self.wo, theta_h);
        row.wi.clear();
        row.weights.clear();
        // Step 2: Gauss's rule of two points between each two of them, on both sides of the plane of incidence.
        for pair in row.cuts.windows(2) {
            let half = 0.5 * (pair[1] - pair[0]);
            let (sin, cos) = (0.5 * (pair[0] + pair[1])).sin_cos();
            // Gauss's points lie δ to either side; δ is short enough for its series.
            let delta = GAUSS_2 * half;
            let delta2 = delta * delta;
            let (sin_d, cos_d) = (
                delta * (1.0 - delta2 / 6.0 * (1.0 - delta2 / 20.0)),
                1.0 - delta2 / 2.0 * (1.0 - delta2 / 12.0),
            );
            let before = (sin * cos_d - cos * sin_d, cos * cos_d + sin * sin_d);
            let after = (sin * cos_d + cos * sin_d, cos * cos_d - sin * sin_d);
            let weights = [circle.weight(before.1), circle.weight(after.1)];
            // Edges lie at ±φ, but the values there may differ.
            for side in [1.0, -1.0] {
                if self.shape.is_constant {
                    row.wi.push(circle.reflect(side * sin, cos));
                    row.weights.push(half * (weights[0] + weights[1]));
                } else {
                    row.wi.push(circle.reflect(side * before.0, before.1));
                    row.wi.push(circle.reflect(side * after.0, after.1));
                    row.weights.extend(weights.map(|weight| half * weight));
                }
            }
        }
        // Step 3: the values of all points together.
        row.found.resize(row.wi.len(), 0.0);
        (row.values)(&row.wi, &mut row.found);
        let mut sum = 0.0;
        for (weight, value) in row.weights.iter().zip(&row.found) {
            sum += weight * value;
        }
        sum
    }

    /// The azimuths from 0 to the horizon's at which a bin of θd or φd ends, ascending; the same hold below 0.
    fn azimuth_cuts<F>(&self, theta_h: f64, row: &mut DirectionRow<F>) {
        let cuts = &mut row.cuts;
        let end = self.domain.phi_max(theta_h);
        cuts.clear();
        cuts.extend([0.0, end]);
        // The change of variables is smooth everywhere, and two points integrate it over steps of this length.
        for step in 1..(PI / LONGEST) as usize {
            push_inside(cuts, step as f64 * LONGEST, end);
        }
        let (sin_h, cos_h) = theta_h.sin_cos();
        let (sin_o, cos_o) = (self.wo.x, self.wo.z);
        // cos φ = (cos θd − cos θo cos θh)/(sin θo sin θh); NaN where there is no such φ.
        for cos_d in &row.theta_d_edges {
            let phi = ((cos_d - cos_o * cos_h) / (sin_o * sin_h)).acos();
            push_inside(cuts, phi, end);
        }
        // sin θo cos ψ sin φ + sin θo cos θh sin ψ cos φ = cos θo sin θh sin ψ at φd = ψ and at φd = ψ + π.
        for &(sin, cos) in &row.phi_d_edges {
            let (p, q) = (sin_o * cos_h * sin, sin_o * cos);
            // p cos φ + q sin φ = √(p² + q²) cos(φ − middle), so that both solutions lie at ±`reach` from `middle`.
            let middle = q.atan2(p);
            let reach = (cos_o * sin_h * sin / p.hypot(q)).acos();
            for phi in [middle - reach, middle + reach] {
                push_inside(cuts, if phi > PI { phi - TAU } else { phi }, end);
            }
        }
        cuts.sort_unstable_by(f64::total_cmp);
    }
}

/// Adds an azimuth that lies strictly between 0 and `end`; any other, and NaN, is no cut.
fn push_inside(cuts: &mut Vec<f64>, phi: f64, end: f64) {
    if phi > 0.0 && phi < end {
        cuts.push(phi);
    }
}

/// The half vectors of one θh, by their azimuth φ against `wo`.
struct HalfVectorCircle {
    wo: DVec3,
    sin_h: f64,
    cos_h: f64,
    /// cos θo cos θh and sin θo sin θh.
    across: f64,
    along: f64,
}

impl HalfVectorCircle {
    fn new(wo: DVec3, theta_h: f64) -> Self {
        let (sin_h, cos_h) = theta_h.sin_cos();
        Self {
            wo,
            sin_h,
            cos_h,
            across: wo.z * cos_h,
            along: wo.x * sin_h,
        }
    }

    /// 4 (wo·h) sin θh cos θi, where wo·h = cos θo cos θh + sin θo sin θh cos φ and cos θi = 2 (wo·h) cos θh − cos θo.
    #[inline(always)]
    fn weight(&self, cos_phi: f64) -> f64 {
        let cos_d = self.across + self.along * cos_phi;
        4.0 * cos_d * self.sin_h * (2.0 * cos_d * self.cos_h - self.wo.z).max(0.0)
    }

    /// `wo` reflected about the half vector of an azimuth with this sine and cosine.
    #[inline(always)]
    fn reflect(&self, sin_phi: f64, cos_phi: f64) -> Vec3 {
        let h = DVec3::new(self.sin_h * cos_phi, self.sin_h * sin_phi, self.cos_h);
        reflect_about(self.wo, h).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{HalfDiff, spherical};
    use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

    const FLOOR: BinShape = BinShape {
        offset: 0.0,
        is_constant: true,
    };

    fn wo(theta: f64) -> Vec3 {
        spherical(theta.to_radians(), 0.0).as_vec3()
    }

    #[test]
    fn a_constant_integrates_to_pi() {
        for theta in [0.0, 0.76, 14.5, 45.0, 75.5, 89.0, 90.0] {
            for shape in [
                FLOOR,
                BinShape {
                    offset: 0.5,
                    is_constant: false,
                },
            ] {
                let mass = BinQuadrature::new(wo(theta), shape)
                    .unwrap()
                    .integrate(1e-6, |_, out| out.fill(1.0));
                assert!(
                    (mass * FRAC_1_PI - 1.0).abs() < 2e-6,
                    "{theta}° {shape:?}: {mass}"
                );
            }
        }
    }

    /// A value that differs from those of all adjacent bins.
    fn value_of_bin(wo: Vec3, wi: Vec3) -> f64 {
        let angles = HalfDiff::from_directions(wo.as_dvec3(), wi.as_dvec3()).unwrap();
        let h = ((angles.theta_h / FRAC_PI_2).sqrt() * 90.0) as u32;
        let d = angles.theta_d.to_degrees() as u32;
        let p = angles.phi_d.rem_euclid(PI).to_degrees() as u32;
        f64::from((h % 7 + 1) * (d % 3 + 1) * (p % 5 + 1))
    }

    /// Bins of all three angles that come and go, against a fine grid over the disc.
    #[test]
    fn values_by_bins_are_integrated_as_on_a_fine_grid_of_the_disc() {
        for theta in [0.0, 0.3, 20.3, 60.1, 88.0] {
            let wo = wo(theta);
            let found = BinQuadrature::new(wo, FLOOR)
                .unwrap()
                .integrate(1e-5, |wi, out| {
                    for (wi, out) in wi.iter().zip(out) {
                        *out = value_of_bin(wo, *wi);
                    }
                });
            let n = 1500;
            let mut sum = 0.0;
            for k in 0..n * n {
                let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
                let (x, y) = (at(k % n), at(k / n));
                let z2 = 1.0 - x * x - y * y;
                if z2 > 0.0 {
                    sum += value_of_bin(wo, DVec3::new(x, y, z2.sqrt()).as_vec3());
                }
            }
            let expected = sum * 4.0 / f64::from(n * n);
            assert!(
                (found / expected - 1.0).abs() < 5e-4,
                "{theta}°: {found}, {expected}"
            );
        }
    }

    /// The closed form along each circle against two points in each bin that it crosses.
    #[test]
    fn cells_are_integrated_as_directions_are() {
        let mut cells = Vec::new();
        for h in 0..THETA_H_BINS {
            for d in 0..THETA_D_BINS {
                cells.extend((0..180).map(|p| ((h % 7 + 1) * (d % 3 + 1) * (p % 5 + 1)) as f32));
            }
        }
        for theta in [1.1, 20.3, 60.1, 75.5, 88.0, 89.9] {
            let wo = wo(theta);
            let quadrature = BinQuadrature::new(wo, FLOOR).unwrap();
            let by_cells = quadrature.integrate_cells(1e-5, &cells, 180);
            let by_directions = quadrature.integrate(1e-5, |wi, out| {
                for (wi, out) in wi.iter().zip(out) {
                    *out = value_of_bin(wo, *wi);
                }
            });
            let ratio = by_cells / by_directions;
            assert!((ratio - 1.0).abs() < 1e-5, "{theta}°: {ratio}");
        }
    }
}
