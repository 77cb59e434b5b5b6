//! Piecewise-constant densities, sampled by inverting the cumulative sum.

use glam::DVec2;

use crate::{Error, Result};

/// A piecewise-constant density on the unit square: a grid of `width` × `height` cells of equal size.
///
/// A point of the unit square chooses a row by its `y` and, within the row, a column by its `x`; what is left of each
/// coordinate places the point in the cell. The map is continuous along each axis, so well-spread points stay well spread.
/// Cumulative sums are `f64`: the ratio of a sun to a sky exceeds the resolution of `f32`. Intervals are found by guide
/// tables (Chen and Asau 1974), and by bisection where many share a cell of the guide.
///
/// # Examples
/// ```
/// use merlkit::distribution::Piecewise2d;
/// use merlkit::glam::DVec2;
///
/// let density = Piecewise2d::new(2, 1, &[1.0, 3.0])?;
/// assert!((density.mass(1, 0) - 0.75).abs() < 1e-12);
/// let u = DVec2::new(0.5, 0.5);
/// let p = density.sample(u);
/// assert!(p.x > 0.5 && (density.pdf(p) - 1.5).abs() < 1e-12);
/// assert!(density.invert(p).expect("drawn").abs_diff_eq(u, 1e-9));
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Piecewise2d {
    width: usize,
    height: usize,
    /// Cumulative probability of rows, `height + 1` values from 0 to 1.
    rows: Vec<f64>,
    /// Cumulative probability of columns within each row, `[row][width + 1]`.
    columns: Vec<f64>,
    row_guide: Guide,
    /// Of all rows, one after another.
    column_guide: Guide,
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
        // Step 1: the conditional F(x | y) of each row, and the row's weight Σ w.
        let mut columns = Vec::with_capacity(height * (width + 1));
        let sums: Vec<f64> = weights
            .chunks_exact(width)
            .map(|row| push_cumulative(&mut columns, row, largest))
            .collect();
        // Step 2: the marginal F(y).
        let mut rows = Vec::with_capacity(height + 1);
        push_cumulative(&mut rows, &sums, 1.0);
        // Step 3: where searches of either begin.
        let row_guide = Guide::new(&rows, height);
        let column_guide = Guide::new(&columns, width);
        Ok(Self {
            width,
            height,
            rows,
            columns,
            row_guide,
            column_guide,
        })
    }

    /// Columns of the grid.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of the grid.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bytes of memory that the cumulative sums and their guides hold.
    pub fn bytes(&self) -> usize {
        let sums = size_of_val(self.rows.as_slice()) + size_of_val(self.columns.as_slice());
        sums + self.row_guide.bytes() + self.column_guide.bytes()
    }

    /// Maps `u` in [0, 1)² to a point in [0, 1)² that lies where the density is positive; coordinates outside are clamped.
    pub fn sample(&self, u: DVec2) -> DVec2 {
        // F(y) is inverted at u.y, then F(x | y) of that row at u.x.
        let (row, y) = find_interval(&self.rows, self.row_guide.row_guide(0), u.y);
        let (column, x) = find_interval(self.row(row), self.column_guide.row_guide(row), u.x);
        debug_assert!((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y));
        DVec2::new(
            position(column, x, self.width),
            position(row, y, self.height),
        )
    }

    /// Density at `p` per unit area of the square; 0 outside [0, 1)².
    pub fn pdf(&self, p: DVec2) -> f64 {
        // The density is probability over area, and each cell has the area 1/(width·height).
        self.cell(p).map_or(0.0, |(x, y)| {
            self.mass(x, y) * (self.width * self.height) as f64
        })
    }

    /// Probability of the cell in column `x` and row `y`; 0 outside the grid.
    pub fn mass(&self, x: usize, y: usize) -> f64 {
        if x >= self.width || y >= self.height {
            return 0.0;
        }
        // p(x, y) = p(y) p(x | y)
        let row = self.row(y);
        (self.rows[y + 1] - self.rows[y]) * (row[x + 1] - row[x])
    }

    /// The `u` that [`Self::sample`] maps to `p`; `None` where the density is zero.
    pub fn invert(&self, p: DVec2) -> Option<DVec2> {
        let (x, y) = self.cell(p)?;
        if self.mass(x, y) == 0.0 {
            return None;
        }
        // Both distributions are linear within a cell: u = F(i) + t (F(i + 1) − F(i)), where t is the place in cell i.
        let size = DVec2::new(self.width as f64, self.height as f64);
        let place = p * size - DVec2::new(x as f64, y as f64);
        Some(DVec2::new(
            interpolate(self.row(y), x, place.x),
            interpolate(&self.rows, y, place.y),
        ))
    }

    fn row(&self, y: usize) -> &[f64] {
        &self.columns[y * (self.width + 1)..(y + 1) * (self.width + 1)]
    }

    fn cell(&self, p: DVec2) -> Option<(usize, usize)> {
        let column = cell_of_axis(p.x, self.width)?;
        let row = cell_of_axis(p.y, self.height)?;
        Some((column, row))
    }
}

/// The cell that `v` falls into, of `cells` even ones on [0, 1); `None` outside.
#[inline]
fn cell_of_axis(v: f64, cells: usize) -> Option<usize> {
    if !(0.0..1.0).contains(&v) {
        return None;
    }
    Some(((v * cells as f64) as usize).min(cells - 1))
}

/// The position on [0, 1) of a place in a cell, 0 to 1, of `cells` even ones.
#[inline]
fn position(cell: usize, place: f64, cells: usize) -> f64 {
    // Rounding must not carry the point into the next cell, whose density may be zero.
    let end = ((cell + 1) as f64 / cells as f64).next_down();
    ((cell as f64 + place) / cells as f64).min(end)
}

/// A distribution at a place in cell `i`, 0 to 1, where it is linear.
#[inline]
fn interpolate(cdf: &[f64], i: usize, place: f64) -> f64 {
    cdf[i] + place * (cdf[i + 1] - cdf[i])
}

fn check(width: usize, height: usize, weights: &[f64]) -> Result<()> {
    let fix = "give one finite weight ≥ 0 a cell, at least one of them positive";
    if width == 0 || height == 0 || width.checked_mul(height) != Some(weights.len()) {
        let what = format!("{} weights for a grid of {width} × {height}", weights.len());
        return Err(Error::argument(what, fix));
    }
    if let Some(i) = weights.iter().position(|w| !w.is_finite() || *w < 0.0) {
        let what = format!(
            "weight {} in column {}, row {}",
            weights[i],
            i % width,
            i / width
        );
        return Err(Error::argument(what, fix));
    }
    if weights.iter().all(|w| *w == 0.0) {
        return Err(Error::argument("all weights of the grid are zero", fix));
    }
    Ok(())
}

/// Appends the cumulative probabilities of `weights`, from 0 to exactly 1, and returns the sum of the weights in units of `unit`.
/// Without mass, all are equal: such a row is never chosen.
fn push_cumulative(cdf: &mut Vec<f64>, weights: &[f64], unit: f64) -> f64 {
    let start = cdf.len();
    cdf.push(0.0);
    let mut sum = 0.0;
    for w in weights {
        sum += w / unit;
        cdf.push(sum);
    }
    // Divided by the sum itself, the last value is exactly 1, so that no u in [0, 1) lies beyond it.
    let shares = &mut cdf[start + 1..];
    for (i, c) in shares.iter_mut().enumerate() {
        *c = if sum > 0.0 {
            *c / sum
        } else {
            (i + 1) as f64 / weights.len() as f64
        };
    }
    sum
}

/// Intervals that are compared with `u` all at once rather than bisected: no branch to predict.
const NEAR: usize = 8;

/// For cumulative sums of equal number of intervals, one after another: where in each the search for `u` begins and ends.
///
/// [0, 1) is divided into as many cells as there are intervals. A value of the sums that is in an earlier cell than `u` is
/// not above it, and one in a later cell is. Rounding does not change that: the number of a cell does not decrease as its
/// value rises.
#[derive(Clone, Debug)]
struct Guide {
    cells: usize,
    /// Values of the sum in earlier cells, `[sum][cells + 1]`; empty if they don't fit in 16 bits.
    starts: Vec<u16>,
}

impl Guide {
    /// A guide to sums of `cells + 1` values.
    fn new(sums: &[f64], cells: usize) -> Self {
        let mut starts = Vec::new();
        if cells < usize::from(u16::MAX) {
            starts.reserve_exact(sums.len());
            sums.chunks_exact(cells + 1)
                .for_each(|cdf| push_starts(&mut starts, cdf));
        }
        Self { cells, starts }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice())
    }

    /// The guide to one of the sums.
    fn row_guide(&self, sum: usize) -> &[u16] {
        self.starts
            .get(sum * (self.cells + 1)..(sum + 1) * (self.cells + 1))
            .unwrap_or_default()
    }
}

fn push_starts(starts: &mut Vec<u16>, cdf: &[f64]) {
    debug_assert!(cdf.is_sorted());
    let cells = cdf.len() - 1;
    let mut earlier = 0;
    for k in 0..cells {
        // F never falls, so one pass over it counts the values before every cell.
        while earlier < cells && guide_cell(cdf[earlier], cells) < k {
            earlier += 1;
        }
        starts.push(earlier as u16);
    }
    starts.push(cdf.len() as u16);
}

fn guide_cell(u: f64, cells: usize) -> usize {
    ((u * cells as f64) as u32 as usize).min(cells - 1)
}

/// The interval of positive mass that holds `u`, and the fraction of it below `u`, in [0, 1].
#[inline]
fn find_interval(cdf: &[f64], guide: &[u16], u: f64) -> (usize, f64) {
    // Not a number counts as 0, and −0, whose sign would mislead, becomes 0.
    let u = u.max(0.0).min(1.0f64.next_down()) + 0.0;
    // F(i) ≤ u < F(i + 1), so interval i has mass, and u lies at (u − F(i))/(F(i + 1) − F(i)) in it.
    let i = above(cdf, guide, u).saturating_sub(1).min(cdf.len() - 2);
    (i, (u - cdf[i]) / (cdf[i + 1] - cdf[i]))
}

/// Index of the first value above `u`.
#[inline]
fn above(cdf: &[f64], guide: &[u16], u: f64) -> usize {
    let cell = guide_cell(u, cdf.len() - 1);
    let (from, to) = match guide.get(cell..cell + 2) {
        Some(&[from, to]) => (usize::from(from), usize::from(to)),
        _ => (0, cdf.len()),
    };
    let start = from.min(cdf.len().saturating_sub(NEAR));
    match cdf.get(start..start + NEAR) {
        Some(near) if to <= start + NEAR => {
            // The signs of u − c are exact, and counted without branches.
            let mut above = 0;
            for &c in near {
                above += ((u - c).to_bits() >> 63) as usize;
            }
            start + NEAR - above
        }
        _ => from + cdf[from..to].partition_point(|&c| c <= u),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Point `i` of a well-spread sequence (Roberts's R2).
    fn spread(i: u32) -> DVec2 {
        DVec2::new(
            f64::from(i) * 0.754_877_666_246_693,
            f64::from(i) * 0.569_840_290_998_053,
        )
        .fract()
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
        let ends = [
            0.0,
            f64::MIN_POSITIVE,
            0.25,
            0.75,
            1.0f64.next_down(),
            1.0,
            -1.0,
            2.0,
        ];
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
            assert!(
                (share - d.mass(i % 5, i / 5)).abs() < 2e-3,
                "cell {i}: {share}"
            );
        }
    }

    /// Every value of the sums and its neighbours, the ends, what is outside, and points in between.
    fn hard_values(sums: &[f64]) -> impl Iterator<Item = f64> {
        let ends = [
            -1.0,
            -0.0,
            f64::MIN_POSITIVE,
            1.0f64.next_down(),
            1.0,
            2.0,
            f64::INFINITY,
            f64::NAN,
        ];
        let close = sums.iter().flat_map(|&c| [c.next_down(), c, c.next_up()]);
        ends.into_iter()
            .chain(close)
            .chain((0..200).map(|i| spread(i).x))
    }

    #[test]
    fn guides_find_what_bisection_finds() {
        let random = |i: u32| spread(i).x * spread(i).y.powi(12);
        let sun = |at: usize| move |i: u32| if i as usize == at { 1e9 } else { random(i) };
        let comb = |i: u32| if i % 3 == 1 { random(i) } else { 0.0 };
        let weights: [&dyn Fn(u32) -> f64; 7] = [
            &random,
            &sun(0),
            &sun(40),
            &sun(150),
            &comb,
            &|_| 0.0,
            &|_| 1.0,
        ];
        for width in [1, 2, 3, 5, 8, 9, 64, 151, 70_000] {
            for (w, weight) in weights.iter().enumerate() {
                let weights: Vec<f64> = (0..width).map(weight).collect();
                let mut cdf = Vec::new();
                push_cumulative(&mut cdf, &weights, 1.0);
                let guide = Guide::new(&cdf, width as usize);
                for u in hard_values(if width < 1000 { &cdf } else { &cdf[..1000] }) {
                    let (i, share) = find_interval(&cdf, guide.row_guide(0), u);
                    let u = u.max(0.0).min(1.0f64.next_down());
                    let expected = cdf.partition_point(|&c| c <= u).saturating_sub(1);
                    assert_eq!(i, expected, "{width} {w} {u:e}");
                    assert!((0.0..=1.0).contains(&share), "{width} {w} {u:e}: {share}");
                }
            }
        }
    }

    #[test]
    fn guides_have_two_bytes_an_interval() {
        let bytes = |width, height| {
            Piecewise2d::new(width, height, &vec![1.0; width * height])
                .unwrap()
                .bytes()
        };
        assert_eq!(bytes(5, 3), (8 + 2) * (6 * 3 + 4));
        assert_eq!(bytes(70_000, 1), 8 * 70_001 + (8 + 2) * 2);
    }

    #[test]
    fn bad_weights_are_refused() {
        assert!(Piecewise2d::new(2, 1, &[1.0]).is_err());
        assert!(Piecewise2d::new(0, 0, &[]).is_err());
        assert!(Piecewise2d::new(2, 1, &[0.0, 0.0]).is_err());
        let message = Piecewise2d::new(2, 2, &[1.0, 1.0, 1.0, -2.0])
            .unwrap_err()
            .to_string();
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
