//! Gaps of a table, filled from what surrounds them.

use glam::{BVec3, DVec3};

use crate::material::merl::{Header, MerlTable, THETA_D_BINS, THETA_H_BINS, bin_is_upper};

/// One level of the pyramid: sums of measured values and their number, by channel, in bins of twice the width of the level before.
struct Level {
    size: [usize; 3],
    cells: Vec<(DVec3, DVec3)>,
}

impl Level {
    fn index(&self, [h, d, p]: [usize; 3]) -> usize {
        (h * self.size[1] + d) * self.size[2] + p
    }

    /// The level of half the resolution.
    fn halved(&self) -> Self {
        let size = self.size.map(|n| n.div_ceil(2));
        let mut out = Self {
            size,
            cells: vec![(DVec3::ZERO, DVec3::ZERO); size.iter().product()],
        };
        for h in 0..self.size[0] {
            for d in 0..self.size[1] {
                for p in 0..self.size[2] {
                    let (sum, weight) = self.cells[self.index([h, d, p])];
                    let k = out.index([h / 2, d / 2, p / 2]);
                    out.cells[k].0 += sum;
                    out.cells[k].1 += weight;
                }
            }
        }
        out
    }

    /// Means of the level with its own gaps filled from the next coarser level's means.
    fn filled_means(&self, coarser: Option<(&Self, &[DVec3])>) -> Vec<DVec3> {
        let mut out = Vec::with_capacity(self.cells.len());
        for h in 0..self.size[0] {
            for d in 0..self.size[1] {
                for p in 0..self.size[2] {
                    let (sum, weight) = self.cells[self.index([h, d, p])];
                    let measured = weight.cmpgt(DVec3::ZERO);
                    let around = match coarser {
                        Some((level, means)) if !measured.all() => {
                            level.interpolate(means, [h, d, p])
                        }
                        _ => DVec3::ZERO,
                    };
                    out.push(DVec3::select(measured, sum / weight, around));
                }
            }
        }
        out
    }

    /// `means` of this level, linear between the centres of its bins, at the centre of a bin of the level of twice the
    /// resolution.
    fn interpolate(&self, means: &[DVec3], fine: [usize; 3]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for corner in 0..8 {
            let mut weight = 1.0;
            let mut bin = [0; 3];
            for axis in 0..3 {
                // The centre of a fine bin is a quarter of a coarse bin away from the coarse centre: weights ¾ and ¼.
                let own = fine[axis] / 2;
                let neighbour = if fine[axis].is_multiple_of(2) {
                    own.saturating_sub(1)
                } else {
                    (own + 1).min(self.size[axis] - 1)
                };
                let far = corner >> axis & 1 == 1;
                bin[axis] = if far { neighbour } else { own };
                weight *= if far { 0.25 } else { 0.75 };
            }
            sum += weight * means[self.index(bin)];
        }
        sum
    }
}

/// Fills the cells of a table that have no value though their bin reaches above the horizon: from the mirror image in the
/// plane of incidence (φd to π − φd) where that has one, else from the surrounding cells, by a pyramid of means over bins
/// twice as wide at each level, linear in between. The filled cells are marked ([`MerlTable::filled`]). Of a table that keeps
/// channels apart, a cell's valid channels stay as they are.
///
/// A channel without any value stays as it is.
///
/// The example of [`Measurements`](crate::material::measurements::Measurements) makes a table from a list.
pub fn fill_gaps(table: &MerlTable) -> MerlTable {
    let header = table.header();
    let mirrored = with_mirror_images(table, header);
    let mut measured = DVec3::ZERO;
    for (_, weight) in &mirrored {
        measured = measured.max(*weight);
    }
    let can_fill = measured.cmpgt(DVec3::ZERO);
    if !can_fill.any() {
        return table.clone();
    }
    let means = pyramid_means(mirrored, header);
    let mut filled = Vec::new();
    let apart = table.keeps_channels_apart();
    let out = MerlTable::collect(header, apart, |h, d, p| {
        let cell = table.index(h, d, p);
        let valid: BVec3 = table.valid_channels(cell).into();
        let own = DVec3::select(valid, table.rgb(h, d, p).as_dvec3(), DVec3::NEG_ONE);
        if valid.all() || !bin_is_upper([h, d, p]) {
            return own.to_array();
        }
        filled.push(cell as u32);
        DVec3::select(!valid & can_fill, means[cell], own).to_array()
    });
    out.with_filled(filled)
}

/// Values with weight 1 in the channels that a cell or its mirror image has.
fn with_mirror_images(table: &MerlTable, header: Header) -> Vec<(DVec3, DVec3)> {
    let mut out = Vec::with_capacity(header.cells());
    for h in 0..THETA_H_BINS {
        for d in 0..THETA_D_BINS {
            for p in 0..header.phi_d_bins {
                let mirror = header.phi_d_bins - 1 - p;
                let [own, other] = [p, mirror].map(|p| table.rgb(h, d, p).as_dvec3());
                let [valid, mirrored]: [BVec3; 2] =
                    [p, mirror].map(|p| table.valid_channels(table.index(h, d, p)).into());
                // Invalid channels hold 0.
                let value = DVec3::select(valid, own, other);
                let weight = DVec3::select(valid | mirrored, DVec3::ONE, DVec3::ZERO);
                out.push((value, weight));
            }
        }
    }
    out
}

/// The finest level's means, gaps filled.
fn pyramid_means(cells: Vec<(DVec3, DVec3)>, header: Header) -> Vec<DVec3> {
    let mut levels = vec![Level {
        size: [THETA_H_BINS, THETA_D_BINS, header.phi_d_bins],
        cells,
    }];
    while let Some(level) = levels.last()
        && level.size.iter().any(|&n| n > 1)
    {
        let coarser = level.halved();
        levels.push(coarser);
    }
    let mut means: Vec<DVec3> = Vec::new();
    for k in (0..levels.len()).rev() {
        let coarser = levels.get(k + 1).map(|level| (level, means.as_slice()));
        means = levels[k].filled_means(coarser);
    }
    means
}
