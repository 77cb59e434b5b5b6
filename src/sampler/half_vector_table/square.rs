//! The half-vector square about one `wo`: which half vector stands where, exactly up to the horizon, without trigonometry.
//!
//! The first axis is the *cap* of θh: sin²(θh/2), the share of the sphere within θh of the normal, so that equal steps are
//! equal solid angles of h. It ends where no azimuth reflects above the horizon any more, θmax = (π/2 + θo)/2. It is cut into
//! [`PARTS`]: MERL's own bins of θh while they lie within that range for every `wo`, then equal steps to the end. Measured
//! tables jump at MERL's bins, and a highlight stays in its bins when `wo` moves.
//!
//! The second axis is tan(φ/4), φ being the azimuth of h against that of `wo`, as a share in [−1, 1] of the largest one that
//! reflects above the horizon. The tangent of a quarter of the angle runs from 0 to 1, is nearly the angle's share itself
//! (its slope changes by a factor of two), and gives sine and cosine by a division. Every point of the square is a direction
//! above the horizon.

use std::f64::consts::FRAC_PI_4;
use std::sync::LazyLock;

use glam::Vec3;

use crate::material::merl::BinIndex;

/// MERL's bins of θh that end below 45°, which half vectors reach for every `wo`.
pub const MERL_PARTS: usize = 63;
/// Equal steps of the cap beyond them.
pub const UPPER_PARTS: usize = 16;
/// Parts of the first axis.
pub const PARTS: usize = MERL_PARTS + UPPER_PARTS;

/// Caps at the edges of MERL's bins, 0 to [`MERL_PARTS`].
static MERL_CAPS: LazyLock<[f32; MERL_PARTS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|i| (FRAC_PI_4 * (i as f64 / 90.0).powi(2)).sin().powi(2) as f32)
});

/// Azimuths narrower than this, as tan(φ/4), are less than f32 directions resolve.
const NARROWEST: f32 = 1e-6;

/// An edge of a part: its cap is `fixed + share · top`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    fixed: f32,
    share: f32,
}

impl Edge {
    /// Edge number `edge`, 0 to [`PARTS`].
    pub fn of_part(edge: usize) -> Self {
        if edge <= MERL_PARTS {
            return Self {
                fixed: MERL_CAPS[edge],
                share: 0.0,
            };
        }
        let share = (edge - MERL_PARTS) as f32 / UPPER_PARTS as f32;
        Self {
            fixed: MERL_CAPS[MERL_PARTS] * (1.0 - share),
            share,
        }
    }

    /// The part of the cap that is the same for every `wo`.
    pub fn fixed(&self) -> f32 {
        self.fixed
    }

    /// The part of the cap of θmax.
    pub fn share(&self) -> f32 {
        self.share
    }
}

/// The square about one direction. All its arithmetic is free of branches, so that loops over it become vector code.
#[derive(Clone, Copy, Debug)]
pub struct Square {
    wo: Vec3,
    /// `wo` turned to azimuth 0.
    sin_o: f32,
    cos_o: f32,
    /// Cosine and sine of the azimuth of `wo`; (1, 0) along the normal.
    azimuth: (f32, f32),
    /// Cap of θmax.
    top: f32,
}

/// Where a direction lies in the square.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Coordinate on the first axis.
    pub cap: f32,
    /// tan²θh, as lookups compute it: where a value jumps at the edge of a bin, the density must jump with it.
    pub tan2: f64,
    /// Coordinate on the second axis, in [−1, 1].
    pub b: f32,
    /// dσ(wi) per dcap db, sr.
    pub jacobian: f32,
}

impl Square {
    /// The square about `wo`, which must be above the horizon and of unit length up to rounding.
    #[inline]
    pub fn about(wo: Vec3) -> Self {
        let rho2 = wo.x * wo.x + wo.y * wo.y;
        let rho = rho2.sqrt();
        let scale = 1.0 / (rho2 + wo.z * wo.z).sqrt();
        let turn = 1.0 / rho;
        let azimuth = if rho > 0.0 {
            (wo.x * turn, wo.y * turn)
        } else {
            (1.0, 0.0)
        };
        let (sin_o, cos_o) = (rho * scale, wo.z * scale);
        // cos θmax = cos(π/4 + θo/2).
        let cos_max = cos_o / (2.0 * (1.0 + sin_o)).sqrt();
        Self {
            wo,
            sin_o,
            cos_o,
            azimuth,
            top: 0.5 * (1.0 - cos_max),
        }
    }

    /// Its numbers, for arrays of many squares.
    #[inline(always)]
    pub fn to_array(self) -> [f32; 8] {
        let Self {
            wo,
            sin_o,
            cos_o,
            azimuth,
            top,
        } = self;
        [wo.x, wo.y, wo.z, sin_o, cos_o, azimuth.0, azimuth.1, top]
    }

    /// The inverse of [`Self::to_array`].
    #[inline(always)]
    pub fn from_array([x, y, z, sin_o, cos_o, c, s, top]: [f32; 8]) -> Self {
        Self {
            wo: Vec3::new(x, y, z),
            sin_o,
            cos_o,
            azimuth: (c, s),
            top,
        }
    }

    /// Cosine of the polar angle of `wo`.
    #[inline]
    pub fn cos_o(&self) -> f32 {
        self.cos_o
    }

    /// The cap at an edge.
    #[inline]
    pub fn cap(&self, edge: Edge) -> f32 {
        edge.fixed + edge.share * self.top
    }

    /// The largest tan(φ/4) at a θh: tan²(φmax/2) = −cos(2θh−θo)/cos(2θh+θo), and 1 where every azimuth is above the horizon.
    #[inline(always)]
    fn widest(&self, sin_h: f32, cos_h: f32) -> f32 {
        let (sin_2h, cos_2h) = (2.0 * sin_h * cos_h, (cos_h - sin_h) * (cos_h + sin_h));
        let (sines, cosines) = (sin_2h * self.sin_o, cos_2h * self.cos_o);
        // Where the sum passes the horizon nowhere, this is √near/√near.
        let far = (sines - cosines).max(0.0);
        let near = (cosines + sines).max(f32::MIN_POSITIVE);
        (near.sqrt() / (far.sqrt() + (near + far).sqrt())).max(NARROWEST)
    }

    /// The largest tan(φ/4) at a cap, 1 where every azimuth reflects above the horizon: the unit of `b`.
    #[inline(always)]
    pub fn widest_at(&self, cap: f32) -> f32 {
        let (sin_h, cos_h) = sin_cos(cap);
        self.widest(sin_h, cos_h)
    }

    /// The reflected direction at (`cap`, `b`); on or above the horizon up to rounding.
    #[inline(always)]
    pub fn direction(&self, cap: f32, b: f32) -> Vec3 {
        let (sin_h, cos_h) = sin_cos(cap);
        let (sin, cos) = sin_cos_of_quarter(b * self.widest(sin_h, cos_h));
        self.reflect(sin_h, cos_h, sin, cos)
    }

    /// The reflection of `wo` about the half vector of a polar angle and an azimuth against `wo`.
    #[inline(always)]
    fn reflect(&self, sin_h: f32, cos_h: f32, sin: f32, cos: f32) -> Vec3 {
        let (h_x, h_y) = (sin_h * cos, sin_h * sin);
        let twice = 2.0 * (self.sin_o * h_x + self.cos_o * cos_h);
        let (x, y) = (twice * h_x - self.sin_o, twice * h_y);
        let (c, s) = self.azimuth;
        Vec3::new(c * x - s * y, s * x + c * y, twice * cos_h - self.cos_o)
    }

    /// Directions and weights at one cap and many azimuths, for tabulating: `visit(wi, dσ(wi) per dcap db)` for each `b`.
    pub fn along(
        &self,
        cap: f32,
        azimuths: impl Iterator<Item = f32>,
        mut visit: impl FnMut(Vec3, f32),
    ) {
        let (sin_h, cos_h) = sin_cos(cap);
        let widest = self.widest(sin_h, cos_h);
        for b in azimuths {
            let quarter = b * widest;
            let (sin, cos) = sin_cos_of_quarter(quarter);
            let cos_d = self.sin_o * sin_h * cos + self.cos_o * cos_h;
            visit(
                self.reflect(sin_h, cos_h, sin, cos),
                32.0 * cos_d * widest / (1.0 + quarter * quarter),
            );
        }
    }

    /// Where `wi`, above the horizon, lies; `b` is held inside the square where rounding leaves it.
    #[inline(always)]
    pub fn place(&self, wi: Vec3) -> Place {
        let (c, s) = self.azimuth;
        let x = self.sin_o + (c * wi.x + s * wi.y);
        let y = c * wi.y - s * wi.x;
        let z = self.cos_o + wi.z;
        let rho2 = x * x + y * y;
        let (rho, length) = (rho2.sqrt(), (rho2 + z * z).sqrt());
        let scale = 1.0 / length;
        let cap = 0.5 * rho2 * scale / (length + z);
        let widest = self.widest(rho * scale, z * scale);
        let quarter = tan_of_quarter(x, y, rho);
        let b = (quarter / widest).clamp(-1.0, 1.0);
        // dσ(wi) = 4 (wo·h) dσ(h), dσ(h) = 2 dcap dφ, dφ = 4 dq/(1 + q²), and wo·h is half the length of wo + wi.
        let jacobian = 16.0 * length * widest / (1.0 + quarter * quarter);
        let sum = self.wo.as_dvec3() + wi.as_dvec3();
        let tan2 = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z);
        Place {
            cap,
            tan2,
            b,
            jacobian,
        }
    }

    /// The part that holds a half vector, by its squared tangent below the last of MERL's bins, as lookups do.
    #[inline]
    pub fn part(&self, place: &Place) -> usize {
        let bin = BinIndex::theta_h_of_tan2(place.tan2);
        if bin < MERL_PARTS {
            return bin;
        }
        let low = MERL_CAPS[MERL_PARTS];
        let steps = (place.cap - low) / (self.top - low) * UPPER_PARTS as f32;
        MERL_PARTS + (steps.max(0.0) as usize).min(UPPER_PARTS - 1)
    }
}

/// Sine and cosine of θh from its cap.
#[inline(always)]
fn sin_cos(cap: f32) -> (f32, f32) {
    (2.0 * (cap * (1.0 - cap)).sqrt(), 1.0 - 2.0 * cap)
}

/// Sine and cosine of φ from tan(φ/4), in [−1, 1].
#[inline(always)]
fn sin_cos_of_quarter(q: f32) -> (f32, f32) {
    let scale = 1.0 / (1.0 + q * q);
    let (sin_half, cos_half) = (2.0 * q * scale, (1.0 - q * q) * scale);
    (
        2.0 * sin_half * cos_half,
        (cos_half - sin_half) * (cos_half + sin_half),
    )
}

/// tan(φ/4) of the azimuth of (x, y), whose length is `rho`; 0 for length 0.
#[inline(always)]
fn tan_of_quarter(x: f32, y: f32, rho: f32) -> f32 {
    // The larger of sine and cosine of φ/2 from the half-angle formula, the smaller from the double angle: no cancellation.
    let sum = rho + x.abs();
    let scale = 1.0 / (2.0 * rho * sum).sqrt().max(f32::MIN_POSITIVE);
    let (large, small) = (sum * scale, y.abs() * scale);
    let back = x < 0.0;
    let (sin_half, cos_half) = (
        if back { large } else { small },
        if back { small } else { large },
    );
    // 1 but for azimuths of half vectors too close to the normal to have one.
    (sin_half / (1.0 + cos_half)).min(1.0).copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{FibonacciLattice, HalfVectors, spherical};

    fn edge(square: &Square, number: usize) -> f64 {
        f64::from(square.cap(Edge::of_part(number)))
    }

    #[test]
    fn places_invert_directions() {
        for theta_o in [0.0, 0.3, 30.0, 60.25, 85.0, 89.9_f64] {
            let wo = spherical(theta_o.to_radians(), 2.0).as_vec3();
            let square = Square::about(wo);
            for (s, t) in FibonacciLattice::at_least(500).points() {
                let (cap, b) = ((s * edge(&square, PARTS)) as f32, (2.0 * t - 1.0) as f32);
                let wi = square.direction(cap, b);
                assert!(
                    wi.z > -1e-6 && (wi.length() - 1.0).abs() < 2e-6,
                    "θo {theta_o}, {s} {t}: {wi}"
                );
                let place = square.place(wi);
                assert!((place.cap - cap).abs() < 1e-6, "{theta_o}: {cap} {place:?}");
                let part = square.part(&place);
                let edges = [part, part + 1].map(|e| edge(&square, e) as f32);
                assert!(
                    edges[0] - 1e-6 < cap && cap < edges[1] + 1e-6,
                    "{cap} {place:?}"
                );
                let slack = 1e-5 / (s * (1.0 - s)).max(1e-3) as f32;
                assert!((place.b - b).abs() < slack, "{theta_o}, {s}: {b} {place:?}");
            }
        }
    }

    #[test]
    fn agrees_with_the_rectangle_of_the_quadrature() {
        for theta_o in [0.0, 14.5, 60.0, 88.0_f64] {
            let wo = spherical(theta_o.to_radians(), -1.0).as_vec3();
            let (square, rectangle) = (Square::about(wo), HalfVectors::about(wo).unwrap());
            let theta_max = 2.0 * edge(&square, PARTS).sqrt().asin();
            assert!((theta_max - rectangle.theta_max()).abs() < 1e-6);
            for (s, t) in FibonacciLattice::at_least(300).points() {
                let (cap, b) = (s * edge(&square, PARTS), 2.0 * t - 1.0);
                let theta_h = 2.0 * cap.sqrt().asin();
                // The quarter's tangent as a share of the largest, against the angle's share.
                let phi_max = rectangle.phi_max(theta_h);
                let share = 4.0 * (b * (0.25 * phi_max).tan()).atan() / phi_max;
                let slope = phi_max * (1.0 + (0.25 * share * phi_max).tan().powi(2))
                    / (4.0 * (0.25 * phi_max).tan());
                let (expected, per_theta) = rectangle.direction(theta_h, share);
                let here = format!("θo {theta_o}, {s} {t}");
                assert!(
                    square
                        .direction(cap as f32, b as f32)
                        .abs_diff_eq(expected, 5e-6),
                    "{here}"
                );
                // dcap/dθh = sin θh/2.
                let agrees = |jacobian: f32| {
                    let ratio = f64::from(jacobian) * 0.5 * theta_h.sin() * slope / per_theta;
                    assert!((ratio - 1.0).abs() < 1e-4 / (1.0 - s), "{here}: {ratio}");
                };
                square.along(cap as f32, std::iter::once(b as f32), |wi, jacobian| {
                    assert!(wi.abs_diff_eq(expected, 5e-6), "{here}");
                    agrees(jacobian);
                });
                agrees(square.place(expected).jacobian);
            }
        }
    }

    #[test]
    fn merl_parts_lie_below_the_end_for_every_wo() {
        let square = Square::about(Vec3::Z);
        assert!((0..PARTS).all(|i| edge(&square, i) < edge(&square, i + 1)));
    }
}
