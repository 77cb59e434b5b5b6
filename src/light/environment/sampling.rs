//! An environment as a light: one direction, or many in stages.

use std::hint::black_box;

use fearless_simd::{Level, dispatch};
use glam::{DVec2, DVec3};

use super::equirectangular::{MapPoint, direction_of, latitude_of, square_of};
use super::sky_table::{ChosenPlace, SkyTable};
use super::{Environment, MapNotes};
use crate::distribution::{CellPlace, LeafSearch};
use crate::lanes::Columns;
use crate::light::{Emission, Light, LightSample, assert_equal_lengths};

/// Directions that go through the stages of a batch together: arithmetic is vector code, and reads of the map overlap.
const LANES: usize = 64;

impl Light for Environment {
    fn notes(&self) -> Option<&MapNotes> {
        Self::notes(self)
    }

    fn sample(&self, _from: DVec3, u: DVec2) -> Option<LightSample> {
        let chosen = match self.table() {
            Some(table) => {
                let (row, column) = table.find(u);
                self.place(row, column)
            }
            None => self.place_uniformly(u),
        };
        let (wi, point) = locate(self.extent(), chosen.column, chosen.cos);
        light_sample(wi, self.emission_of_cell(point, chosen.cell))
    }

    fn emitted_along(&self, _from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        if reach < f64::INFINITY {
            return None;
        }
        Some(self.emission_at(self.point(square_of(direction))))
    }

    fn sample_batch(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        assert_equal_lengths(out.len(), &[from.len(), u.len()]);
        dispatch!(Level::new(), _ => self.sample_blocks(u, out));
    }

    fn emitted_batch(
        &self,
        from: &[DVec3],
        directions: &[DVec3],
        reach: &[f64],
        out: &mut [Option<Emission>],
    ) {
        assert_equal_lengths(out.len(), &[from.len(), directions.len(), reach.len()]);
        dispatch!(Level::new(), _ => self.emitted_blocks(directions, reach, out));
    }
}

impl Environment {
    #[inline(always)]
    fn sample_blocks(&self, u: &[DVec2], out: &mut [Option<LightSample>]) {
        let mut places = PlaceColumns::new();
        let mut directions = Columns::<f64, 3, LANES>::splat([0.0; 3]);
        let mut points = PointColumns::new();
        for (u, out) in u.chunks(LANES).zip(out.chunks_mut(LANES)) {
            let count = out.len().min(LANES);
            // Steps 1 and 2: where in the map.
            match self.table() {
                Some(table) => self.choose_block(table, u, &mut places),
                None => {
                    for lane in 0..count {
                        places.set(lane, self.place_uniformly(u[lane]));
                    }
                }
            }
            // Step 3: directions and points of the map, arithmetic that becomes vector code.
            let extent = self.extent();
            for lane in 0..count {
                let [column, cos] = places.numbers.get(lane);
                let (wi, point) = locate(extent, column, cos);
                directions.set(lane, wi.to_array());
                points.set(lane, point);
            }
            // Step 4: radiance and density.
            points.touch(self, count);
            for lane in 0..count {
                let emission = self.emission_of_cell(points.get(lane), places.cells[lane]);
                out[lane] = light_sample(directions.get(lane).into(), emission);
            }
        }
    }

    /// A place for each of up to [`LANES`] points of the unit square.
    #[inline(always)]
    fn choose_block(&self, table: &SkyTable, u: &[DVec2], places: &mut PlaceColumns) {
        let count = u.len().min(LANES);
        // Step 1: rows, and columns to 16 of them. The tables for this are small.
        let mut searches = [(CellPlace::default(), LeafSearch::default()); LANES];
        for lane in 0..count {
            searches[lane] = table.find_row(u[lane]);
        }
        // Step 2: columns, from the large table, whose lines are asked for together.
        let mut touched = 0;
        for lane in 0..count {
            let (row, search) = searches[lane];
            touched ^= table.touch(row, search);
        }
        black_box(touched);
        for lane in 0..count {
            let (row, search) = searches[lane];
            places.set(lane, self.place(row, table.find_column(row, search)));
        }
    }

    #[inline(always)]
    fn emitted_blocks(&self, directions: &[DVec3], reach: &[f64], out: &mut [Option<Emission>]) {
        let chunks = directions.chunks(LANES).zip(reach.chunks(LANES));
        let mut columns = Columns::<f64, 3, LANES>::splat([0.0; 3]);
        let mut points = PointColumns::new();
        for ((directions, reach), out) in chunks.zip(out.chunks_mut(LANES)) {
            let count = out.len().min(LANES);
            // Step 1: points of the map, arithmetic that becomes vector code.
            for lane in 0..count {
                columns.set(lane, directions[lane].to_array());
            }
            for lane in 0..count {
                points.set(lane, self.point(square_of(columns.get(lane).into())));
            }
            // Step 2: radiance and density.
            points.touch(self, count);
            for lane in 0..count {
                out[lane] = if reach[lane] < f64::INFINITY {
                    None
                } else {
                    Some(self.emission_at(points.get(lane)))
                };
            }
        }
    }
}

/// Chosen places, in columns.
struct PlaceColumns {
    /// Longitude in columns of the map, and the cosine of the polar angle.
    numbers: Columns<f64, 2, LANES>,
    /// Indices of pixels.
    cells: [u32; LANES],
}

impl PlaceColumns {
    #[inline(always)]
    fn new() -> Self {
        Self {
            numbers: Columns::splat([0.0; 2]),
            cells: [0; LANES],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, place: ChosenPlace) {
        self.numbers.set(lane, [place.column, place.cos]);
        self.cells[lane] = place.cell;
    }
}

/// Points of the map, in columns.
struct PointColumns {
    pixels: Columns<u32, 2, LANES>,
    fractions: Columns<f32, 2, LANES>,
}

impl PointColumns {
    #[inline(always)]
    fn new() -> Self {
        Self {
            pixels: Columns::splat([0; 2]),
            fractions: Columns::splat([0.0; 2]),
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, point: MapPoint) {
        self.pixels.set(lane, [point.corner, point.nearest]);
        self.fractions.set(lane, [point.s, point.t]);
    }

    /// Asks for the pixels of all points at once: the look-ups after it wait for memory together.
    #[inline(always)]
    fn touch(&self, sky: &Environment, count: usize) {
        let mut touched = 0;
        for lane in 0..count {
            touched ^= sky.touch(self.get(lane));
        }
        black_box(touched);
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> MapPoint {
        let [corner, nearest] = self.pixels.get(lane);
        let [s, t] = self.fractions.get(lane);
        MapPoint {
            corner,
            nearest,
            s,
            t,
        }
    }
}

/// The direction of a longitude in columns and the cosine of a polar angle, and its point of the map.
///
/// The map's point is computed from the same numbers instead of from the direction: an arctangent less.
#[inline(always)]
fn locate(extent: DVec2, column: f64, cos: f64) -> (DVec3, MapPoint) {
    let wi = direction_of(column / extent.x, cos);
    let p = DVec2::new(column, latitude_of(cos) * extent.y);
    (wi, MapPoint::new(p, extent))
}

/// The light of a chosen direction; `None` where the density that chose it is 0.
#[inline(always)]
fn light_sample(wi: DVec3, emission: Emission) -> Option<LightSample> {
    let Emission { radiance, pdf } = emission;
    (pdf > 0.0).then_some(LightSample {
        wi,
        distance: f64::INFINITY,
        radiance,
        pdf,
    })
}
