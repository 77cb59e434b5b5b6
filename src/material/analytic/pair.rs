//! A pair of directions with the cosines that the formulas are written in.

use glam::DVec3;

/// Two unit directions above the horizon, their half vector and their cosines.
pub(super) struct UpperPair {
    /// Towards the viewer.
    pub(super) wo: DVec3,
    /// Towards the light.
    pub(super) wi: DVec3,
    /// The unit half vector.
    pub(super) h: DVec3,
    /// Cosine of the viewer's angle to the normal.
    pub(super) cos_o: f64,
    /// Cosine of the light's angle to the normal.
    pub(super) cos_i: f64,
    /// Cosine of the angle between the half vector and either direction.
    pub(super) cos_d: f64,
}

impl UpperPair {
    /// The pair; both directions have z > 0 and a length near 1.
    pub(super) fn new(wo: DVec3, wi: DVec3) -> Self {
        let (wo, wi) = (wo.normalize(), wi.normalize());
        // |wo + wi| = 2 wo·h, and it is > 0 because both have z > 0.
        let sum = wo + wi;
        let length = sum.length();
        Self {
            wo,
            wi,
            h: sum / length,
            cos_o: wo.z,
            cos_i: wi.z,
            cos_d: (0.5 * length).min(1.0),
        }
    }

    /// tan² of the angle between half vector and normal.
    pub(super) fn tan2_h(&self) -> f64 {
        (self.h.x * self.h.x + self.h.y * self.h.y) / (self.h.z * self.h.z)
    }

    /// cosⁿ of the angle between half vector and normal, written so that it is accurate for large n: exp(−½n·ln(1 + tan²)).
    pub(super) fn cos_h_power(&self, n: f64) -> f64 {
        (-0.5 * n * self.tan2_h().ln_1p()).exp()
    }

    /// cosⁿ of the angle between the light and the viewer's mirror direction; 0 beyond a right angle.
    pub(super) fn cos_mirror_power(&self, n: f64) -> f64 {
        let (wo, wi) = (self.wo, self.wi);
        clamped_power(wo.z * wi.z - wo.x * wi.x - wo.y * wi.y, n)
    }

    /// Cosine of the difference of the azimuths; 1 where one of them is not defined.
    pub(super) fn cos_azimuth(&self) -> f64 {
        let (o, i) = (self.wo.truncate(), self.wi.truncate());
        let lengths = o.length() * i.length();
        if lengths > 0.0 {
            (o.dot(i) / lengths).clamp(-1.0, 1.0)
        } else {
            1.0
        }
    }
}

/// cosⁿ, 0 where the cosine is not positive; cosines that rounding made larger than 1 count as 1.
pub(super) fn clamped_power(cosine: f64, n: f64) -> f64 {
    if cosine > 0.0 {
        cosine.min(1.0).powf(n)
    } else {
        0.0
    }
}

/// (1 − c)⁵, Schlick's fall from the horizon to the normal.
pub(super) fn schlick_weight(cosine: f64) -> f64 {
    (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}
