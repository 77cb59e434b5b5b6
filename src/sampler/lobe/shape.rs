//! The lobes: what is drawn and its density, without the cosine and mixed with it.
//!
//! Angles near 0 are kept as tangents and chords, whose digits an arc cosine would lose. `wo` and `wi` are unit and above the
//! horizon; with s = wo + wi, tan θh = |s.xy|/s.z and dσ(wi) = 4 (wo·h) dσ(h) = 2|s| dσ(h).

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DVec2, DVec3, Vec3};

use super::horizon::HorizonMass;
use super::settings::{LobeKind, LobeParameters, LobeSettings};
use crate::geometry::reflect_about;
use crate::points::Stream;

/// Draws below the horizon after which a lobe without them gives up: each fails with a probability of ½ at most.
const MOST_REDRAWS: u32 = 60;

/// A lobe mixed with the cosine.
#[derive(Clone, Debug)]
pub(super) struct LobeMixture {
    kind: LobeKind,
    /// Shapes along and across the plane of incidence, or along the surface's x and y.
    shape: [f64; 2],
    diffuse: f64,
    surface_axes: bool,
    /// What is above the horizon of a lobe that is drawn again below it.
    above: Option<HorizonMass>,
}

impl LobeMixture {
    /// The lobe of `settings` with these parameters.
    pub fn new(settings: &LobeSettings, parameters: &LobeParameters) -> Self {
        let shape = [parameters.along, parameters.across].map(f64::from);
        let is_redrawn = settings.kind == LobeKind::CosineLobeHemisphere;
        Self {
            kind: settings.kind,
            shape,
            diffuse: f64::from(parameters.diffuse),
            surface_axes: settings.surface_axes,
            above: is_redrawn.then(|| HorizonMass::new(shape[0])),
        }
    }

    /// Density per solid angle at `wi`; both are unit and above the horizon.
    #[inline]
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f64 {
        let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
        let mut lobe = density(self.kind, self.shape, self.axis(wo), wo, wi);
        if let Some(above) = &self.above {
            lobe /= above.at_cosine(wo.z, self.shape[0]);
        }
        (1.0 - self.diffuse) * lobe + self.diffuse * wi.z * FRAC_1_PI
    }

    /// A direction of the lobe alone, drawn from `u` in [0, 1)²; it may end below the horizon.
    #[inline]
    pub fn draw_lobe(&self, wo: DVec3, u: DVec2) -> DVec3 {
        let axis = self.axis(wo);
        let mut wi = draw(self.kind, self.shape, axis, wo, u);
        if self.above.is_some() && wi.z <= 0.0 {
            let mut random = Stream::from_point(u.as_vec2());
            for _ in 0..MOST_REDRAWS {
                let u = DVec2::new(random.next_f64(), random.next_f64());
                wi = draw(self.kind, self.shape, axis, wo, u);
                if wi.z > 0.0 {
                    break;
                }
            }
        }
        wi
    }

    /// The direction in the plane that the first shape is along.
    #[inline]
    fn axis(&self, wo: DVec3) -> DVec2 {
        if self.surface_axes {
            return DVec2::X;
        }
        plane_of_incidence(wo)
    }
}

/// Density per solid angle of `wi`, with the shapes along and across `axis`.
#[inline]
fn density(kind: LobeKind, shape: [f64; 2], axis: DVec2, wo: DVec3, wi: DVec3) -> f64 {
    let n = shape[0];
    match kind {
        LobeKind::CosineLobe | LobeKind::CosineLobeHemisphere => {
            // (n + 1)/2π · cosⁿα, where cosα = 1 − |r − wi|²/2.
            let less = -0.5 * chord_squared(wo, wi);
            (n + 1.0) / TAU * power(1.0 + less, less, n)
        }
        LobeKind::CosineLobeSphere => {
            // (n + 1)/4π · ((1 + cosα)/2)ⁿ, where (1 + cosα)/2 = 1 − |r − wi|²/4.
            (n + 1.0) / (2.0 * TAU) * power(1.0, -0.25 * chord_squared(wo, wi), n)
        }
        LobeKind::Ggx => visible_normals(n, wo, wi),
        LobeKind::Blinn | LobeKind::Ward | LobeKind::AshikhminShirley => {
            // p(h)/(4 wo·h), where 2 (wo·h) = |wo + wi|.
            half_density(kind, shape, axis, wo + wi) / (2.0 * (wo + wi).length())
        }
    }
}

/// |r − wi|² = 2 (1 − cosα) for the mirror direction r and the angle α between it and `wi`.
#[inline]
fn chord_squared(wo: DVec3, wi: DVec3) -> f64 {
    (mirror(wo) - wi).length_squared()
}

/// (1 + `less`)ⁿ; 0 unless `sign` is positive.
fn power(sign: f64, less: f64, n: f64) -> f64 {
    if sign > 0.0 && less > -1.0 {
        (n * less.ln_1p()).exp()
    } else {
        0.0
    }
}

/// Density of the half vector along `sum`, per its own solid angle.
fn half_density(kind: LobeKind, shape: [f64; 2], axis: DVec2, sum: DVec3) -> f64 {
    let tan2 = sum.truncate().length_squared() / (sum.z * sum.z);
    match kind {
        LobeKind::Ward if shape[0] != shape[1] => {
            // exp(−tan²θ (cos²φ/α₁² + sin²φ/α₂²))/(π α₁α₂ cos³θ), with tanθ cosφ and tanθ sinφ along and across the axis.
            let [along, across] = shape;
            let x = axis.dot(sum.truncate()) / (sum.z * along);
            let y = axis.perp_dot(sum.truncate()) / (sum.z * across);
            FRAC_1_PI / (along * across) * (1.5 * tan2.ln_1p() - x * x - y * y).exp()
        }
        LobeKind::Ward => {
            // exp(−tan²θ/α²)/(πα² cos³θ), where cos⁻³θ = exp(3/2 · ln(1 + tan²θ)).
            let alpha2 = shape[0] * shape[0];
            FRAC_1_PI / alpha2 * (1.5 * tan2.ln_1p() - tan2 / alpha2).exp()
        }
        LobeKind::AshikhminShirley => {
            // √((ex + 1)(ey + 1))/2π · cosθ^(ex cos²φ + ey sin²φ), with φ from the axis.
            let [along, across] = shape;
            let turn = axis.dot(sum.truncate());
            let length2 = sum.truncate().length_squared();
            let cos2 = if length2 > 0.0 {
                (turn * turn / length2).min(1.0)
            } else {
                0.0
            };
            let scale = ((along + 1.0) * (across + 1.0)).sqrt() / TAU;
            scale * cosine_power(tan2, along * cos2 + across * (1.0 - cos2))
        }
        _ => (shape[0] + 1.0) / TAU * cosine_power(tan2, shape[0]),
    }
}

/// cosⁿθ by tan²θ: exp(−n/2 · ln(1 + tan²θ)).
#[inline]
fn cosine_power(tan2: f64, n: f64) -> f64 {
    (-0.5 * n * tan2.ln_1p()).exp()
}

/// G1(wo)·D(h)/(4 cosθo), the density of reflections at GGX normals visible from `wo` (Heitz 2018, equation 17).
fn visible_normals(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    let (sum, alpha2) = (wo + wi, alpha * alpha);
    let cos2 = sum.z * sum.z / sum.length_squared();
    // cos²θh + sin²θh/α², from the components: no digits are lost at the pole.
    let spread = cos2 + sum.truncate().length_squared() / (alpha2 * sum.length_squared());
    // D(h) = 1/(π α² (cos²θh + sin²θh/α²)²)
    let normals = FRAC_1_PI / (alpha2 * spread * spread);
    // G1/(4 cosθo) = 1/(2 (cosθo + √(cos²θo + α² sin²θo)))
    let sin2 = wo.truncate().length_squared();
    normals / (2.0 * (wo.z + (wo.z * wo.z + alpha2 * sin2).sqrt()))
}

/// A direction drawn from `u` in [0, 1)²; it may end below the horizon.
#[inline]
fn draw(kind: LobeKind, shape: [f64; 2], axis: DVec2, wo: DVec3, u: DVec2) -> DVec3 {
    // ln of a number in (0, 1].
    let log = (-u.x).ln_1p();
    let (sin, cos) = (TAU * u.y).sin_cos();
    let circle = DVec2::new(cos, sin);
    let n = shape[0];
    match kind {
        // F(cosα) inverted: cosα = (1 − u)^(1/(n + 1)), or (1 + cosα)/2 the same on the sphere. tilt takes 1 − cosα.
        LobeKind::CosineLobe | LobeKind::CosineLobeHemisphere => {
            tilt(mirror(wo), -(log / (n + 1.0)).exp_m1(), circle)
        }
        LobeKind::CosineLobeSphere => tilt(mirror(wo), -2.0 * (log / (n + 1.0)).exp_m1(), circle),
        // cosθ = (1 − u)^(1/(n + 1)), so tan²θ = (1 − u)^(−2/(n + 1)) − 1.
        LobeKind::Blinn => reflected(wo, circle, (-2.0 * log / (n + 1.0)).exp_m1()),
        // Slopes of an ellipse: tanθ (cosφ, sinφ) = √(−ln(1 − u)) (α₁ cos 2πu.y, α₂ sin 2πu.y).
        LobeKind::Ward if shape[0] != shape[1] => {
            let slope = (-log).sqrt() * DVec2::new(shape[0] * cos, shape[1] * sin);
            let circle = axis.rotate(slope.normalize_or(DVec2::X));
            reflected(wo, circle, slope.length_squared())
        }
        // tan²θ = −α² ln(1 − u)
        LobeKind::Ward => reflected(wo, circle, -n * n * log),
        LobeKind::AshikhminShirley => {
            // tan φ = √((ex + 1)/(ey + 1)) · tan 2πu.y. Given φ, θ is Blinn's with n + 1 = (ex + 1) cos²φ + (ey + 1) sin²φ.
            let [along, across] = shape.map(|e| e + 1.0);
            let turn = DVec2::new(across.sqrt() * cos, along.sqrt() * sin).normalize_or(DVec2::X);
            let exponent = along * turn.x * turn.x + across * turn.y * turn.y;
            reflected(wo, axis.rotate(turn), (-2.0 * log / exponent).exp_m1())
        }
        LobeKind::Ggx => reflect_about(wo, visible_normal(n, wo, u.x, circle)),
    }
}

/// The direction at 1 − cosα = `less` from the unit vector `axis`.
fn tilt(axis: DVec3, less: f64, circle: DVec2) -> DVec3 {
    let sin = (less * (2.0 - less)).max(0.0).sqrt();
    let (x, y) = axis.any_orthonormal_pair();
    (x * (sin * circle.x) + y * (sin * circle.y) + axis * (1.0 - less)).normalize_or(axis)
}

/// `wo` reflected at the half vector of azimuth `circle` and tan²θh = `tan2`.
fn reflected(wo: DVec3, circle: DVec2, tan2: f64) -> DVec3 {
    let cos = 1.0 / (1.0 + tan2).sqrt();
    reflect_about(wo, (circle * (tan2.sqrt() * cos)).extend(cos))
}

/// A GGX normal visible from `wo`: the sum of the stretched `wo` and a direction on the cap that it sees (Dupuy and Benyoub
/// 2023), stretched back.
fn visible_normal(alpha: f64, wo: DVec3, u: f64, circle: DVec2) -> DVec3 {
    // Step 1: wo where the ellipsoid of normals is a sphere.
    let view = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    // z from 1 down to −view.z; the complement keeps the digits of narrow lobes.
    let less = u * (1.0 + view.z);
    let sin = (less * (2.0 - less)).max(0.0).sqrt();
    // Step 2: the half vector of wo and a uniform direction of the cap, and back to the ellipsoid.
    let sum = (circle * sin).extend(1.0 - less) + view;
    DVec3::new(alpha * sum.x, alpha * sum.y, sum.z.max(0.0)).normalize_or(DVec3::Z)
}

fn mirror(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, wo.z)
}

/// Unit vector of the azimuth of `wo`; x along the normal.
fn plane_of_incidence(wo: DVec3) -> DVec2 {
    wo.truncate().try_normalize().unwrap_or(DVec2::X)
}
