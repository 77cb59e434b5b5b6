//! Hard cases on spheres under every kind of light.

use glam::Vec3;

use super::{HardCheck, HardOutcome, HardSampler, HardSubject};
use merlkit::Result;
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit::sampler::Sampler;

/// A picture of so many pixels, wide enough for both spheres and the light between them.
const SETTINGS: RenderSettings = RenderSettings {
    width: 18,
    height: 12,
    seed: 5,
    points: PointSet::Sobol,
    budget: Budget::Even(2),
};

/// [`HardCheck::Picture`]: two spheres on a floor that see each other.
pub(super) fn picture(
    subject: &HardSubject,
    hard: &HardSampler,
    sampler: &Sampler,
) -> Result<HardOutcome> {
    let (mut count, mut violations, mut note) = (0, 0, String::new());
    for light in 0..3 {
        let mut spec = scene(light)?;
        if subject.brdf().mirror(Vec3::Z).is_some() {
            spec.mirrors = vec![0, 1];
        }
        let surface = Surface {
            brdf: subject.brdf().clone(),
            sampler: Some(sampler.shared()),
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| Ok(surface.clone()))?;
        let film = render(&scene, &SETTINGS, &|_| {})?.film;
        for k in 0..SETTINGS.width * SETTINGS.height {
            let (x, y) = (k % SETTINGS.width, k / SETTINGS.width);
            let (mean, error) = (film.mean(x, y), film.standard_error(x, y));
            let right = [mean, error]
                .iter()
                .all(|v| v.is_finite() && v.min_element() >= 0.0);
            count += 1;
            if !right {
                violations += 1;
                note = format!(
                    "pixel ({x}, {y}) under {}: {mean} ± {error}",
                    spec.lights[0].describe()
                );
            }
        }
        film.to_image()?;
    }
    Ok(subject.outcome(
        hard.name,
        HardCheck::Picture,
        f64::from(violations),
        Some(0.0),
        count,
        note,
    ))
}

/// Under a point, an area or an environment light.
fn scene(light: usize) -> Result<SceneSpec> {
    let row = SceneSpec::row(&["left".into(), "right".into()], 1.5);
    let light = match light {
        0 => row.light("point")?,
        1 => row.light("area")?,
        _ => LightSpec::Environment(EnvironmentSource::Studio),
    };
    Ok(SceneSpec {
        lights: vec![light],
        floor: Some(0.4),
        ..row
    })
}
