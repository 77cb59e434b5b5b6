//! Many draws or densities at once: lookups one by one, arithmetic over arrays, which compilers turn into vector code.
//!
//! The same functions as for single ones, so the same bits.

use glam::{Vec2, Vec3};

use super::mixed::Mixed;
use super::mixture::Mixture;
use super::square::{Place, Square};
use super::tables::Blend;
use super::{About, Choice, Found, HalfVectorTable};
use crate::batch::Wo;
use crate::direction_sampler::DirectionSample;
use crate::geometry::unit_upper;
use crate::lanes::{Columns, UnitDirections};

/// Draws that go through the stages together: their arrays fit the fastest cache.
pub(in crate::sampler) const LANES: usize = 64;

/// Draws about one `wo` that pay for mixing the tables beforehand.
const MANY: usize = 256;

/// A draw from each of `u`; the slices are of one length.
pub(super) fn sample(
    table: &HalfVectorTable,
    wo: Wo<'_>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => sample_one(&table.about(Square::about(wo)), u, out),
            None => out.fill(None),
        },
        Wo::Each(wo) => sample_each(table, wo, u, out),
    }
}

/// A draw from each of `u` about one `wo`, from mixed tables if they are many and the tables of an ordinary size.
fn sample_one(about: &About<Blend>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
    if u.len() < MANY {
        return sample_about(*about, u, out);
    }
    match about.blend.node_count() {
        0..=1024 => sample_mixed::<1024>(about, u, out),
        1025..=4096 => sample_mixed::<4096>(about, u, out),
        _ => sample_about(*about, u, out),
    }
}

/// Never inlined, so that other draws don't clear the arrays of mixed tables.
#[inline(never)]
fn sample_mixed<const NODES: usize>(
    about: &About<Blend>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    let mixed = Mixed::<NODES>::new(&about.blend);
    let About {
        table,
        square,
        per_segment,
        unit,
        ..
    } = *about;
    let about = About {
        table,
        square,
        blend: &mixed,
        per_segment,
        unit,
    };
    sample_about(about, u, out);
}

fn sample_about<M: Mixture + Copy>(
    about: About<M>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    for (u, out) in u.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let draws = Draws::of(|_| about, u);
        for (k, out) in out.iter_mut().enumerate() {
            *out = Some(draws.sample(k));
        }
    }
}

fn sample_each(
    table: &HalfVectorTable,
    wo: &[Vec3],
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    for ((wo, u), out) in wo
        .chunks(LANES)
        .zip(u.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let views = Views::about(table, &wo, out.len());
        let draws = Draws::of(|k| views.at(k), u);
        for (k, out) in out.iter_mut().enumerate().take(LANES) {
            *out = wo.is_upper(k).then(|| draws.sample(k));
        }
    }
}

/// The density of each of `wi`; the slices are of one length.
pub(super) fn pdf(table: &HalfVectorTable, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => pdf_one(&table.about(Square::about(wo)), wi, out),
            None => out.fill(0.0),
        },
        Wo::Each(wo) => pdf_each(table, wo, wi, out),
    }
}

fn pdf_one(about: &About<Blend>, wi: &[Vec3], out: &mut [f32]) {
    for (wi, out) in wi.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let wi = UnitDirections::load(wi);
        let pdfs = densities(|_| *about, wi.columns(), out.len());
        for (k, out) in out.iter_mut().enumerate().take(LANES) {
            *out = if wi.is_upper(k) { pdfs[k] } else { 0.0 };
        }
    }
}

fn pdf_each(table: &HalfVectorTable, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    for ((wo, wi), out) in wo
        .chunks(LANES)
        .zip(wi.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let (wo, wi) = (UnitDirections::load(wo), UnitDirections::load(wi));
        let views = Views::about(table, &wo, out.len());
        let pdfs = densities(|k| views.at(k), wi.columns(), out.len());
        for (k, out) in out.iter_mut().enumerate().take(LANES) {
            let upper = wo.is_upper(k) & wi.is_upper(k);
            *out = if upper { pdfs[k] } else { 0.0 };
        }
    }
}

/// What depends on the `wo` of each lane alone.
struct Views<'a> {
    table: &'a HalfVectorTable,
    squares: Columns<f32, 8, LANES>,
    blends: [Blend<'a>; LANES],
}

impl<'a> Views<'a> {
    fn about(table: &'a HalfVectorTable, wo: &UnitDirections<LANES>, count: usize) -> Self {
        let mut squares = Columns::splat([0.0; 8]);
        for k in 0..count.min(LANES) {
            squares.set(k, Square::about(wo.get(k)).to_array());
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
    wi: Columns<f32, 3, LANES>,
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
        let mut choices = Columns::<f32, 9, LANES>::splat([0.0; 9]);
        for ((k, &(row, share)), u) in rows.iter().enumerate().zip(points) {
            choices.set(k, about(k).choose_in(row, share, u.y).to_array());
        }
        let mut wi = Columns::splat([0.0; 3]);
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
    wi: &Columns<f32, 3, LANES>,
    count: usize,
) -> [f32; LANES] {
    let count = count.min(LANES);
    let (mut places, mut tan2) = (Columns::<f32, 3, LANES>::splat([0.0; 3]), [0.0; LANES]);
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
    let mut found = Columns::<f32, 8, LANES>::splat([0.0; 8]);
    for k in 0..count {
        found.set(k, about(k).find(&place(k)).to_array());
    }
    let mut pdf = [0.0; LANES];
    for (k, pdf) in pdf[..count].iter_mut().enumerate() {
        *pdf = about(k).density(&place(k), Found::from_array(found.get(k)));
    }
    pdf
}
