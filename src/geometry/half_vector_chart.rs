//! The half vectors that reflect a given `wo` above the horizon: one domain, in two parametrisations.
//!
//! A half vector h of polar angle θh and azimuth φ, counted from that of `wo`, reflects it to the direction
//! `wi` = 2(wo·h)h − wo. That is above the horizon where 2(wo·h)cos θh > cos θo, which is
//!
//! ```text
//! |φ| < φmax(θh):   φmax = π                                    for θh ≤ θfull = (π/2 − θo)/2
//!                   tan²(φmax/2) = −cos(2θh − θo)/cos(2θh + θo)  beyond, which keeps its digits at both ends
//!                   φmax = 0                                    at θmax = (π/2 + θo)/2
//! dσ(wi) = 4 (wo·h) dσ(h)                                       (Torrance and Sparrow)
//! ```
//!
//! Both parametrisations are a rectangle over [0, θmax] × [−φmax, φmax]. The rectangle ends where the horizon begins, so every
//! point of it is a direction above the horizon, every such direction is one point of it, and no draw fails.
//!
//! | | [`super::HalfVectorDomain`] | [`HalfVectorChart`] |
//! |---|---|---|
//! | for | quadrature, statistical tests | tables that are drawn from |
//! | precision | f64 | f32, without trigonometry |
//! | first coordinate | θh | cap = sin²(θh/2), the fraction of the sphere within θh of the normal |
//! | second, in [−1, 1] | φ/φmax | tan(φ/4)/tan(φmax/4) |
//! | dσ(wi) per coordinates | 4 (wo·h) sin θh φmax | 32 (wo·h) tan(φmax/4)/(1 + tan²(φ/4)) |
//!
//! They are two types because neither can take the other's place without changing results: the one needs angles that it can cut
//! and weight, the other steps of equal solid angle (dσ(h) = 2 dcap dφ) and an azimuth whose sine and cosine cost a division.
//! tan(φ/4) runs from 0 to 1 and its slope changes by a factor of two only, so that it is nearly the angle's fraction itself.
//!
//! The chart's first axis is cut into [`PARTS`] for tables: MERL's own bins of θh while they lie within the domain for every
//! `wo`, then equal steps to its end. Measured tables jump at the edges of MERL's bins, and a highlight stays in its bins when
//! `wo` moves. Numbered steps are those of `docs/half-vector-table.md`.

use std::sync::LazyLock;

use glam::Vec3;

use super::merl_axes::{AxisBins, theta_h_edge_cap};

/// MERL's bins of θh that end below 45°, which half vectors reach for every `wo`.
pub(crate) const MERL_PARTS: usize = 63;
/// Equal steps of the cap beyond them.
pub(crate) const UPPER_PARTS: usize = 16;
/// Parts of the chart's first axis.
pub(crate) const PARTS: usize = MERL_PARTS + UPPER_PARTS;

/// Caps at the edges of MERL's bins, 0 to [`MERL_PARTS`].
static MERL_CAPS: LazyLock<[f32; MERL_PARTS + 1]> =
    LazyLock::new(|| std::array::from_fn(|edge| theta_h_edge_cap(edge) as f32));

/// The least tan(φmax/4): narrower azimuths are less than f32 directions resolve.
const LEAST_MAX_QUARTER_TAN: f32 = 1e-6;

/// An edge between parts of the cap: it lies at `fixed + weight·cap_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChartEdge {
    fixed: f32,
    weight: f32,
}

impl ChartEdge {
    /// Edge number `number`, 0 to [`PARTS`].
    pub(crate) fn new(number: usize) -> Self {
        // Step 3: cap(e) = sin²(45°·(e/90)²) for e ≤ 63, cap(63) + (cap_max − cap(63))·(e − 63)/16 beyond.
        if number <= MERL_PARTS {
            return Self {
                fixed: MERL_CAPS[number],
                weight: 0.0,
            };
        }
        let weight = (number - MERL_PARTS) as f32 / UPPER_PARTS as f32;
        Self {
            fixed: MERL_CAPS[MERL_PARTS] * (1.0 - weight),
            weight,
        }
    }

    /// The summand of the edge's cap that is the same for every `wo`.
    pub(crate) fn fixed(&self) -> f32 {
        self.fixed
    }

    /// The factor of the cap of θmax, 0 to 1.
    pub(crate) fn weight(&self) -> f32 {
        self.weight
    }
}

/// The domain about one direction, with coordinates that need no trigonometry, in f32: for tables that are drawn from.
///
/// The coordinates are the cap of θh, sin²(θh/2), in [0, `cap_max`], and tan(φ/4) as a fraction in [−1, 1] of the largest. All
/// arithmetic is free of branches, so that loops over it become vector code.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfVectorChart {
    wo: Vec3,
    /// `wo` turned to azimuth 0 is (sin_o, 0, cos_o).
    sin_o: f32,
    cos_o: f32,
    /// Cosine and sine of the azimuth of `wo`; (1, 0) along the normal.
    azimuth: (f32, f32),
    /// Cap of θmax.
    cap_max: f32,
}

/// A direction in the coordinates of a [`HalfVectorChart`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChartPoint {
    /// sin²(θh/2), in [0, cap of θmax].
    pub(crate) cap: f32,
    /// tan²θh as lookups compute it: where a value jumps at the edge of a bin, the density must jump with it.
    pub(crate) tan2_theta_h: f64,
    /// tan(φ/4) as a fraction of the largest, in [−1, 1].
    pub(crate) azimuth_fraction: f32,
    /// dσ(wi) per dcap and d(azimuth fraction), sr.
    pub(crate) jacobian: f32,
}

impl HalfVectorChart {
    /// The chart about `wo`, which must be above the horizon and of unit length up to rounding.
    #[inline(always)]
    pub(crate) fn new(wo: Vec3) -> Self {
        // Step 1: sinO = √(wo.x² + wo.y²), cosO = wo.z, (C, S) = (wo.x, wo.y)/sinO; both of length 1 to the last bit.
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
        // Step 2: cos θmax = cos(π/4 + θo/2) = cosO/√(2(1 + sinO)), and the cap of θmax is (1 − cos θmax)/2.
        let cos_max = cos_o / (2.0 * (1.0 + sin_o)).sqrt();
        Self {
            wo,
            sin_o,
            cos_o,
            azimuth,
            cap_max: 0.5 * (1.0 - cos_max),
        }
    }

    /// Where [`Self::to_array`] has the cosine of the polar angle of `wo`.
    pub(crate) const COS_O: usize = 4;
    /// Where it has the cap of θmax.
    pub(crate) const CAP_MAX: usize = 7;

    /// Its numbers, for columns of many charts.
    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; 8] {
        let Self {
            wo,
            sin_o,
            cos_o,
            azimuth,
            cap_max,
        } = self;
        [
            wo.x, wo.y, wo.z, sin_o, cos_o, azimuth.0, azimuth.1, cap_max,
        ]
    }

    /// The inverse of [`Self::to_array`].
    #[inline(always)]
    pub(crate) fn from_array([x, y, z, sin_o, cos_o, c, s, cap_max]: [f32; 8]) -> Self {
        Self {
            wo: Vec3::new(x, y, z),
            sin_o,
            cos_o,
            azimuth: (c, s),
            cap_max,
        }
    }

    /// Cosine of the polar angle of `wo`.
    #[inline(always)]
    pub(crate) fn cos_o(&self) -> f32 {
        self.cos_o
    }

    /// The cap at an edge.
    #[inline(always)]
    pub(crate) fn edge_cap(&self, edge: ChartEdge) -> f32 {
        edge.fixed + edge.weight * self.cap_max
    }

    /// The largest tan(φ/4) at a θh, 1 where every azimuth reflects above the horizon.
    #[inline(always)]
    fn max_quarter_tan(&self, sin_h: f32, cos_h: f32) -> f32 {
        // Step 6: far = −cos(2θh + θo), near = cos(2θh − θo); tan(φmax/2) = √(near/far), so
        //         tan(φmax/4) = √near/(√far + √(near + far)).
        let sin_2h = 2.0 * sin_h * cos_h;
        let cos_2h = (cos_h - sin_h) * (cos_h + sin_h);
        let (sines, cosines) = (sin_2h * self.sin_o, cos_2h * self.cos_o);
        // Where no azimuth reflects below the horizon, far is 0 and the result √near/√near.
        let far = (sines - cosines).max(0.0);
        let near = (cosines + sines).max(f32::MIN_POSITIVE);
        (near.sqrt() / (far.sqrt() + (near + far).sqrt())).max(LEAST_MAX_QUARTER_TAN)
    }

    /// The largest tan(φ/4) at a cap: the unit of the azimuth fraction.
    #[inline(always)]
    pub(crate) fn max_quarter_tan_of_cap(&self, cap: f32) -> f32 {
        let (sin_h, cos_h) = sin_cos_of_cap(cap);
        self.max_quarter_tan(sin_h, cos_h)
    }

    /// The reflected direction at a cap and an azimuth fraction; on or above the horizon up to rounding.
    #[inline(always)]
    pub(crate) fn direction(&self, cap: f32, azimuth_fraction: f32) -> Vec3 {
        // Step 15: sine and cosine of θh from the cap, and q = β·tan(φmax/4).
        let (sin_h, cos_h) = sin_cos_of_cap(cap);
        let quarter_tan = azimuth_fraction * self.max_quarter_tan(sin_h, cos_h);
        // Steps 16 and 17: the half vector, and the reflection of wo about it.
        let (sin, cos) = sin_cos_of_quarter_tan(quarter_tan);
        self.reflect(sin_h, cos_h, sin, cos)
    }

    /// The reflection of `wo` about the half vector of a polar angle and an azimuth against `wo`.
    #[inline(always)]
    fn reflect(&self, sin_h: f32, cos_h: f32, sin: f32, cos: f32) -> Vec3 {
        // Step 16: h = (sinH·cos φ, sinH·sin φ, cosH), d = 2 wo·h.
        let (h_x, h_y) = (sin_h * cos, sin_h * sin);
        let twice = 2.0 * (self.sin_o * h_x + self.cos_o * cos_h);
        // Step 17: wi = d·h − wo, turned by the azimuth of wo.
        let (x, y) = (twice * h_x - self.sin_o, twice * h_y);
        let (c, s) = self.azimuth;
        Vec3::new(c * x - s * y, s * x + c * y, twice * cos_h - self.cos_o)
    }

    /// Directions and Jacobians at one cap and many azimuth fractions, for tabulating: calls
    /// `visit(wi, dσ(wi) per dcap and d(azimuth fraction))` for each.
    pub(crate) fn for_each_azimuth(
        &self,
        cap: f32,
        azimuth_fractions: impl Iterator<Item = f32>,
        mut visit: impl FnMut(Vec3, f32),
    ) {
        let (sin_h, cos_h) = sin_cos_of_cap(cap);
        let max_quarter_tan = self.max_quarter_tan(sin_h, cos_h);
        for azimuth_fraction in azimuth_fractions {
            let quarter_tan = azimuth_fraction * max_quarter_tan;
            let (sin, cos) = sin_cos_of_quarter_tan(quarter_tan);
            // wo·h
            let cos_d = self.sin_o * sin_h * cos + self.cos_o * cos_h;
            visit(
                self.reflect(sin_h, cos_h, sin, cos),
                32.0 * cos_d * max_quarter_tan / (1.0 + quarter_tan * quarter_tan),
            );
        }
    }

    /// The coordinates of `wi`, above the horizon; the azimuth fraction is clamped where rounding leaves the domain.
    #[inline(always)]
    pub(crate) fn locate(&self, wi: Vec3) -> ChartPoint {
        // Step 18: m = wo + wi in the frame where wo has azimuth 0, its length L, and ρ = |m.xy|.
        let (c, s) = self.azimuth;
        let x = self.sin_o + (c * wi.x + s * wi.y);
        let y = c * wi.y - s * wi.x;
        let z = self.cos_o + wi.z;
        let rho2 = x * x + y * y;
        let (rho, length) = (rho2.sqrt(), (rho2 + z * z).sqrt());
        let scale = 1.0 / length;
        // Step 19, the cap: sin²(θh/2) = ρ²/(2L(L + m.z)).
        let cap = 0.5 * rho2 * scale / (length + z);
        // Step 20: q = tan(φ/4), and β = q/tan(φmax/4).
        let max_quarter_tan = self.max_quarter_tan(rho * scale, z * scale);
        let quarter_tan = quarter_tan_of(x, y, rho);
        let azimuth_fraction = (quarter_tan / max_quarter_tan).clamp(-1.0, 1.0);
        // Step 22, the Jacobian: dσ(wi) = 4 (wo·h) dσ(h), dσ(h) = 2 dcap dφ, dφ = 4 dq/(1 + q²), and wo·h = L/2.
        let jacobian = 16.0 * length * max_quarter_tan / (1.0 + quarter_tan * quarter_tan);
        let sum = self.wo.as_dvec3() + wi.as_dvec3();
        let tan2_theta_h = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z);
        ChartPoint {
            cap,
            tan2_theta_h,
            azimuth_fraction,
            jacobian,
        }
    }

    /// The part that holds a point: below the last of MERL's parts by its squared tangent, as lookups find bins.
    #[inline(always)]
    pub(crate) fn find_part(&self, point: &ChartPoint) -> usize {
        let bin = AxisBins::get().theta_h.bin(point.tan2_theta_h);
        if bin < MERL_PARTS {
            return bin;
        }
        self.find_upper_part(point)
    }

    /// The part that holds a point beyond the last of MERL's parts.
    #[inline(always)]
    pub(crate) fn find_upper_part(&self, point: &ChartPoint) -> usize {
        // Beyond MERL's parts the steps of the cap are equal. Tables have no jumps at these edges, so f32 decides.
        let low = MERL_CAPS[MERL_PARTS];
        let steps = (point.cap - low) / (self.cap_max - low) * UPPER_PARTS as f32;
        MERL_PARTS + (steps.max(0.0) as i32 as usize).min(UPPER_PARTS - 1)
    }
}

/// Sine and cosine of θh from its cap: sinH = 2√(cap(1 − cap)), cosH = 1 − 2cap.
#[inline(always)]
fn sin_cos_of_cap(cap: f32) -> (f32, f32) {
    (2.0 * (cap * (1.0 - cap)).sqrt(), 1.0 - 2.0 * cap)
}

/// Sine and cosine of φ from tan(φ/4), in [−1, 1].
#[inline(always)]
fn sin_cos_of_quarter_tan(q: f32) -> (f32, f32) {
    // Step 16: s = 2q/(1 + q²), c = (1 − q²)/(1 + q²) are those of φ/2; sin φ = 2sc, cos φ = c² − s².
    let scale = 1.0 / (1.0 + q * q);
    let (sin_half, cos_half) = (2.0 * q * scale, (1.0 - q * q) * scale);
    (
        2.0 * sin_half * cos_half,
        (cos_half - sin_half) * (cos_half + sin_half),
    )
}

/// tan(φ/4) of the azimuth of (x, y), whose length is `rho`; 0 for length 0.
#[inline(always)]
fn quarter_tan_of(x: f32, y: f32, rho: f32) -> f32 {
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
    use std::f64::consts::PI;

    use crate::geometry::{FibonacciLattice, HalfVectorDomain, is_upper, spherical};

    #[test]
    fn coordinates_invert_directions_and_all_are_above_the_horizon() {
        for theta_o in [0.0, 0.3, 30.0, 60.25, 85.0, 89.9_f64] {
            let wo = spherical(theta_o.to_radians(), 2.0).as_vec3();
            let domain = HalfVectorDomain::new(wo).unwrap();
            for (s, t) in FibonacciLattice::at_least(500).points() {
                let (theta_h, b) = (s * domain.theta_max(), 2.0 * t - 1.0);
                let (wi, jacobian) = domain.direction(theta_h, b);
                assert!(
                    is_upper(wi) && jacobian > 0.0,
                    "θo {theta_o}, θh {theta_h}, b {b}: {wi}"
                );
                let (theta_back, b_back) = domain.coordinates(wi);
                assert!(
                    (theta_back - theta_h).abs() < 2e-6,
                    "{theta_o}: {theta_h} {theta_back}"
                );
                let slack = 1e-5 / (theta_h.sin() * domain.phi_max(theta_h)).max(1e-6);
                assert!((b_back - b).abs() < slack, "{theta_o}: {b} {b_back}");
            }
        }
    }

    #[test]
    fn the_horizon_is_at_the_ends_of_the_azimuth() {
        let domain = HalfVectorDomain::new(spherical(1.2, 0.0).as_vec3()).unwrap();
        for theta_h in [
            domain.theta_full() + 0.01,
            0.6,
            1.0,
            domain.theta_max() - 0.01,
        ] {
            let (wi, _) = domain.direction(theta_h, 1.0);
            assert!(wi.z.abs() < 1e-6, "{theta_h}: {wi}");
        }
        assert_eq!(domain.phi_max(domain.theta_full() - 1e-9), PI);
        assert!(domain.phi_max(domain.theta_max()) < 1e-7);
    }

    #[test]
    fn directions_below_the_horizon_have_no_half_vectors() {
        assert!(HalfVectorDomain::new(-Vec3::Z).is_none());
        assert!(HalfVectorDomain::new(Vec3::NAN).is_none());
    }

    fn edge(chart: &HalfVectorChart, number: usize) -> f64 {
        f64::from(chart.edge_cap(ChartEdge::new(number)))
    }

    #[test]
    fn places_invert_directions() {
        for theta_o in [0.0, 0.3, 30.0, 60.25, 85.0, 89.9_f64] {
            let wo = spherical(theta_o.to_radians(), 2.0).as_vec3();
            let chart = HalfVectorChart::new(wo);
            for (s, t) in FibonacciLattice::at_least(500).points() {
                let (cap, b) = ((s * edge(&chart, PARTS)) as f32, (2.0 * t - 1.0) as f32);
                let wi = chart.direction(cap, b);
                assert!(
                    wi.z > -1e-6 && (wi.length() - 1.0).abs() < 2e-6,
                    "θo {theta_o}, {s} {t}: {wi}"
                );
                let place = chart.locate(wi);
                assert!((place.cap - cap).abs() < 1e-6, "{theta_o}: {cap} {place:?}");
                let part = chart.find_part(&place);
                let edges = [part, part + 1].map(|e| edge(&chart, e) as f32);
                assert!(
                    edges[0] - 1e-6 < cap && cap < edges[1] + 1e-6,
                    "{cap} {place:?}"
                );
                let slack = 1e-5 / (s * (1.0 - s)).max(1e-3) as f32;
                assert!(
                    (place.azimuth_fraction - b).abs() < slack,
                    "{theta_o}, {s}: {b} {place:?}"
                );
            }
        }
    }

    #[test]
    fn both_parametrisations_are_of_one_domain() {
        for theta_o in [0.0, 14.5, 60.0, 88.0_f64] {
            let wo = spherical(theta_o.to_radians(), -1.0).as_vec3();
            let (chart, rectangle) = (HalfVectorChart::new(wo), HalfVectorDomain::new(wo).unwrap());
            let theta_max = 2.0 * edge(&chart, PARTS).sqrt().asin();
            assert!((theta_max - rectangle.theta_max()).abs() < 1e-6);
            for (s, t) in FibonacciLattice::at_least(300).points() {
                let (cap, b) = (s * edge(&chart, PARTS), 2.0 * t - 1.0);
                let theta_h = 2.0 * cap.sqrt().asin();
                // The fraction of the largest tan(φ/4), against the fraction of the largest φ.
                let phi_max = rectangle.phi_max(theta_h);
                let fraction = 4.0 * (b * (0.25 * phi_max).tan()).atan() / phi_max;
                let slope = phi_max * (1.0 + (0.25 * fraction * phi_max).tan().powi(2))
                    / (4.0 * (0.25 * phi_max).tan());
                let (expected, per_theta) = rectangle.direction(theta_h, fraction);
                let here = format!("θo {theta_o}, {s} {t}");
                assert!(
                    chart
                        .direction(cap as f32, b as f32)
                        .abs_diff_eq(expected, 5e-6),
                    "{here}"
                );
                // dcap/dθh = sin θh/2.
                let agrees = |jacobian: f32| {
                    let ratio = f64::from(jacobian) * 0.5 * theta_h.sin() * slope / per_theta;
                    assert!((ratio - 1.0).abs() < 1e-4 / (1.0 - s), "{here}: {ratio}");
                };
                chart.for_each_azimuth(cap as f32, std::iter::once(b as f32), |wi, jacobian| {
                    assert!(wi.abs_diff_eq(expected, 5e-6), "{here}");
                    agrees(jacobian);
                });
                agrees(chart.locate(expected).jacobian);
            }
        }
    }

    #[test]
    fn merl_parts_lie_below_the_end_for_every_wo() {
        let chart = HalfVectorChart::new(Vec3::Z);
        assert!((0..PARTS).all(|i| edge(&chart, i) < edge(&chart, i + 1)));
    }
}
