//! An environment as a light: one direction, or many in stages.

use glam::{DVec2, DVec3};

use super::equirectangular::{direction_of, square_of};
use super::{Environment, MapNotes};
use crate::light::{Emission, Light, LightSample, assert_equal_lengths};

/// Directions that go through the stages of a batch together: arithmetic is vector code, and reads of the map overlap.
const LANES: usize = 64;

impl Light for Environment {
    fn notes(&self) -> Option<&MapNotes> {
        Self::notes(self)
    }

    fn sample(&self, _from: DVec3, u: DVec2) -> Option<LightSample> {
        let (longitude, cos) = self.choose(u);
        let wi = direction_of(longitude, cos);
        light_sample(wi, self.emission_at(square_of(wi)))
    }

    fn emitted_along(&self, _from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        if reach < f64::INFINITY {
            return None;
        }
        Some(self.emission_at(square_of(direction)))
    }

    fn sample_batch(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        assert_equal_lengths(out.len(), &[from.len(), u.len()]);
        let mut places = [(0.0, 0.0); LANES];
        let mut squares = [DVec2::ZERO; LANES];
        let mut directions = [DVec3::Y; LANES];
        for (u, out) in u.chunks(LANES).zip(out.chunks_mut(LANES)) {
            // Choose a longitude and the cosine of a polar angle: searches in tables, whose reads overlap.
            for (place, &u) in places.iter_mut().zip(u) {
                *place = self.choose(u);
            }
            // Turn them into directions, and these into points of the map: arithmetic only, which becomes vector code.
            let chosen_places = places[..u.len()]
                .iter()
                .zip(&mut directions)
                .zip(&mut squares);
            for ((&(longitude, cos), direction), square) in chosen_places {
                *direction = direction_of(longitude, cos);
                *square = square_of(*direction);
            }
            // Read radiance and density at the points.
            for ((out, &wi), &p) in out.iter_mut().zip(&directions).zip(&squares) {
                *out = light_sample(wi, self.emission_at(p));
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
        assert_equal_lengths(out.len(), &[from.len(), directions.len(), reach.len()]);
        let chunks = directions.chunks(LANES).zip(reach.chunks(LANES));
        let mut squares = [DVec2::ZERO; LANES];
        for ((directions, reach), out) in chunks.zip(out.chunks_mut(LANES)) {
            // Find the points of the map: arithmetic only. Then read radiance and density at them.
            for (square, &direction) in squares.iter_mut().zip(directions) {
                *square = square_of(direction);
            }
            for ((out, &p), &reach) in out.iter_mut().zip(&squares).zip(reach) {
                *out = if reach < f64::INFINITY {
                    None
                } else {
                    Some(self.emission_at(p))
                };
            }
        }
    }
}

/// The light of a chosen direction; `None` where the density that chose it is 0.
fn light_sample(wi: DVec3, emission: Emission) -> Option<LightSample> {
    let Emission { radiance, pdf } = emission;
    (pdf > 0.0).then_some(LightSample {
        wi,
        distance: f64::INFINITY,
        radiance,
        pdf,
    })
}
