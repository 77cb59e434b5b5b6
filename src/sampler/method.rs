//! What makes a sampler a method that commands, files and figures know by name, and its settings a text.

use std::any::Any;
use std::fmt;
use std::fmt::Debug;
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::settings::{
    Field, Preset, PresetFacts, SettingFacts, differing_words, find_field, unknown_setting,
};
use super::store::{TensorWriter, Tensors};
use crate::direction_sampler::DirectionSampler;
use crate::material::{Loaded, MaterialFacts};
use crate::{Error, Result};

/// What a method asks of a material.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Needs {
    /// Nothing.
    AnyMaterial,
    /// A sampler that the material's own file holds.
    OwnSampler,
}

impl Needs {
    /// Whether a material has it.
    pub fn are_met_by(self, facts: &MaterialFacts) -> bool {
        match self {
            Self::AnyMaterial => true,
            Self::OwnSampler => facts.has_own_sampler,
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AnyMaterial => "any material",
            Self::OwnSampler => "a .bsdf file that holds a sampler of its own",
        })
    }
}

/// A family of samplers: how one is built from a material and kept in a file.
///
/// The type that implements this is what is built. To add a method, implement it and [`Settings`], and name the type in the
/// list of `sampler/spec.rs`: commands, help, tables, files and checks follow from these.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
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

    /// Adds its tables to a file.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] if there is nothing to store.
    fn write(&self, _out: &mut TensorWriter) -> Result<()> {
        Err(Error::argument(
            format!("the sampler {} has no tables to store", Self::NAME),
            "choose another sampler",
        ))
    }

    /// Whether settings that were used may come from settings that were asked for: they are the same but for what was left
    /// open. A sampler file whose two records contradict each other is refused.
    fn agree(asked: &Self::Settings, used: &Self::Settings) -> bool {
        asked == used
    }

    /// Puts it together from the tables of a file, having checked all that drawing relies on. The settings are within their
    /// domains.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for a tensor that is missing or breaks an invariant.
    fn read(tensors: &Tensors, _settings: Self::Settings, _material: &Loaded) -> Result<Self> {
        Err(tensors.invalid("a sampler with tables", Self::NAME))
    }
}

/// The settings of a [`Method`].
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
pub trait Settings:
    Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync + 'static
{
    /// What they are the settings of.
    type Method: Method<Settings = Self>;

    /// All that can be set, in the order in which it is shown.
    fn fields() -> Vec<Field<Self>>;

    /// Settings that have a name.
    fn presets() -> Vec<Preset<Self>> {
        Vec::new()
    }

    /// What must hold between several settings, each of which is within its domain.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings that contradict each other.
    fn check_together(&self) -> Result<()> {
        Ok(())
    }

    /// Checks every domain, and what must hold between settings.
    ///
    /// # Errors
    /// [`Error::Argument`], naming the first setting that is outside its domain.
    fn check(&self) -> Result<()> {
        let mut copy = self.clone();
        for field in Self::fields() {
            let value = field.value(self);
            if !field.set(&mut copy, &value) {
                return Err(field.refused(Self::Method::NAME, &value));
            }
        }
        self.check_together()
    }

    /// Reads settings, separated by commas: a preset or nothing, then `key=value`, and words that need no key. What is not
    /// named is as in the preset, or as by default. Case does not matter.
    ///
    /// # Errors
    /// [`Error::Argument`] for a setting that does not exist, with the one most like it; for one outside its domain, with that
    /// domain; for one given twice; and for settings that contradict each other.
    fn parse_text(text: &str) -> Result<Self> {
        let name = Self::Method::NAME;
        let fields = Self::fields();
        let presets = Self::presets();
        let mut settings = Self::default();
        let mut given = Vec::new();
        for (place, item) in text.split(',').map(str::trim).enumerate() {
            if let Some(preset) = presets.iter().find(|p| p.name.eq_ignore_ascii_case(item)) {
                if place > 0 {
                    return Err(Error::argument(
                        format!(
                            "the preset {} of {name} follows other settings",
                            preset.name
                        ),
                        format!(
                            "write it first, and one preset only: {name}:{},…",
                            preset.name
                        ),
                    ));
                }
                settings = preset.settings.clone();
                continue;
            }
            let Some((field, value)) = find_field(&fields, item) else {
                return Err(unknown_setting(name, &fields, &presets, item));
            };
            if given.contains(&field.key()) {
                return Err(Error::argument(
                    format!("{} of {name} is given twice", field.key()),
                    "give it once",
                ));
            }
            given.push(field.key());
            if !field.set(&mut settings, value) {
                return Err(field.refused(name, value));
            }
        }
        settings.check_together()?;
        Ok(settings)
    }

    /// The shortest text that [`Self::parse_text`] reads as these settings; empty for the default, unless that is a preset.
    fn to_text(&self) -> String {
        let presets = Self::presets();
        if let Some(preset) = presets.iter().find(|p| p.settings == *self) {
            return preset.name.to_owned();
        }
        let fields = Self::fields();
        // Words needed from the default on, and from each preset on, whose name is one word more.
        let mut best = differing_words(&fields, &Self::default(), self);
        for preset in &presets {
            let mut words = differing_words(&fields, &preset.settings, self);
            words.insert(0, preset.name.to_owned());
            if words.len() < best.len() {
                best = words;
            }
        }
        best.join(",")
    }
}

/// What can be set in a method.
pub(super) fn list_fields<S: Settings>() -> Vec<SettingFacts> {
    let default = S::default();
    let fields = S::fields();
    fields.into_iter().map(|f| f.facts(&default)).collect()
}

/// All presets of a method.
pub(super) fn list_presets<S: Settings>() -> Vec<PresetFacts> {
    S::presets().into_iter().map(Preset::facts).collect()
}

/// The value of the setting called `key`, as text.
pub(super) fn value_text<S: Settings>(settings: &S, key: &str) -> Option<String> {
    let fields = S::fields();
    let field = fields.iter().find(|f| f.key() == key)?;
    Some(field.value(settings))
}
