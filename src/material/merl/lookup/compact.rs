//! Batches of lookups in compact cells: the words of all lanes first, then arithmetic on columns of them.
//!
//! The loops that read do nothing else, so that many reads wait for memory at the same time. Decoding and interpolation are vector
//! code over the lanes, and do for each lane what [`CellNeighbours::mean_of_cells`] does, in the same order.

#![allow(clippy::needless_range_loop)] // Several columns are read at the same lane.

use super::trilinear::CellNeighbours;
use crate::color::Rgb;
use crate::lanes::Columns;
use crate::material::merl::cell_format::CompactCells;

/// A word or two of some cells in each lane.
type Words<const WORDS: usize, const CELLS: usize, const LANES: usize> =
    [[[u32; LANES]; WORDS]; CELLS];

/// RGB of each lane's cell; 0 past the end of the table, which has `count` cells.
#[inline(always)]
pub(super) fn read<const WORDS: usize, const LANES: usize>(
    table: &impl CompactCells<WORDS>,
    count: usize,
    cells: &[usize; LANES],
    out: &mut [Rgb],
) {
    // A word of 0 is black in every format.
    let mut words: Words<WORDS, 1, LANES> = [[[0; LANES]; WORDS]; 1];
    for lane in 0..LANES {
        if cells[lane] < count {
            store(&mut words[0], lane, table.words(cells[lane]));
        }
    }
    let mut rgb = Columns::<f32, 3, LANES>::splat([0.0; 3]);
    for lane in 0..LANES {
        let [red, green, blue, _] = table.decode(load(&words[0], lane));
        rgb.set(lane, [red, green, blue]);
    }
    write(&rgb, out);
}

/// The mean of each lane's neighbours; 0 without any.
#[inline(always)]
pub(super) fn interpolate<const WORDS: usize, const LANES: usize>(
    table: &impl CompactCells<WORDS>,
    neighbours: &[Option<CellNeighbours>; LANES],
    out: &mut [Rgb],
) {
    // Step 1: the words of the eight cells, and the weights.
    let mut words: Words<WORDS, 8, LANES> = [[[0; LANES]; WORDS]; 8];
    let mut weights = Columns::<f32, 3, LANES>::splat([0.0; 3]);
    for lane in 0..out.len().min(LANES) {
        if let Some(n) = &neighbours[lane] {
            let cells = n.cells();
            for k in 0..8 {
                store(&mut words[k], lane, table.words(cells[k] as usize));
            }
            weights.set(lane, n.weights());
        }
    }
    // Step 2: linear along φd, θd and θh, and the sum divided by that of the valid cells' weights.
    let mut rgb = Columns::<f32, 3, LANES>::splat([0.0; 3]);
    for lane in 0..LANES {
        let [theta_h, theta_d, phi_d] = weights.get(lane);
        let a = mean_along_phi_d(table, [&words[0], &words[1]], lane, phi_d);
        let b = mean_along_phi_d(table, [&words[2], &words[3]], lane, phi_d);
        let low = mix(a, b, theta_d);
        let a = mean_along_phi_d(table, [&words[4], &words[5]], lane, phi_d);
        let b = mean_along_phi_d(table, [&words[6], &words[7]], lane, phi_d);
        let high = mix(a, b, theta_d);
        let [red, green, blue, valid] = mix(low, high, theta_h);
        // Where no cell is valid, all sums are 0.
        let valid = if valid > 0.0 { valid } else { 1.0 };
        rgb.set(lane, [red / valid, green / valid, blue / valid]);
    }
    write(&rgb, out);
}

/// The weighted sum of the two neighbours in a row.
#[inline(always)]
fn mean_along_phi_d<const WORDS: usize, const LANES: usize>(
    table: &impl CompactCells<WORDS>,
    [low, high]: [&[[u32; LANES]; WORDS]; 2],
    lane: usize,
    weight: f32,
) -> [f32; 4] {
    mix(
        table.decode(load(low, lane)),
        table.decode(load(high, lane)),
        weight,
    )
}

/// Linear interpolation by two products, number by number.
#[inline(always)]
fn mix(low: [f32; 4], high: [f32; 4], weight: f32) -> [f32; 4] {
    let mut mean = [0.0; 4];
    for i in 0..4 {
        mean[i] = low[i] * (1.0 - weight) + high[i] * weight;
    }
    mean
}

#[inline(always)]
fn store<const WORDS: usize, const LANES: usize>(
    columns: &mut [[u32; LANES]; WORDS],
    lane: usize,
    words: [u32; WORDS],
) {
    for i in 0..WORDS {
        columns[i][lane] = words[i];
    }
}

#[inline(always)]
fn load<const WORDS: usize, const LANES: usize>(
    columns: &[[u32; LANES]; WORDS],
    lane: usize,
) -> [u32; WORDS] {
    let mut words = [0; WORDS];
    for i in 0..WORDS {
        words[i] = columns[i][lane];
    }
    words
}

#[inline(always)]
fn write<const LANES: usize>(rgb: &Columns<f32, 3, LANES>, out: &mut [Rgb]) {
    for lane in 0..out.len().min(LANES) {
        out[lane] = rgb.get(lane).into();
    }
}
