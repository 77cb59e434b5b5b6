//! Objects that emit light.

use std::sync::Arc;

use merlkit::glam::{DVec2, DVec3};
use merlkit::light::{Emission, Light, LightSample, LightSpec};
use merlkit::render::{Effect, EffectPlan, PlanRequest, SceneSpec, Strategy};

use crate::scene_plans::{assert_same, compare, draw, read_text};

/// A floor, a wall and a ball under what is put in the place of LAMP.
const ROOM: &str = r#"
bounces = 3
background = "black"
[camera]
eye = [0.5, 2, 7]
look_at = [0, 1.2, 0]
fov = 42
[[material]]
name = "grey"
brdf = "lambert:reflectance=0.6"
[[material]]
name = "lamp"
brdf = "lambert:reflectance=0.3"
[[object]]
shape = "quad"
corner = [-3, 0, -2]
edge_u = [0, 0, 5]
edge_v = [6, 0, 0]
material = "grey"
[[object]]
shape = "quad"
corner = [-3, 0, -2]
edge_u = [6, 0, 0]
edge_v = [0, 4, 0]
material = "grey"
[[object]]
shape = "sphere"
centre = [-0.8, 0.7, 0.3]
radius = 0.7
material = "grey"
LAMP
"#;

/// Two triangles as a mesh that emits.
const QUAD: &str = r#"
[[object]]
shape = "quad"
corner = [0, 2.2, -1]
edge_u = [1, 0.4, 0]
edge_v = [0.1, 0, 1.5]
emission = [5, 4, 3]
material = "lamp"
"#;

/// The same quad, and on each of its sides, a little above it, an area light.
const AREAS: &str = r#"
[[object]]
shape = "quad"
corner = [0, 2.2, -1]
edge_u = [1, 0.4, 0]
edge_v = [0.1, 0, 1.5]
material = "lamp"
[[light]]
kind = "area"
corner = [0, 2.1999, -1]
edge_u = [1, 0.4, 0]
edge_v = [0.1, 0, 1.5]
radiance = [5, 4, 3]
[[light]]
kind = "area"
corner = [0, 2.2001, -1]
edge_v = [1, 0.4, 0]
edge_u = [0.1, 0, 1.5]
radiance = [5, 4, 3]
"#;

/// A closed lamp with bumps, which shines on itself.
const STONE: &str = r#"
[[object]]
shape = "displaced-sphere"
radius = 0.6
amplitude = 0.5
steps = 8
seed = 3
emission = 4
material = "lamp"
translate = [1, 1.6, -0.3]
scale = [1, 0.7, -1.2]
"#;

fn scene(lamp: &str) -> SceneSpec {
    read_text(&ROOM.replace("LAMP", lamp)).spec
}

fn with(spec: &SceneSpec, strategy: Strategy) -> SceneSpec {
    SceneSpec {
        strategy,
        ..spec.clone()
    }
}

#[test]
fn a_luminous_quad_gives_the_picture_of_area_lights() {
    let (quad, areas) = (scene(QUAD), scene(AREAS));
    let a = draw(&quad, PlanRequest::AsNeeded, 1);
    let b = draw(&areas, PlanRequest::AsNeeded, 2);
    assert_same(&a, &b, "a luminous quad");
    // With another strategy as well: directions of the BRDF need no density of the light, and those of the light no other.
    for strategy in [Strategy::Brdf, Strategy::Light] {
        let c = draw(&with(&quad, strategy), PlanRequest::AsNeeded, 3);
        assert_same(&b, &c, &format!("a luminous quad, {strategy:?}"));
    }
}

#[test]
fn a_closed_lamp_has_one_picture_by_every_strategy() {
    let stone = scene(STONE);
    let weighted = draw(&stone, PlanRequest::AsNeeded, 1);
    for strategy in [
        Strategy::Brdf,
        Strategy::Light,
        Strategy::Ris { candidates: 4 },
    ] {
        let other = draw(&with(&stone, strategy), PlanRequest::AsNeeded, 2);
        assert_same(
            &weighted,
            &other,
            &format!("a luminous stone, {strategy:?}"),
        );
    }
    let everything = draw(&stone, PlanRequest::Everything, 3);
    assert_same(&weighted, &everything, "a luminous stone with everything");
}

/// A light whose samples claim to be drawn more often than they are.
#[derive(Debug)]
struct WrongDensity(Arc<dyn Light>);

impl Light for WrongDensity {
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        let sample = self.0.sample(from, u)?;
        let pdf = 1.1 * sample.pdf;
        Some(LightSample { pdf, ..sample })
    }

    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        self.0.emitted_along(from, direction, reach)
    }

    fn hull(&self) -> Vec<DVec3> {
        self.0.hull()
    }
}

/// The tests above can fail.
#[test]
fn a_wrong_density_is_seen() {
    let quad = scene(QUAD);
    let LightSpec::Object(light) = &quad.lights[0] else {
        panic!("a luminous object");
    };
    let mut wrong = quad.clone();
    wrong.lights = vec![LightSpec::Object(Arc::new(WrongDensity(light.clone())))];
    let differences = compare(
        &draw(&scene(AREAS), PlanRequest::AsNeeded, 1),
        &draw(&wrong, PlanRequest::AsNeeded, 2),
    );
    let squares: f64 = differences.iter().map(|z| z * z).sum();
    assert!(squares > 4.0 * differences.len() as f64, "{squares}");
}

/// A lamp above a floor: its own body is between nothing and its light. A closed one hides its far side.
#[test]
fn effects_are_on_where_a_luminous_object_calls_for_them() {
    let floor = &ROOM[..ROOM.rfind("[[object]]\nshape = \"quad\"").unwrap()];
    for (lamp, shadows) in [(QUAD, false), (STONE, true)] {
        let spec = read_text(&format!("{floor}{lamp}")).spec;
        let plan = EffectPlan::for_scene(&spec, PlanRequest::AsNeeded);
        assert_eq!(plan.is_on(Effect::Shadows), shadows);
        assert!(plan.is_on(Effect::LightSampling) && plan.is_on(Effect::Mis));
        assert!(!plan.is_on(Effect::EnvironmentTables));
    }
    // An object of no radiance is no light.
    let dark = scene(&QUAD.replace("[5, 4, 3]", "0"));
    assert!(dark.lights.is_empty());
}

/// Lights are turned, and objects are not: neither is what they emit.
#[test]
fn a_luminous_object_stays_when_lights_are_turned() {
    let quad = scene(QUAD);
    let turned = SceneSpec {
        light_turn: 2.0,
        ..quad.clone()
    };
    let a = draw(&quad, PlanRequest::AsNeeded, 1);
    let b = draw(&turned, PlanRequest::AsNeeded, 1);
    for y in 0..24 {
        for x in 0..24 {
            assert_eq!(a.mean(x, y), b.mean(x, y));
        }
    }
}
