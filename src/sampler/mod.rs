//! Choosing `wi` for a given `wo`, each method with the density of what it chooses.
//!
//! A method is a folder: its tables, its settings, how it is built and how it is kept in a file. [`SamplerSpec`] names one
//! with its settings, as text, and builds it.

mod adaptive_disc;
mod azimuth_knots;
mod cascade_cdf;
mod cosine;
mod direction_knots;
mod draws;
mod factored;
mod half_vector_table;
mod knots;
mod lobe;
mod method;
mod own_sampler;
mod settings;
mod spec;
pub mod store;

pub use adaptive_disc::{
    AdaptiveDisc, AdaptiveDiscSettings, Carry, Cell, Construction, LeafChoice, Subdivision,
};
pub use cascade_cdf::{CascadeCdf, CascadeCdfSettings, CdfCurve, ThetaSpacing};
pub use cosine::{Cosine, CosineSettings};
pub use factored::{Factored, FactoredSettings, Factors};
pub use half_vector_table::{ByAzimuth, HalfVector, HalfVectorSettings, HalfVectorTable};
pub(crate) use half_vector_table::{NODE_UNIT, ROW_UNIT, Stored};
pub use knots::TableChoice;
pub use lobe::{LEAST_DIFFUSE, Lobe, LobeKind, LobeParameters, LobeSettings};
pub use method::{Method, Needs, Settings};
pub use own_sampler::{OwnSampler, OwnSamplerSettings};
pub use settings::{Field, Preset, PresetFacts, SettingFacts};
pub use spec::{Sampler, SamplerSpec};
