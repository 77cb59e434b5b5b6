//! Pictures of scenes whose plans differ.

use glam::DVec2;

use super::*;
use crate::light::{Emission, LightSample};
use crate::points::PointSet;
use crate::render::{Budget, Film, Intersection, ObjectSpec, RenderSettings, Sphere, render};

/// Two spheres as one object: not convex, even where it claims to be.
#[derive(Debug)]
struct TwoLamps {
    spheres: [Sphere; 2],
    claims_convexity: bool,
}

impl Shape for TwoLamps {
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let first = self.spheres[0].intersect(ray, near, far);
        let far = first.map_or(far, |hit| hit.distance);
        self.spheres[1].intersect(ray, near, far).or(first)
    }

    fn is_convex(&self) -> bool {
        self.claims_convexity
    }
}

/// Two spheres under a lamp and a sky.
fn separate() -> SceneSpec {
    let names = ["grey".to_owned(), "grey".to_owned()];
    let row = SceneSpec::row(&names, 1.5);
    SceneSpec {
        lights: vec![
            row.light("area").unwrap(),
            row.light("uniform:0.3").unwrap(),
        ],
        depth: 4,
        ..row
    }
}

/// The same two spheres as one object.
fn joined(claims_convexity: bool) -> SceneSpec {
    let row = separate();
    let pair = TwoLamps {
        spheres: [row.spheres[0].shape, row.spheres[1].shape],
        claims_convexity,
    };
    SceneSpec {
        spheres: Vec::new(),
        objects: vec![ObjectSpec {
            shape: Arc::new(pair),
            material: 0,
        }],
        ..row
    }
}

fn picture(spec: &SceneSpec) -> Film {
    let scene = Scene::build(spec, PlanRequest::AsNeeded, |_, _| Ok(floor(0.8))).unwrap();
    picture_of(&scene)
}

fn picture_of(scene: &Scene) -> Film {
    let settings = RenderSettings {
        width: 30,
        height: 20,
        seed: 3,
        points: PointSet::Sobol,
        budget: Budget::Even(8),
    };
    render(scene, &settings, &|_| {}).unwrap().film
}

/// A light of which rays are traced that miss it.
#[derive(Debug)]
struct Surrounding(Arc<dyn Light>);

impl Light for Surrounding {
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        self.0.sample(from, u)
    }

    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        self.0.emitted_along(from, direction, reach)
    }

    fn surrounds(&self) -> bool {
        true
    }
}

/// Rays that miss all lights are not traced where the path ends, which changes no bit.
#[test]
fn rays_without_light_are_left_out() {
    for (depth, directions) in [(1, 1), (3, 1), (1, 4)] {
        let mut spec = joined(false);
        spec.lights.truncate(1);
        spec.depth = depth;
        spec.directions = directions;
        let mut scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| Ok(floor(0.8))).unwrap();
        assert!(scene.plan.is_on(Effect::Shadows) && scene.plan.is_on(Effect::Mis));
        let sparing = picture_of(&scene);
        let light = scene.lights.remove(0);
        scene.lights.push(Arc::new(Surrounding(light)));
        assert_eq!(picture_of(&scene), sparing);
    }
}

#[test]
fn an_object_that_is_not_convex_shades_and_lights_itself() {
    let plan = EffectPlan::for_scene(&joined(false), PlanRequest::AsNeeded);
    assert!(plan.is_on(Effect::Shadows) && plan.is_on(Effect::Interreflection));
    let why = plan.effect(Effect::Shadows).why;
    assert_eq!(why, "an object that is not convex hides light from itself");
    assert_eq!(picture(&joined(false)), picture(&separate()));
}

#[test]
fn the_plan_believes_what_the_shape_says() {
    let plan = EffectPlan::for_scene(&joined(true), PlanRequest::AsNeeded);
    assert!(!plan.is_on(Effect::Shadows) && !plan.is_on(Effect::Interreflection));
    // That this is wrong here is seen: the comparison above can fail.
    assert_ne!(picture(&joined(true)), picture(&separate()));
}

#[test]
fn objects_without_a_material_are_refused() {
    let mut spec = joined(false);
    spec.objects[0].material = 1;
    let built = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| Ok(floor(0.8)));
    assert!(built.is_err());
}
