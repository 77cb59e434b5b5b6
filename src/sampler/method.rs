//! What makes a sampler a method that commands, files and figures know by name.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use glam::Vec3;

use super::settings::Settings;
use super::store::{TensorWriter, Tensors};
use crate::Result;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::material::{Loaded, MaterialFacts};

/// What a method asks of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Needs {
    /// Nothing.
    AnyMaterial,
    /// That turning both directions about the normal leaves its values as they are.
    IsotropicMaterial,
    /// A MERL table, whose bins bound its values.
    MerlTable,
    /// A sampler that the material's own file holds.
    OwnSampler,
}

impl Needs {
    /// Whether a material has it.
    pub fn are_met_by(self, facts: &MaterialFacts) -> bool {
        match self {
            Self::AnyMaterial => true,
            Self::IsotropicMaterial => facts.is_isotropic(),
            Self::MerlTable => facts.has_table,
            Self::OwnSampler => facts.has_own_sampler,
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AnyMaterial => "any material",
            Self::IsotropicMaterial => "an isotropic material",
            Self::MerlTable => "a MERL table",
            Self::OwnSampler => "a .bsdf file that holds a sampler of its own",
        })
    }
}

/// A family of samplers: how one is built from a material and kept in a file.
///
/// The type that implements this is what is built. To add a method, implement it and [`Settings`], and name the type in the
/// list of `sampler/mod.rs`: commands, help, tables, files and checks follow from these.
pub trait Method: Any + Send + Sync + Sized {
    /// The word that names it on the command line and in files.
    const NAME: &'static str;
    /// One sentence, without a full stop, for the list of methods.
    const SUMMARY: &'static str;
    /// What it asks of a material.
    const NEEDS: Needs;
    /// Whether it has tables to store: if not, [`Self::write`] and [`Self::read`] fail.
    const IS_STORED: bool = true;
    /// What can be set.
    type Settings: Settings<Method = Self>;

    /// Refuses settings that do not suit a material which is otherwise fit for this method.
    ///
    /// # Errors
    /// [`crate::Error::Argument`], naming the setting.
    fn check_facts(_settings: &Self::Settings, _facts: &MaterialFacts) -> Result<()> {
        Ok(())
    }

    /// Builds it on the threads of the current pool. The result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains, or a material that lacks what [`Self::NEEDS`] says.
    fn build(material: &Loaded, settings: &Self::Settings) -> Result<Self>;

    /// The settings that it was built with, and what was fitted in place of those left open. Building with these gives the
    /// same sampler again.
    fn settings(&self) -> Self::Settings;

    /// What draws the directions.
    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler>;

    /// Draws `count` directions for one `wo` that are spread together by a way of its own, each with the density `pdf`; `None`
    /// if it has none that is better than [`crate::direction_sampler::draw_stratified`].
    fn draw_own_strata(
        &self,
        _wo: Vec3,
        _count: usize,
        _seed: u64,
    ) -> Option<Vec<Option<DirectionSample>>> {
        None
    }

    /// Adds its tables to a file.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] if there is nothing to store.
    fn write(&self, out: &mut TensorWriter) -> Result<()>;

    /// Puts it together from the tables of a file, having checked all that drawing relies on. The settings are within their
    /// domains.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for a tensor that is missing or breaks an invariant.
    fn read(tensors: &Tensors, settings: Self::Settings, material: &Loaded) -> Result<Self>;
}
