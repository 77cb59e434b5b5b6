//! What is said of an environment's file.

use std::path::PathBuf;

use serde::Serialize;

use super::repair::count_pixels;

/// What whoever uses an environment's file should know: how its pixels differ from the file's, and from radiance.
///
/// See [`Light`](crate::light::Light) for an example that samples an environment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapNotes {
    /// The file.
    pub path: PathBuf,
    /// Columns and rows.
    pub size: [usize; 2],
    /// By what Radiance's EXPOSURE lines had multiplied the file's values, which were divided by it; 1 without any.
    pub exposure: f64,
    /// Whether the format holds no light above 1, so that lamps and the sun are too dark.
    pub holds_no_light_above_one: bool,
    /// Pixels with a slightly negative channel, which was raised to 0.
    pub raised_pixels: usize,
    /// The lowest of those channels; 0 if there are none.
    pub lowest: f32,
    /// Pixels with a channel that was lowered, because that was asked for.
    pub clamped_pixels: usize,
    /// To what they were lowered; `None` if none was.
    pub clamped_to: Option<f32>,
}

impl MapNotes {
    /// One sentence for each fact that differs from what is expected of a file; none if nothing does.
    pub fn sentences(&self) -> Vec<String> {
        let mut facts = Vec::new();
        if self.holds_no_light_above_one {
            facts.push(
                "a PNG holds no light above 1, so that lamps and the sun are darker than they were; sRGB was made linear".to_owned(),
            );
        }
        if self.exposure != 1.0 {
            facts.push(format!(
                "its values were divided by the EXPOSURE of its header, {}",
                self.exposure
            ));
        }
        if self.raised_pixels > 0 {
            facts.push(format!(
                "small negative channels of {}, such as compression and resampling leave, were raised to 0, the lowest from {}",
                count_pixels(self.raised_pixels),
                self.lowest
            ));
        }
        if let Some(limit) = self.clamped_to {
            facts.push(format!(
                "the light of {} was lowered to {limit}, as asked",
                count_pixels(self.clamped_pixels)
            ));
        }
        let path = self.path.display();
        facts.iter().map(|fact| format!("{path}: {fact}")).collect()
    }
}
