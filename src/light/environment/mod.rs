//! Light from all around: an equirectangular map.

mod broad_lamps;
mod equirectangular;
mod map;
mod map_file;
mod notes;
mod repair;
mod sampling;
mod sky_table;
mod source;
mod studio;

pub use broad_lamps::broad_lamps;
pub use map::{Environment, SkySampling};
pub use notes::MapNotes;
pub use repair::RadianceClamp;
pub use source::EnvironmentSource;
pub use studio::studio;
