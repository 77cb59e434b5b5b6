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
    fn surrounds(&self) -> bool {
        true
    }

    fn notes(&self) -> Option<&MapNotes> {
        Self::notes(self)
    }

    fn sample(&self, _from: DVec3, u: DVec2) -> Option<LightSample> {
        let chosen = match self.table() {
            Some(table) => {
                let (row, column) = table.find(u);
                self.place_in_cell(row, column)
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
                    for (lane, &u) in u[..count].iter().enumerate() {
                        places.set(lane, self.place_uniformly(u));
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
            for (lane, out) in out[..count].iter_mut().enumerate() {
                let emission = self.emission_of_cell(points.get(lane), places.cells[lane]);
                *out = light_sample(directions.get(lane).into(), emission);
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
        for &(row, search) in &searches[..count] {
            touched ^= table.touch(row, search);
        }
        black_box(touched);
        for (lane, &(row, search)) in searches[..count].iter().enumerate() {
            places.set(
                lane,
                self.place_in_cell(row, table.find_column(row, search)),
            );
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
            for (lane, direction) in directions[..count].iter().enumerate() {
                columns.set(lane, direction.to_array());
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::color::Rgb;
    use crate::light::{SkySampling, studio};
    use crate::points::PointSet;

    /// Maps of extreme sizes and contrasts.
    fn extremes() -> Vec<Environment> {
        let grey = Rgb::splat(0.5);
        let mut maps = Vec::new();
        for (width, height) in [(1, 1), (1, 9), (9, 1), (13, 7), (100, 3), (1100, 2)] {
            let mut sun = vec![Rgb::splat(1e-4); width * height];
            sun[width * height / 2] = Rgb::splat(1e4);
            let mut spot = vec![Rgb::ZERO; width * height];
            spot[width * height / 3] = grey;
            // Every other pair of rows is black, so that rows without any light remain.
            let stripes = (0..width * height).map(|i| grey * ((i / width / 4 % 2) as f32));
            let stripes = stripes.collect::<Vec<_>>();
            for pixels in [vec![grey; width * height], sun, spot, stripes] {
                maps.push(
                    Environment::new(width, height, pixels, SkySampling::Importance).unwrap(),
                );
            }
        }
        maps
    }

    #[test]
    fn draws_have_the_density_of_their_direction() {
        for sky in extremes() {
            let mut apart = 0;
            for i in 0..2000 {
                let u = PointSet::Random.point(8, i, 0).as_dvec2();
                let drawn = sky.sample(DVec3::ZERO, u).unwrap();
                let p = square_of(drawn.wi) * sky.extent();
                let back = sky
                    .emitted_along(DVec3::ZERO, drawn.wi, f64::INFINITY)
                    .unwrap();
                assert!(
                    back.radiance
                        .abs_diff_eq(drawn.radiance, 1e-5 * drawn.radiance.max_element().max(1.0))
                );
                // Within rounding of an edge between cells, the direction may be the neighbour's.
                let from_edge = (p - p.round()).abs().min_element();
                if from_edge > 1e-6 {
                    assert_eq!(
                        back.pdf.to_bits(),
                        drawn.pdf.to_bits(),
                        "{u} {p} {:?}",
                        sky.size()
                    );
                } else {
                    apart += 1;
                }
            }
            assert!(apart < 20, "{apart} draws at edges, {:?}", sky.size());
        }
    }

    #[test]
    fn a_cell_is_drawn_as_often_as_its_density_says() {
        for sky in extremes() {
            let Some(table) = sky.table() else { continue };
            let mut sum = 0.0;
            let [width, height] = sky.size();
            for y in 0..height {
                for x in 0..width {
                    let mass = table.probability(x, y);
                    let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / sky.extent();
                    let pdf = sky.pdf(direction_of(middle.x, (middle.y * PI).cos()));
                    let off = pdf * sky.solid_angle(y) - mass;
                    assert!(off.abs() <= 1e-7 * mass, "{x} {y} of {:?}", sky.size());
                    sum += mass;
                }
            }
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
    }

    #[test]
    fn points_beyond_the_square_choose_directions_too() {
        let uniform = Environment::new(3, 2, vec![Rgb::ONE; 6], SkySampling::Uniform).unwrap();
        let ends = [
            -1.0,
            -0.0,
            0.0,
            1.0f64.next_down(),
            1.0,
            2.0,
            f64::INFINITY,
            f64::NAN,
        ];
        for sky in extremes().into_iter().chain([uniform]) {
            for i in 0..ends.len() * ends.len() {
                let u = DVec2::new(ends[i % ends.len()], ends[i / ends.len()]);
                let drawn = sky.sample(DVec3::ZERO, u).unwrap();
                assert!(drawn.wi.is_normalized() && drawn.pdf > 0.0 && drawn.radiance.is_finite());
                let mut batch = [None];
                sky.sample_batch(&[DVec3::ZERO], &[u], &mut batch);
                assert_eq!(batch[0], Some(drawn));
            }
            for w in [
                DVec3::NAN,
                DVec3::INFINITY,
                DVec3::ZERO,
                DVec3::splat(1e200),
            ] {
                // No direction, but no reason to panic either.
                sky.emitted_along(DVec3::ZERO, w, f64::INFINITY);
            }
        }
    }

    #[test]
    fn tables_take_four_bytes_a_pixel_for_sums_and_four_for_densities() {
        let sky = studio(SkySampling::Importance);
        let bytes = sky.table_bytes() as f64 / (512.0 * 256.0);
        assert!((8.2..8.3).contains(&bytes), "{bytes}");
        assert_eq!(studio(SkySampling::Uniform).table_bytes(), 0);
    }
}
