//! Which sampler, with which settings: `half-vector:64KB`, as users write it and files record it; and what is built from it.

use std::any::Any;
use std::fmt;
use std::ops::Deref;
use std::str::FromStr;
use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::method::{Method, Needs, Settings, list_fields, list_presets, value_text};
use super::settings::{PresetFacts, SettingFacts, most_alike};
use super::store::{TensorWriter, Tensors};
use super::{AdaptiveDisc, CascadeCdf, Cosine, Factored, HalfVector, Lobe, OwnSampler};
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::error::list_words;
use crate::material::merl::LookupRule;
use crate::material::{Loaded, MaterialFacts};
use crate::{Error, Result};

/// The list of methods, each as its default settings.
macro_rules! methods {
    ($($method:ty),+ $(,)?) => {
        &[$(|| SamplerSpec::new(<$method as Method>::Settings::default())),+]
    };
}

/// All methods that have a name, the default first: what commands offer and files may hold.
const METHODS: &[fn() -> SamplerSpec] = methods![
    HalfVector,
    AdaptiveDisc,
    CascadeCdf,
    Lobe,
    Factored,
    Cosine,
    OwnSampler,
];

/// A method and its settings.
///
/// Its text, `NAME` or `NAME:SETTING,SETTING…`, is what users write, the label of tables and plots, and its form in
/// JSON; [`Settings::parse_text`] says how settings are read. It prints as the shortest text that is read as the same.
///
/// # Examples
/// ```
/// use merlkit::sampler::{HalfVectorSettings, Needs};
/// use merlkit::{LookupRule, Material, SamplerSpec};
///
/// let spec: SamplerSpec = "half-vector:2KB".parse()?;
/// assert_eq!(spec.to_string(), "half-vector:2KB");
/// assert_eq!(spec.name(), "half-vector");
/// assert!(spec.settings::<HalfVectorSettings>().is_some());
/// for setting in spec.setting_facts() {
///     println!("{}: {}, {} by default", setting.key, setting.meaning, setting.default);
/// }
///
/// // What a method needs is known before anything is loaded or built.
/// let own: SamplerSpec = "file".parse()?;
/// let material = Material::resolve("lambert:reflectance=0.5")?;
/// assert_eq!(own.needs(), Needs::OwnSampler);
/// assert!(own.check_supports(&material.facts()?).is_err());
///
/// let sampler = spec.build(&material.load(LookupRule::Floor)?)?;
/// println!("tables of {} bytes", sampler.as_dyn().bytes());
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone)]
pub struct SamplerSpec(Arc<dyn AnySettings>);

impl SamplerSpec {
    /// The method that these are the settings of, with these settings.
    pub fn new(settings: impl Settings) -> Self {
        Self(Arc::new(settings))
    }

    /// Every method, each with its default settings.
    pub fn methods() -> Vec<Self> {
        METHODS.iter().map(|default| default()).collect()
    }

    /// Reads several texts.
    ///
    /// # Errors
    /// [`Error::Argument`] for the first that is no sampler.
    pub fn parse_all(texts: &[&str]) -> Result<Vec<Self>> {
        texts.iter().map(|text| text.parse()).collect()
    }

    /// The method's name.
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    /// What the method is, in one sentence without a full stop.
    pub fn summary(&self) -> &'static str {
        self.0.summary()
    }

    /// What the method asks of a material.
    pub fn needs(&self) -> Needs {
        self.0.needs()
    }

    /// Whether it has tables that a file can hold.
    pub fn is_stored(&self) -> bool {
        self.0.is_stored()
    }

    /// The settings, if they are of this type.
    pub fn settings<S: Settings>(&self) -> Option<&S> {
        let settings: &dyn Any = &*self.0;
        settings.downcast_ref()
    }

    /// The value of the setting called `key`, as text; `None` if the method has no such setting.
    pub fn setting(&self, key: &str) -> Option<String> {
        self.0.value_text(key)
    }

    /// What can be set.
    pub fn setting_facts(&self) -> Vec<SettingFacts> {
        self.0.list_fields()
    }

    /// Settings of the method that have a name.
    pub fn preset_facts(&self) -> Vec<PresetFacts> {
        self.0.list_presets()
    }

    /// Whether the method can be used for a material, and with these settings.
    ///
    /// # Errors
    /// [`Error::Argument`] if not, with what the method needs and which the material can have.
    pub fn check_supports(&self, facts: &MaterialFacts) -> Result<()> {
        if self.needs().are_met_by(facts) {
            return self.0.check_facts(facts);
        }
        let methods = Self::methods();
        let mut others = Vec::new();
        for method in &methods {
            if method.needs().are_met_by(facts) {
                others.push(method.name());
            }
        }
        Err(Error::argument(
            format!(
                "the sampler {} needs {}, and this material is not one",
                self.name(),
                self.needs()
            ),
            format!("choose {}", list_words(&others)),
        ))
    }

    /// Builds the sampler on the threads of the current pool. The result does not depend on their number.
    ///
    /// # Errors
    /// As [`Self::check_supports`]; [`Error::Argument`] for settings outside their domains.
    pub fn build(&self, material: &Loaded) -> Result<Sampler> {
        self.check_supports(&material.facts())?;
        self.0.check_settings()?;
        let built = self.0.build(material)?;
        Ok(Sampler::new(self.clone(), built, material))
    }

    /// The settings as JSON, for a file's record.
    pub(super) fn to_json(&self) -> Result<serde_json::Value> {
        self.0.to_json()
    }

    /// Puts the sampler together from a file whose record has `settings` for this method.
    pub(super) fn read(
        &self,
        tensors: &Tensors,
        settings: &serde_json::Value,
        material: &Loaded,
    ) -> Result<Sampler> {
        let built = self.0.read(tensors, settings, material)?;
        Ok(Sampler::new(self.clone(), built, material))
    }
}

impl fmt::Display for SamplerSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.0.to_text();
        if text.is_empty() {
            return f.pad(self.name());
        }
        f.pad(&format!("{}:{text}", self.name()))
    }
}

impl fmt::Debug for SamplerSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SamplerSpec({self})")
    }
}

impl PartialEq for SamplerSpec {
    fn eq(&self, other: &Self) -> bool {
        self.0.equals(&*other.0)
    }
}

impl FromStr for SamplerSpec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (name, settings) = match text.split_once(':') {
            Some((name, settings)) => (name.trim(), Some(settings)),
            None => (text.trim(), None),
        };
        let methods = Self::methods();
        let Some(method) = methods.iter().find(|m| m.name().eq_ignore_ascii_case(name)) else {
            return Err(unknown_method(name, &methods));
        };
        match settings {
            Some(settings) => method.0.parse_text(settings),
            None => Ok(method.clone()),
        }
    }
}

impl Serialize for SamplerSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for SamplerSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// Names that samplers had before they had settings, and what is written today.
const FORMER_NAMES: [(&str, &str); 7] = [
    ("cosine-lobe", "lobe:cosine"),
    ("cosine-lobe-sphere", "lobe:cosine-sphere"),
    ("blinn", "lobe:blinn"),
    ("ward", "lobe:ward"),
    ("ashikhmin-shirley", "lobe:ashikhmin-shirley"),
    ("ggx", "lobe:ggx"),
    ("disc-rejection", "adaptive-disc:rejection"),
];

/// The error for a name that no method has.
fn unknown_method(name: &str, methods: &[SamplerSpec]) -> Error {
    let what = format!("no sampler is called \"{name}\"");
    let former = FORMER_NAMES.iter().find(|f| f.0.eq_ignore_ascii_case(name));
    if let Some((_, today)) = former {
        return Error::argument(what, format!("it is written {today} today"));
    }
    let names: Vec<&str> = methods.iter().map(SamplerSpec::name).collect();
    let fix = match most_alike(name, &names) {
        Some(word) => format!("did you mean {word}? `merlkit samplers` lists all"),
        None => format!("choose {}", list_words(&names)),
    };
    Error::argument(what, fix)
}

/// [`Settings`] of any method.
trait AnySettings: Any + Send + Sync {
    fn name(&self) -> &'static str;
    fn summary(&self) -> &'static str;
    fn needs(&self) -> Needs;
    fn is_stored(&self) -> bool;
    fn to_text(&self) -> String;
    fn parse_text(&self, text: &str) -> Result<SamplerSpec>;
    fn equals(&self, other: &dyn AnySettings) -> bool;
    fn value_text(&self, key: &str) -> Option<String>;
    fn list_fields(&self) -> Vec<SettingFacts>;
    fn list_presets(&self) -> Vec<PresetFacts>;
    fn check_settings(&self) -> Result<()>;
    fn check_facts(&self, facts: &MaterialFacts) -> Result<()>;
    fn build(&self, material: &Loaded) -> Result<Arc<dyn AnyMethod>>;
    fn to_json(&self) -> Result<serde_json::Value>;
    /// As [`Method::read`], with the settings of the record in place of these.
    fn read(
        &self,
        tensors: &Tensors,
        settings: &serde_json::Value,
        material: &Loaded,
    ) -> Result<Arc<dyn AnyMethod>>;
}

impl<S: Settings> AnySettings for S {
    fn name(&self) -> &'static str {
        S::Method::NAME
    }

    fn summary(&self) -> &'static str {
        S::Method::SUMMARY
    }

    fn needs(&self) -> Needs {
        S::Method::NEEDS
    }

    fn is_stored(&self) -> bool {
        S::Method::IS_STORED
    }

    fn to_text(&self) -> String {
        Settings::to_text(self)
    }

    fn parse_text(&self, text: &str) -> Result<SamplerSpec> {
        <S as Settings>::parse_text(text).map(SamplerSpec::new)
    }

    fn equals(&self, other: &dyn AnySettings) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<S>() == Some(self)
    }

    fn value_text(&self, key: &str) -> Option<String> {
        value_text(self, key)
    }

    fn list_fields(&self) -> Vec<SettingFacts> {
        list_fields::<S>()
    }

    fn list_presets(&self) -> Vec<PresetFacts> {
        list_presets::<S>()
    }

    fn check_settings(&self) -> Result<()> {
        self.check()
    }

    fn check_facts(&self, facts: &MaterialFacts) -> Result<()> {
        S::Method::check_facts(self, facts)
    }

    fn build(&self, material: &Loaded) -> Result<Arc<dyn AnyMethod>> {
        let built = <S::Method as Method>::build(material, self)?;
        Ok(Arc::new(built))
    }

    fn to_json(&self) -> Result<serde_json::Value> {
        serde_json::to_value(self).map_err(|e| Error::argument(e.to_string(), "report this"))
    }

    fn read(
        &self,
        tensors: &Tensors,
        settings: &serde_json::Value,
        material: &Loaded,
    ) -> Result<Arc<dyn AnyMethod>> {
        let settings = S::deserialize(settings)
            .map_err(|e| tensors.invalid("settings of a merlkit sampler", e.to_string()))?;
        settings
            .check()
            .map_err(|e| tensors.invalid("settings within their domains", e.to_string()))?;
        let read = <S::Method as Method>::read(tensors, settings, material)?;
        if !<S::Method as Method>::agree(self, &read.settings()) {
            let expected = format!("the settings of {}", SamplerSpec::new(self.clone()));
            let found = SamplerSpec::new(read.settings()).to_string();
            return Err(tensors.invalid(expected, found));
        }
        Ok(Arc::new(read))
    }
}

/// A [`Method`] of any kind, built.
trait AnyMethod: Any + Send + Sync {
    fn fitted(&self) -> SamplerSpec;
    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler>;
    fn write(&self, out: &mut TensorWriter) -> Result<()>;
}

impl<M: Method> AnyMethod for M {
    fn fitted(&self) -> SamplerSpec {
        SamplerSpec::new(Method::settings(self))
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        Method::sampler(self)
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        Method::write(self, out)
    }
}

/// A sampler of any method, built for a material. It dereferences to the [`DirectionSampler`] that draws.
///
/// The example of [`DirectionSampler`](crate::direction_sampler::DirectionSampler) draws a direction and weights it.
#[derive(Clone)]
pub struct Sampler {
    spec: SamplerSpec,
    rule: Option<LookupRule>,
    built: Arc<dyn AnyMethod>,
    drawing: Arc<dyn DirectionSampler>,
}

impl Sampler {
    fn new(spec: SamplerSpec, built: Arc<dyn AnyMethod>, material: &Loaded) -> Self {
        Self {
            spec,
            rule: material.rule(),
            drawing: built.clone().sampler(),
            built,
        }
    }

    /// What was asked for.
    pub fn spec(&self) -> &SamplerSpec {
        &self.spec
    }

    /// The same with what was fitted to the material. Building this gives the same sampler again.
    pub fn fitted(&self) -> SamplerSpec {
        self.built.fitted()
    }

    /// The lookup rule of the material it was built for; `None` if that has no table.
    pub fn rule(&self) -> Option<LookupRule> {
        self.rule
    }

    /// What draws the directions.
    pub fn as_dyn(&self) -> &dyn DirectionSampler {
        &*self.drawing
    }

    /// What draws the directions, to be kept.
    pub fn shared(&self) -> Arc<dyn DirectionSampler> {
        self.drawing.clone()
    }

    /// [`DirectionSampler::draw_stratified`].
    pub fn draw_stratified(
        &self,
        wo: Vec3,
        count: usize,
        seed: u64,
    ) -> Vec<Option<DirectionSample>> {
        self.drawing.draw_stratified(wo, count, seed)
    }

    /// What was built, if it is of this type.
    pub fn downcast<M: Method>(&self) -> Option<&M> {
        let built: &dyn Any = &*self.built;
        built.downcast_ref()
    }

    /// Adds its tables to a file.
    pub(super) fn write(&self, out: &mut TensorWriter) -> Result<()> {
        self.built.write(out)
    }
}

impl Deref for Sampler {
    type Target = dyn DirectionSampler;

    fn deref(&self) -> &Self::Target {
        &*self.drawing
    }
}

impl fmt::Debug for Sampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Sampler({})", self.spec)
    }
}
