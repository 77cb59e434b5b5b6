//! Pictures against closed forms, against quadrature, and against each other.

mod agreement;
mod closed_forms;
mod plans;
mod regions;

use glam::{DVec2, DVec3, Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::distribution::Heuristic;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::image::{Image, write_exr, write_png};
use merlkit::light::{
    Area, Directional, EnvironmentSource, Light, LightSpec, Point, SkySampling, studio,
};
use merlkit::material::merl::{Header, MerlTable, decode_embedded};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Camera, Effect, EffectPlan, Film, PlanRequest, Ray, RenderSettings, Rendered, Scene,
    SceneSpec, Sphere, SphereSpec, Strategy, Surface, render,
};
use merlkit::sampler::Cosine;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const MIS: Strategy = Strategy::Mis(Heuristic::Power);

const STRATEGIES: [Strategy; 3] = [MIS, Strategy::Light, Strategy::Brdf];

fn lambert(rho: f64) -> Arc<dyn Brdf> {
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| [rho / PI; 3]);
    Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor))
}

fn embedded(name: &str) -> Arc<dyn Brdf> {
    Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded(name).unwrap()),
        LookupRule::Floor,
    ))
}

/// A row of spheres of these materials, named by their position.
pub fn row(count: usize, lights: Vec<LightSpec>, strategy: Strategy) -> SceneSpec {
    let names: Vec<String> = (0..count).map(|i| i.to_string()).collect();
    SceneSpec {
        lights,
        strategy,
        ..SceneSpec::row(&names, 1.0)
    }
}

fn build(spec: &SceneSpec, request: PlanRequest, brdfs: &[Arc<dyn Brdf>]) -> Scene {
    Scene::build(spec, request, |i, directions| {
        let sampler = directions.then(|| Arc::new(Cosine) as Arc<dyn DirectionSampler>);
        Ok(Surface {
            brdf: brdfs[i].clone(),
            sampler,
        })
    })
    .unwrap()
}

fn film(
    spec: &SceneSpec,
    request: PlanRequest,
    brdfs: &[Arc<dyn Brdf>],
    side: usize,
    samples: u64,
) -> Film {
    // Random points: their standard errors are right.
    let settings = RenderSettings {
        width: side,
        height: side,
        seed: 7,
        points: PointSet::Random,
        budget: Budget::Even(samples),
    };
    let scene = build(spec, request, brdfs);
    render(&scene, &settings, &|_| {}).unwrap().film
}

fn planned(spec: &SceneSpec, brdfs: &[Arc<dyn Brdf>], side: usize, samples: u64) -> Film {
    film(spec, PlanRequest::AsNeeded, brdfs, side, samples)
}

fn uniform(radiance: f32) -> LightSpec {
    LightSpec::Environment(EnvironmentSource::Uniform(Rgb::splat(radiance)))
}

type Render = fn(&Scene, &RenderSettings, &(dyn Fn(usize) + Sync)) -> merlkit::Result<Rendered>;

/// Large, so that directions from the BRDF hit it often enough for their errors to be known.
fn lamp() -> LightSpec {
    let (corner, edge_u, edge_v) = (
        DVec3::new(-4.0, 4.5, -2.0),
        DVec3::X * 8.0,
        DVec3::new(0.0, -1.5, 7.0),
    );
    LightSpec::Area(Area {
        corner,
        edge_u,
        edge_v,
        radiance: Rgb::new(2.0, 1.5, 1.0),
    })
}

/// Mean over a pixel of `value(ray)`, on a grid; `None` unless every ray meets the sphere.
fn over_pixel(
    spec: &SceneSpec,
    side: usize,
    x: usize,
    y: usize,
    value: impl Fn(&Ray, DVec3, DVec3) -> DVec3,
) -> Option<DVec3> {
    const GRID: usize = 32;
    let ball = spec.spheres[0].shape;
    let mut sum = DVec3::ZERO;
    for i in 0..GRID * GRID {
        let within = (DVec2::new((i % GRID) as f64, (i / GRID) as f64) + 0.5) / GRID as f64;
        let ray = spec
            .camera
            .ray((DVec2::new(x as f64, y as f64) + within) / side as f64, 1.0);
        let at = ray.point_at(ball.enter(&ray)?);
        sum += value(&ray, at, (at - ball.centre) / ball.radius);
    }
    Some(sum / (GRID * GRID) as f64)
}

/// A camera that sees one point of the first sphere, and the direction from there to the eye.
fn look_at_point(spec: &mut SceneSpec, normal: DVec3) -> (DVec3, DVec3) {
    let ball = spec.spheres[0].shape;
    let at = ball.centre + normal * ball.radius;
    let wo = (normal + DVec3::new(0.3, 0.1, 0.4)).normalize();
    spec.camera = Camera {
        eye: at + wo * 5.0,
        target: at,
        vertical_angle: 1e-5,
    };
    (at, wo)
}

fn assert_pixel(film: &Film, expected: DVec3, rounding: f64, what: &str) {
    let (mean, error) = (film.mean(0, 0), film.standard_error(0, 0));
    let slack = 4.0 * error + rounding * expected;
    assert!(
        (mean - expected).abs().cmple(slack).all(),
        "{what}: {mean} ± {error} for {expected}"
    );
    assert!(
        error.x < 0.05 * expected.x,
        "{what}: {mean} ± {error} says nothing"
    );
}
