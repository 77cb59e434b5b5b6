//! The samplers that are crossed with hard cases, in sizes from the least to the usual.

use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, Construction, HalfVectorSettings, LeafChoice,
    SamplerSpec,
};

/// A sampler of the crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HardSampler {
    /// Short name.
    pub name: &'static str,
    /// What it is built from.
    pub spec: SamplerSpec,
    /// Whether its density is promised to be that of its draws. The disc as published draws leaves by the integral of an
    /// image, which its density does not know of.
    pub exact: bool,
}

/// All samplers of the crossing.
pub fn hard_samplers() -> Vec<HardSampler> {
    let mut all = vec![HardSampler {
        name: "cosine",
        spec: SamplerSpec::Cosine,
        exact: true,
    }];
    all.extend(discs());
    all.extend(cascades());
    all.extend(half_vectors());
    all
}

fn discs() -> [HardSampler; 5] {
    let small = AdaptiveDiscSettings {
        tables: 3,
        ..Default::default()
    };
    let published = AdaptiveDiscSettings {
        tables: 3,
        construction: Construction::Grid(200),
        ..AdaptiveDiscSettings::as_published()
    };
    [
        ("disc", small, true),
        (
            "disc, rejection-free",
            AdaptiveDiscSettings {
                leaves: LeafChoice::Warp,
                ..small
            },
            true,
        ),
        (
            "disc, one shallow tree",
            AdaptiveDiscSettings {
                tables: 1,
                depth: 1,
                ..small
            },
            true,
        ),
        (
            "disc, rejection-free, no waste",
            AdaptiveDiscSettings {
                tables: 2,
                leaves: LeafChoice::Warp,
                waste: 0.0,
                depth: 7,
                ..small
            },
            true,
        ),
        ("disc as published", published, false),
    ]
    .map(|(name, s, exact)| HardSampler {
        name,
        spec: SamplerSpec::AdaptiveDisc(s),
        exact,
    })
}

fn cascades() -> [HardSampler; 7] {
    let small = CascadeCdfSettings {
        tables: 4,
        theta_h: 90,
        phi_h: 32,
        ..Default::default()
    };
    let published = CascadeCdfSettings {
        tables: 3,
        theta_h: 128,
        phi_h: 64,
        ..CascadeCdfSettings::as_published(true)
    };
    [
        ("cascade", small),
        (
            "cascade, whole",
            CascadeCdfSettings {
                tolerance: None,
                ..small
            },
        ),
        (
            "cascade, tolerance 0",
            CascadeCdfSettings {
                tolerance: Some(0.0),
                ..small
            },
        ),
        (
            "cascade, tolerance infinite",
            CascadeCdfSettings {
                tolerance: Some(f64::INFINITY),
                ..small
            },
        ),
        (
            "cascade, one cell",
            CascadeCdfSettings {
                tables: 1,
                theta_h: 1,
                phi_h: 1,
                ..small
            },
        ),
        (
            "cascade, floor only",
            CascadeCdfSettings {
                floor: 1.0,
                ..small
            },
        ),
        ("cascade as published", published),
    ]
    .map(|(name, s)| HardSampler {
        name,
        spec: SamplerSpec::CascadeCdf(s),
        exact: true,
    })
}

fn half_vectors() -> [HardSampler; 3] {
    let small = HalfVectorSettings {
        tables: 8,
        ..Default::default()
    };
    [
        ("half-vector", small),
        (
            "half-vector, folded",
            HalfVectorSettings {
                fold: true,
                ..small
            },
        ),
        (
            "half-vector, least",
            HalfVectorSettings {
                tables: 1,
                rows: 2,
                segments: 1,
                fold: true,
                ..small
            },
        ),
    ]
    .map(|(name, s)| HardSampler {
        name,
        spec: SamplerSpec::HalfVector(s),
        exact: true,
    })
}

/// Tables, trees or nodes of the angle of `wo` that a sampler holds.
pub(super) fn tables_of(spec: &SamplerSpec) -> usize {
    match spec {
        SamplerSpec::Cosine | SamplerSpec::Lobe(_) | SamplerSpec::File => 1,
        SamplerSpec::AdaptiveDisc(s) => s.tables,
        SamplerSpec::Factored(s) => s.tables,
        SamplerSpec::CascadeCdf(s) => s.tables,
        SamplerSpec::HalfVector(s) => s.tables,
        SamplerSpec::ByAzimuth(s) => s.table.tables,
    }
}
