//! Many evaluations at once, in passes that each do one kind of work.
//!
//! Arithmetic runs over arrays, which the compiler turns into vector code; look-ups in the small tables follow; reading
//! the large table comes last, so that many reads from memory wait at the same time instead of one after another.

use glam::Vec3;

use super::bins::BinTables;
use super::coordinates::CoordinateTables;
use super::half_diff_tan2::Tangents;
use super::trilinear::Neighbours;
use crate::color::Rgb;
use crate::geometry::{is_unit_upper, unit_upper};
use crate::material::merl::LookupRule;
use crate::material::merl::MerlTable;

/// Pairs that go through the passes together: all their arrays stay in the first level of cache, and a call for 16 pairs clears
/// few that it has no use for.
const LANES: usize = 32;

/// Squared tangents of some pairs, and the directions they came from.
pub(in crate::material::merl) struct Batch {
    wo: [[f32; LANES]; 3],
    wi: [[f32; LANES]; 3],
    theta_h: [f64; LANES],
    theta_d: [f64; LANES],
    phi_d: [f64; LANES],
    half_turn: [f64; LANES],
}

/// Evaluates `pairs` into `out`, as many as the shorter of them.
pub(in crate::material::merl) fn evaluate(
    table: &MerlTable,
    rule: LookupRule,
    mut pairs: impl Iterator<Item = (Vec3, Vec3)>,
    out: &mut [Rgb],
) {
    let mut batch = Batch::new();
    for out in out.chunks_mut(LANES) {
        let count = batch.fill(&mut pairs, out.len());
        let out = &mut out[..count];
        match rule {
            LookupRule::Floor => batch.floor(table, out),
            LookupRule::Linear => batch.trilinear(table, 0.0, out),
            LookupRule::Centred => batch.trilinear(table, 0.5, out),
        }
    }
}

impl Batch {
    fn new() -> Self {
        let (directions, tangents) = ([[0.0; LANES]; 3], [0.0; LANES]);
        Self {
            wo: directions,
            wi: directions,
            theta_h: tangents,
            theta_d: tangents,
            phi_d: tangents,
            half_turn: tangents,
        }
    }

    /// Takes up to `limit` pairs and computes their tangents; returns their number.
    #[inline(always)]
    fn fill(&mut self, pairs: &mut impl Iterator<Item = (Vec3, Vec3)>, limit: usize) -> usize {
        let mut count = 0;
        for (k, (wo, wi)) in (0..limit.min(LANES)).zip(pairs) {
            for axis in 0..3 {
                self.wo[axis][k] = wo[axis];
                self.wi[axis][k] = wi[axis];
            }
            count = k + 1;
        }
        // Nearly all are unit directions: one count for all of them, without a branch for each.
        let unit = |k: usize| is_unit_upper(at(&self.wo, k)) & is_unit_upper(at(&self.wi, k));
        if (0..count.min(LANES))
            .map(|k| u32::from(!unit(k)))
            .sum::<u32>()
            > 0
        {
            self.renormalise(count);
        }
        for k in 0..count.min(LANES) {
            let tan2 = Tangents::of(at(&self.wo, k), at(&self.wi, k));
            self.theta_h[k] = tan2.theta_h;
            self.theta_d[k] = tan2.theta_d;
            self.phi_d[k] = tan2.phi_d;
            self.half_turn[k] = tan2.half_turn;
        }
        count
    }

    /// Brings all to unit length, and what is no direction to NaN.
    #[cold]
    fn renormalise(&mut self, count: usize) {
        for k in 0..count.min(LANES) {
            for w in [&mut self.wo, &mut self.wi] {
                let unit = unit_upper(at(w, k)).unwrap_or(Vec3::NAN);
                for axis in 0..3 {
                    w[axis][k] = unit[axis];
                }
            }
        }
    }

    #[inline(always)]
    fn tangents(&self, k: usize) -> Tangents {
        Tangents {
            theta_h: self.theta_h[k],
            theta_d: self.theta_d[k],
            phi_d: self.phi_d[k],
            half_turn: self.half_turn[k],
        }
    }

    fn floor(&self, table: &MerlTable, out: &mut [Rgb]) {
        let tables = BinTables::get();
        let bins = table.phi_d_bins();
        // Past the end of the table for a pair that has no bin.
        let mut cells = [usize::MAX; LANES];
        let count = out.len().min(LANES);
        for (k, cell) in cells[..count].iter_mut().enumerate() {
            if let Some(b) = tables.bins(self.tangents(k), at(&self.wi, k), bins) {
                *cell = table.index(b.theta_h, b.theta_d, b.phi_d);
            }
        }
        for (out, &cell) in out.iter_mut().zip(&cells) {
            *out = table.cells().get(cell).map_or(Rgb::ZERO, |c| c.truncate());
        }
    }

    fn trilinear(&self, table: &MerlTable, offset: f64, out: &mut [Rgb]) {
        let tables = CoordinateTables::get();
        let bins = table.phi_d_bins();
        let mut neighbours = [None; LANES];
        let count = out.len().min(LANES);
        for (k, n) in neighbours[..count].iter_mut().enumerate() {
            *n = Neighbours::of(tables, self.tangents(k), at(&self.wi, k), bins, offset);
        }
        for (out, n) in out.iter_mut().zip(&neighbours) {
            *out = n.as_ref().map_or(Rgb::ZERO, |n| n.mean(table));
        }
    }
}

#[inline(always)]
fn at(w: &[[f32; LANES]; 3], k: usize) -> Vec3 {
    Vec3::new(w[0][k], w[1][k], w[2][k])
}
