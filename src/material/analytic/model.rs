//! What every model is.

use std::sync::Arc;

use super::parameters::Parameters;
use crate::Result;
use crate::brdf::Brdf;

/// A model: what it is called, and how it is made of its parameters.
pub(super) struct Model {
    /// Its name in front of the colon.
    pub(super) name: &'static str,
    /// Asks for every parameter that the model has, and builds the BRDF.
    pub(super) build: fn(&mut Parameters) -> Result<Arc<dyn Brdf>>,
}
