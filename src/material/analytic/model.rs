//! What every model is, and what it is made of.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::constant::Lambert;
use super::pair::UpperPair;
use super::parameters::Parameters;
use crate::Result;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{Symmetry, unit_upper};

/// A model: what it is called, where it comes from, and how it is made of its parameters.
pub(super) struct Model {
    /// Its name in front of the colon.
    pub(super) name: &'static str,
    /// What it is, in a few words.
    pub(super) summary: &'static str,
    /// The paper that describes it.
    pub(super) source: &'static str,
    /// Asks for every parameter that the model has, and builds the formula.
    pub(super) build: fn(&mut Parameters) -> Result<Arc<dyn Formula>>,
}

/// A reflectance formula with its parameters.
pub(super) trait Formula: Send + Sync {
    /// f_r in sr⁻¹ of two unit directions above the horizon, without the delta part. `rgb` is the model's colour, by which
    /// most formulas multiply their value. A result that is NaN or negative is read as 0.
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3;

    /// The fraction of the light from the mirror direction that the delta part reflects, where the viewer's cosine is
    /// `cos_o`; `None` for a formula without a delta part.
    fn mirror(&self, _cos_o: f64, _rgb: DVec3) -> Option<DVec3> {
        None
    }

    /// The same as a BRDF of one constant, which is evaluated faster; `None` for formulas that depend on directions.
    fn lambertian(&self, _rgb: DVec3) -> Option<Lambert> {
        None
    }

    /// What is known of its values.
    fn properties(&self) -> Properties;
}

/// What is known of a formula's values for given parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Properties {
    /// Whether exchanging the directions leaves f_r as it is.
    pub(super) reciprocal: bool,
    /// Whether f_r has a bound over all pairs of directions.
    pub(super) bounded: bool,
    /// What may be done to both directions without changing f_r.
    pub(super) symmetry: Symmetry,
    /// A bound of the directional albedo, with the delta part and a white colour; `None` where none is known.
    pub(super) albedo_bound: Option<f64>,
}

impl Properties {
    /// Reciprocal, bounded and isotropic, with no known bound of the albedo.
    pub(super) const PLAIN: Self = Self {
        reciprocal: true,
        bounded: true,
        symmetry: Symmetry::Isotropic,
        albedo_bound: None,
    };

    /// The symmetry of a formula whose x and y axes are treated alike if `alike`, and which is symmetric to both in any case.
    pub(super) fn axes(alike: bool) -> Symmetry {
        if alike {
            Symmetry::Isotropic
        } else {
            Symmetry::Quarter
        }
    }
}

/// A formula as a BRDF, with its colour.
pub(super) struct FormulaBrdf {
    pub(super) formula: Arc<dyn Formula>,
    pub(super) rgb: DVec3,
}

impl Brdf for FormulaBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return Rgb::ZERO;
        };
        let pair = UpperPair::new(wo.as_dvec3(), wi.as_dvec3());
        round_to_f32(self.formula.value(&pair, self.rgb))
    }

    fn mirror(&self, wo: Vec3) -> Option<Rgb> {
        let cos_o = f64::from(unit_upper(wo)?.z).min(1.0);
        self.formula.mirror(cos_o, self.rgb).map(round_to_f32)
    }

    fn is_isotropic(&self) -> bool {
        self.symmetry() == Symmetry::Isotropic
    }

    fn symmetry(&self) -> Symmetry {
        self.formula.properties().symmetry
    }
}

/// The value in f32, finite and ≥ 0: 0 for what is not, and the largest f32 for what exceeds it.
fn round_to_f32(value: DVec3) -> Rgb {
    let [r, g, b] = value.to_array().map(|channel| {
        if channel > 0.0 {
            channel.min(f64::from(f32::MAX)) as f32
        } else {
            0.0
        }
    });
    Rgb::new(r, g, b)
}
