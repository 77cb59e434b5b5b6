//! Trilinear lookup that leaves invalid bins out.

use glam::{Vec3, Vec4};

use super::bins::azimuth;
use super::coordinates::Coordinates;
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

/// The eight cells about a pair of directions and their weights.
#[derive(Clone, Copy)]
pub(in crate::material::merl) struct CellNeighbours {
    /// The nearer of two cells along φd in each row: low and high θd at low θh, then at high θh.
    rows: [u32; 4],
    /// From these to the others along φd, modulo 2³²: 1, or back to the row's start.
    phi_d_step: u32,
    /// Weights of the second neighbour along θh, θd and φd.
    weights: [f32; 3],
}

impl CellNeighbours {
    /// The neighbours of a pair whose values lie at `bin + offset`: 0 for edges, ½ for centres; `None` unless both directions are
    /// above the horizon.
    #[inline(always)]
    pub fn find(tan2: HalfDiffTan2, wi: Vec3, phi_d_bins: usize, offset: f64) -> Option<Self> {
        let place = Coordinates::compute(tan2, phi_d_bins);
        Self::surround(place, tan2.theta_h, wi, phi_d_bins, offset)
    }

    /// [`Self::find`] from the coordinates of a pair and its tan²θh, which is NaN unless both directions are above the horizon.
    #[inline(always)]
    pub fn surround(
        place: Coordinates,
        tan2_theta_h: f64,
        wi: Vec3,
        phi_d_bins: usize,
        offset: f64,
    ) -> Option<Self> {
        if tan2_theta_h.is_nan() {
            return None;
        }
        let phi_d = if tan2_theta_h > 0.0 {
            place.phi_d
        } else {
            azimuth(wi.x, wi.y, phi_d_bins)
        };
        let h = Pair::clamped(place.theta_h - offset, THETA_H_BINS);
        let d = Pair::clamped(place.theta_d - offset, THETA_D_BINS);
        let p = Pair::periodic(phi_d - offset, phi_d_bins);
        let bins = phi_d_bins as u32;
        let low = h.low * (THETA_D_BINS as u32 * bins) + p.low;
        let high = h.high * (THETA_D_BINS as u32 * bins) + p.low;
        Some(Self {
            rows: [
                low + d.low * bins,
                low + d.high * bins,
                high + d.low * bins,
                high + d.high * bins,
            ],
            phi_d_step: p.high.wrapping_sub(p.low),
            weights: [h.weight, d.weight, p.weight],
        })
    }

    /// Mean of the valid neighbours by their weights, which are renormalised; zero if none is valid. Rounding that would carry
    /// the mean past the largest f32 leaves it there.
    #[inline(always)]
    pub fn mean(&self, table: &MerlTable) -> Rgb {
        if table.has_partial_cells() {
            return self.mean_by_channel(table);
        }
        match table.stored_cells() {
            Cells::F32(cells) => self.mean_of_cells(cells.as_slice()),
            Cells::F16(cells) => self.mean_of_cells(cells),
            Cells::Rgb9e5(cells) => self.mean_of_cells(cells),
        }
    }

    /// [`Self::mean`] where every cell is valid in all of its channels or in none.
    #[inline(always)]
    pub fn mean_of_cells(&self, cells: &(impl ReadCells + ?Sized)) -> Rgb {
        // Linear along φd, then θd, then θh: low · (1 − w) + high · w on each axis. An invalid cell is zero in all of its
        // numbers, so that the fourth sums the weights of the valid ones.
        let [theta_h, theta_d, _] = self.weights;
        let low = mix(
            self.mean_along_phi_d(cells, self.rows[0]),
            self.mean_along_phi_d(cells, self.rows[1]),
            theta_d,
        );
        let high = mix(
            self.mean_along_phi_d(cells, self.rows[2]),
            self.mean_along_phi_d(cells, self.rows[3]),
            theta_d,
        );
        let sum = mix(low, high, theta_h);
        if sum.w > 0.0 {
            (sum / sum.w).truncate().min(Rgb::splat(f32::MAX))
        } else {
            Rgb::ZERO
        }
    }

    /// The weighted sum of the two neighbours in a row.
    #[inline(always)]
    fn mean_along_phi_d(&self, cells: &(impl ReadCells + ?Sized), near: u32) -> Vec4 {
        let low = cells.read(near as usize);
        let high = cells.read(near.wrapping_add(self.phi_d_step) as usize);
        mix(low, high, self.weights[2])
    }

    /// The eight cells, those of a row together.
    #[inline(always)]
    pub fn cells(&self) -> [u32; 8] {
        let mut cells = [0; 8];
        for row in 0..4 {
            cells[2 * row] = self.rows[row];
            cells[2 * row + 1] = self.rows[row].wrapping_add(self.phi_d_step);
        }
        cells
    }

    /// Weights of the second neighbour along θh, θd and φd.
    #[inline(always)]
    pub fn weights(&self) -> [f32; 3] {
        self.weights
    }

    /// [`Self::mean`] of a table that keeps channels apart: each channel has weights of its own. The same bits where all neighbours
    /// are valid in all channels.
    #[cold]
    fn mean_by_channel(&self, table: &MerlTable) -> Rgb {
        // Sums of the values, and of 1 for each channel that is valid: along φd, then θd, then θh.
        let [theta_h, theta_d, phi_d] = self.weights;
        let mut along_phi_d = [(Vec4::ZERO, Vec4::ZERO); 4];
        for (mean, near) in along_phi_d.iter_mut().zip(self.rows) {
            let low = value_and_valid(table, near as usize);
            let high = value_and_valid(table, near.wrapping_add(self.phi_d_step) as usize);
            *mean = mix_both(low, high, phi_d);
        }
        let [a, b, c, d] = along_phi_d;
        let (low, high) = (mix_both(a, b, theta_d), mix_both(c, d, theta_d));
        let (sum, weights) = mix_both(low, high, theta_h);
        let mut out = Rgb::ZERO;
        for channel in 0..3 {
            if weights[channel] > 0.0 {
                out[channel] = (sum[channel] / weights[channel]).min(f32::MAX);
            }
        }
        out
    }
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
