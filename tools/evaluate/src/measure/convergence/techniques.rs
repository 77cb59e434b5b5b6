//! Ways to estimate what a lit point reflects, and what they cost.

use glam::{DVec3, Vec3};

use super::{Incident, LitPoint, Runs};
use merlkit::Wo;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::distribution::Heuristic;
use merlkit::light::{Environment, Light};
use merlkit::{Error, Result};

/// How directions are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Technique {
    /// N directions from the sampler.
    Brdf,
    /// N directions from the environment.
    Light,
    /// N directions in all: ⌈N/2⌉ from the sampler and ⌊N/2⌋ from the environment, weighted by their numbers and densities
    /// (Veach and Guibas 1995). One sample is the sampler's.
    Mis(Heuristic),
    /// N directions, each kept of so many from the sampler, in proportion to the integrand (Talbot et al. 2005).
    ///
    /// Nothing hides the light here, so the target function is the integrand itself, whichever candidate is kept gives the
    /// same estimate, and it is that of [`Self::Brdf`] with all N·M candidates: resampling saves rays that are traced for
    /// visibility, and a point has none.
    Ris(u32),
}

impl Technique {
    /// Its name for people.
    pub fn name(self) -> String {
        match self {
            Self::Brdf => "BRDF".into(),
            Self::Light => "light".into(),
            Self::Mis(Heuristic::Balance) => "MIS (balance)".into(),
            Self::Mis(Heuristic::Power) => "MIS (power)".into(),
            Self::Ris(candidates) => format!("RIS ({candidates} candidates)"),
        }
    }

    /// How often the integrand, the BRDF times the light, is evaluated for `samples` samples.
    pub fn evaluations(self, samples: usize) -> usize {
        match self {
            Self::Brdf | Self::Light | Self::Mis(_) => samples,
            Self::Ris(candidates) => samples.saturating_mul(candidates as usize),
        }
    }

    /// # Errors
    /// [`Error::Argument`] for light from a function, which can't be sampled, or for no candidates.
    pub(super) fn check(self, light: Incident<'_>) -> Result<()> {
        match (self, light) {
            (Self::Light | Self::Mis(_), Incident::Function(_)) => Err(Error::argument(
                "light that is a function can't be sampled",
                "give an environment, or choose a technique that draws from the BRDF only",
            )),
            (Self::Ris(0), _) => Err(Error::argument(
                "no candidates to resample",
                "give at least 1",
            )),
            _ => Ok(()),
        }
    }
}

/// An integrand at a direction, over the density that chose it, and what the other technique's density is to it.
#[derive(Clone, Copy)]
struct Draw {
    weight: f64,
    pdf: f64,
    other: f64,
}

const NOTHING: Draw = Draw {
    weight: 0.0,
    pdf: 1.0,
    other: 0.0,
};

/// The draws of one seed, as many as its largest estimate asks for.
pub(super) struct TechniqueDraws {
    technique: Technique,
    brdf: Vec<Draw>,
    light: Vec<Draw>,
}

impl TechniqueDraws {
    pub(super) fn new(
        point: &LitPoint<'_>,
        sampler: &dyn DirectionSampler,
        technique: Technique,
        most: usize,
        runs: Runs,
        seed: u64,
    ) -> Self {
        let (brdf, light) = match technique {
            Technique::Brdf | Technique::Ris(_) => (technique.evaluations(most), 0),
            Technique::Light => (0, most),
            Technique::Mis(_) => (most.div_ceil(2), most / 2),
        };
        let sky = match point.light {
            Incident::Environment(sky) => Some(sky),
            Incident::Function(_) => None,
        };
        // What the other technique's density is, is asked for only where it counts.
        let both = matches!(technique, Technique::Mis(_));
        let mut draws = Self {
            technique,
            brdf: Vec::new(),
            light: Vec::new(),
        };
        draws.brdf = from_brdf(point, sampler, sky.filter(|_| both), brdf, runs, seed);
        if let Some(sky) = sky {
            draws.light = from_light(point, sky, both.then_some(sampler), light, runs, seed);
        }
        draws
    }

    /// The estimate from the first `samples` samples; 0 for none.
    pub(super) fn estimate(&self, samples: usize) -> f64 {
        match self.technique {
            Technique::Brdf | Technique::Ris(_) => {
                mean(&self.brdf[..self.technique.evaluations(samples)])
            }
            Technique::Light => mean(&self.light[..samples]),
            Technique::Mis(heuristic) => {
                let (brdf, light) = (
                    &self.brdf[..samples.div_ceil(2)],
                    &self.light[..samples / 2],
                );
                shared(heuristic, brdf, light.len()) + shared(heuristic, light, brdf.len())
            }
        }
    }
}

fn mean(draws: &[Draw]) -> f64 {
    draws.iter().map(|d| d.weight).sum::<f64>() / draws.len().max(1) as f64
}

/// One technique's part of the integral, with `others` draws of the other.
fn shared(heuristic: Heuristic, draws: &[Draw], others: usize) -> f64 {
    let own = draws.len() as f64;
    let others = others as f64;
    let share = |d: &Draw| d.weight * heuristic.weight(own * d.pdf, others * d.other);
    draws.iter().map(share).sum::<f64>() / own.max(1.0)
}

fn from_brdf(
    point: &LitPoint<'_>,
    sampler: &dyn DirectionSampler,
    other: Option<&Environment>,
    count: usize,
    runs: Runs,
    seed: u64,
) -> Vec<Draw> {
    let points: Vec<_> = (0..count as u64)
        .map(|i| runs.points.point(seed, i, 0))
        .collect();
    let draw = |wi: Vec3, pdf: f32| {
        let pdf = f64::from(pdf);
        let other = other.map_or(0.0, |sky| sky.pdf(to_world(wi)));
        Draw {
            weight: point.integrand(wi) / pdf,
            pdf,
            other,
        }
    };
    let mut drawn = vec![None; count];
    sampler.sample_batch(Wo::One(point.wo), &points, &mut drawn);
    drawn
        .into_iter()
        .map(|d| d.map_or(NOTHING, |d| draw(d.wi, d.pdf)))
        .collect()
}

fn from_light(
    point: &LitPoint<'_>,
    sky: &Environment,
    other: Option<&dyn DirectionSampler>,
    count: usize,
    runs: Runs,
    seed: u64,
) -> Vec<Draw> {
    let draw = |i: usize| {
        // The second pair of dimensions: independent of the sampler's points.
        let u = runs.points.point(seed, i as u64, 1).as_dvec2();
        let Some(chosen) = sky.sample(DVec3::ZERO, u) else {
            return NOTHING;
        };
        let wi = to_local(chosen.wi);
        let weight = point.reflected(wi, chosen.radiance) / chosen.pdf;
        let other = other
            .filter(|_| weight > 0.0)
            .map_or(0.0, |s| f64::from(s.pdf(point.wo, wi)));
        Draw {
            weight,
            pdf: chosen.pdf,
            other,
        }
    };
    (0..count).map(draw).collect()
}

/// From the surface's frame, `z` its normal, to the environment's, `y` up: the surface lies flat, its `x` is the world's, and
/// its `y` points at the middle of the map.
pub(super) fn to_world(w: Vec3) -> DVec3 {
    let w = w.as_dvec3();
    DVec3::new(w.x, w.z, -w.y)
}

fn to_local(w: DVec3) -> Vec3 {
    DVec3::new(w.x, -w.z, w.y).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_turn_and_turn_back() {
        for w in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.36, -0.48, 0.8)] {
            assert_eq!(to_local(to_world(w)), w);
        }
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(to_world);
        assert_eq!((x.cross(y), z), (z, DVec3::Y));
    }
}
