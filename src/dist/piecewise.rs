//! Piecewise-constant densities, sampled by inverting the cumulative sum.

use glam::DVec2;

use crate::{Error, Result};

/// A piecewise-constant density on the unit square: a grid of `width` × `height` cells of equal size.
///
/// A point of the unit square chooses a row by its `y` and, within the row, a column by its `x`; what is left of each
/// coordinate places the point in the cell. The map is continuous along each axis, so well-spread points stay well spread.
/// Cumulative sums are `f64`: the ratio of a sun to a sky exceeds the resolution of `f32`.
#[derive(Clone, Debug)]
pub struct Piecewise2d {
    width: usize,
    height: usize,
    /// Cumulative share of rows, `height + 1` values from 0 to 1.
    rows: Vec<f64>,
    /// Cumulative share of columns within each row, `[row][width + 1]`.
    columns: Vec<f64>,
}

impl Piecewise2d {
    /// A density proportional to `weights`, row after row, `[height][width]`.
    ///
    /// # Errors
    /// [`Error::Argument`] if the number of weights is not `width · height`, a weight is negative or not finite, or none is
    /// positive.
    pub fn new(width: usize, height: usize, weights: &[f64]) -> Result<Self> {
        check(width, height, weights)?;
        // In units of the largest, sums can't overflow.
        let largest = weights.iter().fold(0.0, |m: f64, &w| m.max(w));
        let mut columns = Vec::with_capacity(height * (width + 1));
        let sums: Vec<f64> =
            weights.chunks_exact(width).map(|row| push_cumulative(&mut columns, row, largest)).collect();
        let mut rows = Vec::with_capacity(height + 1);
        push_cumulative(&mut rows, &sums, 1.0);
        Ok(Self { width, height, rows, columns })
    }

    /// Columns of the grid.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of the grid.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bytes of memory that the cumulative sums hold.
    pub fn bytes(&self) -> usize {
        size_of_val(self.rows.as_slice()) + size_of_val(self.columns.as_slice())
    }

    /// Maps `u` in [0, 1)² to a point in [0, 1)² that lies where the density is positive; coordinates outside are clamped.
    pub fn sample(&self, u: DVec2) -> DVec2 {
        let (row, y) = place(&self.rows, u.y);
        let (column, x) = place(self.row(row), u.x);
        let point = |cell: usize, share: f64, cells: usize| {
            // Rounding must not carry the point into the next cell, whose density may be zero.
            ((cell as f64 + share) / cells as f64).min(((cell + 1) as f64 / cells as f64).next_down())
        };
        DVec2::new(point(column, x, self.width), point(row, y, self.height))
    }

    /// Density at `p` per unit area of the square; 0 outside [0, 1)².
    pub fn pdf(&self, p: DVec2) -> f64 {
        self.cell(p).map_or(0.0, |(x, y)| self.mass(x, y) * (self.width * self.height) as f64)
    }

    /// Probability of the cell in column `x` and row `y`; 0 outside the grid.
    pub fn mass(&self, x: usize, y: usize) -> f64 {
        if x >= self.width || y >= self.height {
            return 0.0;
        }
        let row = self.row(y);
        (self.rows[y + 1] - self.rows[y]) * (row[x + 1] - row[x])
    }

    /// The `u` that [`Self::sample`] maps to `p`; `None` where the density is zero.
    pub fn invert(&self, p: DVec2) -> Option<DVec2> {
        let (x, y) = self.cell(p)?;
        if self.mass(x, y) == 0.0 {
            return None;
        }
        let within = |cdf: &[f64], i: usize, share: f64| cdf[i] + share * (cdf[i + 1] - cdf[i]);
        let share = p * DVec2::new(self.width as f64, self.height as f64) - DVec2::new(x as f64, y as f64);
        Some(DVec2::new(within(self.row(y), x, share.x), within(&self.rows, y, share.y)))
    }

    fn row(&self, y: usize) -> &[f64] {
        &self.columns[y * (self.width + 1)..(y + 1) * (self.width + 1)]
    }

    fn cell(&self, p: DVec2) -> Option<(usize, usize)> {
        let inside = |v: f64| (0.0..1.0).contains(&v);
        let index = |v: f64, cells: usize| ((v * cells as f64) as usize).min(cells - 1);
        (inside(p.x) && inside(p.y)).then(|| (index(p.x, self.width), index(p.y, self.height)))
    }
}

fn check(width: usize, height: usize, weights: &[f64]) -> Result<()> {
    let fix = "give one finite weight ≥ 0 a cell, at least one of them positive";
    if width == 0 || height == 0 || width.checked_mul(height) != Some(weights.len()) {
        let what = format!("{} weights for a grid of {width} × {height}", weights.len());
        return Err(Error::argument(what, fix));
    }
    if let Some(i) = weights.iter().position(|w| !w.is_finite() || *w < 0.0) {
        let what = format!("weight {} in column {}, row {}", weights[i], i % width, i / width);
        return Err(Error::argument(what, fix));
    }
    if weights.iter().all(|w| *w == 0.0) {
        return Err(Error::argument("all weights of the grid are zero", fix));
    }
    Ok(())
}

/// Appends the cumulative shares of `weights`, from 0 to exactly 1, and returns their sum in units of `unit`. Without mass, shares are
/// equal: nothing chooses such a row.
fn push_cumulative(cdf: &mut Vec<f64>, weights: &[f64], unit: f64) -> f64 {
    let start = cdf.len();
    cdf.push(0.0);
    let mut sum = 0.0;
    for w in weights {
        sum += w / unit;
        cdf.push(sum);
    }
    let shares = &mut cdf[start + 1..];
    for (i, c) in shares.iter_mut().enumerate() {
        *c = if sum > 0.0 { *c / sum } else { (i + 1) as f64 / weights.len() as f64 };
    }
    sum
}

/// The interval of positive mass that holds `u`, and the share of it below `u`, in [0, 1).
fn place(cdf: &[f64], u: f64) -> (usize, f64) {
    let u = u.clamp(0.0, 1.0f64.next_down());
    let above = cdf.partition_point(|&c| c <= u);
    let i = above.saturating_sub(1).min(cdf.len() - 2);
    (i, (u - cdf[i]) / (cdf[i + 1] - cdf[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Point `i` of a well-spread sequence (Roberts's R2).
    fn spread(i: u32) -> DVec2 {
        DVec2::new(f64::from(i) * 0.754_877_666_246_693, f64::from(i) * 0.569_840_290_998_053).fract()
    }

    /// Not square, zeros in front, behind and between, and one empty row.
    fn uneven() -> Piecewise2d {
        #[rustfmt::skip]
        let weights = [
            0.0, 3.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, 0.0, 0.0,
            1.0, 0.0, 2.0, 0.0, 9.0,
        ];
        Piecewise2d::new(5, 3, &weights).unwrap()
    }

    #[test]
    fn masses_are_the_shares_of_the_weights() {
        let d = uneven();
        assert_eq!(d.mass(1, 0), 3.0 / 16.0);
        assert_eq!(d.mass(4, 2), 9.0 / 16.0);
        assert_eq!(d.mass(2, 1), 0.0);
        assert_eq!(d.mass(5, 0), 0.0);
        assert_eq!(d.pdf(DVec2::new(0.3, 0.1)), 3.0 / 16.0 * 15.0);
        assert_eq!(d.pdf(DVec2::new(1.0, 0.1)), 0.0);
        assert_eq!(d.pdf(DVec2::new(f64::NAN, 0.1)), 0.0);
    }

    #[test]
    fn corners_of_the_square_land_in_cells_with_mass() {
        let d = uneven();
        let ends = [0.0, f64::MIN_POSITIVE, 0.25, 0.75, 1.0f64.next_down(), 1.0, -1.0, 2.0];
        for x in ends {
            for y in ends {
                let p = d.sample(DVec2::new(x, y));
                assert!(d.pdf(p) > 0.0, "({x}, {y}) → {p}");
            }
        }
    }

    #[test]
    fn invert_undoes_sample() {
        let d = uneven();
        for i in 0..5000 {
            let u = spread(i);
            let back = d.invert(d.sample(u)).unwrap();
            assert!(back.abs_diff_eq(u, 1e-14), "{u} {back}");
        }
        assert_eq!(d.invert(DVec2::new(0.1, 0.5)), None);
    }

    #[test]
    fn samples_fill_cells_by_their_mass() {
        let d = uneven();
        let mut counts = [0u32; 15];
        let n = 1 << 14;
        for i in 0..n {
            let p = d.sample(spread(i));
            counts[(p.x * 5.0) as usize + 5 * (p.y * 3.0) as usize] += 1;
        }
        for (i, &count) in counts.iter().enumerate() {
            let share = f64::from(count) / f64::from(n);
            assert!((share - d.mass(i % 5, i / 5)).abs() < 2e-3, "cell {i}: {share}");
        }
    }

    #[test]
    fn bad_weights_are_refused() {
        assert!(Piecewise2d::new(2, 1, &[1.0]).is_err());
        assert!(Piecewise2d::new(0, 0, &[]).is_err());
        assert!(Piecewise2d::new(2, 1, &[0.0, 0.0]).is_err());
        let message = Piecewise2d::new(2, 2, &[1.0, 1.0, 1.0, -2.0]).unwrap_err().to_string();
        assert!(message.contains("column 1, row 1"), "{message}");
        assert!(Piecewise2d::new(2, 1, &[1.0, f64::NAN]).is_err());
    }

    #[test]
    fn extreme_weights_keep_their_shares() {
        for unit in [f64::MAX, f64::MIN_POSITIVE * 1e-3] {
            let d = Piecewise2d::new(2, 2, &[unit, 0.0, unit, 0.0]).unwrap();
            assert_eq!(d.mass(0, 0), 0.5);
            assert_eq!(d.mass(0, 1), 0.5);
        }
    }
}
