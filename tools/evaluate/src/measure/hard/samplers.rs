//! The samplers that are crossed with hard cases, in sizes from the least to the usual.

use merlkit::Result;
use merlkit::sampler::SamplerSpec;

/// A sampler of the crossing.
#[derive(Clone, Debug, PartialEq)]
pub struct HardSampler {
    /// Short name.
    pub name: &'static str,
    /// What it is built from.
    pub spec: SamplerSpec,
    /// Whether its density is promised to be that of its draws. The disc as published draws leaves by the integral of an
    /// image, which its density does not know of.
    pub exact: bool,
}

/// Names and texts of the samplers of the crossing.
const CROSSED: [(&str, &str); 16] = [
    ("cosine", "cosine"),
    ("disc", "adaptive-disc:tables=3"),
    (
        "disc, rejection-free",
        "adaptive-disc:tables=3,rejection-free",
    ),
    ("disc, one shallow tree", "adaptive-disc:tables=1,depth=1"),
    (
        "disc, rejection-free, no waste",
        "adaptive-disc:tables=2,rejection-free,waste=0,depth=7",
    ),
    (INEXACT, "adaptive-disc:published,tables=3,grid=200"),
    ("cascade", "cascade-cdf:tables=4,cells=90x32"),
    (
        "cascade, whole",
        "cascade-cdf:tables=4,cells=90x32,tolerance=none",
    ),
    (
        "cascade, tolerance 0",
        "cascade-cdf:tables=4,cells=90x32,tolerance=0",
    ),
    (
        "cascade, tolerance infinite",
        "cascade-cdf:tables=4,cells=90x32,tolerance=inf",
    ),
    ("cascade, one cell", "cascade-cdf:tables=1,cells=1x1"),
    (
        "cascade, floor only",
        "cascade-cdf:tables=4,cells=90x32,floor=1",
    ),
    (
        "cascade as published",
        "cascade-cdf:published,tables=3,cells=128x64",
    ),
    ("half-vector", "half-vector:tables=8"),
    ("half-vector, folded", "half-vector:tables=8,folded"),
    (
        "half-vector, least",
        "half-vector:tables=1,rows=2,segments=1,folded",
    ),
];

/// The one whose density is not that of its draws.
const INEXACT: &str = "disc as published";

/// All samplers of the crossing.
///
/// # Errors
/// As [`SamplerSpec::parse_all`].
pub fn hard_samplers() -> Result<Vec<HardSampler>> {
    CROSSED.into_iter().map(parse_sampler).collect()
}

/// Names and texts of the samplers that formulas are crossed with.
const CROSSED_WITH_MODELS: [(&str, &str); 4] = [
    ("disc", "adaptive-disc:tables=3"),
    ("half-vector", "half-vector:tables=8"),
    (
        "disc, rejection-free",
        "adaptive-disc:tables=3,rejection-free",
    ),
    ("cascade", "cascade-cdf:tables=4,cells=90x32"),
];

/// The samplers that formulas are crossed with.
///
/// # Errors
/// As [`SamplerSpec::parse_all`].
pub(super) fn hard_model_samplers() -> Result<Vec<HardSampler>> {
    CROSSED_WITH_MODELS.into_iter().map(parse_sampler).collect()
}

fn parse_sampler((name, text): (&'static str, &str)) -> Result<HardSampler> {
    Ok(HardSampler {
        name,
        spec: text.parse()?,
        exact: name != INEXACT,
    })
}

/// Tables, trees or nodes of the directions of `wo` that a sampler holds, by the settings that it was built with.
pub(super) fn count_tables(spec: &SamplerSpec) -> usize {
    let mut count = 1;
    for key in ["tables", "azimuths"] {
        let value = spec.setting(key).and_then(|text| text.parse().ok());
        count *= value.unwrap_or(1);
    }
    count
}
