//! The factored BRDF (Lawrence, Rusinkiewicz, Ramamoorthi 2004; thesis 5.5): f_r·cosθ ≈ Σ_j F_j(wo) Σ_k u_jk(θw) v_jk(φw), a
//! sum of products of non-negative functions of one angle each, where w is the half vector or `wi`.
//!
//! A draw chooses a term (j, k) by its probability at `wo` and inverts the CDFs of its two factors. The density is the derivative of
//! what is drawn; half vectors that reflect `wo` below the horizon make a draw fail. Azimuths count from that of `wo`, or, of an
//! anisotropic material, from the surface's x, and F_j is interpolated between the directions of `wo` that have a table.

mod build;
mod codec;
mod fields;
mod mixture;
mod settings;

pub use mixture::Factored;
pub use settings::{FactoredSettings, Factors};

use std::sync::Arc;

use super::azimuth_knots::{check_azimuths, check_stored_azimuths};
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::direction_sampler::DirectionSampler;
use crate::material::{Loaded, MaterialFacts};

impl Method for Factored {
    const NAME: &'static str = "factored";
    const SUMMARY: &'static str = "a sum of products of functions of one angle each";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = FactoredSettings;

    fn check_facts(settings: &FactoredSettings, facts: &MaterialFacts) -> Result<()> {
        check_azimuths(settings.azimuths, facts.symmetry)
    }

    fn build(material: &Loaded, settings: &FactoredSettings) -> Result<Self> {
        Self::build(&**material.brdf(), *settings)
    }

    fn settings(&self) -> FactoredSettings {
        *self.settings()
    }

    fn agree(asked: &FactoredSettings, used: &FactoredSettings) -> bool {
        let factors = asked.factors.or(used.factors);
        let azimuths = asked.azimuths.or(used.azimuths);
        FactoredSettings {
            factors,
            azimuths,
            ..*asked
        } == *used
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        codec::write(&self.terms, out);
        Ok(())
    }

    fn read(tensors: &Tensors, settings: FactoredSettings, material: &Loaded) -> Result<Self> {
        let symmetry = material.symmetry();
        check_stored_azimuths(settings.azimuths, symmetry, tensors)?;
        Self::from_parts(settings, symmetry, codec::read(tensors, &settings)?)
    }
}
