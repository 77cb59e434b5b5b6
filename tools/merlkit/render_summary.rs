//! What `render` says of a picture when it is finished: how many paths it took, how far it came, and what it cost.

use merlkit::render::{Budget, Refinement, RenderSettings};
use serde::Serialize;

use crate::render_costs::CostSummary;

/// How many paths per pixel has; of a target error the mean, and with those that only served decisions.
pub fn paths_a_pixel(
    settings: &RenderSettings,
    pixels: usize,
    refinement: Option<&Refinement>,
) -> String {
    match (settings.budget, refinement) {
        (Budget::Even(paths), _) => paths.to_string(),
        (Budget::Adaptive(paths), _) => format!("about {paths}"),
        (Budget::ToError { most, .. }, None) => format!("at most {most}"),
        (Budget::ToError { .. }, Some(refinement)) => {
            let kept = refinement.paths as f64 / pixels as f64;
            let traced = refinement.traced as f64 / pixels as f64;
            format!("{kept:.1} (traced: {traced:.1})")
        }
    }
}

/// The error that was estimated, and whether all tiles came down to the target.
pub fn error_reached(refinement: &Refinement, most: u64) -> String {
    let worst = refinement.tiles.iter().map(|t| t.error).fold(0.0, f64::max);
    let tiles = refinement.tiles.len();
    let short = refinement.tiles.iter().filter(|t| !t.reached).count();
    let errors = format!(
        "estimated relative error {:.2} %, worst tile {:.2} %",
        100.0 * refinement.error(),
        100.0 * worst
    );
    match short {
        0 => format!("{errors}; all {tiles} tiles with objects have stopped"),
        _ => format!(
            "{errors}; {short} of {tiles} tiles did not reach the target: raise --max-spp {most}"
        ),
    }
}

/// What is written as JSON of a picture.
#[derive(Serialize)]
pub struct RenderResult<'a> {
    /// The pictures that were written.
    pub files: Vec<String>,
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pictures of a turn, or 1.
    pub frames: usize,
    /// What they cost.
    #[serde(flatten)]
    pub costs: &'a CostSummary,
}
