//! Pictures by their budgets of paths.

mod adaptive;
mod even;
mod rendered;
mod to_error;

pub use rendered::{Refinement, Rendered, Tile};

use super::scene::Scene;
use super::settings::{Budget, RenderSettings};
use crate::Result;

/// Renders `scene` by the plan that it holds, on all threads of the current pool.
///
/// Random numbers are functions of seed, pixel, sample and dimension, and each pixel's samples are summed in order, so that
/// the film is the same, bit for bit, for any number of threads. `progress(n)` is called from any thread when `n` more
/// pixels are done. A path that carries more than 10¹⁴⁰ is dropped.
///
/// # Errors
/// As [`RenderSettings::check`].
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Rendered> {
    settings.check()?;
    Ok(match settings.budget {
        Budget::Even(paths) => Rendered {
            film: even::render_even(scene, settings, paths, progress),
            refinement: None,
        },
        Budget::Adaptive(paths) => Rendered {
            film: adaptive::render_adaptive(scene, settings, paths, progress),
            refinement: None,
        },
        Budget::ToError { error, most } => {
            to_error::render_to_error(scene, settings, error, most, progress)
        }
    })
}
