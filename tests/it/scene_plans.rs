//! Four scenes with four plans, each of which gives the picture that everything gives.

use std::path::Path;
use std::sync::Arc;

use merlkit::direction_sampler::DirectionSampler;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Effect, EffectPlan, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Surface,
    render,
};
use merlkit::sampler::Cosine;
use merlkit_scene::{BuiltScene, read_scene};

pub(crate) fn read(name: &str) -> SceneSpec {
    let folder = Path::new(crate::ROOT).join("tools/scene/scenes");
    read_scene(&folder.join(name))
        .unwrap()
        .build()
        .unwrap()
        .spec
}

/// The scene of a text.
pub(crate) fn read_text(text: &str) -> BuiltScene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    read_scene(&path).unwrap().build().unwrap()
}

pub(crate) fn draw(spec: &SceneSpec, request: PlanRequest, seed: u64) -> Film {
    draw_by(spec, request, seed, |_| Arc::new(Cosine))
}

/// The same with other samplers of the materials.
pub(crate) fn draw_by(
    spec: &SceneSpec,
    request: PlanRequest,
    seed: u64,
    sampler: impl Fn(&Loaded) -> Arc<dyn DirectionSampler>,
) -> Film {
    let scene = Scene::build(spec, request, |i, _| {
        let material = Material::resolve(&spec.materials[i])?.load(LookupRule::Floor)?;
        Ok(Surface {
            brdf: material.brdf().clone(),
            sampler: Some(sampler(&material)),
        })
    });
    let settings = RenderSettings {
        width: 24,
        height: 24,
        seed,
        points: PointSet::Random,
        budget: Budget::Even(256),
    };
    render(&scene.unwrap(), &settings, &|_| {}).unwrap().film
}

/// The difference of two films in each block of 4 × 4 pixels, in standard errors.
pub(crate) fn compare(a: &Film, b: &Film) -> Vec<f64> {
    let mut differences = Vec::new();
    for block in 0..36 {
        let (mut difference, mut variance) = (0.0, 0.0);
        for i in 0..16 {
            let (x, y) = (block % 6 * 4 + i % 4, block / 6 * 4 + i / 4);
            difference += a.mean(x, y).element_sum() - b.mean(x, y).element_sum();
            // Channels of a path move together: their errors add.
            variance += a.standard_error(x, y).element_sum().powi(2)
                + b.standard_error(x, y).element_sum().powi(2);
        }
        if variance > 0.0 {
            differences.push(difference / variance.sqrt());
        } else {
            assert!(
                difference.abs() < 1e-9,
                "block {block} differs by {difference}"
            );
        }
    }
    differences
}

/// Of 36 blocks a difference of 4.5 standard errors has the chance 2·10⁻⁴, and a mean square of 2 less than 10⁻³.
pub(crate) fn assert_same(a: &Film, b: &Film, name: &str) {
    let differences = compare(a, b);
    assert!(differences.len() > 8, "{name}");
    let worst = differences
        .iter()
        .fold(0.0, |most, z| f64::max(most, z.abs()));
    let squares: f64 = differences.iter().map(|z| z * z).sum();
    assert!(worst < 4.5, "{name}: {worst} standard errors");
    assert!(
        squares < 2.0 * differences.len() as f64,
        "{name}: {squares}"
    );
}

#[test]
fn four_scenes_have_four_plans_with_the_pictures_of_everything() {
    use Effect::*;
    let scenes: [(&str, &[Effect]); 4] = [
        // A constant environment is found by directions of the BRDF alone, and the jar hides it from itself.
        (
            "jar.toml",
            &[Directions, Shadows, Interreflection, Roulette],
        ),
        // Nothing is between the walls of a room and its lamp.
        (
            "room.toml",
            &[Directions, LightSampling, Mis, Interreflection, Roulette],
        ),
        ("sphere.toml", &[Directions, LightSampling, Mis]),
        // Parallel light is evaluated, and directions are drawn for what the spheres reflect of one another.
        ("spheres.toml", &[Directions, Interreflection, Roulette]),
    ];
    for (name, expected) in scenes {
        let spec = read(name);
        let plan = EffectPlan::for_scene(&spec, PlanRequest::AsNeeded);
        let on: Vec<Effect> = Effect::ALL.into_iter().filter(|e| plan.is_on(*e)).collect();
        assert_eq!(on, expected, "{name}");
        let planned = draw(&spec, PlanRequest::AsNeeded, 1);
        let everything = draw(&spec, PlanRequest::Everything, 2);
        assert_same(&planned, &everything, name);
    }
}

/// The test above can fail: with a ball in the room shadows are on, and a picture without them differs.
#[test]
fn a_ball_in_the_room_hides_the_lamp() {
    let room = read("room.toml");
    let mut occupied = room.clone();
    occupied.spheres.push(merlkit::render::SphereSpec {
        shape: merlkit::render::Sphere {
            centre: merlkit::glam::DVec3::new(278.0, 200.0, 280.0),
            radius: 100.0,
        },
        material: 0,
    });
    let plan = EffectPlan::for_scene(&occupied, PlanRequest::AsNeeded);
    assert!(plan.is_on(Effect::Shadows));
    let differences = compare(
        &draw(&room, PlanRequest::AsNeeded, 1),
        &draw(&occupied, PlanRequest::AsNeeded, 2),
    );
    assert!(differences.iter().any(|z| z.abs() > 10.0));
}

/// A turned room is convex within rounding, and still nothing is between a wall and the lamp.
#[test]
fn a_turned_room_needs_no_shadow_rays() {
    let text = std::fs::read_to_string(Path::new(crate::ROOT).join("tools/scene/scenes/room.toml"));
    let text = text
        .unwrap()
        .replace("material = \"", "rotate = [17, 29, -8]\nmaterial = \"");
    let folder = std::env::temp_dir().join(format!("merlkit-turned-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("room.toml");
    std::fs::write(&path, text).unwrap();
    let mut spec = read_scene(&path).unwrap().build().unwrap().spec;
    std::fs::remove_dir_all(&folder).unwrap();
    // The lamp is turned with the walls.
    let turned = merlkit::glam::DQuat::from_euler(
        merlkit::glam::EulerRot::ZYX,
        -8f64.to_radians(),
        29f64.to_radians(),
        17f64.to_radians(),
    );
    let merlkit::light::LightSpec::Area(lamp) = &mut spec.lights[0] else {
        panic!("a square lamp");
    };
    lamp.corner = turned * lamp.corner;
    lamp.edge_u = turned * lamp.edge_u;
    lamp.edge_v = turned * lamp.edge_v;
    let plan = EffectPlan::for_scene(&spec, PlanRequest::AsNeeded);
    assert!(!plan.is_on(Effect::Shadows) && plan.is_on(Effect::Interreflection));
}
