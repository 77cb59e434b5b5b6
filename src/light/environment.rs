//! Light from all around: an equirectangular map.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::{Light, LightSample, Seen};
use crate::color::{Rgb, luminance};
use crate::dist::Piecewise2d;
use crate::{Error, Result};

/// How an environment chooses directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkySampling {
    /// In proportion to luminance × solid angle, from tables of 8 bytes a pixel.
    Importance,
    /// Uniform over the sphere, without tables.
    Uniform,
}

/// Radiance from infinitely far away, by direction: a map `[row][column]` of latitude and longitude.
///
/// Rows run from the zenith (+y) to the nadir, columns clockwise as seen from above. The middle of the map is −z and its
/// right half is +x, so that a camera looking along −z sees the middle upright. Between the pixels' centres radiance is
/// bilinear; it closes on itself left and right, and is constant beyond the first and last rows.
pub struct Environment {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
    /// Cosines of the polar angles of the rows' upper edges, `height + 1` values from 1 to −1.
    cos_edges: Vec<f64>,
    /// `None`: uniform over the sphere.
    table: Option<Piecewise2d>,
}

impl Environment {
    /// An environment of `width` × `height` pixels, `[row][column]`.
    ///
    /// A black map has nothing to be in proportion to and is sampled uniformly.
    ///
    /// # Errors
    /// [`Error::Argument`] if a side is 0, the number of pixels is not `width · height`, or a channel is negative or not
    /// finite.
    pub fn new(width: usize, height: usize, pixels: Vec<Rgb>, sampling: SkySampling) -> Result<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            let what = format!("{} pixels for an environment of {width} × {height}", pixels.len());
            return Err(Error::argument(what, "give one value a pixel"));
        }
        if let Some(i) = pixels.iter().position(|c| !c.is_finite() || c.min_element() < 0.0) {
            let what = format!("radiance {} in column {}, row {}", pixels[i], i % width, i / width);
            return Err(Error::argument(what, "give finite radiance ≥ 0"));
        }
        let cos_edges = (0..=height).map(|row| (row as f64 / height as f64 * PI).cos()).collect();
        let mut sky = Self { width, height, pixels, cos_edges, table: None };
        if sampling == SkySampling::Importance && sky.pixels.iter().any(|c| luminance(*c) > 0.0) {
            sky.table = Some(Piecewise2d::new(width, height, &sky.weights())?);
        }
        Ok(sky)
    }

    /// An environment of `width` × `height` pixels whose radiance towards the unit vector of each pixel's centre is given.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_fn(
        width: usize,
        height: usize,
        sampling: SkySampling,
        radiance: impl Fn(DVec3) -> Rgb,
    ) -> Result<Self> {
        let pixel = |i: usize| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            radiance(direction_of(x / width as f64, (y / height as f64 * PI).cos()))
        };
        Self::new(width, height, (0..width * height).map(pixel).collect(), sampling)
    }

    /// Equal radiance from everywhere.
    ///
    /// # Errors
    /// [`Error::Argument`] if a channel is negative or not finite.
    pub fn uniform(radiance: Rgb) -> Result<Self> {
        Self::new(1, 1, vec![radiance], SkySampling::Uniform)
    }

    /// Bytes of memory that the sampling tables hold.
    pub fn table_bytes(&self) -> usize {
        self.table.as_ref().map_or(0, Piecewise2d::bytes)
    }

    /// Radiance that arrives from the unit vector `direction`.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.radiance_at(square_of(direction))
    }

    /// Density per solid angle of choosing `direction`, in sr⁻¹.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.pdf_at(square_of(direction))
    }

    fn radiance_at(&self, p: DVec2) -> Rgb {
        let x = p.x * self.width as f64 - 0.5;
        let y = (p.y * self.height as f64 - 0.5).clamp(0.0, (self.height - 1) as f64);
        let (column, row) = (x.floor(), y as usize);
        let (s, t) = ((x - column) as f32, (y - row as f64) as f32);
        let left = (column as i64).rem_euclid(self.width as i64) as usize;
        let right = (left + 1) % self.width;
        let line = |row: usize| {
            let row = &self.pixels[row * self.width..(row + 1) * self.width];
            row[left].lerp(row[right], s)
        };
        line(row).lerp(line((row + 1).min(self.height - 1)), t)
    }

    fn pdf_at(&self, p: DVec2) -> f64 {
        let index = |v: f64, cells: usize| ((v * cells as f64) as usize).min(cells - 1);
        match &self.table {
            None => 1.0 / (4.0 * PI),
            Some(table) => {
                let row = index(p.y, self.height);
                table.mass(index(p.x, self.width), row) / self.solid_angle(row)
            }
        }
    }

    fn direction(&self, u: DVec2) -> DVec3 {
        match &self.table {
            None => direction_of(u.x, 1.0 - 2.0 * u.y),
            Some(table) => {
                let p = table.sample(u);
                let row = ((p.y * self.height as f64) as usize).min(self.height - 1);
                let share = p.y * self.height as f64 - row as f64;
                // Uniform in solid angle within a row, so that the density is constant in a cell and finite at the poles.
                let (top, bottom) = (self.cos_edges[row], self.cos_edges[row + 1]);
                direction_of(p.x, top + share * (bottom - top))
            }
        }
    }

    /// Solid angle of a cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        TAU / self.width as f64 * (self.cos_edges[row] - self.cos_edges[row + 1])
    }

    /// For each cell, the mean luminance of the bilinear map in it, times its solid angle. The mean over a cell of what is
    /// bilinear between centres weighs the pixel itself and its neighbours 1 : 6 : 1 along each axis; it is positive
    /// wherever some light is.
    fn weights(&self) -> Vec<f64> {
        let at = |x: usize, y: usize| f64::from(luminance(self.pixels[y * self.width + x]));
        let across = |x: usize, y: usize| {
            let (w, e) = ((x + self.width - 1) % self.width, (x + 1) % self.width);
            (at(w, y) + 6.0 * at(x, y) + at(e, y)) / 8.0
        };
        let mut weights = Vec::with_capacity(self.pixels.len());
        for y in 0..self.height {
            let (n, s) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
            let solid_angle = self.solid_angle(y);
            for x in 0..self.width {
                let mean = (across(x, n) + 6.0 * across(x, y) + across(x, s)) / 8.0;
                weights.push(mean * solid_angle);
            }
        }
        weights
    }
}

impl Light for Environment {
    fn sample(&self, _from: DVec3, u: DVec2) -> Option<LightSample> {
        let wi = self.direction(u);
        let p = square_of(wi);
        let (radiance, pdf) = (self.radiance_at(p), self.pdf_at(p));
        (pdf > 0.0).then_some(LightSample { wi, distance: f64::INFINITY, radiance, pdf })
    }

    fn seen(&self, _from: DVec3, direction: DVec3, reach: f64) -> Option<Seen> {
        if reach < f64::INFINITY {
            return None;
        }
        let p = square_of(direction);
        Some(Seen { radiance: self.radiance_at(p), pdf: self.pdf_at(p) })
    }
}

/// Longitude share and cosine of the polar angle to a unit vector.
fn direction_of(longitude: f64, cos: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = ((longitude - 0.5) * TAU).sin_cos();
    DVec3::new(sin * s, cos, -sin * c)
}

/// Longitude and latitude of a unit vector as shares in [0, 1].
fn square_of(direction: DVec3) -> DVec2 {
    let longitude = direction.x.atan2(-direction.z) / TAU + 0.5;
    let beside = (direction.x * direction.x + direction.z * direction.z).sqrt();
    DVec2::new(longitude, beside.atan2(direction.y) / PI)
}

#[cfg(test)]
mod tests {
    use super::*;
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
                let s = sky.sample(DVec3::ZERO, PointSet::Sobol.point(1, i, 0).as_dvec2()).unwrap();
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
            assert!(sky.pdf(w) > 0.0 || sky.radiance(w) == Rgb::ZERO, "dark hole at {w}");
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

    #[test]
    fn bad_pixels_are_refused_and_black_maps_are_not() {
        let build = |c| Environment::new(1, 1, vec![c], SkySampling::Importance);
        assert!(build(Rgb::splat(-1.0)).is_err());
        assert!(build(Rgb::splat(f32::NAN)).is_err());
        assert!(build(Rgb::ZERO).unwrap().sample(DVec3::ZERO, DVec2::ZERO).is_some());
        assert!(Environment::new(2, 2, vec![Rgb::ONE], SkySampling::Uniform).is_err());
    }
}
