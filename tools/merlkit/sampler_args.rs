//! Which samplers a command builds.

use merlkit::Error;
use merlkit::material::Material;
use merlkit::sampler::SamplerSpec;

/// What `--sampler` is followed by.
pub const VALUE: &str = "NAME[:SETTING,…]";

/// The sampler of a command that is not told which.
pub const DEFAULT: &str = "half-vector:64KB";

/// The samplers of a command that compares those it is not told, as far as a material supports them.
pub const COMPARED: [&str; 8] = [
    "half-vector:2KB",
    DEFAULT,
    "half-vector:1MB",
    "cosine",
    "adaptive-disc",
    "cascade-cdf:uniform",
    "cascade-cdf",
    "file",
];

/// The samplers given, all of which `material` must support; or those of [`COMPARED`] that it supports.
///
/// # Errors
/// [`Error::Argument`] for a sampler that the material can't have; those of reading its kind.
pub fn samplers_for(material: &Material, given: &[SamplerSpec]) -> Result<Vec<SamplerSpec>, Error> {
    let facts = material.facts()?;
    if !given.is_empty() {
        given.iter().try_for_each(|s| s.check_supports(&facts))?;
        return Ok(given.to_vec());
    }
    let mut all = SamplerSpec::parse_all(&COMPARED)?;
    all.retain(|s| s.check_supports(&facts).is_ok());
    Ok(all)
}
