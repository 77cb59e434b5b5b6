//! Many draws about one `wo`: lookups one by one, arithmetic over arrays, which compilers turn into vector code.
//!
//! The same functions as for single draws, so the same bits.

use glam::{Vec2, Vec3};

use super::mixed::Mixed;
use super::mixture::Mixture;
use super::square::Place;
use super::tables::Blend;
use super::{About, Choice, Found};
use crate::sampler::DirectionSample;

/// Draws that go through the stages together: their arrays fit the fastest cache.
const LANES: usize = 64;

/// Draws that pay for mixing the tables beforehand.
const MANY: usize = 256;

/// A draw from each of `points`.
pub(super) fn sample(about: &About<Blend>, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
    if points.len() < MANY {
        return in_stages(about, points);
    }
    let About { table, square, per_segment, unit, .. } = *about;
    in_stages(&About { table, square, blend: Mixed::new(&about.blend), per_segment, unit }, points)
}

fn in_stages<M: Mixture>(about: &About<M>, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
    let mut samples = Vec::with_capacity(points.len());
    for points in points.chunks(LANES) {
        let mut choices = [Choice::default(); LANES];
        for (choice, &u) in choices.iter_mut().zip(points) {
            *choice = about.choose(u);
        }
        let mut wis = [Vec3::Z; LANES];
        for (wi, choice) in wis.iter_mut().zip(&choices) {
            *wi = about.direction(*choice);
        }
        let mut places = [Place::default(); LANES];
        for (place, &wi) in places.iter_mut().zip(&wis) {
            *place = about.square.place(wi);
        }
        let mut found = [Found::default(); LANES];
        for (found, place) in found.iter_mut().zip(&places).take(points.len()) {
            *found = about.find(place);
        }
        let draw = |i: usize| Some(DirectionSample { wi: wis[i], pdf: about.density(&places[i], found[i]) });
        samples.extend((0..points.len()).map(draw));
    }
    samples
}
