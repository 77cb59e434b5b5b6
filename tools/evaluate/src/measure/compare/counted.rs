//! What a sample and a sampler cost, counted by a fixed model instead of a clock.
//!
//! A clock never says the same twice, so a verdict that rests on it turns from run to run where samplers are near equals.
//! The model's figures are nanoseconds and are the same on every machine and in every run: medians over materials of
//! [`crate::measure::cost::costs`] in a release build on one core of an AMD EPYC (2026), rounded. They are right to some
//! 25 %, which is why contenders within [`super::TIE`] count as equal. docs/compare.md has the table.

use serde::{Deserialize, Serialize};

use super::{Competitor, Curve};
use crate::measure::convergence::Technique;
use crate::measure::cost::unsteady_note;
use merlkit::material::{Loaded, LookupRule};
use merlkit::sampler::{AdaptiveDiscSettings, CascadeCdfSettings, LeafChoice, SamplerSpec};

/// A counted cost, on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CountedCost {
    /// Nanoseconds of one sample of an estimate: numbers, draw, density, BRDF and light.
    pub sample_ns: f64,
    /// Seconds to build the tables.
    pub build_seconds: f64,
}

/// Two numbers of a Sobol point and the radiance of an environment: every sample needs them.
const POINT_AND_LIGHT: f64 = 170.0;
/// A direction from the environment's tables, with its density and radiance.
const LIGHT_DRAW: f64 = 370.0;
/// The environment's density of a direction from elsewhere.
const LIGHT_DENSITY: f64 = 100.0;
/// Building an environment's tables, for each of their bytes.
const LIGHT_BUILD: f64 = 2.0;
/// One value of f: a table's bin, or eight of them, a file's interpolation, or a formula.
fn value_ns(material: &Loaded) -> f64 {
    match material.rule() {
        Some(LookupRule::Floor) => 40.0,
        Some(LookupRule::Linear | LookupRule::Centred) => 90.0,
        None if material.own_sampler().is_some() => 200.0,
        None => 10.0,
    }
}

/// What a sampler costs beside the values of f that its estimates take.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SamplerCost {
    /// Nanoseconds of a draw with its density.
    draw_ns: f64,
    /// Values of f that building evaluates.
    build_values: f64,
    /// Seconds that building takes besides.
    build_seconds: f64,
}

impl SamplerCost {
    const fn new(draw_ns: f64, build_values: f64, build_seconds: f64) -> Self {
        Self {
            draw_ns,
            build_values,
            build_seconds,
        }
    }

    /// A sampler that the model does not know costs as much as the dearest that anyone would choose.
    const UNKNOWN: Self = Self::new(1000.0, 1e7, 0.1);

    /// The cost of a sampler whose tables have `table_bytes`.
    fn find(spec: &SamplerSpec, table_bytes: usize) -> Self {
        match spec.name() {
            "cosine" => Self::new(40.0, 0.0, 0.0),
            "half-vector" => {
                // The search for the rows evaluates f whatever the size is; the cells do in proportion.
                let values = 4e5 + 5.0 * table_bytes as f64;
                let draw_ns = if table_bytes > CACHE { 90.0 } else { 70.0 };
                Self::new(draw_ns, values, 0.0)
            }
            "lobe" => Self::new(150.0, 2e5, 0.05),
            "cascade-cdf" => {
                let settings = spec.settings::<CascadeCdfSettings>();
                let whole = settings.is_some_and(|s| s.tolerance.is_none());
                Self::new(if whole { 280.0 } else { 380.0 }, 1e7, 0.0)
            }
            "adaptive-disc" => Self::disc(spec),
            "factored" => Self::new(800.0, 5e7, 0.0),
            "file" => Self::new(850.0, 0.0, 0.0),
            _ => Self::UNKNOWN,
        }
    }

    /// The adaptive disc: trials in the leaves, one hierarchical warp, or trials on the whole disc, which are more the higher
    /// the material's peak is.
    fn disc(spec: &SamplerSpec) -> Self {
        let draw_ns = match spec.settings::<AdaptiveDiscSettings>() {
            Some(s) if s.depth == 0 => 8000.0,
            Some(s) if s.leaves == LeafChoice::Warp => 800.0,
            _ => 600.0,
        };
        Self::new(draw_ns, 8e6, 0.0)
    }
}

/// Bytes beyond which a table no longer stays in the caches near the core.
const CACHE: usize = 128_000;

/// What `competitor` costs for `material`, whose sampler has tables of `sampler_bytes` and whose light, where it is sampled,
/// tables of `light_bytes`.
///
/// A sample is a point, a direction with its density, a value of f and the light. Multiple importance sampling takes every
/// other sample from the light, and asks for the density of the technique that did not draw, which costs as much as half a
/// draw of the sampler.
pub fn counted_cost(
    competitor: &Competitor,
    material: &Loaded,
    sampler_bytes: usize,
    light_bytes: usize,
) -> CountedCost {
    let cost = SamplerCost::find(&competitor.spec, sampler_bytes);
    let draw = cost.draw_ns;
    let f = value_ns(material);
    let build = cost.build_values * f * 1e-9 + cost.build_seconds;
    let light_build = light_bytes as f64 * LIGHT_BUILD * 1e-9;
    let from_brdf = POINT_AND_LIGHT + f + draw;
    let from_light = f + LIGHT_DRAW;
    match competitor.technique {
        Technique::Brdf => CountedCost {
            sample_ns: from_brdf,
            build_seconds: build,
        },
        Technique::Light => CountedCost {
            sample_ns: from_light,
            build_seconds: light_build,
        },
        Technique::Mis(_) => CountedCost {
            sample_ns: 0.5 * (from_brdf + LIGHT_DENSITY + from_light + 0.5 * draw),
            build_seconds: build + light_build,
        },
        Technique::Ris(candidates) => CountedCost {
            sample_ns: from_brdf * f64::from(candidates),
            build_seconds: build,
        },
    }
}

/// Measured times are held to disagree with the counted ones beyond this factor.
const DISAGREE: f64 = 2.0;

/// What to know before trusting the times of some contenders: repeats that differ, and measured times whose ratio to the
/// median of all is far from the counted one.
///
/// A machine may be quicker or slower than the model's as a whole; what counts is how its samplers compare.
pub fn cost_notes(curves: &[&Curve]) -> Vec<String> {
    let times = curves.iter().map(|c| (c.label.as_str(), c.ns_per_sample));
    let mut notes: Vec<String> = unsteady_note(times).into_iter().collect();
    // The median of measured over counted is this machine's speed, by which each one's is divided.
    let mut ratios: Vec<f64> = curves.iter().map(|c| measured_over_counted(c)).collect();
    ratios.retain(|r| r.is_finite() && *r > 0.0);
    ratios.sort_by(f64::total_cmp);
    let Some(&speed) = ratios.get(ratios.len() / 2) else {
        return notes;
    };
    let mut names: Vec<String> = Vec::new();
    for curve in curves {
        let factor = measured_over_counted(curve) / speed;
        if factor.is_finite() && !(1.0 / DISAGREE..=DISAGREE).contains(&factor) {
            names.push(format!("{} ({factor:.1}×)", curve.label));
        }
    }
    if !names.is_empty() {
        notes.push(format!(
            "measured times differ from counted ones by more than a factor of {DISAGREE}, relative to the other samplers: {}",
            names.join(", ")
        ));
    }
    notes
}

fn measured_over_counted(curve: &Curve) -> f64 {
    curve.ns_per_sample.ns / curve.counted.sample_ns
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A method that is added to the library gets a figure of its own here.
    #[test]
    fn every_sampler_is_known_to_the_model() {
        for spec in SamplerSpec::methods() {
            assert_ne!(SamplerCost::find(&spec, 0), SamplerCost::UNKNOWN, "{spec}");
        }
    }
}
