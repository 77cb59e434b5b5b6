//! The function that a tree is grown over.

use glam::{DVec2, Vec3};

use super::AdaptiveDiscSettings;
use super::bounds::MaxTable;
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::bin_quadrature::{BinQuadrature, BinShape};
use crate::geometry::{Quadrature, spherical};
use crate::material::merl::LookupRule;

/// Directions that are evaluated together.
pub(super) const BATCH: usize = 64;

/// f(wo, ·) for one fixed `wo` in the plane of φ = 0, as a scalar.
pub(super) struct Slice<'a> {
    brdf: &'a dyn Brdf,
    pub settings: &'a AdaptiveDiscSettings,
    /// Where values may be taken from instead of `brdf`.
    plane: Option<&'a MaxTable>,
    pub wo: Vec3,
}

impl<'a> Slice<'a> {
    /// Values of `brdf`, or, where it is a MERL table with floor lookup, of `table`, which must be made from it.
    pub fn new(
        brdf: &'a dyn Brdf,
        settings: &'a AdaptiveDiscSettings,
        table: Option<&'a MaxTable>,
        theta: f64,
    ) -> Self {
        let plane = table.filter(|table| table.rule() == LookupRule::Floor);
        Self {
            brdf,
            settings,
            plane,
            wo: spherical(theta, 0.0).as_vec3(),
        }
    }

    #[inline]
    pub fn value(&self, wi: Vec3) -> f64 {
        f64::from(match self.plane {
            Some(plane) => plane.floor_value(self.wo, wi),
            None => self.settings.importance.reduce(self.brdf.eval(self.wo, wi)),
        })
    }

    /// f at a few directions: `out[k]` becomes `value(wi[k])`, to the bit.
    pub fn values(&self, wi: &[Vec3], out: &mut [f64]) {
        let mut values = [Rgb::ZERO; BATCH];
        for (wi, out) in wi.chunks(BATCH).zip(out.chunks_mut(BATCH)) {
            let values = &mut values[..wi.len()];
            self.brdf.eval_batch(Wo::One(self.wo), wi, values);
            for (out, &value) in out.iter_mut().zip(&*values) {
                *out = f64::from(self.settings.importance.reduce(value));
            }
        }
    }

    /// ∫ f over the disc by lattices: enough to decide on divisions.
    pub fn rough_integral(&self, tolerance: f64) -> f64 {
        // dx dy = cosθi dσ(wi)
        Quadrature::new(self.wo, 1)
            .integrate_refined(tolerance, |wi| self.value(wi) * f64::from(wi.z))
    }

    /// ∫ f over the disc of a MERL table with this lookup to `tolerance`, relative: every density is divided by it.
    pub fn integral_of_table(&self, rule: LookupRule, tolerance: f64) -> f64 {
        // Values jump at the edges of bins under floor lookup. Interpolated ones bend there, or at the middles of bins.
        let (offset, is_constant) = match rule {
            LookupRule::Floor => (0.0, true),
            LookupRule::Linear => (0.0, false),
            LookupRule::Centred => (0.5, false),
        };
        let shape = BinShape {
            offset,
            is_constant,
        };
        let Some(quadrature) = BinQuadrature::new(self.wo, shape) else {
            return 0.0;
        };
        match self.plane {
            Some(plane) if !quadrature.is_near_normal() => {
                quadrature.integrate_cells(tolerance, plane.cells(), plane.phi_d_bins())
            }
            _ => quadrature.integrate(tolerance, |wi, out| self.values(wi, out)),
        }
    }

    /// The direction above a point of the disc; none, which has the value 0, beyond the rim.
    pub fn above_disc(p: DVec2) -> Vec3 {
        let z2 = 1.0 - p.length_squared();
        if z2 > 0.0 {
            p.extend(z2.sqrt()).as_vec3()
        } else {
            Vec3::ZERO
        }
    }

    pub fn value_on_disc(&self, p: DVec2) -> f64 {
        let z2 = 1.0 - p.length_squared();
        if z2 > 0.0 {
            self.value(p.extend(z2.sqrt()).as_vec3())
        } else {
            0.0
        }
    }
}
