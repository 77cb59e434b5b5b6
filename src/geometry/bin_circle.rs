//! ∫ f cos θi dσ(wi)/dθh over the azimuths of one θh, in closed form, where f is constant in each bin of a MERL table.
//!
//! Half vectors of one θh form a circle about the normal. By their azimuth φ against `wo`, with D = cos θd,
//!
//! ```text
//! D = A + B cos φ,   A = cos θo cos θh,   B = sin θo sin θh
//! cos θi dσ(wi) = 4 D sin θh (2 D cos θh − cos θo) dφ dθh
//! ∫ D dφ  = A φ + B sin φ
//! ∫ D² dφ = (A² + B²/2) φ + (2 A B + B²/2 cos φ) sin φ
//! ```
//!
//! so that each bin contributes its value times a difference of this primitive between the φ at which the circle enters and leaves it.
//! A circle enters bins of θd in rising order, as D falls with φ. The other angle has the edges
//!
//! ```text
//! p cos φ + q sin φ = r,   p = sin θo cos θh sin φd,   q = sin θo cos φd,   r = cos θo sin θh sin φd
//! (cos φ, sin φ) = (p r ∓ q s, q r ± p s)/(p² + q²),   s² = p² + q² − r²
//! ```
//!
//! Where θh < θo, `wo` goes round h, and φd falls from π to 0. Elsewhere it rises from 0 to asin(sin θo/sin θh) and falls back.

use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::approx::fine_atan2;
use super::merl_axes::{AxisBins, THETA_D_BINS, degree_edge};

/// Edges of φd within half a turn, in degrees.
const HALF_TURN: usize = 180;
/// Where h is as close to `wo` as this, in radians, φd is hardly defined, and the circle is taken this far away from it.
const TOO_CLOSE: f64 = 1e-7;

/// The cells of a table, and their edges, about one `wo`.
pub(super) struct BinCircles<'a> {
    theta_o: f64,
    sin_o: f64,
    cos_o: f64,
    /// Values by θh, θd and φd.
    cells: &'a [f32],
    phi_d_bins: usize,
    /// cos θd at the edges of its bins.
    theta_d_cosines: [f64; THETA_D_BINS],
    /// Cosine and sine of φd at its edges.
    phi_d_cosines: [f64; HALF_TURN],
    phi_d_sines: [f64; HALF_TURN],
    theta_d_crossings: Crossings<THETA_D_BINS>,
    phi_d_crossings: Crossings<HALF_TURN>,
}

/// The azimuths of edges that a circle crosses, ascending, and the primitive there.
struct Crossings<const N: usize> {
    azimuths: [f64; N],
    primitives: [f64; N],
    count: usize,
}

impl<const N: usize> Crossings<N> {
    const NONE: Self = Self {
        azimuths: [0.0; N],
        primitives: [0.0; N],
        count: 0,
    };

    /// Azimuth of a crossing; infinity after the last.
    #[inline(always)]
    fn azimuth(&self, number: usize) -> f64 {
        if number < self.count {
            self.azimuths[number]
        } else {
            f64::INFINITY
        }
    }

    #[inline(always)]
    fn set(&mut self, number: usize, circle: &Circle, sin: f64, cos: f64) {
        let azimuth = fine_atan2(sin, cos);
        self.azimuths[number] = azimuth;
        self.primitives[number] = circle.primitive(azimuth, sin, cos);
    }
}

/// The half vectors of one θh.
struct Circle {
    theta_h: f64,
    sin_h: f64,
    cos_h: f64,
    /// A and B.
    across: f64,
    along: f64,
    /// The primitive is `slope`·φ + (`first` + `second` cos φ) sin φ.
    slope: f64,
    first: f64,
    second: f64,
}

impl Circle {
    fn new(theta_h: f64, sin_o: f64, cos_o: f64) -> Self {
        let (sin_h, cos_h) = theta_h.sin_cos();
        let (a, b) = (cos_o * cos_h, sin_o * sin_h);
        // 4 sin θh (2 cos θh ∫D² − cos θo ∫D)
        let scale = 4.0 * sin_h;
        Self {
            theta_h,
            sin_h,
            cos_h,
            across: a,
            along: b,
            slope: scale * (2.0 * cos_h * (a * a + 0.5 * b * b) - cos_o * a),
            first: scale * (4.0 * cos_h * a * b - cos_o * b),
            second: scale * cos_h * b * b,
        }
    }

    /// ∫ cos θi dσ(wi)/dθh from the azimuth 0.
    #[inline(always)]
    fn primitive(&self, azimuth: f64, sin: f64, cos: f64) -> f64 {
        self.slope * azimuth + (self.first + self.second * cos) * sin
    }
}

impl<'a> BinCircles<'a> {
    /// Circles about `wo`, of length 1, in the plane of φ = 0 with x > 0; `cells` has values by θh, θd and `phi_d_bins` (180 or 360) bins of φd.
    pub fn new(wo: DVec3, cells: &'a [f32], phi_d_bins: usize) -> Self {
        let mut circles = Self {
            theta_o: wo.x.atan2(wo.z),
            sin_o: wo.x,
            cos_o: wo.z,
            cells,
            phi_d_bins,
            theta_d_cosines: [0.0; THETA_D_BINS],
            phi_d_cosines: [0.0; HALF_TURN],
            phi_d_sines: [0.0; HALF_TURN],
            theta_d_crossings: Crossings::NONE,
            phi_d_crossings: Crossings::NONE,
        };
        for (degree, cosine) in circles.theta_d_cosines.iter_mut().enumerate() {
            *cosine = degree_edge(degree).cos();
        }
        for degree in 0..HALF_TURN {
            let (sin, cos) = degree_edge(degree).sin_cos();
            circles.phi_d_sines[degree] = sin;
            circles.phi_d_cosines[degree] = cos;
        }
        circles
    }

    /// The integral over the azimuths from −`end` to `end` at one θh.
    pub fn integrate(&mut self, theta_h: f64, end: f64) -> f64 {
        dispatch!(Level::new(), _ => self.integrate_circle(theta_h, end))
    }

    #[inline(always)]
    fn integrate_circle(&mut self, theta_h: f64, end: f64) -> f64 {
        let is_too_close = (theta_h - self.theta_o).abs() < TOO_CLOSE;
        let theta_h = if is_too_close {
            self.theta_o + TOO_CLOSE
        } else {
            theta_h
        };
        let circle = Circle::new(theta_h, self.sin_o, self.cos_o);
        let (sin_end, cos_end) = end.sin_cos();
        // Step 1: the edges of θd, from |θh − θo| on, where the circle starts.
        let first_theta_d = whole_degrees((theta_h - self.theta_o).abs());
        let cos_last = (circle.across + circle.along * cos_end).clamp(0.0, 1.0);
        let last_theta_d = whole_degrees(cos_last.acos());
        self.cross_theta_d(&circle, first_theta_d, last_theta_d);
        // Step 2: the edges of φd, rising and then falling.
        let (rising, falling) = self.cross_phi_d(&circle);
        // Step 3: from edge to edge. Bins at −φ mirror those at φ.
        let size = THETA_D_BINS * self.phi_d_bins;
        let row = AxisBins::get()
            .theta_h
            .bin((circle.sin_h / circle.cos_h).powi(2));
        let cells = &self.cells[row * size..(row + 1) * size];
        let (thetas, phis) = (&self.theta_d_crossings, &self.phi_d_crossings);
        let (mut theta_d, mut next_theta_d) = (first_theta_d, 0);
        let (mut phi_d, mut next_phi_d) = (if rising == 0 { falling } else { 0 }, 0);
        let (mut sum, mut before) = (0.0, 0.0);
        loop {
            let start = theta_d * self.phi_d_bins;
            let value = f64::from(cells[start + phi_d])
                + f64::from(cells[start + self.phi_d_bins - 1 - phi_d]);
            let (by_theta, by_phi) = (thetas.azimuth(next_theta_d), phis.azimuth(next_phi_d));
            if by_theta.min(by_phi) >= end {
                return sum + value * (circle.primitive(end, sin_end, cos_end) - before);
            }
            let after = if by_theta < by_phi {
                next_theta_d += 1;
                theta_d += 1;
                thetas.primitives[next_theta_d - 1]
            } else {
                next_phi_d += 1;
                phi_d = match next_phi_d {
                    crossed if crossed <= rising => crossed,
                    crossed => falling - (crossed - rising),
                };
                phis.primitives[next_phi_d - 1]
            };
            sum += value * (after - before);
            before = after;
        }
    }

    /// The crossings of the edges above bin `first` up to the lower edge of bin `last`.
    #[inline(always)]
    fn cross_theta_d(&mut self, circle: &Circle, first: usize, last: usize) {
        let count = last.saturating_sub(first);
        for number in 0..count {
            let cosine = self.theta_d_cosines[first + 1 + number];
            // An edge that the circle only touches may be beyond it by rounding.
            let cos = ((cosine - circle.across) / circle.along).clamp(-1.0, 1.0);
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
            self.theta_d_crossings.set(number, circle, sin, cos);
        }
        self.theta_d_crossings.count = count;
    }

    /// The crossings of edges of φd; how many of them rise, and the bin from which they fall.
    #[inline(always)]
    fn cross_phi_d(&mut self, circle: &Circle) -> (usize, usize) {
        // Step 1: the highest edge. All are crossed where `wo` goes round h.
        let encloses = circle.theta_h < self.theta_o;
        let highest = if encloses {
            HALF_TURN - 1
        } else {
            let sine = (self.sin_o / circle.sin_h).min(1.0);
            (sine.asin().to_degrees() as usize).min(90)
        };
        let rising = if encloses { 0 } else { highest };
        // Step 2: on the way up, the solution of the lesser azimuth, and on the way down the other.
        for number in 0..rising {
            self.cross_one_phi_d(circle, number + 1, number, -1.0);
        }
        for number in 0..highest {
            self.cross_one_phi_d(circle, highest - number, rising + number, 1.0);
        }
        self.phi_d_crossings.count = rising + highest;
        (rising, highest)
    }

    /// The crossing of an edge of φd; `sign` is 1 for the solution of the greater azimuth.
    #[inline(always)]
    fn cross_one_phi_d(&mut self, circle: &Circle, edge: usize, number: usize, sign: f64) {
        let (sine, cosine) = (self.phi_d_sines[edge], self.phi_d_cosines[edge]);
        let (p, q) = (self.sin_o * circle.cos_h * sine, self.sin_o * cosine);
        let r = self.cos_o * circle.sin_h * sine;
        let length2 = p * p + q * q;
        // The highest edge may be touched only, and be missed by rounding.
        let s = sign * (length2 - r * r).max(0.0).sqrt();
        let (sin, cos) = ((q * r + p * s) / length2, (p * r - q * s) / length2);
        self.phi_d_crossings.set(number, circle, sin, cos);
    }
}

/// The bin of θd of an angle in radians.
fn whole_degrees(angle: f64) -> usize {
    (angle.to_degrees() as usize).min(THETA_D_BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::merl_axes::THETA_H_BINS;
    use crate::geometry::{HalfDiff, HalfVectorDomain, reflect_about, spherical};
    use std::f64::consts::{FRAC_PI_2, TAU};

    /// A value that differs from those of all adjacent bins.
    fn cell(theta_h: usize, theta_d: usize, phi_d: usize) -> f32 {
        ((theta_h % 7 + 1) * (theta_d % 3 + 1) * (phi_d % 5 + 1)) as f32
    }

    fn cells(phi_d_bins: usize) -> Vec<f32> {
        let mut cells = Vec::new();
        for theta_h in 0..THETA_H_BINS {
            for theta_d in 0..THETA_D_BINS {
                cells.extend((0..phi_d_bins).map(|phi_d| cell(theta_h, theta_d, phi_d)));
            }
        }
        cells
    }

    /// The integral by the midpoints of equal steps, each with the bin of its angles.
    fn sum_of_steps(wo: DVec3, theta_h: f64, end: f64, phi_d_bins: usize) -> f64 {
        let steps = 200_000;
        let turn = phi_d_bins as f64 / 360.0 * TAU;
        let mut sum = 0.0;
        for step in 0..steps {
            let phi = ((step as f64 + 0.5) / steps as f64 * 2.0 - 1.0) * end;
            let h = spherical(theta_h, phi);
            let wi = reflect_about(wo, h);
            if wi.z <= 0.0 {
                continue;
            }
            let angles = HalfDiff::from_directions(wo, wi).unwrap();
            let bins = [
                ((angles.theta_h / FRAC_PI_2).sqrt() * 90.0) as usize,
                angles.theta_d.to_degrees() as usize,
                angles.phi_d.rem_euclid(turn).to_degrees() as usize,
            ];
            let value = f64::from(cell(bins[0], bins[1], bins[2].min(phi_d_bins - 1)));
            sum += value * 4.0 * wo.dot(h) * theta_h.sin() * wi.z;
        }
        sum * 2.0 * end / f64::from(steps)
    }

    /// Circles about the normal that leave `wo` outside, hold it, and pass next to it, also those that the horizon cuts.
    #[test]
    fn a_circle_through_bins_is_the_sum_of_small_steps() {
        for phi_d_bins in [180, 360] {
            let cells = cells(phi_d_bins);
            for theta_o in [1.5f64, 20.3, 45.0, 71.2, 89.0] {
                let wo = spherical(theta_o.to_radians(), 0.0);
                let domain = HalfVectorDomain::new(wo.as_vec3()).unwrap();
                let mut circles = BinCircles::new(wo, &cells, phi_d_bins);
                for fraction in [0.03, 0.2, 0.4, 0.6, 0.8, 0.97] {
                    let theta_h = fraction * domain.theta_max();
                    let end = domain.phi_max(theta_h);
                    let found = circles.integrate(theta_h, end);
                    let expected = sum_of_steps(wo, theta_h, end, phi_d_bins);
                    assert!(
                        (found / expected - 1.0).abs() < 1e-3,
                        "{theta_o}°, {theta_h}, {phi_d_bins}: {found}, {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_circle_through_wo_is_like_its_neighbours() {
        let cells = cells(180);
        let wo = spherical(0.6, 0.0);
        let mut circles = BinCircles::new(wo, &cells, 180);
        let theta_o = circles.theta_o;
        let through = circles.integrate(theta_o, std::f64::consts::PI);
        for theta_h in [
            theta_o - 1e-6,
            theta_o - 1e-9,
            theta_o.next_up(),
            theta_o + 1e-6,
        ] {
            let near = circles.integrate(theta_h, std::f64::consts::PI);
            assert!((near / through - 1.0).abs() < 1e-3, "{near}, {through}");
        }
    }

    /// What is compiled for the oldest processor and what is compiled for this one give the same bits.
    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let cells = cells(180);
        let wo = spherical(0.9, 0.0);
        let mut circles = BinCircles::new(wo, &cells, 180);
        for step in 1..100 {
            let theta_h = 0.01 * f64::from(step);
            let end = 2.0 - theta_h;
            let newest = circles.integrate(theta_h, end);
            assert_eq!(newest, circles.integrate_circle(theta_h, end));
        }
    }
}
