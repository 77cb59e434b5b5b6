//! Analytic lobes whose parameters are fitted to the material: what a renderer uses that has no tables.
//!
//! Each is mixed with the cosine, of which a fraction of at least [`LEAST_DIFFUSE`] is drawn unless another is given: a lobe alone has densities of 0, or so near to 0 that
//! the variance of weights is infinite, where measured materials still reflect. The density is that of the mixture (one-sample
//! MIS with the balance heuristic; Veach 1997, 9.2.4). Draws that end below the horizon fail.

mod codec;
mod fields;
#[cfg(feature = "fit")]
mod fit;
mod horizon;
mod nodes;
mod settings;
mod shape;

pub(super) use nodes::Nodes;
pub use settings::{LEAST_DIFFUSE, LobeKind, LobeParameters, LobeSettings};

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use super::draws::with_density;
use super::knots::split_unit;
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs, Settings};
use crate::Result;
use crate::brdf::Brdf;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, unit_upper};
use crate::material::Loaded;
use shape::LobeMixture;

/// A lobe and the fraction of draws that follow the cosine.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct Lobe {
    settings: LobeSettings,
    parameters: LobeParameters,
    mixture: LobeMixture,
}

impl Lobe {
    /// The lobe with the parameters given, or else those that make the weights f_r·cosθ/pdf most even: the least mean over
    /// six angles of `wo` of ln(E\[w²\]/E\[w\]²), by quadrature. A black material is given
    /// the cosine alone.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for parameters outside their domains, and for none where the feature `fit` is left out.
    pub fn build(brdf: &dyn Brdf, settings: LobeSettings) -> Result<Self> {
        let parameters = match settings.parameters {
            Some(given) => given,
            None => fit_parameters(brdf, &settings)?,
        };
        Self::from_settings(settings, parameters)
    }

    /// The lobe with these parameters, which replace those of the settings.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for parameters outside their domains.
    fn from_settings(settings: LobeSettings, parameters: LobeParameters) -> Result<Self> {
        let settings = LobeSettings {
            parameters: Some(parameters),
            ..settings
        };
        settings.check()?;
        Ok(Self {
            mixture: LobeMixture::new(&settings, &parameters),
            settings,
            parameters,
        })
    }

    /// The settings it was built with, and the parameters fitted.
    pub fn settings(&self) -> &LobeSettings {
        &self.settings
    }

    /// The parameters drawn with.
    pub fn parameters(&self) -> &LobeParameters {
        &self.parameters
    }
}

/// The parameters that suit a material best.
#[cfg(feature = "fit")]
fn fit_parameters(brdf: &dyn Brdf, settings: &LobeSettings) -> Result<LobeParameters> {
    let nodes = Nodes::tabulate(brdf, settings.importance);
    Ok(fit::fit(settings, &nodes))
}

/// Stands in for the fit where it is left out.
#[cfg(not(feature = "fit"))]
fn fit_parameters(_: &dyn Brdf, _: &LobeSettings) -> Result<LobeParameters> {
    Err(crate::Error::argument(
        "this build of the library fits no lobes",
        "give the lobe's parameters, or build with the feature `fit`",
    ))
}

impl Method for Lobe {
    const NAME: &'static str = "lobe";
    const SUMMARY: &'static str = "an analytic lobe fitted to the material, mixed with the cosine";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = LobeSettings;

    fn build(material: &Loaded, settings: &LobeSettings) -> Result<Self> {
        Self::build(&**material.brdf(), *settings)
    }

    fn settings(&self) -> LobeSettings {
        *self.settings()
    }

    fn agree(asked: &LobeSettings, used: &LobeSettings) -> bool {
        let parameters = asked.parameters.or(used.parameters);
        LobeSettings {
            parameters,
            ..*asked
        } == *used
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        codec::write(self.parameters(), out);
        Ok(())
    }

    fn read(tensors: &Tensors, settings: LobeSettings, _: &Loaded) -> Result<Self> {
        Self::from_settings(settings, codec::read(tensors, &settings)?)
    }
}

impl DirectionSampler for Lobe {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        // One-sample MIS: u.x chooses the cosine with its fraction, and what is left of it is used for the draw.
        let diffuse = f64::from(self.parameters.diffuse);
        let (cosine, x) = split_unit(f64::from(u.x), diffuse);
        let point = DVec2::new(x, f64::from(u.y));
        let wi = if cosine {
            cosine_hemisphere(point)
        } else {
            self.mixture.draw_lobe(wo.as_dvec3(), point)
        }
        .as_vec3();
        with_density(self, wo, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        self.mixture.density(wo, wi).min(f64::from(f32::MAX)) as f32
    }

    fn bytes(&self) -> usize {
        size_of::<LobeParameters>()
    }
}
