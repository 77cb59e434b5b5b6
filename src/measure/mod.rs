//! Figures about a material or a method: computed here, worded by [`crate::report`].

mod albedo;
mod facts;

pub use albedo::{AlbedoEstimate, albedo_by_degree, directional_albedo, directional_albedo_with_error};
pub use facts::{Albedo, AlbedoAboveOne, Asymmetry, Facts, TableFacts, facts, table_facts};
