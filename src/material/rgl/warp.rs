//! Bilinear functions on the unit square that depend on two angles, and the map of the square that follows one.
//!
//! Functions at angles between the tabulated ones are means of the neighbours, outside them the nearest. Points of the square
//! are (x, y); x runs along the rows.

use super::tensors::Tensor;

/// The (at most four) tabulated slices about a pair of angles, and their weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct SliceBlend([(usize, f64); 4]);

impl SliceBlend {
    /// For grids that depend on nothing.
    pub const ONLY: Self = Self([(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);

    /// The slices about `phi` and `theta` (radians) on the axes of a file; slices are numbered with theta the faster.
    pub fn between(phi: f64, theta: f64, phi_i: &[f32], theta_i: &[f32]) -> Self {
        let ((p, v), (t, w)) = (neighbours(phi, phi_i), neighbours(theta, theta_i));
        let at =
            |p: usize, t: usize| p.min(phi_i.len() - 1) * theta_i.len() + t.min(theta_i.len() - 1);
        Self([
            (at(p, t), (1.0 - v) * (1.0 - w)),
            (at(p, t + 1), (1.0 - v) * w),
            (at(p + 1, t), v * (1.0 - w)),
            (at(p + 1, t + 1), v * w),
        ])
    }

    #[inline]
    fn mean(&self, value: impl Fn(usize) -> f32) -> f64 {
        let mut sum = 0.0;
        for &(slice, weight) in &self.0 {
            if weight > 0.0 {
                sum += weight * f64::from(value(slice));
            }
        }
        sum
    }
}

/// The tabulated value at or below `x` on a rising axis that is not empty, and the weight of the next; clamped at both ends.
fn neighbours(x: f64, axis: &[f32]) -> (usize, f64) {
    let low = axis
        .partition_point(|&a| f64::from(a) <= x)
        .saturating_sub(1)
        .min(axis.len().saturating_sub(2));
    match axis.get(low..low + 2) {
        Some(&[a, b]) => {
            let (a, b) = (f64::from(a), f64::from(b));
            (low, ((x - a) / (b - a)).clamp(0.0, 1.0))
        }
        _ => (0, 0.0),
    }
}

/// A cell of a grid and a point inside it, x and y in [0, 1].
#[derive(Clone, Copy)]
struct GridCell {
    column: usize,
    row: usize,
    x: f64,
    y: f64,
}

impl GridCell {
    /// The cell that holds a point; points outside the square go to its edge.
    fn containing(point: [f64; 2], width: usize, height: usize) -> Self {
        let along = |v: f64, n: usize| {
            let scaled = v.clamp(0.0, 1.0) * (n - 1) as f64;
            let cell = (scaled as usize).min(n - 2);
            (cell, scaled - cell as f64)
        };
        let ((column, x), (row, y)) = (along(point[0], width), along(point[1], height));
        Self { column, row, x, y }
    }
}

/// `shape` is `[…, h, w]`, every `[h, w]` one slice of `channels` in a row.
#[derive(Debug)]
pub(super) struct SliceGrid {
    values: Vec<f32>,
    width: usize,
    height: usize,
    channels: usize,
}

impl SliceGrid {
    /// A tensor whose last two axes, of at least 2 each, are the square; the one before is `channels` long, if not 1.
    pub fn new(tensor: Tensor, channels: usize) -> Self {
        let axes = tensor.shape.len();
        Self {
            width: tensor.shape[axes - 1],
            height: tensor.shape[axes - 2],
            channels,
            values: tensor.values,
        }
    }

    /// Value of a channel at a point.
    pub fn interpolate(&self, point: [f64; 2], channel: usize, blend: &SliceBlend) -> f64 {
        let cell = GridCell::containing(point, self.width, self.height);
        let [left, right] = self.corners(&cell, channel, blend);
        left + (right - left) * cell.x
    }

    /// Values on the left and right of a cell.
    fn corners(&self, cell: &GridCell, channel: usize, blend: &SliceBlend) -> [f64; 2] {
        let first = cell.row * self.width + cell.column;
        let side = |k: usize| {
            let at = |k: usize| {
                blend.mean(|slice| {
                    let start = (slice * self.channels + channel) * self.width * self.height;
                    self.values[start + k]
                })
            };
            let (low, high) = (at(first + k), at(first + k + self.width));
            low + (high - low) * cell.y
        };
        [side(0), side(1)]
    }

    /// Bytes of the values.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }

    fn slices(&self) -> impl Iterator<Item = &[f32]> {
        self.values.chunks_exact(self.width * self.height)
    }
}

/// A density on the square in each slice, and the continuous map that draws from it: y by the marginal, then x by the
/// density along the row, both piecewise linear.
#[derive(Debug)]
pub(super) struct SquareWarp {
    density: SliceGrid,
    /// Integral over x up to each column, of each row: `[slice, h, w − 1]`.
    along: Vec<f32>,
    /// Integral over y up to each row: `[slice, h − 1]`.
    rows: Vec<f32>,
}

impl SquareWarp {
    /// From values ≥ 0, each slice above 0 somewhere; slices are normalised.
    pub fn new(tensor: Tensor) -> Self {
        let mut density = SliceGrid::new(tensor, 1);
        let (w, h) = (density.width, density.height);
        let (step_x, step_y) = (0.5 / (w - 1) as f64, 0.5 / (h - 1) as f64);
        let (mut along, mut rows, mut scales) = (Vec::new(), Vec::new(), Vec::new());
        for slice in density.slices() {
            let sums: Vec<Vec<f64>> = slice
                .chunks_exact(w)
                .map(|row| running(row, step_x))
                .collect();
            let totals: Vec<f32> = sums.iter().map(|s| s[w - 2] as f32).collect();
            let marginal = running(&totals, step_y);
            let scale = 1.0 / marginal[h - 2];
            along.extend(sums.iter().flatten().map(|&v| (v * scale) as f32));
            rows.extend(marginal.iter().map(|&v| (v * scale) as f32));
            scales.push(scale);
        }
        for (slice, scale) in density.values.chunks_exact_mut(w * h).zip(scales) {
            slice
                .iter_mut()
                .for_each(|v| *v = (f64::from(*v) * scale) as f32);
        }
        Self {
            density,
            along,
            rows,
        }
    }

    /// Density at a point of the square.
    pub fn density(&self, point: [f64; 2], blend: &SliceBlend) -> f64 {
        self.density.interpolate(point, 0, blend)
    }

    /// The point of the square that is mapped to `point`, and the density there. 0 on both axes where nothing is drawn.
    pub fn invert(&self, point: [f64; 2], blend: &SliceBlend) -> ([f64; 2], f64) {
        let (w, h) = (self.density.width, self.density.height);
        let cell = GridCell::containing(point, w, h);
        // u_x = ∫₀ˣ p(t, y) dt / ∫₀¹ p(t, y) dt: whole columns, and the trapezoid inside the cell.
        let [left, right] = self.density.corners(&cell, 0, blend);
        let inside = 0.5 * (left + left + (right - left) * cell.x) * cell.x / (w - 1) as f64;
        let x = self.row_sum(&cell, cell.column, blend) + inside;
        let whole = self.row_sum(&cell, w - 1, blend);
        // u_y = ∫₀ʸ of the marginal: whole rows, and the trapezoid inside the cell.
        let [low, high] = self.row_totals(cell.row, blend);
        let inside = 0.5 * (low + low + (high - low) * cell.y) * cell.y / (h - 1) as f64;
        let y = self.rows_to(cell.row, blend) + inside;
        let pdf = left + (right - left) * cell.x;
        ([if whole > 0.0 { x / whole } else { 0.0 }, y], pdf)
    }

    /// The point that `u` is mapped to.
    pub fn sample(&self, u: [f64; 2], blend: &SliceBlend) -> [f64; 2] {
        let (w, h) = (self.density.width, self.density.height);
        // The row in which the marginal's integral reaches u_y, and where in it.
        let row = search(h - 1, |k| self.rows_to(k + 1, blend) <= u[1]);
        let [low, high] = self.row_totals(row, blend);
        let y = invert_linear_cdf(
            (u[1] - self.rows_to(row, blend)) * (h - 1) as f64,
            low,
            high,
        );
        let mut cell = GridCell {
            column: 0,
            row,
            x: 0.0,
            y,
        };
        // The column in which the integral along that row reaches its part u_x, and where in it.
        let target = u[0] * self.row_sum(&cell, w - 1, blend);
        cell.column = search(w - 1, |k| self.row_sum(&cell, k + 1, blend) <= target);
        let [left, right] = self.density.corners(&cell, 0, blend);
        let rest = target - self.row_sum(&cell, cell.column, blend);
        let x = invert_linear_cdf(rest * (w - 1) as f64, left, right);
        [
            (cell.column as f64 + x) / (w - 1) as f64,
            (row as f64 + y) / (h - 1) as f64,
        ]
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        self.density.bytes() + size_of_val(&self.along[..]) + size_of_val(&self.rows[..])
    }

    /// Integral over x up to a column, along the row that a cell's y means.
    fn row_sum(&self, cell: &GridCell, column: usize, blend: &SliceBlend) -> f64 {
        if column == 0 {
            return 0.0;
        }
        let (w, h) = (self.density.width, self.density.height);
        let at =
            |row: usize| blend.mean(|slice| self.along[(slice * h + row) * (w - 1) + column - 1]);
        let (low, high) = (at(cell.row), at(cell.row + 1));
        low + (high - low) * cell.y
    }

    /// Integrals over x along a row and the next.
    fn row_totals(&self, row: usize, blend: &SliceBlend) -> [f64; 2] {
        let last = self.density.width - 1;
        [0.0, 1.0].map(|y| {
            self.row_sum(
                &GridCell {
                    column: 0,
                    row,
                    x: 0.0,
                    y,
                },
                last,
                blend,
            )
        })
    }

    /// Integral over y up to a row.
    fn rows_to(&self, row: usize, blend: &SliceBlend) -> f64 {
        let h = self.density.height;
        if row == 0 {
            0.0
        } else {
            blend.mean(|slice| self.rows[slice * (h - 1) + row - 1])
        }
    }
}

/// Integral of the linear interpolant up to each value but the first; `half_step` is half the distance between values.
fn running(values: &[f32], half_step: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let trapezoids = values
        .windows(2)
        .map(|v| half_step * (f64::from(v[0]) + f64::from(v[1])));
    trapezoids
        .map(|t| {
            sum += t;
            sum
        })
        .collect()
}

/// The number of values for which `is_below` holds, at most `count − 1`; it holds for the first ones.
fn search(count: usize, is_below: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count - 1);
    while low < high {
        let middle = (low + high) / 2;
        if is_below(middle) {
            low = middle + 1
        } else {
            high = middle
        }
    }
    low
}

/// Where the integral of a density that goes from `a` to `b` over [0, 1] reaches `mass`: the x of a·x + (b − a)·x²/2 = mass.
fn invert_linear_cdf(mass: f64, a: f64, b: f64) -> f64 {
    let root = (a * a + 2.0 * mass * (b - a)).max(0.0).sqrt();
    let x = 2.0 * mass / (a + root);
    if x.is_finite() {
        x.clamp(0.0, 1.0)
    } else {
        0.0
    }
}
