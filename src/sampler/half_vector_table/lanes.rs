//! Numbers of many draws, arranged for vector code.

use glam::Vec3;

use crate::geometry::{is_unit_upper, unit_upper};

/// Draws that go through the stages together: their arrays fit the fastest cache.
pub(super) const LANES: usize = 64;

/// `N` numbers a lane, those of one kind side by side.
pub(super) struct Columns<const N: usize>([[f32; LANES]; N]);

impl<const N: usize> Columns<N> {
    pub const ZERO: Self = Self([[0.0; LANES]; N]);

    #[inline(always)]
    pub fn get(&self, lane: usize) -> [f32; N] {
        std::array::from_fn(|i| self.0[i][lane])
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, values: [f32; N]) {
        for (column, value) in self.0.iter_mut().zip(values) {
            column[lane] = value;
        }
    }
}

/// Directions at unit length.
pub(super) struct Units {
    pub directions: Columns<3>,
    /// Lanes that have one; in the others stands the normal.
    pub upper: [bool; LANES],
}

impl Units {
    /// [`unit_upper`] of up to [`LANES`] directions.
    #[inline(always)]
    pub fn of(w: &[Vec3]) -> Self {
        let mut units = Self {
            directions: Columns::ZERO,
            upper: [true; LANES],
        };
        for (k, w) in w.iter().enumerate().take(LANES) {
            units.directions.set(k, w.to_array());
        }
        // Nearly all are unit directions: one count for all of them, without a branch for each.
        let other = |k: usize| u32::from(!is_unit_upper(units.directions.get(k).into()));
        if (0..w.len().min(LANES)).map(other).sum::<u32>() > 0 {
            units.renormalise(w);
        }
        units
    }

    #[cold]
    fn renormalise(&mut self, w: &[Vec3]) {
        for (k, &w) in w.iter().enumerate().take(LANES) {
            let unit = unit_upper(w);
            self.upper[k] = unit.is_some();
            self.directions.set(k, unit.unwrap_or(Vec3::Z).to_array());
        }
    }
}
