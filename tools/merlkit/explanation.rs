//! Why a picture has its effects.

use merlkit::render::{Decision, Effect, EffectPlan, SceneSpec};
use merlkit_evaluate::report::Sheet;

use crate::picture::Picture;

/// One line an effect, then one a material and a light; a table for each kind of plan.
pub fn explain_plans(pictures: &[Picture<'_>]) -> Vec<Sheet> {
    let mut kinds: Vec<(EffectPlan, Vec<&SceneSpec>)> = Vec::new();
    for picture in pictures {
        let plan = EffectPlan::for_scene(&picture.scene, picture.effects);
        match kinds.iter_mut().find(|(known, _)| *known == plan) {
            Some((_, scenes)) => scenes.push(&picture.scene),
            None => kinds.push((plan, vec![&picture.scene])),
        }
    }
    kinds
        .iter()
        .map(|kind| explanation(&kind.0, &kind.1))
        .collect()
}

/// What a plan decides for scenes that it is the plan of.
fn explanation(plan: &EffectPlan, scenes: &[&SceneSpec]) -> Sheet {
    let mut sheet = Sheet::new(&["effect", "", "why"]);
    let mut rows = Vec::new();
    for effect in Effect::ALL {
        rows.push((effect.name().to_owned(), plan.effect(effect)));
    }
    for scene in scenes {
        for (name, decision) in scene.materials.iter().zip(plan.materials()) {
            rows.push((format!("load material {name}"), *decision));
        }
    }
    let lights = scenes.first().map_or(&[][..], |scene| &scene.lights);
    for (light, decision) in lights.iter().zip(plan.lights()) {
        rows.push((format!("load light {}", light.describe()), *decision));
    }
    for (name, Decision { on, why }) in rows {
        let on = if on { "on" } else { "off" };
        sheet.push(vec![name, on.into(), why.into()]);
    }
    sheet
}
