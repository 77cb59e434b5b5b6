//! Pictures by their budgets of paths.

mod adaptive;
mod even;
mod to_error;

pub use to_error::{Refinement, Tile};

use super::film::Film;
use super::scene::Scene;
use super::settings::{Budget, RenderSettings};
use crate::Result;

/// A rendered picture, and how it came to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The picture.
    pub film: Film,
    /// How far [`Budget::ToError`] came; `None` for other budgets.
    pub refinement: Option<Refinement>,
}

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
