//! From a formula's text to its BRDF.

use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, FormulaBrdf, Model};
use super::parameters::{ParameterFacts, Parameters};
use crate::Result;
use crate::brdf::Brdf;

/// A formula that was understood.
pub(super) struct Parsed {
    pub(super) model: &'static Model,
    pub(super) formula: Arc<dyn Formula>,
    pub(super) rgb: DVec3,
    /// The canonical text.
    pub(super) text: String,
    pub(super) parameters: Vec<ParameterFacts>,
}

/// Reads the text of a formula of `model`.
///
/// # Errors
/// As [`Parameters::parse`], and for a parameter that is unknown or outside its domain.
pub(super) fn parse_formula(model: &'static Model, argument: &str) -> Result<Parsed> {
    let settings = argument
        .split_once(':')
        .map_or("", |(_, settings)| settings);
    let mut parameters = Parameters::parse(model.name, settings)?;
    let formula = (model.build)(&mut parameters)?;
    let rgb = parameters.rgb()?;
    let (text, parameters) = parameters.finish()?;
    Ok(Parsed {
        model,
        formula,
        rgb,
        text,
        parameters,
    })
}

impl Parsed {
    /// The formula as a BRDF.
    pub(super) fn brdf(&self) -> Arc<dyn Brdf> {
        match self.formula.lambertian(self.rgb) {
            Some(lambert) => Arc::new(lambert),
            None => Arc::new(FormulaBrdf {
                formula: self.formula.clone(),
                rgb: self.rgb,
            }),
        }
    }
}
