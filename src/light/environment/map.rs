//! The map, and how directions are chosen by it.

use std::f64::consts::{PI, TAU};
use std::fmt;

use glam::{DVec2, DVec3, Vec4};

use super::equirectangular::{MapPoint, direction_of, square_of};
use super::notes::MapNotes;
use super::sky_table::{ChosenPlace, SkyTable};
use crate::color::{Rgb, luminance};
use crate::distribution::CellPlace;
use crate::light::Emission;
use crate::{Error, Result};

/// How an environment chooses directions.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkySampling {
    /// In proportion to luminance × solid angle, from tables of some 8.3 bytes per pixel.
    Importance,
    /// Uniform over the sphere, without tables.
    Uniform,
}

/// With the pixels around them, at most four times as many, they have indices of 32 bits.
const MOST_PIXELS: usize = 1_000_000_000;

/// Radiance from infinitely far away, by direction: a map `[row][column]` of latitude and longitude.
///
/// Rows run from the zenith (+y) to the nadir, columns clockwise as seen from above. The middle of the map is −z and its
/// right half is +x, so that a camera looking along −z sees the middle upright. Between the pixels' centres radiance is
/// bilinear; it closes on itself left and right, and is constant beyond the first and last rows.
///
/// The example of [`Light`](crate::light::Light) samples an environment.
pub struct Environment {
    width: usize,
    height: usize,
    /// Width and height.
    extent: DVec2,
    /// Radiance, and the density with which directions within the pixel are chosen, in sr⁻¹. Around them is what a look-up
    /// may read beyond the map: the last column before the first, the first after the last, and the last row once more.
    /// `[height + 1][width + 2]`.
    pixels: Vec<Vec4>,
    /// Cosines of the polar angles of the rows' upper edges, `height + 1` values from 1 to −1.
    cos_edges: Vec<f64>,
    /// `None`: uniform over the sphere.
    table: Option<SkyTable>,
    /// `None` for maps that were not read from a file.
    notes: Option<Box<MapNotes>>,
}

/// Its size: the pixels are too many to be read.
impl fmt::Debug for Environment {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Environment")
            .field("width", &self.width)
            .field("height", &self.height)
            .finish_non_exhaustive()
    }
}

impl Environment {
    /// An environment of `width` × `height` pixels, `[row][column]`.
    ///
    /// A black map has nothing to be in proportion to and is sampled uniformly.
    ///
    /// # Errors
    /// [`Error::Argument`] if a side is 0, the number of pixels is not `width · height` or is above 10⁹, or a channel is
    /// negative or not finite.
    pub fn new(
        width: usize,
        height: usize,
        pixels: Vec<Rgb>,
        sampling: SkySampling,
    ) -> Result<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            let what = format!(
                "{} pixels for an environment of {width} × {height}",
                pixels.len()
            );
            return Err(Error::argument(what, "give one value per pixel"));
        }
        if pixels.len() > MOST_PIXELS {
            let what = format!("an environment of {width} × {height} pixels");
            return Err(Error::argument(what, "give at most 10⁹ pixels"));
        }
        if let Some(i) = pixels
            .iter()
            .position(|c| !c.is_finite() || c.min_element() < 0.0)
        {
            let what = format!(
                "radiance {} in column {}, row {}",
                pixels[i],
                i % width,
                i / width
            );
            return Err(Error::argument(what, "give finite radiance ≥ 0"));
        }
        Ok(Self::assemble(width, height, &pixels, sampling))
    }

    /// An environment of at least one pixel, all of them finite and ≥ 0.
    fn assemble(width: usize, height: usize, pixels: &[Rgb], sampling: SkySampling) -> Self {
        // cosθ instead of θ, since solid angle is even in it.
        let cos_edges = (0..=height)
            .map(|row| (row as f64 / height as f64 * PI).cos())
            .collect();
        let extent = DVec2::new(width as f64, height as f64);
        let mut sky = Self {
            width,
            height,
            extent,
            pixels: Vec::new(),
            cos_edges,
            table: None,
            notes: None,
        };
        debug_assert!(sky.cos_edges.is_sorted_by(|a, b| a >= b));
        if sampling == SkySampling::Importance {
            sky.table = SkyTable::new(width, &sky.weights(pixels));
        }
        sky.pixels = padded(width, &sky.with_densities(pixels));
        sky
    }

    /// Radiance and density of each pixel.
    fn with_densities(&self, pixels: &[Rgb]) -> Vec<Vec4> {
        let mut all = Vec::with_capacity(pixels.len());
        for (y, row) in pixels.chunks_exact(self.width).enumerate() {
            for (x, radiance) in row.iter().enumerate() {
                // pdf = P(row)·P(column | row)/Ω, where Ω is the same for all cells of a row.
                let pdf = match &self.table {
                    Some(table) => table.probability(x, y) / self.solid_angle(y),
                    None => 1.0 / (4.0 * PI),
                };
                all.push(radiance.extend(pdf as f32));
            }
        }
        all
    }

    /// A built-in environment: radiance towards the unit vector of each pixel's centre, known to be finite and ≥ 0.
    pub(super) fn procedural(
        width: usize,
        height: usize,
        sampling: SkySampling,
        radiance: impl Fn(DVec3) -> Rgb,
    ) -> Self {
        let pixels = radiance_of_pixels(width, height, radiance);
        debug_assert!(!pixels.is_empty());
        debug_assert!(
            pixels
                .iter()
                .all(|c| c.is_finite() && c.min_element() >= 0.0)
        );
        Self::assemble(width, height, &pixels, sampling)
    }

    /// Equal radiance from everywhere.
    ///
    /// # Errors
    /// [`Error::Argument`] if a channel is negative or not finite.
    pub fn uniform(radiance: Rgb) -> Result<Self> {
        Self::new(1, 1, vec![radiance], SkySampling::Uniform)
    }

    /// Pixels of a row, and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    pub(super) fn with_notes(mut self, notes: MapNotes) -> Self {
        self.notes = Some(Box::new(notes));
        self
    }

    /// What was found and changed in the file that the map was read from; `None` for maps that come from none.
    pub fn notes(&self) -> Option<&MapNotes> {
        self.notes.as_deref()
    }

    /// Bytes of memory that the sampling tables hold.
    pub fn table_bytes(&self) -> usize {
        // Densities are the pixels' fourth channel.
        let densities = self.width * self.height * size_of::<f32>();
        self.table.as_ref().map_or(0, |t| t.bytes() + densities)
    }

    /// The unit vector towards a point of the map, whose `x` runs from left to right and whose `y` runs from the zenith, +y, down,
    /// both from 0 to 1.
    pub fn map_direction(point: DVec2) -> DVec3 {
        direction_of(point.x, (point.y * std::f64::consts::PI).cos())
    }

    /// The point of the map that lies in a direction: the inverse of [`Self::map_direction`].
    pub fn map_point(direction: DVec3) -> DVec2 {
        square_of(direction)
    }

    /// Radiance that arrives from the unit vector `direction`.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.emission_at(self.point(square_of(direction))).radiance
    }

    /// Density per solid angle of choosing `direction`, in sr⁻¹.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.emission_at(self.point(square_of(direction))).pdf
    }

    pub(super) fn table(&self) -> Option<&SkyTable> {
        self.table.as_ref()
    }

    /// Columns and rows as numbers to reckon with.
    #[inline(always)]
    pub(super) fn extent(&self) -> DVec2 {
        self.extent
    }

    /// Where a point of the unit square lies between the centres of pixels.
    #[inline(always)]
    pub(super) fn point(&self, p: DVec2) -> MapPoint {
        MapPoint::new(p * self.extent, self.extent)
    }

    /// What arrives from a point: radiance between the centres of pixels, and the density of the pixel that holds it.
    #[inline(always)]
    pub(super) fn emission_at(&self, p: MapPoint) -> Emission {
        self.emission_of_cell(p, p.nearest)
    }

    /// What arrives from a point that was chosen in the pixel `cell`, an index of `pixels`.
    #[inline(always)]
    pub(super) fn emission_of_cell(&self, p: MapPoint, cell: u32) -> Emission {
        let upper = &self.pixels[p.corner as usize..][..2];
        let lower = &self.pixels[p.corner as usize + self.width + 2..][..2];
        // Linear along the two rows, then between them.
        let radiance = upper[0]
            .lerp(upper[1], p.s)
            .lerp(lower[0].lerp(lower[1], p.s), p.t);
        Emission {
            radiance: radiance.truncate(),
            pdf: f64::from(self.pixels[cell as usize].w),
        }
    }

    /// Reads a word of each pixel that a point lies between, and combines them to something of no meaning.
    ///
    /// A loop of nothing but this makes processors wait for the pixels of many points together.
    #[inline(always)]
    pub(super) fn touch(&self, p: MapPoint) -> u32 {
        let upper = &self.pixels[p.corner as usize..][..2];
        let lower = &self.pixels[p.corner as usize + self.width + 2..][..2];
        let words = [upper[0].w, upper[1].w, lower[0].w, lower[1].w];
        words[0].to_bits() ^ words[1].to_bits() ^ words[2].to_bits() ^ words[3].to_bits()
    }

    /// The direction that is chosen in a cell of the map.
    #[inline(always)]
    pub(super) fn place_in_cell(&self, row: CellPlace, column: CellPlace) -> ChosenPlace {
        let (x, y) = (column.cell as usize, row.cell as usize);
        // Uniform in solid angle within a row, so that the density is constant in a cell and finite at the poles.
        let (top, bottom) = (self.cos_edges[y], self.cos_edges[y + 1]);
        ChosenPlace {
            column: f64::from(column.cell) + column.fraction,
            cos: top + row.fraction * (bottom - top),
            cell: (y * (self.width + 2) + x + 1) as u32,
        }
    }

    /// The direction that `u` in [0, 1)² chooses uniformly over the sphere; coordinates outside are clamped.
    #[inline(always)]
    pub(super) fn place_uniformly(&self, u: DVec2) -> ChosenPlace {
        let u = u.max(DVec2::ZERO).min(DVec2::ONE);
        // Solid angle is even in the longitude and in cosθ. All densities are the same.
        ChosenPlace {
            column: u.x * self.extent.x,
            cos: 1.0 - 2.0 * u.y,
            cell: 0,
        }
    }

    /// Solid angle of a cell of a row.
    pub(super) fn solid_angle(&self, row: usize) -> f64 {
        // Ω = Δφ·(cosθ_top − cosθ_bottom)
        TAU / self.width as f64 * (self.cos_edges[row] - self.cos_edges[row + 1])
    }

    /// For each cell, the mean luminance of the bilinear map in it, times its solid angle. In the mean over a cell, the pixel
    /// itself and its neighbours have the weights 1 : 6 : 1 along each axis, since the map is bilinear between centres. It is
    /// positive for every cell that any light falls into.
    fn weights(&self, pixels: &[Rgb]) -> Vec<f64> {
        let mut weights = Vec::with_capacity(pixels.len());
        for y in 0..self.height {
            let (n, s) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
            let solid_angle = self.solid_angle(y);
            for x in 0..self.width {
                let [north, middle, south] = [n, y, s].map(|y| self.mean_across(pixels, x, y));
                let mean = (north + 6.0 * middle + south) / 8.0;
                weights.push(mean * solid_angle);
            }
        }
        weights
    }

    /// The mean luminance in a row over the width of a pixel; the map closes on itself left and right.
    fn mean_across(&self, pixels: &[Rgb], x: usize, y: usize) -> f64 {
        let west = (x + self.width - 1) % self.width;
        let east = (x + 1) % self.width;
        let [west, middle, east] =
            [west, x, east].map(|x| f64::from(luminance(pixels[y * self.width + x])));
        (west + 6.0 * middle + east) / 8.0
    }
}

/// Radiance towards the centres of pixels, `[row][column]`.
fn radiance_of_pixels(width: usize, height: usize, radiance: impl Fn(DVec3) -> Rgb) -> Vec<Rgb> {
    let mut pixels = Vec::with_capacity(width * height);
    for i in 0..width * height {
        let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let cos = (y / height as f64 * PI).cos();
        pixels.push(radiance(direction_of(x / width as f64, cos)));
    }
    pixels
}

/// The map with what look-ups may read beyond it.
fn padded(width: usize, pixels: &[Vec4]) -> Vec<Vec4> {
    let rows = pixels.chunks_exact(width);
    let last = rows.clone().next_back();
    let mut padded = Vec::with_capacity((width + 2) * (rows.len() + 1));
    for row in rows.chain(last) {
        padded.push(row[width - 1]);
        padded.extend_from_slice(row);
        padded.push(row[0]);
    }
    padded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::points::PointSet;

    /// A dim sky with one bright pixel and a black half.
    fn spotted() -> Environment {
        let pixels = (0..32 * 16).map(|i| match i {
            100 => Rgb::splat(500.0),
            _ if i % 32 < 16 => Rgb::ZERO,
            _ => Rgb::new(0.1, 0.2, 0.3),
        });
        Environment::new(32, 16, pixels.collect(), SkySampling::Importance).unwrap()
    }

    #[test]
    fn directions_have_the_density_they_claim() {
        // ∫ L dω by sampling the map against a fine grid of directions.
        let sky = spotted();
        let (n, grid) = (1 << 14, 512);
        let mean = |f: &dyn Fn(u64) -> f64, n: u64| (0..n).map(f).sum::<f64>() / n as f64;
        let sampled = mean(
            &|i| {
                let s = sky
                    .sample(DVec3::ZERO, PointSet::Sobol.point(1, i, 0).as_dvec2())
                    .unwrap();
                f64::from(luminance(s.radiance)) / s.pdf
            },
            n,
        );
        let at = |i: u64| {
            let (x, y) = ((i % grid) as f64 + 0.5, (i / grid) as f64 + 0.5);
            let w = direction_of(x / grid as f64, 1.0 - 2.0 * y / grid as f64);
            f64::from(luminance(sky.radiance(w))) * 4.0 * PI
        };
        let exact = mean(&at, grid * grid);
        assert!((sampled / exact - 1.0).abs() < 5e-3, "{sampled} {exact}");
    }

    #[test]
    fn the_density_integrates_to_one_and_covers_all_light() {
        let sky = spotted();
        // Midpoints of a grid that the map's cells are multiples of.
        let (columns, rows) = (32 * 30, 16 * 30);
        let mut sum = 0.0;
        for i in 0..columns * rows {
            let (x, y) = (f64::from(i % columns) + 0.5, f64::from(i / columns) + 0.5);
            let theta = y / f64::from(rows) * PI;
            let w = direction_of(x / f64::from(columns), theta.cos());
            sum += sky.pdf(w) * theta.sin() * TAU * PI / f64::from(columns * rows);
            assert!(
                sky.pdf(w) > 0.0 || sky.radiance(w) == Rgb::ZERO,
                "dark hole at {w}"
            );
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }

    #[test]
    fn the_middle_of_the_map_is_ahead_and_its_right_is_x() {
        assert!(square_of(-DVec3::Z).abs_diff_eq(DVec2::splat(0.5), 1e-15));
        assert!(square_of(DVec3::X).abs_diff_eq(DVec2::new(0.75, 0.5), 1e-15));
        assert_eq!(square_of(DVec3::Y).y, 0.0);
        for i in 0..100 {
            let u = PointSet::Random.point(2, i, 0).as_dvec2();
            let back = square_of(direction_of(u.x, (u.y * PI).cos()));
            assert!(back.abs_diff_eq(u, 1e-9), "{u} {back}");
        }
    }

    #[test]
    fn poles_and_seam_are_finite() {
        let sky = spotted();
        for w in [DVec3::Y, -DVec3::Y, DVec3::Z, DVec3::new(-0.0, 0.0, 1.0)] {
            assert!(sky.radiance(w).is_finite() && sky.pdf(w).is_finite());
        }
        for u in [DVec2::ZERO, DVec2::ONE, DVec2::new(1.0f64.next_down(), 0.0)] {
            let s = sky.sample(DVec3::ZERO, u).unwrap();
            assert!(s.wi.is_normalized() && s.pdf.is_finite());
        }
    }

    /// Directions of all kinds: drawn, and along, near and between the axes.
    fn directions(count: u64) -> Vec<DVec3> {
        let drawn = (0..count).map(|i| {
            let u = PointSet::Random.point(5, i, 0).as_dvec2();
            direction_of(u.x, 1.0 - 2.0 * u.y)
        });
        let steps = [-1.0, -1e-9, -1e-300, -0.0, 0.0, 1e-300, 1e-9, 1.0];
        let grid = (0..512).map(|i| DVec3::new(steps[i % 8], steps[i / 8 % 8], steps[i / 64]));
        grid.filter(|w| w.abs().max_element() == 1.0)
            .map(DVec3::normalize)
            .chain(drawn)
            .collect()
    }

    #[test]
    fn batches_are_the_same_bits_as_one_by_one() {
        let plain =
            Environment::new(3, 2, vec![Rgb::new(0.1, 2.0, 3e5); 6], SkySampling::Uniform).unwrap();
        let nothing = Some(Emission {
            radiance: Rgb::ONE,
            pdf: -1.0,
        });
        for sky in [spotted(), plain] {
            let wi = directions(10_000);
            let u: Vec<DVec2> = (0..10_000)
                .map(|i| PointSet::Random.point(6, i, 0).as_dvec2())
                .collect();
            let from = vec![DVec3::ONE; wi.len()];
            let reach: Vec<f64> = (0..wi.len())
                .map(|i| if i % 7 == 3 { 5.0 } else { f64::INFINITY })
                .collect();
            for count in [0, 1, 63, 64, 65, 200, 10_000] {
                let mut sampled = vec![None; count];
                sky.sample_batch(&from[..count], &u[..count], &mut sampled);
                let mut emitted = vec![nothing; count];
                sky.emitted_batch(&from[..count], &wi[..count], &reach[..count], &mut emitted);
                for k in 0..count {
                    assert_eq!(sampled[k], sky.sample(from[k], u[k]), "{}", u[k]);
                    assert_eq!(
                        emitted[k],
                        sky.emitted_along(from[k], wi[k], reach[k]),
                        "{}",
                        wi[k]
                    );
                    // A draw knows its place in the map, which a look-up computes from the direction, to rounding.
                    let drawn = sampled[k].unwrap();
                    let back = sky.emitted_along(from[k], drawn.wi, f64::INFINITY).unwrap();
                    let rounding = 1e-5 * drawn.radiance.max_element();
                    assert!(back.radiance.abs_diff_eq(drawn.radiance, rounding));
                    assert_eq!(back.pdf.to_bits(), drawn.pdf.to_bits());
                }
            }
        }
    }

    #[test]
    fn fractions_are_those_of_the_library_and_in_bounds() {
        for w in directions(100_000) {
            let p = square_of(w);
            let exact = DVec2::new(w.x.atan2(-w.z) / TAU + 0.5, w.x.hypot(w.z).atan2(w.y) / PI);
            assert!(p.abs_diff_eq(exact, 1e-11), "{w}: {p} {exact}");
            assert!(p.min_element() >= 0.0 && p.max_element() <= 1.0, "{w}: {p}");
            let back = direction_of(p.x, (p.y * PI).cos());
            assert!((back.length() - 1.0).abs() < 1e-12, "{w}: {back}");
        }
    }

    #[test]
    fn radiance_is_bilinear_between_centres_and_closes_on_itself() {
        let (width, height) = (5, 3);
        let pixel = |x: usize, y: usize| Rgb::new(x as f32, y as f32, (x * x + 7 * y) as f32);
        let pixels = (0..width * height)
            .map(|i| pixel(i % width, i / width))
            .collect();
        let sky = Environment::new(width, height, pixels, SkySampling::Importance).unwrap();
        for i in 0..2000 {
            let p = PointSet::Sobol.point(3, i, 0).as_dvec2();
            let (x, y) = (
                p.x * width as f64 - 0.5,
                (p.y * height as f64 - 0.5).clamp(0.0, height as f64 - 1.0),
            );
            let (s, t) = ((x - x.floor()) as f32, y.fract() as f32);
            let column = |x: f64| (x as i64).rem_euclid(width as i64) as usize;
            let line =
                |y: usize| pixel(column(x.floor()), y).lerp(pixel(column(x.floor() + 1.0), y), s);
            let expected = line(y as usize).lerp(line((y as usize + 1).min(height - 1)), t);
            assert!(
                sky.emission_at(sky.point(p))
                    .radiance
                    .abs_diff_eq(expected, 1e-5),
                "{p}"
            );
        }
    }

    #[test]
    fn bad_pixels_are_refused_and_black_maps_are_not() {
        let build = |c| Environment::new(1, 1, vec![c], SkySampling::Importance);
        assert!(build(Rgb::splat(-1.0)).is_err());
        assert!(build(Rgb::splat(f32::NAN)).is_err());
        assert!(
            build(Rgb::ZERO)
                .unwrap()
                .sample(DVec3::ZERO, DVec2::ZERO)
                .is_some()
        );
        assert!(Environment::new(2, 2, vec![Rgb::ONE], SkySampling::Uniform).is_err());
    }
}
