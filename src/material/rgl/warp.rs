//! Bilinear functions on the unit square that depend on two angles, and the map of the square that follows one.
//!
//! Functions at angles between the tabulated ones are means of the neighbours, outside them the nearest. Points of the square
//! are (x, y); x runs along the rows.

use super::tensors::Tensor;

/// The tabulated slices about a pair of angles, at most four, and their weights; slices of no weight are left out.
#[derive(Clone, Copy, Debug)]
pub(super) struct SliceBlend {
    parts: [(usize, f64); 4],
    count: usize,
}

impl SliceBlend {
    /// For grids that depend on nothing.
    pub const ONLY: Self = Self {
        parts: [(0, 1.0); 4],
        count: 1,
    };

    /// The slices about `phi` and `theta` (radians) on the axes of a file; slices are numbered with theta the faster.
    #[inline(always)]
    pub fn between(phi: f64, theta: f64, phi_i: &[f64], theta_i: &[f64]) -> Self {
        let (p, v) = neighbours(phi, phi_i);
        let (t, w) = neighbours(theta, theta_i);
        let mut blend = Self {
            parts: [(0, 0.0); 4],
            count: 0,
        };
        // Weights of the corners, (1 − v)(1 − w) to v·w, sum to 1. So the mean of densities is a density.
        for (p, v) in [(p, 1.0 - v), (p + 1, v)] {
            for (t, w) in [(t, 1.0 - w), (t + 1, w)] {
                // A neighbour past the end of an axis has no weight.
                if v * w > 0.0 {
                    blend.parts[blend.count] = (p * theta_i.len() + t, v * w);
                    blend.count += 1;
                }
            }
        }
        blend
    }

    #[inline(always)]
    fn parts(&self) -> &[(usize, f64)] {
        &self.parts[..self.count]
    }
}

/// The tabulated value at or below `x` on a rising axis that is not empty, and the weight of the next; clamped at both ends.
#[inline(always)]
fn neighbours(x: f64, axis: &[f64]) -> (usize, f64) {
    let [_, inner @ .., _] = axis else {
        return (0, 0.0);
    };
    // Axes are short, so all nodes are compared: no branch depends on x.
    let mut low = 0;
    for &node in inner {
        low += usize::from(node <= x);
    }
    let (a, b) = (axis[low], axis[low + 1]);
    (low, ((x - a) / (b - a)).clamp(0.0, 1.0))
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
    #[inline(always)]
    fn containing(point: [f64; 2], width: usize, height: usize) -> Self {
        let (column, x) = locate(point[0], width);
        let (row, y) = locate(point[1], height);
        Self { column, row, x, y }
    }
}

/// The interval between `nodes` even nodes on [0, 1] that holds `v`, which is clamped, and where `v` is inside it, 0 to 1.
#[inline(always)]
fn locate(v: f64, nodes: usize) -> (usize, f64) {
    let scaled = v.clamp(0.0, 1.0) * (nodes - 1) as f64;
    let interval = (scaled as usize).min(nodes - 2);
    (interval, scaled - interval as f64)
}

/// low + (high − low) t of each channel.
#[inline(always)]
fn interpolate_linearly<const C: usize>(low: [f64; C], high: [f64; C], t: f64) -> [f64; C] {
    std::array::from_fn(|c| low[c] + (high[c] - low[c]) * t)
}

/// Values of `C` channels at the nodes of a square, in each slice. Those of one node lie together, since a look-up wants all.
#[derive(Debug)]
pub(super) struct SliceGrid<const C: usize> {
    /// `[slice, h, w]`.
    nodes: Vec<[f32; C]>,
    width: usize,
    height: usize,
}

impl<const C: usize> SliceGrid<C> {
    /// A tensor whose last two axes, of at least 2 each, are the square; the one before is `C` long, if not 1.
    pub fn new(tensor: &Tensor) -> Self {
        let axes = tensor.shape.len();
        let width = tensor.shape[axes - 1];
        let height = tensor.shape[axes - 2];
        let plane = width * height;
        let mut nodes = Vec::with_capacity(tensor.values.len() / C);
        for slice in tensor.values.chunks_exact(C * plane) {
            for node in 0..plane {
                nodes.push(std::array::from_fn(|channel| slice[channel * plane + node]));
            }
        }
        Self {
            nodes,
            width,
            height,
        }
    }

    /// Values of all channels at a point.
    #[inline(always)]
    pub fn interpolate(&self, point: [f64; 2], blend: &SliceBlend) -> [f64; C] {
        let cell = GridCell::containing(point, self.width, self.height);
        let [left, right] = self.sides(&cell, blend);
        interpolate_linearly(left, right, cell.x)
    }

    /// Values on the left and right of a cell, at the height of its point.
    #[inline(always)]
    fn sides(&self, cell: &GridCell, blend: &SliceBlend) -> [[f64; C]; 2] {
        // Means over the slices on the lower and the upper row, left and right of the cell.
        let mut rows = [[[0.0; C]; 2]; 2];
        match blend.parts() {
            // Two slices are the commonest case by far: without a loop, their values are waited for together.
            &[first, second] => {
                self.add_slice(&mut rows, cell, first);
                self.add_slice(&mut rows, cell, second);
            }
            parts => {
                for &part in parts {
                    self.add_slice(&mut rows, cell, part);
                }
            }
        }
        let [low, high] = rows;
        [
            interpolate_linearly(low[0], high[0], cell.y),
            interpolate_linearly(low[1], high[1], cell.y),
        ]
    }

    /// Adds a slice's values at the corners of a cell, times its weight: lower and upper row, left and right.
    #[inline(always)]
    fn add_slice(
        &self,
        rows: &mut [[[f64; C]; 2]; 2],
        cell: &GridCell,
        (slice, weight): (usize, f64),
    ) {
        let first = (slice * self.height + cell.row) * self.width + cell.column;
        let nodes = &self.nodes[first..first + self.width + 2];
        add_weighted(&mut rows[0], weight, [nodes[0], nodes[1]]);
        let upper = [nodes[self.width], nodes[self.width + 1]];
        add_weighted(&mut rows[1], weight, upper);
    }

    /// Bytes of the values.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }
}

/// Adds a slice's values at two nodes, times its weight.
#[inline(always)]
fn add_weighted<const C: usize>(sums: &mut [[f64; C]; 2], weight: f64, nodes: [[f32; C]; 2]) {
    for (sums, node) in sums.iter_mut().zip(nodes) {
        for (sum, value) in sums.iter_mut().zip(node) {
            *sum += weight * f64::from(value);
        }
    }
}

/// A density on the square in each slice, and the continuous map that draws from it: y by the marginal, then x by the
/// density along the row, both piecewise linear.
#[derive(Debug)]
pub(super) struct SquareWarp {
    /// The density, and its integral over x up to the node.
    nodes: SliceGrid<2>,
    /// Integral over y up to the row, and over x along it: `[slice, h]`.
    rows: Vec<[f32; 2]>,
}

impl SquareWarp {
    /// From values ≥ 0, each slice above 0 somewhere; slices are normalised.
    pub fn new(tensor: &Tensor) -> Self {
        let axes = tensor.shape.len();
        let (w, h) = (tensor.shape[axes - 1], tensor.shape[axes - 2]);
        let (step_x, step_y) = (0.5 / (w - 1) as f64, 0.5 / (h - 1) as f64);
        let mut nodes = Vec::with_capacity(tensor.values.len());
        let mut rows = Vec::new();
        for slice in tensor.values.chunks_exact(w * h) {
            // Step 1: ∫ over x along each row up to each node, by trapezoids, which are exact for linear functions.
            let sums: Vec<Vec<f64>> = slice
                .chunks_exact(w)
                .map(|row| running(row, step_x))
                .collect();
            let totals: Vec<f32> = sums.iter().map(|s| s[w - 1] as f32).collect();
            // Step 2: ∫ over y of the rows' totals, which are linear between rows too.
            let marginal = running(&totals, step_y);
            // Step 3: all of it over the integral over the square, so that the density integrates to 1.
            let scale = 1.0 / marginal[h - 1];
            for (&value, &sum) in slice.iter().zip(sums.iter().flatten()) {
                nodes.push([f64::from(value), sum].map(|v| (v * scale) as f32));
            }
            for (row, &sum) in marginal.iter().enumerate() {
                rows.push([sum, sums[row][w - 1]].map(|v| (v * scale) as f32));
            }
        }
        let nodes = SliceGrid {
            nodes,
            width: w,
            height: h,
        };
        Self { nodes, rows }
    }

    /// Density at a point of the square.
    pub fn density(&self, point: [f64; 2], blend: &SliceBlend) -> f64 {
        self.nodes.interpolate(point, blend)[0]
    }

    /// The point of the square that is mapped to `point`, and the density there. 0 on both axes where nothing is drawn.
    #[inline(always)]
    pub fn invert(&self, point: [f64; 2], blend: &SliceBlend) -> ([f64; 2], f64) {
        let (w, h) = (self.nodes.width, self.nodes.height);
        let cell = GridCell::containing(point, w, h);
        // u_x = ∫₀ˣ p(t, y) dt / ∫₀¹ p(t, y) dt: whole columns, and the trapezoid inside the cell.
        let [[left, columns], [right, _]] = self.nodes.sides(&cell, blend);
        let inside = 0.5 * (left + left + (right - left) * cell.x) * cell.x / (w - 1) as f64;
        let x = columns + inside;
        // u_y = ∫₀ʸ of the marginal: whole rows, and the trapezoid inside the cell.
        let [[rows, low], [_, high]] = self.rows_about(cell.row, blend);
        let whole = low + (high - low) * cell.y;
        let inside = 0.5 * (low + low + (high - low) * cell.y) * cell.y / (h - 1) as f64;
        let y = rows + inside;
        let pdf = left + (right - left) * cell.x;
        ([if whole > 0.0 { x / whole } else { 0.0 }, y], pdf)
    }

    /// The point that `u` is mapped to.
    pub fn sample(&self, u: [f64; 2], blend: &SliceBlend) -> [f64; 2] {
        let (w, h) = (self.nodes.width, self.nodes.height);
        // The row in which the marginal's integral reaches u_y, and where in it.
        let row = search(h - 1, |k| self.rows_to(k + 1, blend) <= u[1]);
        let [[rows, low], [_, high]] = self.rows_about(row, blend);
        let y = invert_linear_cdf((u[1] - rows) * (h - 1) as f64, low, high);
        // The column in which the integral along that row reaches its part u_x, and where in it.
        let target = u[0] * (low + (high - low) * y);
        let column = search(w - 1, |k| self.row_sum(row, y, k + 1, blend) <= target);
        let cell = GridCell {
            column,
            row,
            x: 0.0,
            y,
        };
        let [[left, columns], [right, _]] = self.nodes.sides(&cell, blend);
        let x = invert_linear_cdf((target - columns) * (w - 1) as f64, left, right);
        [
            (column as f64 + x) / (w - 1) as f64,
            (row as f64 + y) / (h - 1) as f64,
        ]
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        self.nodes.bytes() + size_of_val(&self.rows[..])
    }

    /// Integral over x up to a column, at a height `y` between a row and the next.
    fn row_sum(&self, row: usize, y: f64, column: usize, blend: &SliceBlend) -> f64 {
        let (w, h) = (self.nodes.width, self.nodes.height);
        let [mut low, mut high] = [0.0; 2];
        for &(slice, weight) in blend.parts() {
            let node = (slice * h + row) * w + column;
            low += weight * f64::from(self.nodes.nodes[node][1]);
            high += weight * f64::from(self.nodes.nodes[node + w][1]);
        }
        low + (high - low) * y
    }

    /// Of a row and the next: the integral over y up to it, and over x along it.
    #[inline(always)]
    fn rows_about(&self, row: usize, blend: &SliceBlend) -> [[f64; 2]; 2] {
        let mut means = [[0.0; 2]; 2];
        for &(slice, weight) in blend.parts() {
            let first = slice * self.nodes.height + row;
            for (mean, row) in means.iter_mut().zip(&self.rows[first..first + 2]) {
                mean[0] += weight * f64::from(row[0]);
                mean[1] += weight * f64::from(row[1]);
            }
        }
        means
    }

    /// Integral over y up to a row.
    fn rows_to(&self, row: usize, blend: &SliceBlend) -> f64 {
        let mut mean = 0.0;
        for &(slice, weight) in blend.parts() {
            mean += weight * f64::from(self.rows[slice * self.nodes.height + row][0]);
        }
        mean
    }
}

/// Integral of the linear interpolant up to each value, 0 for the first; `half_step` is half the distance between values.
fn running(values: &[f32], half_step: f64) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len());
    let mut sum = 0.0;
    let mut before = None;
    for &value in values {
        let value = f64::from(value);
        if let Some(before) = before {
            sum += half_step * (before + value);
        }
        before = Some(value);
        sums.push(sum);
    }
    sums
}

/// The number of values for which `is_below` holds, at most `count − 1`; it holds for the first ones.
fn search(count: usize, is_below: impl Fn(usize) -> bool) -> usize {
    let mut low = 0;
    let mut high = count - 1;
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
    // x = 2·mass/(a + √(a² + 2·mass·(b − a))): no cancellation for a near b, where the other form of the root divides by
    // b − a.
    let root = (a * a + 2.0 * mass * (b - a)).max(0.0).sqrt();
    let x = 2.0 * mass / (a + root);
    if x.is_finite() {
        x.clamp(0.0, 1.0)
    } else {
        0.0
    }
}
