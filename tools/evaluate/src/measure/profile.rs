//! All figures of a sampler for a material, measured in one run.

use rayon::prelude::*;

use super::accuracy::{Bias, Draws, WeightSpread, bias, limit_directions, weight_spread};
use super::cost::{CallTimes, Seconds, call_times, time, unsteady_note};
use merlkit::Result;
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, Symmetry, spherical};
use merlkit::material::merl::RoundingError;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::{AdaptiveDisc, Sampler, SamplerSpec, store};

/// How much to measure.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ProfileSettings {
    /// Draws a bias is estimated from, at each angle.
    pub draws: usize,
    /// Calls of each batch that is timed.
    pub timed_calls: usize,
    /// Chooses the draws.
    pub seed: u64,
    /// Scalar whose weights are measured.
    pub importance: Importance,
}

impl Default for ProfileSettings {
    fn default() -> Self {
        Self {
            draws: 100_000,
            timed_calls: 20_000,
            seed: 1,
            importance: Importance::Mean,
        }
    }
}

/// Figures of one angle of `wo`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AngleFigures {
    /// Polar angle of `wo`, degrees.
    pub theta_o_deg: f64,
    /// Azimuth of `wo`, degrees in (−180, 180].
    pub phi_o_deg: f64,
    /// Spread of single weights, by quadrature.
    pub spread: WeightSpread,
    /// Deviation of the estimated albedo, by draws.
    pub bias: Bias,
}

/// What an adaptive disc's trees came to.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DiscFigures {
    /// Mean number of trials allowed in a leaf, as asked for.
    pub n_max: f64,
    /// Trials that a draw takes on average over the trees.
    pub mean_trials: f64,
    /// The largest part of ∫ f_r·cosθ, over the trees, that exceeds the bounds of leaves.
    pub largest_excess: f64,
}

/// Figures of one sampler.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SamplerFigures {
    /// Method and settings, as asked for.
    pub spec: SamplerSpec,
    /// The same with what was fitted to the material.
    pub fitted: SamplerSpec,
    /// Bytes its tables hold, counted.
    pub table_bytes: usize,
    /// Bytes of its file; `None` for a sampler that is not stored.
    pub file_bytes: Option<usize>,
    /// Time to build it from the loaded material.
    pub build: Seconds,
    /// Threads that built it.
    pub threads: usize,
    /// Time of single calls.
    pub calls: CallTimes,
    /// Figures at [`limit_directions`].
    pub angles: Vec<AngleFigures>,
    /// Of an adaptive disc, its trees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disc: Option<DiscFigures>,
}

impl SamplerFigures {
    /// Mean over the angles of the relative standard deviation of a weight.
    pub fn relstd(&self) -> f64 {
        self.angles.iter().map(|a| a.spread.relstd).sum::<f64>() / self.angles.len().max(1) as f64
    }

    /// Largest of the angles' relative standard deviations.
    pub fn worst_relstd(&self) -> f64 {
        self.angles
            .iter()
            .map(|a| a.spread.relstd)
            .fold(0.0, f64::max)
    }

    /// Largest fraction of the albedo, over the angles, where the density is 0.
    pub fn worst_holes(&self) -> f64 {
        self.angles
            .iter()
            .map(|a| a.spread.holes)
            .fold(0.0, f64::max)
    }

    /// The bias that is farthest from 0 in standard errors.
    pub fn worst_bias(&self) -> Bias {
        let errors = Bias::in_standard_errors;
        self.angles
            .iter()
            .map(|a| a.bias)
            .max_by(|a, b| errors(a).total_cmp(&errors(b)))
            .unwrap_or_default()
    }
}

/// Figures of a material and of samplers built for it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MaterialFigures {
    /// Short name.
    pub material: String,
    /// Lookup rule of everything measured; `None` for a material that is not a MERL table.
    pub lookup: Option<LookupRule>,
    /// How its values are come by, as [`Loaded::reading`].
    pub reading: String,
    /// Which azimuths of `wo` represent all others.
    pub symmetry: Symmetry,
    /// Time to load the file, or to decode an embedded material.
    pub load: Seconds,
    /// Bytes of the loaded tables.
    pub material_bytes: usize,
    /// How far the channels of a table in compact cells are from what was read, as [`merlkit::material::MerlTable::rounding_errors`].
    pub rounding_errors: Option<[RoundingError; 3]>,
    /// What was measured, and how much of it.
    pub settings: ProfileSettings,
    /// The samplers, in the order asked for.
    pub samplers: Vec<SamplerFigures>,
    /// What to know before trusting a figure: that of the material ([`Loaded::notes`]), and times that were unsteady.
    pub notes: Vec<String>,
}

/// Loads a material, builds each sampler and measures it. `done` is called after each sampler.
///
/// # Errors
/// Those of loading the material and of building the samplers.
pub fn profile(
    material: &Material,
    lookup: LookupRule,
    specs: &[SamplerSpec],
    settings: &ProfileSettings,
    done: &dyn Fn(),
) -> Result<MaterialFigures> {
    let (loaded, load) = time(|| material.load(lookup));
    let brdf = loaded?;
    let mut built: Vec<Sampler> = Vec::new();
    let mut samplers = Vec::new();
    for spec in specs {
        let (sampler, build) = time(|| spec.build(&brdf));
        let sampler = sampler?;
        samplers.push(sampler_figures(material, &brdf, &sampler, build, settings)?);
        built.push(sampler);
        done();
    }
    // All are timed in turn, so that a slow minute of the machine meets all of them alike.
    let drawing: Vec<&dyn DirectionSampler> = built.iter().map(Sampler::as_dyn).collect();
    let times = call_times(&drawing, settings.timed_calls, settings.seed);
    for (figures, calls) in samplers.iter_mut().zip(times) {
        figures.calls = calls;
    }
    let mut named = Vec::new();
    for (sampler, figures) in built.iter().zip(&samplers) {
        named.push((sampler.spec().to_string(), figures.calls));
    }
    let each_time = named
        .iter()
        .flat_map(|(name, c)| [(name.as_str(), c.sample_ns), (name.as_str(), c.pdf_ns)]);
    let mut notes = brdf.notes().to_vec();
    notes.extend(unsteady_note(each_time));
    Ok(MaterialFigures {
        material: material.name().into(),
        lookup: brdf.rule(),
        reading: brdf.reading(),
        symmetry: brdf.symmetry(),
        load,
        material_bytes: brdf.bytes(),
        rounding_errors: brdf.table().and_then(|m| m.table().rounding_errors()),
        settings: *settings,
        samplers,
        notes,
    })
}

/// All figures but the times of calls.
fn sampler_figures(
    material: &Material,
    brdf: &Loaded,
    sampler: &Sampler,
    build: Seconds,
    settings: &ProfileSettings,
) -> Result<SamplerFigures> {
    let file_bytes = if sampler.spec().is_stored() {
        Some(store::encode(sampler, material)?.len())
    } else {
        None
    };
    let symmetry = brdf.symmetry();
    Ok(SamplerFigures {
        spec: sampler.spec().clone(),
        fitted: sampler.fitted(),
        table_bytes: sampler.bytes(),
        file_bytes,
        build,
        threads: rayon::current_num_threads(),
        calls: CallTimes::default(),
        disc: sampler.downcast::<AdaptiveDisc>().map(|disc| DiscFigures {
            n_max: disc.settings().n_max,
            mean_trials: disc.mean_trials(),
            largest_excess: disc.largest_excess(),
        }),
        angles: limit_directions(symmetry)
            .par_iter()
            .map(|&angles| angle_figures(&**sampler, &**brdf.brdf(), angles, settings))
            .collect(),
    })
}

fn angle_figures(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    [theta_o_deg, phi_o_deg]: [f64; 2],
    settings: &ProfileSettings,
) -> AngleFigures {
    let wo = spherical(theta_o_deg.to_radians(), phi_o_deg.to_radians()).as_vec3();
    let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
    let draws = Draws {
        count: settings.draws,
        seed: settings.seed,
    };
    AngleFigures {
        theta_o_deg,
        phi_o_deg,
        spread: weight_spread(sampler, brdf, &quadrature, settings.importance),
        bias: bias(sampler, brdf, &quadrature, settings.importance, draws),
    }
}
