//! Sources of light: how to sample them from a point, and what a ray receives from them.
//!
//! World space, `y` up. Lights have no body: they block nothing, and whether something blocks them is the renderer's
//! business.
//!
//! A [`LightSpec`] describes a light by numbers and names; a [`Light`] is loaded and ready to be sampled. Each kind of light
//! is one file and one line of the list in `spec.rs`.

mod area;
mod directional;
mod environment;
mod light_source;
mod luminous_object;
mod point;
mod spec;
mod turned;

pub use area::Area;
pub use directional::Directional;
pub use environment::{
    Environment, EnvironmentSource, MapNotes, RadianceClamp, SkySampling, broad_lamps, studio,
};
pub use light_source::Placement;
pub use point::Point;
pub use spec::LightSpec;

pub(crate) use turned::TurnedLight;

use std::fmt::Debug;

use glam::{DVec2, DVec3};

use crate::color::Rgb;

/// A direction towards a light, chosen from a point.
///
/// The example of [`Light`] samples an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Towards the light, world space, unit length.
    pub wi: DVec3,
    /// How far the light is; infinite for distant ones.
    pub distance: f64,
    /// Radiance that arrives along `wi`; for a delta light, its irradiance on a surface that faces it.
    pub radiance: Rgb,
    /// Density per solid angle, sr⁻¹, finite and > 0; 1 for a delta light.
    pub pdf: f64,
}

/// What a ray receives from a light that has an extent.
///
/// The example of [`Light`] samples an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance along the ray.
    pub radiance: Rgb,
    /// Density per solid angle of [`Light::sample`] choosing this direction from the ray's origin, sr⁻¹; may be 0.
    pub pdf: f64,
}

/// A source of light.
///
/// # Examples
/// ```
/// use merlkit::color::Rgb;
/// use merlkit::glam::{DVec2, DVec3};
/// use merlkit::light::{Environment, Light};
///
/// let sky = Environment::uniform(Rgb::ONE)?;
/// let sample = sky.sample(DVec3::ZERO, DVec2::new(0.3, 0.7)).expect("light from everywhere");
/// assert_eq!(sample.radiance, Rgb::ONE);
/// let emitted = sky.emitted_along(DVec3::ZERO, sample.wi, f64::INFINITY).expect("it surrounds us");
/// assert!((emitted.pdf / sample.pdf - 1.0).abs() < 1e-6);
/// # Ok::<(), merlkit::Error>(())
/// ```
pub trait Light: Debug + Send + Sync {
    /// Chooses a direction towards the light from a point of the unit square; `None` where none of its light arrives.
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample>;

    /// What the light emits along a ray that looks from `from` along the unit vector `direction`, within the distance
    /// `reach`; `None` if the ray misses the light, and always for delta lights.
    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission>;

    /// [`Self::sample`] for many points at once: `out[k]` becomes `sample(from[k], u[k])`, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[track_caller]
    fn sample_batch(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        assert_equal_lengths(out.len(), &[from.len(), u.len()]);
        for (k, sample) in out.iter_mut().enumerate() {
            *sample = self.sample(from[k], u[k]);
        }
    }

    /// [`Self::emitted_along`] for many rays at once: `out[k]` becomes `emitted_along(from[k], directions[k], reach[k])`, to
    /// the bit.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[track_caller]
    fn emitted_batch(
        &self,
        from: &[DVec3],
        directions: &[DVec3],
        reach: &[f64],
        out: &mut [Option<Emission>],
    ) {
        assert_equal_lengths(out.len(), &[from.len(), directions.len(), reach.len()]);
        for (k, emission) in out.iter_mut().enumerate() {
            *emission = self.emitted_along(from[k], directions[k], reach[k]);
        }
    }

    /// Whether the light has no extent: there is one direction to it from each point, and no ray hits it.
    fn is_delta(&self) -> bool {
        false
    }

    /// Whether every ray meets the light that nothing is in the way of, as it does an environment.
    fn surrounds(&self) -> bool {
        false
    }

    /// What was found and changed in the file that the light was read from; `None` for lights that come from none.
    fn notes(&self) -> Option<&MapNotes> {
        None
    }

    /// Points whose convex hull holds the light, world space; none where that is not known. With them the plan of a scene finds
    /// out that nothing is in the way of a [`LightSpec::Object`].
    fn hull(&self) -> Vec<DVec3> {
        Vec::new()
    }
}

/// Every lane of a batch needs one element of each slice.
#[track_caller]
fn assert_equal_lengths(results: usize, inputs: &[usize]) {
    for &input in inputs {
        assert_eq!(input, results, "slices of a batch differ in length");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A light of each way to be batched: by the trait's default, and in stages.
    fn lights() -> [Box<dyn Light>; 2] {
        let point = Point {
            position: DVec3::Y,
            intensity: Rgb::ONE,
        };
        [
            Box::new(point),
            Box::new(Environment::uniform(Rgb::ONE).unwrap()),
        ]
    }

    #[test]
    fn batches_of_unequal_lengths_panic() {
        for light in lights() {
            let light = &*light;
            for (from, u, out) in [(2, 3, 3), (3, 2, 3), (3, 3, 2), (3, 3, 4)] {
                let batch = std::panic::AssertUnwindSafe(|| {
                    let mut samples = vec![None; out];
                    light.sample_batch(
                        &vec![DVec3::ZERO; from],
                        &vec![DVec2::ZERO; u],
                        &mut samples,
                    );
                });
                assert!(std::panic::catch_unwind(batch).is_err(), "{from} {u} {out}");
            }
            for (from, along, reach, out) in
                [(2, 3, 3, 3), (3, 2, 3, 3), (3, 3, 2, 3), (3, 3, 3, 2)]
            {
                let batch = std::panic::AssertUnwindSafe(|| {
                    let mut emissions = vec![None; out];
                    light.emitted_batch(
                        &vec![DVec3::ZERO; from],
                        &vec![DVec3::Y; along],
                        &vec![1.0; reach],
                        &mut emissions,
                    );
                });
                assert!(std::panic::catch_unwind(batch).is_err());
            }
        }
    }

    #[test]
    fn batches_of_equal_lengths_are_filled() {
        for light in lights() {
            let (from, u) = ([DVec3::ZERO; 3], [DVec2::splat(0.25); 3]);
            let mut samples = [None; 3];
            light.sample_batch(&from, &u, &mut samples);
            assert_eq!(samples, [light.sample(from[0], u[0]); 3]);
            assert!(samples[0].is_some());
            light.sample_batch(&[], &[], &mut []);
            light.emitted_batch(&[], &[], &[], &mut []);
        }
    }
}
