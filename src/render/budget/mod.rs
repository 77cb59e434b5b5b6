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
