//! A light turned about the vertical axis.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Emission, Light, LightSample, MapNotes};

/// Lanes that are turned at a time, on the stack.
const LANES: usize = 64;

/// A light, turned about the axis x = z = 0, counter-clockwise as seen from above.
#[derive(Debug)]
pub(crate) struct TurnedLight {
    light: Arc<dyn Light>,
    sin: f64,
    cos: f64,
}

impl TurnedLight {
    /// `light`, turned by an angle in radians.
    pub(crate) fn new(light: Arc<dyn Light>, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { light, sin, cos }
    }

    /// From where the light was before it was turned to where it is: +z goes to +x in a quarter of a turn.
    fn turn(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.cos * v.x + self.sin * v.z,
            v.y,
            self.cos * v.z - self.sin * v.x,
        )
    }

    /// The inverse of [`Self::turn`].
    fn turn_back(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.cos * v.x - self.sin * v.z,
            v.y,
            self.cos * v.z + self.sin * v.x,
        )
    }

    /// [`Self::turn_back`] of up to [`LANES`] vectors.
    fn turn_all_back(&self, vectors: &[DVec3]) -> [DVec3; LANES] {
        let mut back = [DVec3::ZERO; LANES];
        for (back, vector) in back.iter_mut().zip(vectors) {
            *back = self.turn_back(*vector);
        }
        back
    }
}

impl Light for TurnedLight {
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        let sample = self.light.sample(self.turn_back(from), u)?;
        Some(LightSample {
            wi: self.turn(sample.wi),
            ..sample
        })
    }

    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        let (from, direction) = (self.turn_back(from), self.turn_back(direction));
        self.light.emitted_along(from, direction, reach)
    }

    fn sample_batch(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        super::assert_equal_lengths(out.len(), &[from.len(), u.len()]);
        let lanes = from.chunks(LANES).zip(u.chunks(LANES));
        for ((from, u), out) in lanes.zip(out.chunks_mut(LANES)) {
            let back = self.turn_all_back(from);
            self.light.sample_batch(&back[..from.len()], u, out);
            for sample in out.iter_mut().flatten() {
                sample.wi = self.turn(sample.wi);
            }
        }
    }

    fn emitted_batch(
        &self,
        from: &[DVec3],
        directions: &[DVec3],
        reach: &[f64],
        out: &mut [Option<Emission>],
    ) {
        super::assert_equal_lengths(out.len(), &[from.len(), directions.len(), reach.len()]);
        for (number, out) in out.chunks_mut(LANES).enumerate() {
            let lanes = number * LANES..number * LANES + out.len();
            let back = self.turn_all_back(&from[lanes.clone()]);
            let along = self.turn_all_back(&directions[lanes.clone()]);
            let (back, along) = (&back[..out.len()], &along[..out.len()]);
            self.light.emitted_batch(back, along, &reach[lanes], out);
        }
    }

    fn is_delta(&self) -> bool {
        self.light.is_delta()
    }

    fn surrounds(&self) -> bool {
        self.light.surrounds()
    }

    fn notes(&self) -> Option<&MapNotes> {
        self.light.notes()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::color::Rgb;
    use crate::light::{Point, SkySampling, studio};

    /// A quarter of a turn takes what was in front to the right.
    #[test]
    fn a_turned_point_is_where_it_was_turned_to() {
        let point = Point {
            position: DVec3::new(0.0, 2.0, 3.0),
            intensity: Rgb::ONE,
        };
        let turned = TurnedLight::new(Arc::new(point), FRAC_PI_2);
        let sample = turned.sample(DVec3::ZERO, DVec2::ZERO).unwrap();
        let expected = DVec3::new(3.0, 2.0, 0.0).normalize();
        assert!(sample.wi.abs_diff_eq(expected, 1e-12), "{}", sample.wi);
        assert!(turned.is_delta() && turned.notes().is_none());
    }

    #[test]
    fn batches_have_the_bits_of_single_calls_and_agree_with_themselves() {
        let turned = TurnedLight::new(Arc::new(studio(SkySampling::Importance)), 0.7);
        let count = 2 * LANES + 5;
        let from = vec![DVec3::Y; count];
        let u: Vec<DVec2> = (0..count)
            .map(|i| DVec2::new((i as f64 * 0.618) % 1.0, (i as f64 * 0.413) % 1.0))
            .collect();
        let mut samples = vec![None; count];
        turned.sample_batch(&from, &u, &mut samples);
        let mut directions = Vec::new();
        for (k, sample) in samples.iter().enumerate() {
            assert_eq!(*sample, turned.sample(from[k], u[k]));
            directions.push(sample.unwrap().wi);
        }
        let reach = vec![f64::INFINITY; count];
        let mut emitted = vec![None; count];
        turned.emitted_batch(&from, &directions, &reach, &mut emitted);
        for (k, emission) in emitted.iter().enumerate() {
            assert_eq!(
                *emission,
                turned.emitted_along(from[k], directions[k], reach[k])
            );
            // Close to the edges of pixels, rounding may choose the neighbour.
            let [found, drawn] = [emission.unwrap().pdf, samples[k].unwrap().pdf];
            assert!((found / drawn - 1.0).abs() < 1e-3, "{found} {drawn}");
        }
    }
}
