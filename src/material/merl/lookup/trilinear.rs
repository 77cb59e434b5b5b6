//! Trilinear lookup that leaves invalid bins out.

use glam::{Vec3, Vec4};

use super::bins::azimuth;
use super::coordinates::CoordinateTables;
use super::half_diff_tan2::HalfDiffTan2;
use crate::color::Rgb;
use crate::geometry::merl_axes::{THETA_D_BINS, THETA_H_BINS};
use crate::material::merl::MerlTable;
use crate::material::merl::cell_format::ReadCells;
use crate::material::merl::cells::Cells;

/// Two neighbouring bins and the weight of the second.
#[derive(Clone, Copy)]
struct Pair {
    low: u32,
    high: u32,
    weight: f32,
}

impl Pair {
    #[inline(always)]
    fn bins(&self) -> [u32; 2] {
        [self.low, self.high]
    }

    /// Neighbours of a coordinate in units of bins, clamped at both ends of the axis.
    #[inline(always)]
    fn clamped(x: f64, bins: usize) -> Self {
        let end = (bins - 1) as f64;
        let x = if x > 0.0 { x } else { 0.0 };
        let (low, weight) = split(if x < end { x } else { end });
        Self {
            low,
            high: (low + 1).min(bins as u32 - 1),
            weight,
        }
    }

    /// Neighbours of a coordinate from −`bins` to `bins` on an axis that closes on itself.
    #[inline(always)]
    fn periodic(x: f64, bins: usize) -> Self {
        let bins = bins as u32;
        let (low, weight) = split(x + f64::from(u8::from(x < 0.0)) * f64::from(bins));
        Self {
            low: wrap(low, bins),
            high: wrap(low + 1, bins),
            weight,
        }
    }
}

/// A bin below 2 · `bins` on an axis that closes on itself.
#[inline(always)]
fn wrap(bin: u32, bins: u32) -> u32 {
    bin - if bin < bins { 0 } else { bins }
}

/// Integer and fractional part of a number from 0 to 2¹⁶, to 2⁻²³: the bits of a sum whose unit in the last place is 2⁻³².
#[inline(always)]
fn split(x: f64) -> (u32, f32) {
    const SHIFT: f64 = (1 << 20) as f64;
    let bits = (x + SHIFT).to_bits();
    let fraction = f32::from_bits(1f32.to_bits() | bits as u32 >> 9) - 1.0;
    ((bits >> 32) as u32 & 0xffff, fraction)
}

/// The eight bins about a pair of directions and their weights.
#[derive(Clone, Copy)]
pub(in crate::material::merl) struct CellNeighbours {
    theta_h: Pair,
    theta_d: Pair,
    phi_d: Pair,
}

impl CellNeighbours {
    /// The neighbours of a pair whose values lie at `bin + offset`: 0 for edges, ½ for centres; `None` unless both directions are
    /// above the horizon.
    #[inline(always)]
    pub fn find(
        tables: &CoordinateTables,
        tan2: HalfDiffTan2,
        wi: Vec3,
        phi_d_bins: usize,
        offset: f64,
    ) -> Option<Self> {
        if tan2.theta_h.is_nan() {
            return None;
        }
        let x = tables.compute(tan2, phi_d_bins, || azimuth(wi.x, wi.y, phi_d_bins));
        Some(Self {
            theta_h: Pair::clamped(x.theta_h - offset, THETA_H_BINS),
            theta_d: Pair::clamped(x.theta_d - offset, THETA_D_BINS),
            phi_d: Pair::periodic(x.phi_d - offset, phi_d_bins),
        })
    }

    /// Mean of the valid neighbours by their weights, which are renormalised; zero if none is valid. Rounding that would carry
    /// the mean past the largest f32 leaves it there.
    #[inline(always)]
    pub fn mean(&self, table: &MerlTable) -> Rgb {
        if table.has_partial_cells() {
            return self.mean_by_channel(table);
        }
        let bins = table.phi_d_bins();
        match table.stored_cells() {
            Cells::F32(cells) => self.mean_of_cells(cells, bins),
            Cells::F16(cells) => self.mean_of_cells(cells, bins),
            Cells::Rgb9e5(cells) => self.mean_of_cells(cells, bins),
        }
    }

    /// [`Self::mean`] where every cell is valid in all of its channels or in none.
    #[inline(always)]
    pub fn mean_of_cells(&self, cells: &impl ReadCells, phi_d_bins: usize) -> Rgb {
        // Linear along φd, then θd, then θh: low · (1 − w) + high · w on each axis. An invalid cell is zero in all of its
        // numbers, so that the fourth sums the weights of the valid ones.
        let sum = mix(
            self.mean_along_theta_d(cells, phi_d_bins, self.theta_h.low),
            self.mean_along_theta_d(cells, phi_d_bins, self.theta_h.high),
            self.theta_h.weight,
        );
        if sum.w > 0.0 {
            (sum / sum.w).truncate().min(Rgb::splat(f32::MAX))
        } else {
            Rgb::ZERO
        }
    }

    /// The weighted sum of the four neighbours in bin `h` of θh.
    #[inline(always)]
    fn mean_along_theta_d(&self, cells: &impl ReadCells, phi_d_bins: usize, h: u32) -> Vec4 {
        mix(
            self.mean_along_phi_d(cells, row(phi_d_bins, h, self.theta_d.low)),
            self.mean_along_phi_d(cells, row(phi_d_bins, h, self.theta_d.high)),
            self.theta_d.weight,
        )
    }

    /// The weighted sum of two neighbours in a row, which begins at the cell `row`.
    #[inline(always)]
    fn mean_along_phi_d(&self, cells: &impl ReadCells, row: usize) -> Vec4 {
        let low = cells.get(row + self.phi_d.low as usize);
        let high = cells.get(row + self.phi_d.high as usize);
        mix(low, high, self.phi_d.weight)
    }

    /// Bits of one neighbour in each of the four rows. The other one is nearly always in the same line of a cache.
    #[inline(always)]
    pub fn peek(&self, cells: &impl ReadCells, phi_d_bins: usize) -> u32 {
        let p = self.phi_d.low as usize;
        let ([h, next_h], [d, next_d]) = (self.theta_h.bins(), self.theta_d.bins());
        cells.peek(row(phi_d_bins, h, d) + p)
            ^ cells.peek(row(phi_d_bins, h, next_d) + p)
            ^ cells.peek(row(phi_d_bins, next_h, d) + p)
            ^ cells.peek(row(phi_d_bins, next_h, next_d) + p)
    }

    /// [`Self::mean`] of a table that keeps channels apart: each channel has weights of its own. The same bits where all neighbours
    /// are valid in all channels.
    #[cold]
    fn mean_by_channel(&self, table: &MerlTable) -> Rgb {
        // Sums of the values, and of 1 for each channel that is valid: along φd, then θd, then θh.
        let mut along_theta_h = [(Vec4::ZERO, Vec4::ZERO); 2];
        for (mean, h) in along_theta_h.iter_mut().zip(self.theta_h.bins()) {
            let mut along_theta_d = [(Vec4::ZERO, Vec4::ZERO); 2];
            for (mean, d) in along_theta_d.iter_mut().zip(self.theta_d.bins()) {
                let row = table.index(h as usize, d as usize, 0);
                let [low, high] = self.phi_d.bins().map(|p| row + p as usize);
                let low = value_and_valid(table, low);
                let high = value_and_valid(table, high);
                *mean = mix_both(low, high, self.phi_d.weight);
            }
            let [low, high] = along_theta_d;
            *mean = mix_both(low, high, self.theta_d.weight);
        }
        let [low, high] = along_theta_h;
        let (sum, weights) = mix_both(low, high, self.theta_h.weight);
        let mut out = Rgb::ZERO;
        for channel in 0..3 {
            if weights[channel] > 0.0 {
                out[channel] = (sum[channel] / weights[channel]).min(f32::MAX);
            }
        }
        out
    }
}

/// The cell of bin `h` of θh and bin `d` of θd at φd = 0.
#[inline(always)]
fn row(phi_d_bins: usize, h: u32, d: u32) -> usize {
    phi_d_bins * (d as usize + THETA_D_BINS * h as usize)
}

/// A cell's value, and 1 for each of its channels that is valid.
fn value_and_valid(table: &MerlTable, cell: usize) -> (Vec4, Vec4) {
    let valid = table.valid_channels(cell).map(|v| f32::from(u8::from(v)));
    (table.cell(cell), Vec3::from_array(valid).extend(0.0))
}

/// [`mix`] of two pairs.
fn mix_both(low: (Vec4, Vec4), high: (Vec4, Vec4), weight: f32) -> (Vec4, Vec4) {
    (mix(low.0, high.0, weight), mix(low.1, high.1, weight))
}

/// Linear interpolation by two products that don't wait for each other.
#[inline(always)]
fn mix(low: Vec4, high: Vec4, weight: f32) -> Vec4 {
    low * (1.0 - weight) + high * weight
}
