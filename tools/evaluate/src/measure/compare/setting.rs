//! Each sampler's own settings against bytes, seconds and error.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::candidates::supported;
use super::point::{PointPlan, error_at};
use crate::measure::accuracy::{LIMIT_ANGLES_DEG, weight_spread};
use crate::measure::cost::{CallCost, call_times, time};
use merlkit::Result;
use merlkit::brdf::Importance;
use merlkit::geometry::{Quadrature, spherical};
use merlkit::light::Environment;
use merlkit::material::{Loaded, LookupRule, MaterialFacts, MerlBrdf};
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, HalfVectorSettings, LeafChoice, SamplerSpec,
};

/// One setting of one sampler.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knob {
    /// What is turned.
    pub name: String,
    /// To what.
    pub value: String,
    /// The sampler that comes of it.
    pub spec: SamplerSpec,
    /// How the table that it samples is read; without a meaning to other materials.
    pub lookup: LookupRule,
}

/// What a setting costs and gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The setting.
    pub knob: Knob,
    /// Bytes of the sampler's tables.
    pub table_bytes: usize,
    /// Wall-clock seconds that building took, on all threads.
    pub build_seconds: f64,
    /// CPU time of a draw with its density. Settings are timed one after the other, so compare them with the intervals in
    /// mind.
    pub sample_ns: CallCost,
    /// Relative standard deviation of the weight of one draw, by quadrature: mean over [`LIMIT_ANGLES_DEG`].
    pub relstd: f64,
    /// Relative RMSE of the lit point from [`RMSE_SAMPLES`] Sobol samples.
    pub rmse: f64,
}

/// Samples of [`Setting::rmse`].
pub const RMSE_SAMPLES: usize = 256;

/// Every setting that is tried for a material, as far as it supports them; lookup rules of tables alone.
pub fn knobs(quick: bool, lookup: LookupRule, facts: &MaterialFacts) -> Vec<Knob> {
    let mut all = half_vector_knobs(lookup);
    all.extend(disc_knobs(lookup));
    all.extend(cascade_knobs(lookup));
    all.retain(|knob| supported(&knob.spec, &[*facts]));
    if quick {
        // Every third still shows the shape of the front.
        return all.into_iter().step_by(3).collect();
    }
    if facts.has_table {
        all.extend(lookup_knobs());
    }
    all
}

fn lookup_knobs() -> [Knob; 3] {
    LookupRule::ALL.map(|rule| {
        let spec = SamplerSpec::new(HalfVectorSettings::default());
        Knob {
            name: "lookup rule".into(),
            value: rule.name().into(),
            spec,
            lookup: rule,
        }
    })
}

fn half_vector_knobs(lookup: LookupRule) -> Vec<Knob> {
    let knob = |(size, settings): (&str, HalfVectorSettings)| Knob {
        name: "half-vector: table size".into(),
        value: size.into(),
        spec: SamplerSpec::new(settings),
        lookup,
    };
    HalfVectorSettings::PRESETS.map(knob).to_vec()
}

fn disc_knobs(lookup: LookupRule) -> Vec<Knob> {
    let d = AdaptiveDiscSettings::default();
    let knob = |name: &str, value: String, s: AdaptiveDiscSettings| Knob {
        name: format!("adaptive disc: {name}"),
        value,
        spec: SamplerSpec::new(s),
        lookup,
    };
    let mut all: Vec<Knob> = [1.3, 1.5, 2.0, 2.5, 3.0]
        .map(|n_max| {
            knob(
                "n_max",
                n_max.to_string(),
                AdaptiveDiscSettings { n_max, ..d },
            )
        })
        .to_vec();
    all.extend([5, 10, 20, 40, 60].map(|tables| {
        knob(
            "trees",
            tables.to_string(),
            AdaptiveDiscSettings { tables, ..d },
        )
    }));
    all.extend([10, 20, 40].map(|tables| {
        let settings = AdaptiveDiscSettings {
            tables,
            leaves: LeafChoice::Warp,
            ..d
        };
        knob("rejection-free trees", tables.to_string(), settings)
    }));
    all
}

fn cascade_knobs(lookup: LookupRule) -> Vec<Knob> {
    let d = CascadeCdfSettings::default();
    let knob = |name: &str, value: String, s: CascadeCdfSettings| Knob {
        name: format!("cascade CDF: {name}"),
        value,
        spec: SamplerSpec::new(s),
        lookup,
    };
    let whole = [(64, 16), (128, 32), (256, 32), (512, 64), (1024, 128)].map(|(theta_h, phi_h)| {
        let settings = CascadeCdfSettings {
            theta_h,
            phi_h,
            tolerance: None,
            ..d
        };
        knob("resolution, whole", format!("{theta_h}×{phi_h}"), settings)
    });
    let compressed = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2].map(|tolerance| {
        knob(
            "tolerance",
            tolerance.to_string(),
            CascadeCdfSettings {
                tolerance: Some(tolerance),
                ..d
            },
        )
    });
    let tables = [8, 32].map(|tables| {
        knob(
            "tables",
            tables.to_string(),
            CascadeCdfSettings { tables, ..d },
        )
    });
    whole.into_iter().chain(compressed).chain(tables).collect()
}

/// Points a bin of the spread's quadrature.
const SPREAD_POINTS: usize = 233;
/// Calls of each batch that is timed.
const TIMED: usize = 4000;

/// Measures a setting for a material under a sky; a table is read by the setting's own lookup rule.
///
/// # Errors
/// Those of building the sampler.
pub fn setting(
    material: &Loaded,
    sky: &Environment,
    knob: Knob,
    plan: &PointPlan,
) -> Result<Setting> {
    let material = match material.table() {
        Some(measured) => {
            let read = MerlBrdf::new(measured.table().clone(), knob.lookup);
            Loaded::from_table(Arc::new(read)).named(material.name())
        }
        None => material.clone(),
    };
    let brdf = &**material.brdf();
    let (sampler, seconds) = time(|| knob.spec.build(&material));
    let sampler = sampler?;
    let spread = |degrees: f64| {
        let wo = spherical(degrees.to_radians(), 0.4).as_vec3();
        weight_spread(
            &*sampler,
            brdf,
            &Quadrature::new(wo, SPREAD_POINTS),
            Importance::Mean,
        )
        .relstd
    };
    Ok(Setting {
        table_bytes: sampler.bytes(),
        build_seconds: seconds.wall,
        sample_ns: call_times(&[&*sampler], TIMED, 1)
            .first()
            .map_or_else(CallCost::default, |t| t.sample_ns),
        relstd: LIMIT_ANGLES_DEG.map(spread).iter().sum::<f64>() / LIMIT_ANGLES_DEG.len() as f64,
        rmse: error_at(&*sampler, brdf, sky, RMSE_SAMPLES, plan),
        knob,
    })
}
