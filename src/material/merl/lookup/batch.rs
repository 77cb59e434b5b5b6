//! Many evaluations at once, in passes that each do one kind of work.
//!
//! Arithmetic runs over arrays, which the compiler turns into vector code; look-ups in the small tables follow; reading
//! the large table comes last, so that many reads from memory wait at the same time instead of one after another.

use fearless_simd::{Level, dispatch};
use glam::{Vec3, Vec4};

use super::bins::find_bins;
use super::compact;
use super::coordinates::Coordinates;
use super::half_diff_tan2::HalfDiffTan2;
use super::rule::LookupRule;
use super::trilinear::CellNeighbours;
use crate::batch::Wo;
use crate::color::Rgb;
use crate::geometry::merl_axes::AxisBins;
use crate::lanes::{Columns, UnitDirections};
use crate::material::merl::MerlTable;
use crate::material::merl::cells::Cells;

/// Pairs that go through the passes together: all their arrays stay in the first level of cache, and a call for 16 pairs clears
/// few that it has no use for.
const LANES: usize = 32;

/// A block of pairs and the squared tangents of their half and difference angles.
struct Block {
    wo: UnitDirections<LANES>,
    wi: UnitDirections<LANES>,
    tan2: Columns<f64, 4, LANES>,
}

/// f_r of each pair into `out`; the slices are of one length.
pub(in crate::material::merl) fn evaluate(
    table: &MerlTable,
    rule: LookupRule,
    wo: Wo<'_>,
    wi: &[Vec3],
    out: &mut [Rgb],
) {
    dispatch!(Level::new(), _ => evaluate_blocks(table, rule, wo, wi, out));
}

#[inline(always)]
fn evaluate_blocks(table: &MerlTable, rule: LookupRule, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
    let mut block = Block::new(wo);
    for (number, out) in out.chunks_mut(LANES).enumerate() {
        let lanes = number * LANES..number * LANES + out.len();
        block.load(wo.lanes(lanes.clone()), &wi[lanes]);
        match rule {
            LookupRule::Floor => block.floor(table, out),
            LookupRule::Linear => block.trilinear(table, 0.0, out),
            LookupRule::Centred => block.trilinear(table, 0.5, out),
        }
    }
}

impl Block {
    /// A block without pairs; with its `wo`, if that is the same for all blocks.
    #[inline(always)]
    fn new(wo: Wo<'_>) -> Self {
        let wo = match wo {
            Wo::One(wo) => UnitDirections::load(&[wo; LANES]),
            Wo::Each(_) => UnitDirections::load(&[]),
        };
        Self {
            wo,
            wi: UnitDirections::load(&[]),
            tan2: Columns::splat([0.0; 4]),
        }
    }

    /// Takes up to [`LANES`] pairs and computes their squared tangents, NaN for a pair that is not above the horizon.
    #[inline(always)]
    fn load(&mut self, wo: Wo<'_>, wi: &[Vec3]) {
        if let Wo::Each(wo) = wo {
            self.wo = UnitDirections::load(wo);
        }
        self.wi = UnitDirections::load(wi);
        for lane in 0..wi.len().min(LANES) {
            let tan2 = HalfDiffTan2::from_directions(self.wo.get(lane), self.wi.get(lane));
            let upper = self.wo.is_upper(lane) & self.wi.is_upper(lane);
            let theta_h = if upper { tan2.theta_h } else { f64::NAN };
            let columns = [theta_h, tan2.theta_d, tan2.phi_d, tan2.half_turn];
            self.tan2.set(lane, columns);
        }
    }

    #[inline(always)]
    fn tangents(&self, lane: usize) -> HalfDiffTan2 {
        let [theta_h, theta_d, phi_d, half_turn] = self.tan2.get(lane);
        HalfDiffTan2 {
            theta_h,
            theta_d,
            phi_d,
            half_turn,
        }
    }

    /// The value of the bin that holds each pair.
    #[inline(always)]
    fn floor(&self, table: &MerlTable, out: &mut [Rgb]) {
        let axes = AxisBins::get();
        let bins = table.phi_d_bins();
        // Past the end of the table for a pair that has no bin.
        let mut cells = [usize::MAX; LANES];
        let count = out.len().min(LANES);
        for (lane, cell) in cells[..count].iter_mut().enumerate() {
            if let Some(b) = find_bins(axes, self.tangents(lane), self.wi.get(lane), bins) {
                *cell = table.index(b.theta_h, b.theta_d, b.phi_d);
            }
        }
        match table.stored_cells() {
            Cells::F32(stored) => read(stored, &cells, out),
            Cells::F16(stored) => compact::read(stored, table.header().cells(), &cells, out),
            Cells::Rgb9e5(stored) => compact::read(stored, table.header().cells(), &cells, out),
        }
    }

    /// The mean of each pair's neighbours, whose values are taken to be at `bin + offset`.
    #[inline(always)]
    fn trilinear(&self, table: &MerlTable, offset: f64, out: &mut [Rgb]) {
        let bins = table.phi_d_bins();
        let mut places = Columns::<f64, 3, LANES>::splat([0.0; 3]);
        for lane in 0..LANES {
            let place = Coordinates::compute(self.tangents(lane), bins);
            places.set(lane, [place.theta_h, place.theta_d, place.phi_d]);
        }
        let mut neighbours = [None; LANES];
        let count = out.len().min(LANES);
        for (lane, n) in neighbours[..count].iter_mut().enumerate() {
            let [theta_h, theta_d, phi_d] = places.get(lane);
            let place = Coordinates {
                theta_h,
                theta_d,
                phi_d,
            };
            let tan2_theta_h = self.tangents(lane).theta_h;
            *n = CellNeighbours::surround(place, tan2_theta_h, self.wi.get(lane), bins, offset);
        }
        if table.has_partial_cells() {
            read_partial_cells(table, &neighbours, out);
            return;
        }
        match table.stored_cells() {
            Cells::F32(cells) => interpolate(cells, &neighbours, out),
            Cells::F16(cells) => compact::interpolate(cells, &neighbours, out),
            Cells::Rgb9e5(cells) => compact::interpolate(cells, &neighbours, out),
        }
    }
}

/// RGB of each lane's cell; 0 past the end of the table.
#[inline(always)]
fn read(stored: &[Vec4], cells: &[usize; LANES], out: &mut [Rgb]) {
    for (out, &cell) in out.iter_mut().zip(cells) {
        *out = match stored.get(cell) {
            Some(value) => value.truncate(),
            None => Rgb::ZERO,
        };
    }
}

/// The mean of each lane's neighbours.
#[inline(always)]
fn interpolate(cells: &[Vec4], neighbours: &[Option<CellNeighbours>; LANES], out: &mut [Rgb]) {
    for (out, n) in out.iter_mut().zip(neighbours) {
        *out = match n {
            Some(n) => n.mean_of_cells(cells),
            None => Rgb::ZERO,
        };
    }
}

/// [`interpolate`] for a table some cells of which are valid in some channels only.
#[cold]
fn read_partial_cells(
    table: &MerlTable,
    neighbours: &[Option<CellNeighbours>; LANES],
    out: &mut [Rgb],
) {
    for (out, n) in out.iter_mut().zip(neighbours) {
        *out = match n {
            Some(n) => n.mean(table),
            None => Rgb::ZERO,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;
    use crate::material::merl::{CellFormat, decode_embedded};
    use crate::points::Stream;

    /// What is compiled for the oldest processor and what is compiled for this one give the same bits.
    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let table = decode_embedded("nickel").unwrap();
        let mut stream = Stream::new(6);
        let (mut wo, mut wi) = (Vec::new(), Vec::new());
        for _ in 0..2000 {
            for directions in [&mut wo, &mut wi] {
                let (theta, phi) = (stream.next_f64() * 1.57, stream.next_f64() * 6.2);
                directions.push(spherical(theta, phi).as_vec3());
            }
        }
        for format in CellFormat::ALL {
            let table = table.clone().with_cell_format(format).unwrap();
            for rule in LookupRule::ALL {
                let (mut oldest, mut newest) = (vec![Rgb::ZERO; 2000], vec![Rgb::ZERO; 2000]);
                evaluate_blocks(&table, rule, Wo::Each(&wo), &wi, &mut oldest);
                evaluate(&table, rule, Wo::Each(&wo), &wi, &mut newest);
                assert_eq!(oldest, newest, "{rule:?} {format:?}");
            }
        }
    }
}
