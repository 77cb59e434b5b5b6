//! What the batch methods of [`crate::brdf::Brdf`] and [`crate::direction_sampler::DirectionSampler`] have in common.
//!
//! A batch has one lane for each element of `out`. Every other slice that is passed has an element for each lane; only
//! `wo` may be one direction for all of them. A batch method writes every element of `out`, allocates nothing, and gives each
//! lane the bits of the single call, so a caller may cut its work into batches of any length: the columns of a vector kernel,
//! or the rows of an array that a foreign language owns.

use std::ops::Range;

use glam::Vec3;

/// The given direction of a batch: one for all lanes, or one for each lane.
///
/// Implementations prepare what depends on `wo` alone once for [`Wo::One`], and lane by lane for [`Wo::Each`].
///
/// # Examples
/// ```
/// use merlkit::color::Rgb;
/// use merlkit::glam::Vec3;
/// use merlkit::{LookupRule, Material, Wo};
///
/// let material = Material::resolve("lambert:reflectance=0.5")?.load(LookupRule::Floor)?;
/// let brdf = material.brdf();
/// let wi = [Vec3::Z, Vec3::new(0.6, 0.0, 0.8)];
/// let mut values = [Rgb::ZERO; 2];
/// brdf.eval_batch(Wo::One(Vec3::Z), &wi, &mut values);
/// assert_eq!(values[1], brdf.eval(Vec3::Z, wi[1]));
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Wo<'a> {
    /// The same direction in every lane.
    One(Vec3),
    /// A direction for each lane.
    Each(&'a [Vec3]),
}

impl<'a> Wo<'a> {
    /// The direction of lane `lane`.
    ///
    /// # Panics
    /// If there is one direction for each lane and `lane` is past the last of them.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> Vec3 {
        match self {
            Self::One(wo) => wo,
            Self::Each(wo) => wo[lane],
        }
    }

    /// The directions of a range of lanes.
    ///
    /// # Panics
    /// If there is one direction for each lane and the range reaches past the last of them.
    #[inline(always)]
    pub fn lanes(self, lanes: Range<usize>) -> Self {
        match self {
            Self::One(wo) => Self::One(wo),
            Self::Each(wo) => Self::Each(&wo[lanes]),
        }
    }

    /// Asserts that the slices of a batch are of one length: `inputs` elements of the second input, `outputs` elements of `out`.
    /// Every batch method calls it before anything else.
    ///
    /// # Panics
    /// If the lengths differ.
    #[inline]
    #[track_caller]
    pub fn assert_lanes(self, inputs: usize, outputs: usize) {
        let directions = match self {
            Self::One(_) => outputs,
            Self::Each(wo) => wo.len(),
        };
        assert!(
            directions == outputs && inputs == outputs,
            "the slices of a batch must be of one length, but wo has {directions}, the second input {inputs} \
             and out {outputs} elements"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_those_of_the_slice_or_all_the_same() {
        let each = [Vec3::X, Vec3::Y, Vec3::Z];
        assert_eq!(Wo::Each(&each).lane(1), Vec3::Y);
        assert_eq!(Wo::Each(&each).lanes(1..3).lane(1), Vec3::Z);
        assert_eq!(Wo::One(Vec3::X).lanes(7..9).lane(1), Vec3::X);
    }

    #[test]
    fn equal_lengths_pass() {
        Wo::One(Vec3::Z).assert_lanes(3, 3);
        Wo::Each(&[Vec3::Z; 2]).assert_lanes(2, 2);
        Wo::Each(&[]).assert_lanes(0, 0);
    }

    #[test]
    #[should_panic(expected = "wo has 2, the second input 3 and out 3")]
    fn too_few_directions_panic() {
        Wo::Each(&[Vec3::Z; 2]).assert_lanes(3, 3);
    }

    #[test]
    #[should_panic(expected = "must be of one length")]
    fn too_short_an_output_panics() {
        Wo::One(Vec3::Z).assert_lanes(3, 2);
    }
}
