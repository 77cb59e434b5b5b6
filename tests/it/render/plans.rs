//! What a scene calls for, what it loads, and what is refused or fails.

use super::*;

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
    let mirror = |spec: SceneSpec| SceneSpec {
        mirrors: vec![0],
        ..spec
    };
    assert_eq!(
        effects_on(&mirror(one(sky(), Strategy::Light))),
        [LightSampling, EnvironmentTables, Mirrors]
    );
    let dark_ground = floor(row(1, vec![], MIS).light("directional").unwrap(), 3);
    assert_eq!(
        effects_on(&mirror(dark_ground)),
        [Directions, Shadows, Interreflection, Mirrors]
    );
    let alone = one(row(1, vec![], MIS).light("directional").unwrap(), MIS);
    assert_eq!(effects_on(&mirror(alone)), []);
    let all = EffectPlan::for_scene(&row(1, vec![], MIS), PlanRequest::Everything);
    assert!(Effect::ALL.into_iter().all(|e| all.is_on(e)) && all.materials()[0].on);
}

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
