//! What a picture is traced with: a scene, its plan's switches, and the camera.

use fearless_simd::{Level, dispatch};
use glam::{DVec2, DVec3, Vec2};

use super::bundle::PathsOfRun;
use super::camera::CameraAxes;
use super::path_numbers::PathNumbers;
use super::plan::Effect;
use super::scene::Scene;
use super::settings::{PixelRegion, RenderSettings};
use crate::distribution::Heuristic;

/// The scene and the switches of its plan, read once.
pub(super) struct Tracer<'a> {
    pub(super) scene: &'a Scene,
    /// Of the whole picture.
    pub(super) settings: RenderSettings,
    /// The pixels that are traced.
    pub(super) region: PixelRegion,
    axes: CameraAxes,
    pub(super) numbers: PathNumbers,
    /// Whether directions from the BRDF are drawn.
    pub(super) directions: bool,
    /// Whether lights with an extent are sampled.
    pub(super) light_sampling: bool,
    /// Whether directions that hit such lights count as they are drawn.
    pub(super) hits_count: bool,
    /// Whether they count after a choice among several.
    pub(super) resampling: bool,
    /// Directions that are drawn at each vertex together.
    pub(super) spread: u32,
    pub(super) mis: bool,
    pub(super) heuristic: Heuristic,
    pub(super) shadows: bool,
    /// Whether rays may miss all lights, so that it pays to look before they are traced.
    pub(super) lights_are_missed: bool,
    pub(super) interreflection: bool,
    pub(super) roulette: bool,
    /// Whether a surface has a part that reflects the mirror direction alone.
    pub(super) mirrors: bool,
}

impl<'a> Tracer<'a> {
    pub(super) fn new(scene: &'a Scene, settings: RenderSettings, region: PixelRegion) -> Self {
        let plan = &scene.plan;
        let mis = plan.is_on(Effect::Mis);
        let light_sampling = plan.is_on(Effect::LightSampling);
        // Where lights are sampled and nothing is weighted, what directions hit would be counted twice.
        let hits_may_count = mis || !light_sampling;
        // Resampling takes the place of counting each hit as it is drawn.
        let resampling = hits_may_count && plan.is_on(Effect::Resampling);
        // Several directions find more light than one. Where there is none to be found, they would find nothing.
        let finds_light =
            hits_may_count && !resampling && scene.lights.iter().any(|l| !l.is_delta());
        let spread = if finds_light { scene.directions } else { 1 };
        Self {
            scene,
            settings,
            region,
            axes: scene
                .camera
                .axes(settings.width as f64 / settings.height as f64),
            numbers: PathNumbers::new(scene, settings.points),
            directions: plan.is_on(Effect::Directions),
            light_sampling,
            hits_count: hits_may_count && !resampling,
            resampling,
            spread,
            mis,
            heuristic: scene.strategy.heuristic(),
            lights_are_missed: !scene.lights.iter().any(|light| light.surrounds()),
            shadows: plan.is_on(Effect::Shadows),
            interreflection: plan.is_on(Effect::Interreflection),
            mirrors: plan.is_on(Effect::Mirrors),
            roulette: plan.is_on(Effect::Roulette),
        }
    }

    /// Directions of the camera's rays through a point `within` each path's pixel, in [0, 1]² from the pixel's upper left corner.
    pub(super) fn aim(&self, paths: &[PathsOfRun], within: &[Vec2], along: &mut [DVec3]) {
        dispatch!(Level::new(), _ => self.fill_directions(paths, within, along));
    }

    #[inline(always)]
    fn fill_directions(&self, paths: &[PathsOfRun], within: &[Vec2], along: &mut [DVec3]) {
        let mut first = 0;
        for paths in paths {
            for k in first..first + paths.count {
                along[k] = self.direction(paths.pixel, within[k].as_dvec2());
            }
            first += paths.count;
        }
    }

    /// The direction of the camera's ray through a point of a pixel, in [0, 1]² from its upper left corner.
    #[inline(always)]
    pub(super) fn direction(&self, [x, y]: [usize; 2], within: DVec2) -> DVec3 {
        let size = DVec2::new(self.settings.width as f64, self.settings.height as f64);
        let corner = DVec2::new(x as f64, y as f64);
        self.axes.direction((corner + within) / size)
    }
}
