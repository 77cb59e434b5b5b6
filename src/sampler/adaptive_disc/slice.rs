//! The function that a tree is grown over.

use glam::{DVec2, Vec3};

use super::AdaptiveDiscSettings;
use super::bounds::MaxTable;
use crate::brdf::Brdf;
use crate::geometry::{Quadrature, spherical};
use crate::material::merl::{LookupRule, MerlBrdf};

/// Points in each bin of θh of [`Slice::finest_integral`].
const FINEST: usize = 10_946;

/// f(wo, ·) for one fixed `wo` in the plane of φ = 0, as a scalar.
pub(super) struct Slice<'a> {
    brdf: &'a MerlBrdf,
    pub settings: &'a AdaptiveDiscSettings,
    /// Where values may be taken from instead of `brdf`.
    plane: Option<&'a MaxTable>,
    pub wo: Vec3,
}

impl<'a> Slice<'a> {
    pub fn new(
        brdf: &'a MerlBrdf,
        settings: &'a AdaptiveDiscSettings,
        table: Option<&'a MaxTable>,
        theta: f64,
    ) -> Self {
        let plane = table.filter(|_| brdf.rule() == LookupRule::Floor);
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

    /// ∫ f over the disc.
    pub fn integral(&self, tolerance: f64) -> f64 {
        Quadrature::new(self.wo, 1)
            .integrate_refined(tolerance, |wi| self.value(wi) * f64::from(wi.z))
    }

    /// ∫ f over the disc with as many points as any bin is given.
    pub fn finest_integral(&self) -> f64 {
        Quadrature::new(self.wo, FINEST).integrate(|wi| self.value(wi) * f64::from(wi.z))
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
