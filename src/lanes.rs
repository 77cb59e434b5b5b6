//! Numbers of the lanes of a batch, those of one kind side by side ("structure of arrays").
//!
//! Batches go through their steps a block of lanes at a time. Loops over such a block have a length that the compiler knows,
//! and read and write columns, so they become vector code. Everything here lives on the stack.
//!
//! Closures, and functions that take them, are avoided: inside code for a newer processor they may stay functions for the
//! oldest one, and each use of them a call.
#![allow(clippy::needless_range_loop)] // Several columns are read at the same lane.

use glam::Vec3;

use crate::geometry::{is_unit_upper, unit_upper};

/// `N` numbers for each of `LANES` lanes.
#[derive(Clone, Copy)]
pub(crate) struct Columns<T, const N: usize, const LANES: usize>([[T; LANES]; N]);

impl<T: Copy, const N: usize, const LANES: usize> Columns<T, N, LANES> {
    /// Every lane holds `values`.
    #[inline(always)]
    pub(crate) fn splat(values: [T; N]) -> Self {
        let mut columns = [[values[0]; LANES]; N];
        for i in 1..N {
            columns[i] = [values[i]; LANES];
        }
        Self(columns)
    }

    /// The numbers of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> [T; N] {
        let mut values = [self.0[0][lane]; N];
        for i in 1..N {
            values[i] = self.0[i][lane];
        }
        values
    }

    /// A number of all lanes.
    #[inline(always)]
    pub(crate) fn column(&self, number: usize) -> &[T; LANES] {
        &self.0[number]
    }

    /// A number of all lanes, to be replaced.
    #[inline(always)]
    pub(crate) fn column_mut(&mut self, number: usize) -> &mut [T; LANES] {
        &mut self.0[number]
    }

    /// Replaces the numbers of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, values: [T; N]) {
        for i in 0..N {
            self.0[i][lane] = values[i];
        }
    }
}

/// Directions brought to unit length, for up to `LANES` lanes.
pub(crate) struct UnitDirections<const LANES: usize> {
    columns: Columns<f32, 3, LANES>,
    /// Lanes whose direction is above the horizon; the others hold the normal.
    upper: [bool; LANES],
}

impl<const LANES: usize> UnitDirections<LANES> {
    /// [`unit_upper`] of the first `LANES` of `directions`.
    #[inline(always)]
    pub(crate) fn load(directions: &[Vec3]) -> Self {
        let mut units = Self {
            columns: Columns::splat([0.0; 3]),
            upper: [true; LANES],
        };
        let count = directions.len().min(LANES);
        for (lane, w) in directions[..count].iter().enumerate() {
            units.columns.set(lane, w.to_array());
        }
        // Nearly all are unit directions above the horizon. One count over all lanes finds the others without a branch each.
        let mut others = 0;
        for lane in 0..count {
            others += u32::from(!is_unit_upper(units.columns.get(lane).into()));
        }
        if others > 0 {
            units.renormalise(&directions[..count]);
        }
        units
    }

    #[cold]
    fn renormalise(&mut self, directions: &[Vec3]) {
        for (lane, &w) in directions.iter().enumerate() {
            let unit = unit_upper(w);
            self.upper[lane] = unit.is_some();
            self.columns.set(lane, unit.unwrap_or(Vec3::Z).to_array());
        }
    }

    /// The unit direction of a lane; the normal if it is not above the horizon.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Vec3 {
        self.columns.get(lane).into()
    }

    /// Whether a lane's direction is above the horizon.
    #[inline(always)]
    pub(crate) fn is_upper(&self, lane: usize) -> bool {
        self.upper[lane]
    }

    /// The unit directions as columns.
    #[inline(always)]
    pub(crate) fn columns(&self) -> &Columns<f32, 3, LANES> {
        &self.columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_keep_what_is_set() {
        let mut columns = Columns::<f64, 2, 4>::splat([1.0, 2.0]);
        columns.set(3, [5.0, 6.0]);
        assert_eq!((columns.get(0), columns.get(3)), ([1.0, 2.0], [5.0, 6.0]));
    }

    #[test]
    fn directions_are_those_of_unit_upper() {
        let directions = [
            Vec3::Z,
            Vec3::new(3.0, 0.0, 4.0),
            -Vec3::Z,
            Vec3::NAN,
            Vec3::new(0.6, 0.0, 0.8),
        ];
        for count in 0..=directions.len() {
            let units = UnitDirections::<8>::load(&directions[..count]);
            for (lane, &w) in directions[..count].iter().enumerate() {
                assert_eq!(units.is_upper(lane), unit_upper(w).is_some(), "{w}");
                assert_eq!(units.get(lane), unit_upper(w).unwrap_or(Vec3::Z), "{w}");
            }
        }
    }
}
