//! All figures of a sampler for a material, measured in one run.

use rayon::prelude::*;

use super::accuracy::{Bias, Draws, WeightSpread, bias, limit_directions, weight_spread};
use super::cost::{CallTimes, Seconds, call_times, time};
use merlkit::Result;
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, Symmetry, spherical};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::{SamplerSpec, store};

/// How much to measure.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ProfileSettings {
    /// Draws a bias is estimated from, at each angle.
    pub draws: usize,
    /// Calls timed, five times over.
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
            timed_calls: 100_000,
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

    /// Largest share of the albedo, over the angles, where the density is 0.
    pub fn worst_holes(&self) -> f64 {
        self.angles
            .iter()
            .map(|a| a.spread.holes)
            .fold(0.0, f64::max)
    }

    /// The bias that is farthest from 0 in standard errors.
    pub fn worst_bias(&self) -> Bias {
        let errors = |b: &Bias| b.relative.abs() / b.standard_error.max(f64::MIN_POSITIVE);
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
    /// What users should know of it, as [`Loaded::notes`].
    pub notes: Vec<String>,
    /// Which azimuths of `wo` represent all others.
    pub symmetry: Symmetry,
    /// Time to load the file, or to decode an embedded material.
    pub load: Seconds,
    /// Bytes of the loaded tables.
    pub material_bytes: usize,
    /// What was measured, and how much of it.
    pub settings: ProfileSettings,
    /// The samplers, in the order asked for.
    pub samplers: Vec<SamplerFigures>,
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
    let samplers = specs
        .iter()
        .map(|spec| {
            let figures = sampler_figures(material, &brdf, spec, settings);
            done();
            figures
        })
        .collect::<Result<_>>()?;
    Ok(MaterialFigures {
        material: material.name().into(),
        lookup: brdf.rule(),
        reading: brdf.reading(),
        notes: brdf.notes().to_vec(),
        symmetry: brdf.symmetry(),
        load,
        material_bytes: brdf.bytes(),
        settings: *settings,
        samplers,
    })
}

fn sampler_figures(
    material: &Material,
    brdf: &Loaded,
    spec: &SamplerSpec,
    settings: &ProfileSettings,
) -> Result<SamplerFigures> {
    let (sampler, build) = time(|| spec.build(brdf));
    let sampler = sampler?;
    let file_bytes = if spec.is_stored() {
        Some(store::encode(&sampler, material)?.len())
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
        calls: call_times(&*sampler, settings.timed_calls, settings.seed),
        angles: limit_directions(symmetry)
            .par_iter()
            .map(|&angles| angle_figures(&*sampler, &**brdf.brdf(), angles, settings))
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
