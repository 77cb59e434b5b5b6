//! Where on an environment a strategy draws directions: by the light, by the BRDF, or by resampling candidates of the BRDF.
//!
//! The surface lies level: its normal is +y, its x axis is +x, and its y axis is −z, the middle of the map.

use glam::{DVec2, DVec3, Vec3};
use merlkit::Brdf;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::{Environment, Light};
use merlkit::points::PointSet;

/// How directions are chosen.
#[derive(Clone, Copy)]
pub enum SkyStrategy<'a> {
    /// In proportion to the environment's luminance.
    Light,
    /// By a sampler of the BRDF.
    Brdf(SurfaceView<'a>),
    /// As many candidates from the sampler, of which some are kept in proportion to f·cosθ·L over their density.
    Ris(SurfaceView<'a>, usize),
}

/// A surface as it is seen from one direction.
#[derive(Clone, Copy)]
pub struct SurfaceView<'a> {
    /// What it reflects.
    pub brdf: &'a dyn Brdf,
    /// What draws directions.
    pub sampler: &'a dyn DirectionSampler,
    /// Towards the viewer, in the surface's frame.
    pub wo: Vec3,
}

/// Directions that were drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkyDraws {
    /// Unit vectors in world space.
    pub directions: Vec<DVec3>,
    /// Draws that gave none.
    pub failed: usize,
}

/// Draws `count` directions from random points of `seed`.
pub fn sky_draws(
    environment: &Environment,
    strategy: SkyStrategy<'_>,
    count: usize,
    seed: u64,
) -> SkyDraws {
    match strategy {
        SkyStrategy::Light => draw_by_light(environment, count, seed),
        SkyStrategy::Brdf(view) => {
            let (drawn, failed) = draw_by_brdf(view, count, seed);
            SkyDraws {
                directions: drawn.iter().map(|(wi, _)| to_world(*wi)).collect(),
                failed,
            }
        }
        SkyStrategy::Ris(view, candidates) => {
            resample(environment, view, [count, candidates], seed)
        }
    }
}

/// Places of directions on the map, as fractions of its width and its height from the upper left corner.
pub fn map_places(directions: &[DVec3]) -> Vec<(f64, f64)> {
    let mut places = Vec::with_capacity(directions.len());
    for direction in directions {
        // Half a turn, the middle of the map, is −z. A quarter more is +x.
        let turns = direction.x.atan2(-direction.z) / std::f64::consts::TAU;
        let polar = direction.x.hypot(direction.z).atan2(direction.y);
        places.push((turns + 0.5, polar / std::f64::consts::PI));
    }
    places
}

/// A direction of the surface's frame in world space.
pub fn to_world(w: Vec3) -> DVec3 {
    let w = w.as_dvec3();
    DVec3::new(w.x, w.z, -w.y)
}

fn draw_by_light(environment: &Environment, count: usize, seed: u64) -> SkyDraws {
    let mut draws = SkyDraws::default();
    for index in 0..count as u64 {
        let u: glam::Vec2 = PointSet::Random.point(seed, index, 0);
        let u = DVec2::new(f64::from(u.x), f64::from(u.y));
        match environment.sample(DVec3::ZERO, u) {
            Some(sample) => draws.directions.push(sample.wi),
            None => draws.failed += 1,
        }
    }
    draws
}

/// Directions with their densities, and how many draws failed.
fn draw_by_brdf(view: SurfaceView<'_>, count: usize, seed: u64) -> (Vec<(Vec3, f32)>, usize) {
    let mut drawn = Vec::with_capacity(count);
    for index in 0..count as u64 {
        let u = PointSet::Random.point(seed, index, 0);
        if let Some(sample) = view.sampler.sample(view.wo, u) {
            drawn.push((sample.wi, sample.pdf));
        }
    }
    let failed = count - drawn.len();
    (drawn, failed)
}

/// Keeps `count` of `candidates` directions, with replacement: candidate i with the probability w_i/Σw, where w = f·cosθ·L/p.
fn resample(
    environment: &Environment,
    view: SurfaceView<'_>,
    [count, candidates]: [usize; 2],
    seed: u64,
) -> SkyDraws {
    let (drawn, failed) = draw_by_brdf(view, candidates, seed);
    // Running sums of the weights: mean channel of f·cosθ·L over the density.
    let mut sums = Vec::with_capacity(drawn.len());
    let mut total = 0.0;
    for (wi, pdf) in &drawn {
        let reflected = view.brdf.eval_cos(view.wo, *wi);
        let light = environment.radiance(to_world(*wi));
        let weight = f64::from((reflected * light).element_sum()) / 3.0 / f64::from(*pdf);
        if weight.is_finite() && weight > 0.0 {
            total += weight;
        }
        sums.push(total);
    }
    let mut draws = SkyDraws {
        directions: Vec::new(),
        failed,
    };
    if total <= 0.0 {
        return draws;
    }
    // The candidates took dimension 0; the choice among them takes the next.
    for index in 0..count as u64 {
        let chance: glam::Vec2 = PointSet::Random.point(seed, index, 1);
        let sought = f64::from(chance.x) * total;
        let place = sums.partition_point(|sum| *sum <= sought);
        let (wi, _) = drawn[place.min(drawn.len() - 1)];
        draws.directions.push(to_world(wi));
    }
    draws
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::color::Rgb;
    use merlkit::light::SkySampling;
    use merlkit::material::analytic::ModelFacts;
    use merlkit::sampler::Cosine;

    /// A dim sky with one bright pixel above the horizon.
    fn spotted() -> Environment {
        let mut pixels = vec![Rgb::splat(0.01); 32 * 16];
        pixels[32 * 4 + 20] = Rgb::splat(1000.0);
        Environment::new(32, 16, pixels, SkySampling::Importance).unwrap()
    }

    /// The part of the draws within the bright pixel and its neighbours, over which the map is interpolated.
    fn part_at_spot(draws: &SkyDraws) -> f64 {
        let mut hits = 0;
        for (x, y) in map_places(&draws.directions) {
            let near = (x * 32.0 - 20.5).abs() <= 1.5 && (y * 16.0 - 4.5).abs() <= 1.5;
            hits += usize::from(near);
        }
        hits as f64 / draws.directions.len() as f64
    }

    #[test]
    fn light_and_resampling_find_the_spot_that_the_brdf_does_not_know() {
        let environment = spotted();
        let grey = ModelFacts::brdf("lambert:reflectance=0.5").unwrap();
        let view = SurfaceView {
            brdf: &*grey,
            sampler: &Cosine,
            wo: Vec3::Z,
        };
        let light = sky_draws(&environment, SkyStrategy::Light, 1000, 1);
        assert!(part_at_spot(&light) > 0.95, "{}", part_at_spot(&light));
        let brdf = sky_draws(&environment, SkyStrategy::Brdf(view), 1000, 1);
        assert!(part_at_spot(&brdf) < 0.1);
        assert!(brdf.directions.iter().all(|d| d.y > 0.0));
        let ris = sky_draws(&environment, SkyStrategy::Ris(view, 20_000), 1000, 1);
        assert_eq!(ris.directions.len(), 1000);
        assert!(part_at_spot(&ris) > 0.95, "{}", part_at_spot(&ris));
    }

    #[test]
    fn places_are_those_of_the_map() {
        let middle = map_places(&[to_world(Vec3::new(0.0, 1.0, 0.0))])[0];
        assert!((middle.0 - 0.5).abs() < 1e-12 && (middle.1 - 0.5).abs() < 1e-12);
        let right = map_places(&[DVec3::X])[0];
        assert!((right.0 - 0.75).abs() < 1e-12);
        assert!(map_places(&[to_world(Vec3::Z)])[0].1.abs() < 1e-12);
    }
}
