//! Pictures against closed forms, against quadrature, and against each other.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

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
fn row(count: usize, lights: Vec<LightSpec>, strategy: Strategy) -> SceneSpec {
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

/// f_r·cosθᵢ of world directions, in a frame worked out here.
fn reflect(brdf: &dyn Brdf, normal: DVec3, wo: DVec3, wi: DVec3) -> DVec3 {
    let helper = if normal.x.abs() < 0.5 {
        DVec3::X
    } else {
        DVec3::Z
    };
    let x = normal.cross(helper).normalize();
    let y = normal.cross(x);
    let local = |w: DVec3| DVec3::new(w.dot(x), w.dot(y), w.dot(normal)).as_vec3();
    brdf.eval(local(wo), local(wi)).as_dvec3() * wi.dot(normal).max(0.0)
}

fn assert_pixels_match(
    spec: &SceneSpec,
    brdf: &Arc<dyn Brdf>,
    expected: impl Fn(&Ray, DVec3, DVec3) -> DVec3,
) {
    let side = 16;
    let film = planned(spec, std::slice::from_ref(brdf), side, 2048);
    let mut compared = 0;
    for (x, y) in (0..side * side).map(|i| (i % side, i / side)) {
        let Some(value) = over_pixel(spec, side, x, y, &expected) else {
            continue;
        };
        let slack = 4.5 * film.standard_error(x, y) + 2e-3 * value + 1e-6;
        let off = (film.mean(x, y) - value).abs();
        assert!(
            off.cmple(slack).all(),
            "({x}, {y}): {} for {value}",
            film.mean(x, y)
        );
        compared += usize::from(value.x > 0.01);
    }
    assert!(compared > 12, "{compared} lit pixels compared");
}

#[test]
fn a_lambert_sphere_in_uniform_light_shows_its_albedo() {
    for strategy in STRATEGIES {
        let spec = row(1, vec![uniform(1.0)], strategy);
        let film = planned(&spec, &[lambert(0.6)], 16, 1024);
        let mut compared = 0;
        for (x, y) in (0..256).map(|i| (i % 16, i / 16)) {
            let (mean, error) = (film.mean(x, y).x, film.standard_error(x, y).x);
            if over_pixel(&spec, 16, x, y, |_, _, _| DVec3::ZERO).is_some() {
                assert!(
                    (mean - 0.6).abs() < 4.5 * error + 1e-6,
                    "{strategy:?} ({x}, {y}): {mean} ± {error}"
                );
                compared += 1;
            }
        }
        assert!(compared > 60);
        assert_eq!(film.mean(0, 0), DVec3::ONE);
    }
}

#[test]
fn a_white_sphere_on_a_white_floor_in_uniform_light_is_invisible() {
    let spec = SceneSpec {
        floor: Some(1.0),
        depth: 200,
        ..row(1, vec![uniform(1.0)], MIS)
    };
    let film = planned(&spec, &[lambert(1.0)], 12, 512);
    let mut sum = 0.0;
    for (x, y) in (0..144).map(|i| (i % 12, i / 12)) {
        let z = (film.mean(x, y).x - 1.0) / film.standard_error(x, y).x.max(1e-9);
        assert!(
            z.abs() < 4.5,
            "({x}, {y}): {} is {z} standard errors from 1",
            film.mean(x, y).x
        );
        sum += film.mean(x, y).x / 144.0;
    }
    assert!((sum - 1.0).abs() < 5e-3, "{sum}");
}

#[test]
fn a_point_light_follows_the_closed_form() {
    let light = Point {
        position: DVec3::new(-2.0, 4.0, 3.0),
        intensity: Rgb::new(20.0, 40.0, 60.0),
    };
    let spec = row(1, vec![LightSpec::Point(light)], MIS);
    for brdf in [lambert(0.5), embedded("blue-metallic-paint")] {
        assert_pixels_match(&spec, &brdf, |ray, at, normal| {
            let to = light.position - at;
            let irradiance = light.intensity.as_dvec3() / to.length_squared();
            reflect(brdf.as_ref(), normal, -ray.direction, to.normalize()) * irradiance
        });
    }
}

#[test]
fn parallel_light_follows_the_closed_form() {
    let light = Directional {
        towards: DVec3::new(0.5, 1.0, 1.5),
        irradiance: Rgb::new(1.0, 2.0, 3.0),
    };
    let spec = row(1, vec![LightSpec::Directional(light)], MIS);
    for brdf in [lambert(0.5), embedded("blue-metallic-paint")] {
        assert_pixels_match(&spec, &brdf, |ray, _, normal| {
            let wi = light.towards.normalize();
            reflect(brdf.as_ref(), normal, -ray.direction, wi) * light.irradiance.as_dvec3()
        });
    }
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

#[test]
fn an_area_light_agrees_with_quadrature() {
    let light = Area {
        corner: DVec3::new(-1.5, 3.0, 1.0),
        edge_u: DVec3::new(0.0, 0.0, 1.5),
        edge_v: DVec3::new(-1.0, 0.5, 0.0),
        radiance: Rgb::new(10.0, 5.0, 2.0),
    };
    let facing = light.edge_u.cross(light.edge_v);
    let light = if facing.y < 0.0 {
        light
    } else {
        Area {
            edge_u: light.edge_v,
            edge_v: light.edge_u,
            ..light
        }
    };
    for strategy in STRATEGIES {
        let mut spec = row(1, vec![LightSpec::Area(light)], strategy);
        let normal = DVec3::new(-0.3, 0.9, 0.2).normalize();
        let (at, wo) = look_at_point(&mut spec, normal);
        let brdf = lambert(0.7);
        let (n, mut sum) = (200, DVec3::ZERO);
        for i in 0..n * n {
            let (u, v) = (f64::from(i % n) + 0.5, f64::from(i / n) + 0.5);
            let to = light.corner + (u * light.edge_u + v * light.edge_v) / f64::from(n) - at;
            let area = -light.edge_u.cross(light.edge_v).dot(to.normalize()) / f64::from(n * n);
            sum += reflect(brdf.as_ref(), normal, wo, to.normalize()) * area / to.length_squared();
        }
        let expected = sum * light.radiance.as_dvec3();
        assert_pixel(
            &planned(&spec, &[brdf], 1, 1 << 16),
            expected,
            1e-4,
            &format!("{strategy:?}"),
        );
    }
}

#[test]
fn an_environment_on_a_metal_agrees_with_quadrature() {
    let (sky, nickel) = (studio(SkySampling::Uniform), embedded("nickel"));
    let studio = || vec![LightSpec::Environment(EnvironmentSource::Studio)];
    for normal in [
        DVec3::new(-0.4, 0.6, 0.7),
        DVec3::new(0.5, 0.1, 0.8),
        DVec3::new(0.0, -0.6, 0.7),
    ] {
        let normal = normal.normalize();
        let mut spec = row(1, studio(), MIS);
        let (_, wo) = look_at_point(&mut spec, normal);
        let (rows, mut expected) = (1200, DVec3::ZERO);
        for i in 0..rows {
            let theta = (f64::from(i) + 0.5) / f64::from(rows) * PI;
            let cell = theta.sin() * (PI / f64::from(rows)).powi(2);
            for j in 0..2 * rows {
                let w = spherical(theta, (f64::from(j) + 0.5) / f64::from(2 * rows) * TAU);
                let reflected = reflect(nickel.as_ref(), normal, wo, w);
                expected += reflected * sky.radiance(w).as_dvec3() * cell;
            }
        }
        let film = planned(&spec, std::slice::from_ref(&nickel), 1, 1 << 20);
        assert_pixel(&film, expected, 3e-3, &format!("normal {normal}"));
    }
}

/// Compares two films block by block, in standard errors of the difference.
fn assert_same_within_noise(a: &Film, b: &Film, what: &str) {
    const BLOCK: usize = 4;
    let (mut squares, mut blocks) = (0.0, 0.0);
    let (columns, rows) = (a.width() / BLOCK, a.height() / BLOCK);
    for block in 0..columns * rows {
        let (mut difference, mut variance, mut total) = (0.0, 0.0, 0.0);
        for i in 0..BLOCK * BLOCK {
            let (x, y) = (
                block % columns * BLOCK + i % BLOCK,
                block / columns * BLOCK + i / BLOCK,
            );
            difference += a.mean(x, y).element_sum() - b.mean(x, y).element_sum();
            // Channels move together: their errors add.
            variance += a.standard_error(x, y).element_sum().powi(2)
                + b.standard_error(x, y).element_sum().powi(2);
            total += a.mean(x, y).element_sum();
        }
        let z = difference / variance.sqrt().max(1e-9 * total + 1e-12);
        assert!(
            z.abs() < 4.5,
            "{what}: block {block} differs by {z} standard errors"
        );
        squares += z * z;
        blocks += f64::from(variance > 0.0);
    }
    assert!(
        squares < 1.8 * f64::max(blocks, 1.0),
        "{what}: mean z² {}",
        squares / f64::max(blocks, 1.0)
    );
}

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

#[test]
fn strategies_agree_where_everything_meets() {
    let brdfs = [lambert(0.8), embedded("red-plastic")];
    let films = STRATEGIES.map(|strategy| {
        let spec = SceneSpec {
            floor: Some(0.5),
            depth: 5,
            ..row(2, vec![lamp(), uniform(0.2)], strategy)
        };
        planned(&spec, &brdfs, 32, 256)
    });
    assert_same_within_noise(&films[0], &films[1], "mis and light");
    assert_same_within_noise(&films[0], &films[2], "mis and brdf");
}

#[test]
fn everything_forced_on_gives_the_same_picture() {
    let brdfs = [lambert(0.8), embedded("blue-metallic-paint")];
    let point = || row(2, vec![], MIS).light("point").unwrap();
    let cases = [
        ("one sphere, point", row(1, vec![point()], MIS)),
        ("one sphere, environment", row(1, vec![uniform(1.0)], MIS)),
        (
            "one sphere, lamp, light only",
            row(1, vec![lamp()], Strategy::Light),
        ),
        (
            "one sphere, lamp and point, brdf only",
            row(1, vec![lamp(), point()], Strategy::Brdf),
        ),
        (
            "two spheres, direct",
            SceneSpec {
                depth: 1,
                ..row(2, vec![point()], MIS)
            },
        ),
        ("two spheres on a floor, point", {
            SceneSpec {
                floor: Some(0.6),
                depth: 3,
                ..row(2, vec![point()], MIS)
            }
        }),
    ];
    for (name, spec) in cases {
        let planned = planned(&spec, &brdfs, 32, 128);
        let forced = film(&spec, PlanRequest::Everything, &brdfs, 32, 128);
        assert_same_within_noise(&planned, &forced, name);
        assert!(planned.mean(16, 16).x > 0.0, "{name} is black");
        for effect in Effect::ALL {
            let one = film(&spec, PlanRequest::Plus(effect), &brdfs, 32, 32);
            assert_same_within_noise(&one, &forced, &format!("{name}, {} forced", effect.name()));
        }
    }
}

#[test]
fn a_wrong_picture_is_told_from_noise() {
    let spec = row(1, vec![lamp()], Strategy::Light);
    let right = planned(&spec, &[lambert(0.8)], 32, 512);
    let wrong = planned(&spec, &[lambert(0.76)], 32, 512);
    let compare = || assert_same_within_noise(&right, &wrong, "albedo 0.8 and 0.76");
    assert!(std::panic::catch_unwind(compare).is_err());
}

fn effects_on(spec: &SceneSpec) -> Vec<Effect> {
    let plan = EffectPlan::for_scene(spec, PlanRequest::AsNeeded);
    Effect::ALL.into_iter().filter(|e| plan.is_on(*e)).collect()
}

#[test]
fn plans_hold_what_the_scene_calls_for() {
    use Effect::*;
    let sky = || LightSpec::Environment(EnvironmentSource::Studio);
    let delta = row(1, vec![], MIS).light("directional").unwrap();
    let one = |light, strategy| row(1, vec![light], strategy);
    assert_eq!(effects_on(&one(delta.clone(), MIS)), []);
    assert_eq!(
        effects_on(&one(lamp(), MIS)),
        [Directions, LightSampling, Mis]
    );
    assert_eq!(effects_on(&one(lamp(), Strategy::Light)), [LightSampling]);
    assert_eq!(effects_on(&one(lamp(), Strategy::Brdf)), [Directions]);
    assert_eq!(
        effects_on(&one(sky(), MIS)),
        [Directions, LightSampling, EnvironmentTables, Mis]
    );
    assert_eq!(effects_on(&one(sky(), Strategy::Brdf)), [Directions]);
    let floor = |light, depth| SceneSpec {
        floor: Some(0.5),
        depth,
        ..one(light, MIS)
    };
    assert_eq!(effects_on(&floor(delta.clone(), 1)), [Shadows]);
    assert_eq!(
        effects_on(&floor(delta.clone(), 3)),
        [Directions, Shadows, Interreflection]
    );
    assert_eq!(
        effects_on(&floor(delta, 8)),
        [Directions, Shadows, Interreflection, Roulette]
    );
    let all_but_resampling = [
        Directions,
        LightSampling,
        EnvironmentTables,
        Mis,
        Shadows,
        Interreflection,
        Roulette,
    ];
    assert_eq!(effects_on(&floor(sky(), 8)), all_but_resampling);
    let ris = |candidates| one(sky(), Strategy::Ris { candidates });
    assert_eq!(effects_on(&ris(8)), [Directions, Resampling]);
    assert_eq!(effects_on(&ris(1)), [Directions]);
    assert_eq!(effects_on(&row(3, vec![], MIS)), []);
    let all = EffectPlan::for_scene(&row(1, vec![], MIS), PlanRequest::Everything);
    assert!(Effect::ALL.into_iter().all(|e| all.is_on(e)) && all.materials()[0].on);
}

type Render = fn(&Scene, &RenderSettings, &(dyn Fn(usize) + Sync)) -> merlkit::Result<Rendered>;

#[test]
fn a_scene_is_rendered_by_the_plan_it_was_built_by() {
    // No function takes a plan beside a scene.
    let _: Render = render;
    let spec = row(2, vec![uniform(1.0)], MIS);
    let brdfs = [lambert(0.5), lambert(0.7)];
    for request in [
        PlanRequest::AsNeeded,
        PlanRequest::Plus(Effect::Resampling),
        PlanRequest::Everything,
    ] {
        let scene = build(&spec, request, &brdfs);
        assert_eq!(scene.plan(), &EffectPlan::for_scene(&spec, request));
    }
    let forced = build(&spec, PlanRequest::Plus(Effect::Resampling), &brdfs);
    assert!(forced.plan().is_on(Effect::Resampling));
    assert_eq!(forced.plan().effect(Effect::Resampling).why, "forced");
}

#[test]
fn only_what_is_used_is_loaded() {
    let loads = |spec: &SceneSpec, request: PlanRequest| {
        let mut calls = Vec::new();
        let brdf = lambert(0.5);
        let load = |i, directions| {
            calls.push((i, directions));
            Ok(Surface {
                brdf: brdf.clone(),
                sampler: Some(Arc::new(Cosine)),
            })
        };
        Scene::build(spec, request, load).unwrap();
        calls
    };
    let names = ["a", "b", "a"].map(String::from);
    let mut spec = SceneSpec {
        lights: vec![uniform(1.0)],
        ..SceneSpec::row(&names, 2.0)
    };
    spec.materials.push("unused".into());
    assert_eq!(loads(&spec, PlanRequest::AsNeeded), [(0, true), (1, true)]);
    assert_eq!(loads(&spec, PlanRequest::Everything).len(), 3);
    spec.lights = vec![uniform(0.0)];
    assert_eq!(loads(&spec, PlanRequest::AsNeeded), []);
    let delta = row(1, vec![spec.light("point").unwrap()], MIS);
    assert_eq!(loads(&delta, PlanRequest::AsNeeded), [(0, false)]);
}

/// Draws by the cosine, but fails every other time.
struct Failing;

impl DirectionSampler for Failing {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let inner = Cosine
            .sample(wo, Vec2::new(2.0 * u.x - 1.0, u.y))
            .filter(|_| u.x >= 0.5)?;
        Some(DirectionSample {
            pdf: 0.5 * inner.pdf,
            ..inner
        })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        0.5 * Cosine.pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        0
    }
}

#[test]
fn failed_draws_count_as_zero() {
    for strategy in [MIS, Strategy::Brdf, Strategy::Ris { candidates: 4 }] {
        let mut spec = row(1, vec![uniform(1.0)], strategy);
        look_at_point(&mut spec, DVec3::Y);
        let brdf = lambert(0.6);
        let load = |_, _| {
            Ok(Surface {
                brdf: brdf.clone(),
                sampler: Some(Arc::new(Failing)),
            })
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, load).unwrap();
        let settings = RenderSettings {
            width: 1,
            height: 1,
            seed: 1,
            points: PointSet::Random,
            budget: Budget::Even(1 << 14),
        };
        let film = render(&scene, &settings, &|_| {}).unwrap().film;
        assert_pixel(&film, DVec3::splat(0.6), 1e-6, &format!("{strategy:?}"));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let brdfs = [lambert(0.8), embedded("nickel")];
    let sky = LightSpec::Environment(EnvironmentSource::Studio);
    let spec = SceneSpec {
        floor: Some(0.4),
        ..row(2, vec![sky], MIS)
    };
    let scene = build(&spec, PlanRequest::AsNeeded, &brdfs);
    let settings = RenderSettings {
        width: 41,
        height: 23,
        seed: 3,
        points: PointSet::Sobol,
        budget: Budget::Even(5),
    };
    let folder = tempfile::tempdir().unwrap();
    let files = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let count = |n| {
            done.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
        };
        let image = pool
            .install(|| render(&scene, &settings, &count))
            .unwrap()
            .film
            .to_image()
            .unwrap();
        assert_eq!(done.into_inner(), 41 * 23);
        let path = |extension| folder.path().join(format!("{threads}.{extension}"));
        pool.install(|| write_exr(&path("exr"), &image, Overwrite::Refuse))
            .unwrap();
        write_png(&path("png"), &image, 0.0, Overwrite::Refuse).unwrap();
        ["exr", "png"].map(|e| std::fs::read(path(e)).unwrap())
    });
    assert!(files[0] == files[1] && files[0] == files[2]);
    let other = render(
        &scene,
        &RenderSettings {
            seed: 4,
            ..settings
        },
        &|_| {},
    )
    .unwrap();
    assert_ne!(other, render(&scene, &settings, &|_| {}).unwrap());
}

#[test]
fn scenes_outside_their_domain_are_refused() {
    let refused = |spec: &SceneSpec| {
        let brdf = lambert(0.5);
        let load = |_, _| {
            Ok(Surface {
                brdf: brdf.clone(),
                sampler: None,
            })
        };
        Scene::build(spec, PlanRequest::AsNeeded, load)
            .err()
            .map(|e| e.to_string())
    };
    let point = row(1, vec![], MIS).light("point").unwrap();
    let good = row(1, vec![point], MIS);
    assert_eq!(refused(&good), None);
    let flat = SphereSpec {
        shape: Sphere {
            centre: DVec3::ZERO,
            radius: 0.0,
        },
        material: 0,
    };
    assert!(
        refused(&SceneSpec {
            spheres: vec![flat],
            ..good.clone()
        })
        .is_some()
    );
    let lost = SphereSpec {
        material: 1,
        ..good.spheres[0]
    };
    assert!(
        refused(&SceneSpec {
            spheres: vec![lost],
            ..good.clone()
        })
        .is_some()
    );
    assert!(
        refused(&SceneSpec {
            floor: Some(f32::NAN),
            ..good.clone()
        })
        .is_some()
    );
    assert!(
        refused(&SceneSpec {
            lights: vec![uniform(-1.0)],
            ..good.clone()
        })
        .is_some()
    );
    // Light with an extent needs directions, and with them a sampler.
    assert!(
        refused(&SceneSpec {
            lights: vec![uniform(1.0)],
            ..good.clone()
        })
        .unwrap()
        .contains("sampler")
    );
    let settings = RenderSettings {
        width: 0,
        height: 4,
        seed: 0,
        points: PointSet::Sobol,
        budget: Budget::Even(1),
    };
    let scene = build(&good, PlanRequest::AsNeeded, &[lambert(0.5)]);
    assert!(render(&scene, &settings, &|_| {}).is_err());
    assert!(
        render(
            &scene,
            &RenderSettings {
                width: usize::MAX,
                ..settings
            },
            &|_| {}
        )
        .is_err()
    );
}

#[test]
fn an_environment_file_lights_as_its_pixels_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.exr");
    // Light from the upper half only: irradiance on the top of the sphere is that of a uniform sky.
    let half = Image::from_fn(64, 32, |_, y| Rgb::splat(if y < 16 { 2.0 } else { 0.0 })).unwrap();
    write_exr(&path, &half, Overwrite::Refuse).unwrap();
    let sky = LightSpec::Environment(EnvironmentSource::File { path, clamp: None });
    let mut spec = row(1, vec![sky], MIS);
    look_at_point(&mut spec, DVec3::Y);
    let film = planned(&spec, &[lambert(0.5)], 1, 1 << 14);
    assert_pixel(&film, DVec3::ONE, 1e-3, "half sky");
}

#[test]
fn the_studio_is_the_same_with_and_without_tables() {
    let tables = studio(SkySampling::Importance);
    let plain = studio(SkySampling::Uniform);
    assert!(tables.table_bytes() > 0 && plain.table_bytes() == 0);
    let mean = |sky: &dyn Light| {
        let n = 1 << 15;
        let value = |i| {
            let s = sky
                .sample(DVec3::ZERO, PointSet::Sobol.point(1, i, 0).as_dvec2())
                .unwrap();
            f64::from(s.radiance.y) / s.pdf
        };
        (0..n).map(value).sum::<f64>() / n as f64
    };
    let (a, b) = (mean(&tables), mean(&plain));
    assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
}
