//! Upper bounds of a MERL table over regions of the disc, from the table itself.
//!
//! A maximum over a grid of points is no bound: up to a tenth of the draws from a metal exceed it. Here the squared
//! tangents of θh, θd and φd are bounded over a rectangle of the disc by interval arithmetic, which gives the bins that the
//! rectangle can reach; the largest value among them bounds f.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};

use super::quad_cell::Rect;
use crate::brdf::Importance;
use crate::color::Rgb;
use crate::material::merl::{BinIndex, LookupRule, MerlBrdf, MerlTable};
use crate::material::merl::{THETA_D_BINS, THETA_H_BINS};

/// Components of directions are rounded to f32, so a rectangle reaches a little further than drawn.
const SLACK: f64 = 4e-7;

/// Largest values of a table over runs of φd.
pub(super) struct MaxTable {
    /// `levels[l][row · width(l) + k]`: the maximum over bins k·2ˡ … (k+1)·2ˡ − 1 of row (θh, θd).
    levels: Vec<Vec<f32>>,
    widths: Vec<usize>,
    phi_d_bins: usize,
    /// How many bins below and above its own a lookup touches.
    reach: (usize, usize),
    rule: LookupRule,
}

/// Bins from `low` to `high`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Range {
    low: usize,
    high: usize,
}

/// RGB of a cell of which some channels alone are invalid, those replaced by the greatest value of the adjacent cells; of any other
/// cell as it is.
fn with_greatest_neighbours(table: &MerlTable, cell: usize) -> Rgb {
    let mut rgb = table.cell(cell).truncate();
    let valid = table.valid_channels(cell);
    if valid[0] == valid[1] && valid[1] == valid[2] {
        return rgb;
    }
    let bins = table.phi_d_bins();
    let (row, p) = (cell / bins, cell % bins);
    let (h, d) = (row / THETA_D_BINS, row % THETA_D_BINS);
    // Invalid channels hold 0.
    let mut greatest = Rgb::ZERO;
    for h in h.saturating_sub(1)..=(h + 1).min(THETA_H_BINS - 1) {
        for d in d.saturating_sub(1)..=(d + 1).min(THETA_D_BINS - 1) {
            for turn in [bins - 1, 0, 1] {
                greatest = greatest.max(table.rgb(h, d, (p + turn) % bins));
            }
        }
    }
    for channel in 0..3 {
        if !valid[channel] {
            rgb[channel] = greatest[channel];
        }
    }
    rgb
}

impl MaxTable {
    pub fn new(brdf: &MerlBrdf, importance: Importance) -> Self {
        let table = brdf.table();
        // Between samples, a channel without a value takes those of its neighbours, so that they bound it.
        let is_bounded_by_neighbours =
            table.has_partial_cells() && brdf.rule() != LookupRule::Floor;
        let mut values = Vec::with_capacity(table.cells().len());
        for (cell, rgba) in table.cells().enumerate() {
            let bound = match is_bounded_by_neighbours {
                true => with_greatest_neighbours(table, cell),
                false => rgba.truncate(),
            };
            values.push(importance.reduce(bound));
        }
        // Level l + 1 holds the maxima of neighbouring pairs of level l. The last has one maximum for all of φd.
        let phi_d_bins = table.phi_d_bins();
        let mut levels = vec![values];
        let mut widths = vec![phi_d_bins];
        while widths[widths.len() - 1] > 1 {
            let width = widths[widths.len() - 1];
            let finer = &levels[levels.len() - 1];
            let next = finer
                .chunks(width)
                .flat_map(|row| {
                    row.chunks(2)
                        .map(|pair| pair.iter().copied().fold(0.0, f32::max))
                })
                .collect();
            levels.push(next);
            widths.push(width.div_ceil(2));
        }
        // A value that is interpolated between lower edges of bins depends on the next bin too, and one between their
        // middles on the bins of both sides.
        let reach = match brdf.rule() {
            LookupRule::Floor => (0, 0),
            LookupRule::Linear => (0, 1),
            LookupRule::Centred => (1, 1),
        };
        Self {
            levels,
            widths,
            phi_d_bins,
            reach,
            rule: brdf.rule(),
        }
    }

    /// The lookup that these bound.
    pub fn rule(&self) -> LookupRule {
        self.rule
    }

    /// The values of all cells, by θh, θd and φd.
    pub fn cells(&self) -> &[f32] {
        &self.levels[0]
    }

    /// Bins of φd: 180, or 360 for a table that is not reciprocal.
    pub fn phi_d_bins(&self) -> usize {
        self.phi_d_bins
    }

    /// The table's value for a pair of directions by floor lookup: from a plane of scalars, a quarter of the table's memory.
    #[inline]
    pub fn floor_value(&self, wo: Vec3, wi: Vec3) -> f32 {
        BinIndex::find(wo, wi, self.phi_d_bins).map_or(0.0, |b| {
            self.levels[0][(b.theta_h * THETA_D_BINS + b.theta_d) * self.phi_d_bins + b.phi_d]
        })
    }

    /// Upper bound of f(wo, ·) over a rectangle of the disc, for `wo` in the plane of φ = 0 with x ≥ 0.
    pub fn over(&self, wo: DVec3, rect: Rect) -> f32 {
        // Step 1: the bins of each angle that the rectangle reaches.
        let region = Region::enclose(wo, rect);
        let h = self.widen(region.theta_h(), THETA_H_BINS);
        let d = self.widen(region.theta_d(), THETA_D_BINS);
        let phi = region
            .phi_d(self.phi_d_bins)
            .map(|r| (r.0 - self.reach.0 as i64, r.1 + self.reach.1 as i64));
        // Step 2: the maximum over these, row by row.
        let whole = &self.levels[self.levels.len() - 1];
        let mut max = 0.0f32;
        for row_h in h.low..=h.high {
            let rows = row_h * THETA_D_BINS + d.low..row_h * THETA_D_BINS + d.high + 1;
            for (row, &whole) in rows.clone().zip(&whole[rows]) {
                // Most rows are told by all of φd not to matter.
                if whole > max {
                    max = max.max(self.row(row, phi));
                }
            }
        }
        max
    }

    fn widen(&self, r: Range, bins: usize) -> Range {
        Range {
            low: r.low.saturating_sub(self.reach.0),
            high: (r.high + self.reach.1).min(bins - 1),
        }
    }

    /// Maximum of a row over unwrapped bins `phi`, or all of it.
    fn row(&self, row: usize, phi: Option<(i64, i64)>) -> f32 {
        let bins = self.phi_d_bins as i64;
        match phi {
            Some((low, high)) if high - low + 1 < bins => {
                // Unwrapped bins may pass the end of the turn. The run is then cut in two there.
                let (a, b) = (
                    low.rem_euclid(bins) as usize,
                    high.rem_euclid(bins) as usize,
                );
                if a <= b {
                    self.run(row, a, b)
                } else {
                    self.run(row, a, self.phi_d_bins - 1)
                        .max(self.run(row, 0, b))
                }
            }
            _ => self.levels[self.levels.len() - 1][row],
        }
    }

    /// Maximum over bins `a..=b` of a row, climbing the levels.
    fn run(&self, row: usize, mut a: usize, mut b: usize) -> f32 {
        let mut max = 0.0f32;
        debug_assert!(a <= b && b < self.phi_d_bins);
        // An odd `a` is the second of its pair and an even `b` the first. Both are taken at this level. What is left
        // consists of whole pairs, which the next level holds.
        for (level, &width) in self.levels.iter().zip(&self.widths) {
            let cells = &level[row * width..(row + 1) * width];
            if a & 1 == 1 {
                max = max.max(cells[a]);
                a += 1;
            }
            if b & 1 == 0 {
                max = max.max(cells[b]);
                if b == 0 {
                    break;
                }
                b -= 1;
            }
            if a > b {
                break;
            }
            (a, b) = (a / 2, b / 2);
        }
        max
    }
}

/// What half and difference angles are computed from, each as an interval over a rectangle.
struct Region {
    tan2_theta_h: (f64, f64),
    tan2_theta_d: (f64, f64),
    /// The difference vector along and across the plane of the normal, up to a positive factor.
    along: (f64, f64),
    across: (f64, f64),
}

impl Region {
    fn enclose(wo: DVec3, rect: Rect) -> Self {
        debug_assert!(wo.x >= 0.0 && wo.y == 0.0);
        let rect = Rect {
            low: rect.low - SLACK,
            high: rect.high + SLACK,
        };
        // z = √(1 − r²) falls with the distance r from the centre of the disc.
        let (near2, far2) = rect.distances_squared(DVec2::ZERO);
        let lowest = (1.0 - far2).max(0.0).sqrt();
        let highest = (1.0 - near2).max(0.0).sqrt();
        let z = ((lowest - SLACK).max(0.0), highest + SLACK);
        // ρ = |wo.xy + wi.xy| is a distance from −wo.xy.
        let rho2 = rect.distances_squared(DVec2::new(-wo.x, 0.0));
        // tan²θh = ρ²/(wo.z + z)², least for the nearest ρ and the highest z.
        let tan2_theta_h = (
            rho2.0 / (wo.z + z.1).powi(2),
            rho2.1 / (wo.z + z.0).max(1e-30).powi(2),
        );
        // wo·wi = wo.x·x + wo.z·z rises with x and z, since wo.y = 0 and wo.x ≥ 0.
        let cosine = (
            wo.x * rect.low.x + wo.z * z.0 - SLACK,
            wo.x * rect.high.x + wo.z * z.1 + SLACK,
        );
        let low = cosine.0.clamp(-1.0, 1.0);
        let high = cosine.1.clamp(-1.0, 1.0);
        // tan²θd = (1 − c)/(1 + c) falls with c, the cosine between the directions.
        let tan2_theta_d = (
            (1.0 - high) / (1.0 + high),
            (1.0 - low) / (1.0 + low).max(1e-30),
        );
        let cos_theta_d = (((1.0 + low) * 0.5).sqrt(), ((1.0 + high) * 0.5).sqrt());
        // Along the plane of the normal the difference vector is (wo.z − z)·cos θd, up to a positive factor, with
        // cos θd = √((1 + c)/2). The extremes of a product of two intervals are products of their ends.
        let dz = (wo.z - z.1, wo.z - z.0);
        let ends = [
            dz.0 * cos_theta_d.0,
            dz.0 * cos_theta_d.1,
            dz.1 * cos_theta_d.0,
            dz.1 * cos_theta_d.1,
        ];
        Self {
            tan2_theta_h,
            tan2_theta_d,
            along: (
                ends.iter().copied().fold(f64::MAX, f64::min),
                ends.iter().copied().fold(f64::MIN, f64::max),
            ),
            across: (wo.x * rect.low.y - SLACK, wo.x * rect.high.y + SLACK),
        }
    }

    fn theta_h(&self) -> Range {
        let (low, high) = self.tan2_theta_h;
        Range {
            low: BinIndex::theta_h_of_tan2(low),
            high: BinIndex::theta_h_of_tan2(high),
        }
    }

    fn theta_d(&self) -> Range {
        let (low, high) = self.tan2_theta_d;
        Range {
            low: BinIndex::theta_d_of_tan2(low),
            high: BinIndex::theta_d_of_tan2(high),
        }
    }

    /// Bins of φd, unwrapped: may run below 0 or past the last; `None` for all.
    fn phi_d(&self, bins: usize) -> Option<(i64, i64)> {
        let ((a0, a1), (c0, c1)) = (self.along, self.across);
        // A box around the origin has all azimuths. In any other, azimuths are extreme at the corners.
        if a0 <= 0.0 && a1 >= 0.0 && c0 <= 0.0 && c1 >= 0.0 {
            return None;
        }
        // A rectangle across the cut of the arctangent is turned by π, and its bins turned back.
        let turned = a0 < 0.0 && c0 <= 0.0 && c1 >= 0.0;
        let sign = if turned { -1.0 } else { 1.0 };
        let corners =
            [(a0, c0), (a0, c1), (a1, c0), (a1, c1)].map(|(a, c)| (sign * c).atan2(sign * a));
        let low = corners.iter().copied().fold(f64::MAX, f64::min);
        let high = corners.iter().copied().fold(f64::MIN, f64::max);
        let turn = if turned && bins == 360 { 180 } else { 0 };
        let bin = |phi: f64| (phi / PI * 180.0).floor() as i64 + turn;
        Some((bin(low - 1e-9), bin(high + 1e-9)))
    }
}
