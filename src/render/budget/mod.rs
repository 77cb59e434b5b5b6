//! Pictures by their budgets of paths.

mod adaptive;
mod even;
mod partial_file;
mod rendered;
mod rendering;
mod rounds;
mod tiles;
mod to_error;
mod words;

pub use rendered::{Refinement, Rendered, Tile};
pub use rendering::Rendering;

use super::scene::Scene;
use super::settings::RenderSettings;
use crate::Result;

/// Renders `scene` by the plan that it holds, on all threads of the current pool. [`Rendering`] can be stopped.
///
/// Random numbers are functions of seed, pixel, sample and dimension, and each pixel's samples are summed in order, so that
/// the film is the same, bit for bit, for any number of threads. `progress(n)` is called from any thread when as much more is
/// done as `n` pixels take; the sum of all n is the number of pixels. A path that carries more than 10¹⁴⁰ is dropped.
///
/// # Examples
/// ```
/// use merlkit::points::PointSet;
/// use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
/// use merlkit::{LookupRule, Material, SamplerSpec};
///
/// // Describe the scene: nothing is loaded yet.
/// let mut spec = SceneSpec::row(&["lambert:reflectance=0.5".to_owned()], 1.0);
/// spec.lights = vec![spec.light("environment")?];
///
/// // The scene plans which effects it needs, and asks for each material and, where directions are drawn, its sampler.
/// let sampler: SamplerSpec = "cosine".parse()?;
/// let scene = Scene::build(&spec, PlanRequest::AsNeeded, |index, directions| {
///     let loaded = Material::resolve(&spec.materials[index])?.load(LookupRule::Floor)?;
///     let sampler = match directions {
///         true => Some(sampler.build(&loaded)?.shared()),
///         false => None,
///     };
///     Ok(Surface { brdf: loaded.brdf().clone(), sampler })
/// })?;
///
/// let settings = RenderSettings {
///     width: 8,
///     height: 8,
///     seed: 0,
///     points: PointSet::Lattice,
///     budget: Budget::Even(4),
/// };
/// let rendered = render(&scene, &settings, &|_pixels| {})?;
/// let image = rendered.film.to_image()?;
/// assert!(image.pixel(4, 4).x > 0.0);
/// # Ok::<(), merlkit::Error>(())
/// ```
///
/// # Errors
/// As [`RenderSettings::check`].
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Rendered> {
    let mut rendering = Rendering::begin(scene, settings)?;
    rendering.advance(&|| false, progress);
    Ok(rendering.into_rendered())
}
