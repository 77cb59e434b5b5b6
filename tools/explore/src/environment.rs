//! Environments as pictures, and the directions that ways of sampling them choose.

use std::sync::OnceLock;

use glam::{DVec2, DVec3, Vec3};
use merlkit::color::{Rgb, mean};
use merlkit::distribution::Reservoir;
use merlkit::light::{Environment, EnvironmentSource, Light, SkySampling};
use merlkit::points::PointSet;
use merlkit::{Brdf, DirectionSampler};
use rayon::prelude::*;
use serde_json::json;

use crate::affordable::parse_sampler;
use crate::answer::{Answer, ArrayAnswer};
use crate::query::{Query, shorten};
use crate::refusal::Refusal;
use crate::session::Session;

/// The environments that the page offers. They need no file.
pub(crate) const ENVIRONMENTS: [&str; 3] = ["studio", "lamps", "uniform"];
/// What environments are lit by where the BRDF chooses.
const SAMPLER: &str = "half-vector";
/// The most pixels of a row.
const MOST_COLUMNS: usize = 512;
/// The most directions of an answer.
const MOST_KEPT: usize = 100_000;
/// The most candidates for each of them.
const MOST_CANDIDATES: usize = 64;

/// Maps that were asked for.
static MAPS: [OnceLock<Environment>; ENVIRONMENTS.len()] =
    [const { OnceLock::new() }; ENVIRONMENTS.len()];

/// One of the offered environments; other names, paths among them, name none.
fn find_environment(name: &str) -> Result<&'static Environment, Refusal> {
    let Some(index) = ENVIRONMENTS.iter().position(|known| *known == name) else {
        return Err(Refusal::missing(format!(
            "there is no environment \"{}\"; choose {}",
            shorten(name),
            ENVIRONMENTS.join(", ")
        )));
    };
    if let Some(map) = MAPS[index].get() {
        return Ok(map);
    }
    let source = EnvironmentSource::from_name(ENVIRONMENTS[index])?;
    let map = source.load_map(SkySampling::Importance)?;
    Ok(MAPS[index].get_or_init(|| map))
}

/// Radiance by the map's latitude and longitude, the zenith on top.
pub(crate) fn environment(_: &Session, query: &Query) -> Result<Answer, Refusal> {
    let name = query.text("name");
    let map = find_environment(name)?;
    let columns = map.size()[0].clamp(2, MOST_COLUMNS);
    let rows = columns / 2;
    let mut radiance = Vec::with_capacity(3 * rows * columns);
    for row in 0..rows {
        for column in 0..columns {
            let pixel = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let point = pixel / DVec2::new(columns as f64, rows as f64);
            let value = map.radiance(Environment::map_direction(point));
            radiance.extend(value.to_array());
        }
    }
    let mut answer = ArrayAnswer::new(json!({ "name": name, "size": [columns, rows] }));
    answer.push_f32("radiance", &[rows, columns, 3], &radiance);
    Ok(answer.finish())
}

/// How directions are chosen.
#[derive(Clone, Copy)]
enum DrawStrategy {
    /// By the environment.
    FromLight,
    /// By the BRDF's sampler.
    FromBrdf,
    /// One of so many candidates of the sampler, in proportion to f·cosθ·L over their density.
    Resampled(usize),
}

impl DrawStrategy {
    fn parse(query: &Query) -> Result<Self, Refusal> {
        let candidates = query.count("candidates", 1..=MOST_CANDIDATES)?;
        match query.text("strategy") {
            "light" => Ok(Self::FromLight),
            "brdf" => Ok(Self::FromBrdf),
            "ris" => Ok(Self::Resampled(candidates)),
            other => Err(Refusal::bad(format!(
                "there is no strategy \"{}\"; choose light, brdf or ris",
                shorten(other)
            ))),
        }
    }
}

/// A direction in the surface's frame, its density, and the radiance that arrives from it.
#[derive(Clone, Copy)]
struct LitDirection {
    wi: Vec3,
    pdf: f32,
    radiance: Rgb,
}

/// A surface under the zenith, and what directions are drawn from.
struct LitSurface<'a> {
    map: &'a Environment,
    brdf: &'a dyn Brdf,
    sampler: &'a dyn DirectionSampler,
    wo: Vec3,
    seed: u64,
}

/// Directions that a strategy chooses on a surface whose normal is the zenith.
pub(crate) fn environment_draws(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (id, wo, seed) = (query.material()?, query.wo()?, query.seed()?);
    let strategy = DrawStrategy::parse(query)?;
    let keep = query.count("keep", 1..=MOST_KEPT)?;
    let map = find_environment(query.text("name"))?;
    let (_, loaded) = session.load(id)?;
    let sampler = session.build(id, &parse_sampler(SAMPLER)?)?;
    let surface = LitSurface {
        map,
        brdf: &**loaded.brdf(),
        sampler: sampler.as_dyn(),
        wo,
        seed,
    };
    let drawn: Vec<Option<LitDirection>> = (0..keep as u64)
        .into_par_iter()
        .map(|index| surface.draw(strategy, index))
        .collect();
    Ok(tabulate_directions(&drawn))
}

/// Draws as arrays; a failed draw is 0 in all of them.
fn tabulate_directions(drawn: &[Option<LitDirection>]) -> Answer {
    let count = drawn.len();
    let (mut uv, mut pdf) = (Vec::with_capacity(2 * count), Vec::with_capacity(count));
    let (mut radiance, mut wi) = (Vec::with_capacity(3 * count), Vec::with_capacity(3 * count));
    for draw in drawn {
        let Some(draw) = draw else {
            uv.extend([0.0; 2]);
            pdf.push(0.0);
            radiance.extend([0.0; 3]);
            wi.extend([0.0; 3]);
            continue;
        };
        let point = Environment::map_point(to_world(draw.wi));
        uv.extend([point.x as f32, point.y as f32]);
        pdf.push(draw.pdf);
        radiance.extend(draw.radiance.to_array());
        wi.extend(draw.wi.to_array());
    }
    let mut answer = ArrayAnswer::new(json!({ "sampler": SAMPLER }));
    answer.push_f32("uv", &[count, 2], &uv);
    answer.push_f32("pdf", &[count], &pdf);
    answer.push_f32("radiance", &[count, 3], &radiance);
    answer.push_f32("wi", &[count, 3], &wi);
    answer.finish()
}

/// From the surface's frame, whose z is the normal, to the world, whose zenith is +y.
fn to_world(local: Vec3) -> DVec3 {
    let local = local.as_dvec3();
    DVec3::new(local.x, local.z, -local.y).normalize()
}

/// The inverse of [`to_world`].
fn to_local(world: DVec3) -> Vec3 {
    DVec3::new(world.x, -world.z, world.y).as_vec3()
}

impl LitSurface<'_> {
    /// Draw number `index`; `None` for a failed one.
    fn draw(&self, strategy: DrawStrategy, index: u64) -> Option<LitDirection> {
        match strategy {
            DrawStrategy::FromLight => self.draw_from_light(index),
            DrawStrategy::FromBrdf => self.draw_from_brdf(index),
            DrawStrategy::Resampled(candidates) => self.resample(candidates, index),
        }
    }

    fn draw_from_light(&self, index: u64) -> Option<LitDirection> {
        let u = PointSet::Sobol.point(self.seed, index, 0).as_dvec2();
        let sample = self.map.sample(DVec3::ZERO, u)?;
        Some(LitDirection {
            wi: to_local(sample.wi),
            pdf: sample.pdf as f32,
            radiance: sample.radiance,
        })
    }

    fn draw_from_brdf(&self, index: u64) -> Option<LitDirection> {
        let u = PointSet::Sobol.point(self.seed, index, 0);
        let sample = self.sampler.sample(self.wo, u)?;
        Some(LitDirection {
            wi: sample.wi,
            pdf: sample.pdf,
            radiance: self.map.radiance(to_world(sample.wi)),
        })
    }

    /// Keeps one of `candidates` draws of the sampler (Talbot et al. 2005).
    fn resample(&self, candidates: usize, index: u64) -> Option<LitDirection> {
        let chance = PointSet::Random.point(self.seed, index, 1).x;
        let mut reservoir = Reservoir::new(f64::from(chance));
        for candidate in 0..candidates as u64 {
            let drawn = self.draw_from_brdf(index * candidates as u64 + candidate);
            // The weight of a candidate is its target t = f·cosθ·L, mean of the channels, over its density p.
            reservoir.offer(drawn.map(|d| (d, self.target(&d) / f64::from(d.pdf))));
        }
        let kept = reservoir.kept()?;
        // The kept direction counts as if its density were t/mean(t/p) = p·(t/p)/mean(t/p).
        let factor = kept.weight / kept.mean_weight;
        Some(LitDirection {
            pdf: (f64::from(kept.candidate.pdf) * factor) as f32,
            ..kept.candidate
        })
    }

    fn target(&self, direction: &LitDirection) -> f64 {
        let value = self.brdf.eval_cos(self.wo, direction.wi) * direction.radiance;
        f64::from(mean(value))
    }
}
