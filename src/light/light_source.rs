//! What every kind of light says about itself before it is loaded.

use glam::DVec3;

use super::{Light, SkySampling};
use crate::Result;

/// Where a light goes that is named by a word alone: it is placed relative to the objects that it is to light.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The middle of the objects, world space.
    pub subject: DVec3,
    /// Where a photographer would put the key light: above the objects, to the left, in front of them.
    pub key: DVec3,
}

/// What every kind of light says about itself; each implements it in its own file.
pub(super) trait LightSource: Sized {
    /// The words that name it, as help and errors list them.
    const WORDS: &'static [&'static str];

    /// The light that a word names; `None` if the word names no light of this kind.
    ///
    /// # Errors
    /// [`Error::Argument`] for a word of this kind with a value outside its domain.
    fn from_word(word: &str, placement: &Placement) -> Option<Result<Self>>;

    /// What it is, in a word or two.
    fn describe(&self) -> String;

    /// Whether it is a point or parallel: no direction drawn by chance can hit it.
    fn is_delta(&self) -> bool;

    /// Whether its description alone shows that it gives no light.
    fn is_dark(&self) -> bool;

    /// Whether its numbers are finite and its emission is not negative.
    fn is_valid(&self) -> bool;

    /// Whether it surrounds the scene, so that tables may choose directions to it.
    fn is_environment(&self) -> bool {
        false
    }

    /// The light, ready to be sampled; `sampling` is for environments.
    ///
    /// # Errors
    /// Those of reading its file, where it has one.
    fn load(&self, sampling: SkySampling) -> Result<Box<dyn Light>>;
}

/// Numbers with commas between them; `None` if a word is none.
pub(super) fn read_numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|n| n.trim().parse().ok()).collect()
}
