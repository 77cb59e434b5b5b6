//! Many draws or densities at once: lookups one by one, arithmetic over arrays, which compilers turn into vector code.
//!
//! The same functions as for single ones, so the same bits.

use glam::{Vec2, Vec3};

use super::lanes::{Columns, LANES, Units};
use super::mixed::Mixed;
use super::mixture::Mixture;
use super::square::{Place, Square};
use super::tables::Blend;
use super::{About, Choice, Found, HalfVectorTable};
use crate::direction_sampler::DirectionSample;

/// Draws about one `wo` that pay for mixing the tables beforehand.
const MANY: usize = 256;

/// A draw about one `wo` from each of `points`.
pub(super) fn sample(about: &About<Blend>, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
    if points.len() < MANY {
        return sample_about(*about, points);
    }
    let mixed = Mixed::new(&about.blend);
    let About {
        table,
        square,
        per_segment,
        unit,
        ..
    } = *about;
    sample_about(
        About {
            table,
            square,
            blend: &mixed,
            per_segment,
            unit,
        },
        points,
    )
}

fn sample_about<M: Mixture + Copy>(
    about: About<M>,
    points: &[Vec2],
) -> Vec<Option<DirectionSample>> {
    let mut samples = Vec::with_capacity(points.len());
    for points in points.chunks(LANES) {
        let draws = Draws::of(|_| about, points);
        samples.extend((0..points.len()).map(|k| Some(draws.sample(k))));
    }
    samples
}

/// A draw from each of `points` about the `wo` of the same place; the slices are of one length.
pub(super) fn sample_pairs(
    table: &HalfVectorTable,
    wo: &[Vec3],
    points: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    for ((wo, points), out) in wo
        .chunks(LANES)
        .zip(points.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let views = Views::about(table, &Units::of(wo), out.len());
        let draws = Draws::of(|k| views.at(k), points);
        for (k, out) in out.iter_mut().enumerate().take(LANES) {
            *out = views.upper[k].then(|| draws.sample(k));
        }
    }
}

/// The density of each of `wi` about the `wo` of the same place; the slices are of one length.
pub(super) fn pdf_pairs(table: &HalfVectorTable, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    for ((wo, wi), out) in wo
        .chunks(LANES)
        .zip(wi.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let views = Views::about(table, &Units::of(wo), out.len());
        let wi = Units::of(wi);
        let pdfs = densities(|k| views.at(k), &wi.directions, out.len());
        for (k, out) in out.iter_mut().enumerate().take(LANES) {
            *out = if views.upper[k] & wi.upper[k] {
                pdfs[k]
            } else {
                0.0
            };
        }
    }
}

/// What depends on the `wo` of each lane alone.
struct Views<'a> {
    table: &'a HalfVectorTable,
    squares: Columns<8>,
    blends: [Blend<'a>; LANES],
    /// Lanes that have a `wo`.
    upper: [bool; LANES],
}

impl<'a> Views<'a> {
    fn about(table: &'a HalfVectorTable, wo: &Units, count: usize) -> Self {
        let mut squares = Columns::ZERO;
        for k in 0..count.min(LANES) {
            squares.set(k, Square::about(wo.directions.get(k).into()).to_array());
        }
        let blend = |k| table.tables.at(Square::from_array(squares.get(k)).cos_o());
        let mut blends = [blend(0); LANES];
        for (k, out) in blends.iter_mut().enumerate().take(count).skip(1) {
            *out = blend(k);
        }
        Self {
            table,
            squares,
            blends,
            upper: wo.upper,
        }
    }

    #[inline(always)]
    fn at(&self, k: usize) -> About<'a, Blend<'a>> {
        self.table
            .with(Square::from_array(self.squares.get(k)), self.blends[k])
    }
}

/// Directions drawn and their densities.
struct Draws {
    wi: Columns<3>,
    pdf: [f32; LANES],
}

impl Draws {
    /// `about` tells what the draw of a lane is about.
    #[inline(always)]
    fn of<'a, M: Mixture + 'a>(about: impl Fn(usize) -> About<'a, M>, points: &[Vec2]) -> Self {
        // A search waits for each of its steps: alone in a loop, many of them fit the processor at once.
        let mut rows = [(0, 0.0); LANES];
        for ((k, row), u) in rows.iter_mut().enumerate().zip(points) {
            let (found, share) = about(k).blend.find_row(u.x);
            *row = (found.index, share);
        }
        let mut choices = Columns::ZERO;
        for ((k, &(row, share)), u) in rows.iter().enumerate().zip(points) {
            choices.set(k, about(k).choose_in(row, share, u.y).to_array());
        }
        let mut wi = Columns::ZERO;
        for k in 0..points.len().min(LANES) {
            wi.set(
                k,
                about(k)
                    .direction(Choice::from_array(choices.get(k)))
                    .to_array(),
            );
        }
        let pdf = densities(about, &wi, points.len());
        Self { wi, pdf }
    }

    #[inline(always)]
    fn sample(&self, k: usize) -> DirectionSample {
        DirectionSample {
            wi: self.wi.get(k).into(),
            pdf: self.pdf[k],
        }
    }
}

/// Densities of the first `count` of `wi`.
#[inline(always)]
fn densities<'a, M: Mixture + 'a>(
    about: impl Fn(usize) -> About<'a, M>,
    wi: &Columns<3>,
    count: usize,
) -> [f32; LANES] {
    let count = count.min(LANES);
    let (mut places, mut tan2) = (Columns::ZERO, [0.0; LANES]);
    for (k, tan2) in tan2[..count].iter_mut().enumerate() {
        let place = about(k).square.place(wi.get(k).into());
        places.set(k, [place.cap, place.b, place.jacobian]);
        *tan2 = place.tan2;
    }
    let place = |k: usize| {
        let [cap, b, jacobian] = places.get(k);
        Place {
            cap,
            tan2: tan2[k],
            b,
            jacobian,
        }
    };
    let mut found = Columns::ZERO;
    for k in 0..count {
        found.set(k, about(k).find(&place(k)).to_array());
    }
    let mut pdf = [0.0; LANES];
    for (k, pdf) in pdf[..count].iter_mut().enumerate() {
        *pdf = about(k).density(&place(k), Found::from_array(found.get(k)));
    }
    pdf
}
