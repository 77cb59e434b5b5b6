//! What squares hold of a MERL table, and of the thesis's image of any BRDF.

use glam::{DVec2, Vec3};

use super::bounds::MaxTable;
use super::grower::{Content, Contents};
use super::quad_cell::{QuadCell, Rect};
use super::settings::LeafChoice;
use super::slice::{BATCH, Slice};

/// Points along each side of a node in the refined construction. Where leaves are drawn by their bounds, the integral only
/// decides on splits, and a rough one will do.
fn points_a_side(leaves: LeafChoice) -> usize {
    match leaves {
        LeafChoice::Envelope | LeafChoice::Warp => 4,
        LeafChoice::Integral => 8,
    }
}
/// Nodes above this depth are split unseen.
const COARSEST: u32 = 3;

/// Values at points of the square itself, bounds from the table.
pub(super) struct PointValues<'a> {
    pub slice: &'a Slice<'a>,
    pub bounds: &'a MaxTable,
    /// ∫ f over the disc.
    pub integral: f64,
}

impl Contents for PointValues<'_> {
    fn too_coarse(&self, depth: u32) -> bool {
        depth < COARSEST
    }

    fn too_fine(&self, _: QuadCell) -> bool {
        false
    }

    fn content(&self, _: QuadCell, rect: Rect) -> Content {
        let (mut sum, mut seen) = (0.0, 0.0f64);
        // I = mean of f at the midpoints of a grid, times the area. Points beyond the rim count as 0.
        let side = points_a_side(self.slice.settings.leaves);
        let (mut wi, mut values) = ([Vec3::ZERO; BATCH], [0.0; BATCH]);
        let count = side * side;
        for (k, wi) in wi[..count].iter_mut().enumerate() {
            let t = DVec2::new((k % side) as f64 + 0.5, (k / side) as f64 + 0.5) / side as f64;
            *wi = Slice::above_disc(rect.point(t));
        }
        self.slice.values(&wi[..count], &mut values[..count]);
        for &f in &values[..count] {
            sum += f;
            seen = seen.max(f);
        }
        Content {
            integral: sum / count as f64 * rect.area(),
            seen,
            area: rect.area(),
        }
    }

    fn bound(&self, rect: Rect, _: &Content) -> f32 {
        self.bounds.over(self.slice.wo.as_dvec3(), rect)
    }

    fn total(&self) -> f64 {
        self.integral
    }
}

/// The thesis's image of f over [−1, 1]² (6.3.3): pixel centres, row by row.
pub(super) struct DiscImage {
    side: usize,
    values: Vec<f32>,
    total: f64,
}

impl DiscImage {
    pub fn new(slice: &Slice<'_>, side: u32) -> Self {
        let n = side as usize;
        let mut values = Vec::with_capacity(n * n);
        for k in 0..n * n {
            // Pixel i has its centre at 2 (i + ½)/n − 1.
            let [x, y] = [k % n, k / n].map(|i| (i as f64 + 0.5) / n as f64 * 2.0 - 1.0);
            values.push(slice.value_on_disc(DVec2::new(x, y)) as f32);
        }
        // ∫ f dx dy = Σ f·(2/n)², where f is 0 outside the disc.
        let total = values.iter().map(|&v| f64::from(v)).sum::<f64>() * (2.0 / n as f64).powi(2);
        Self {
            side: n,
            values,
            total,
        }
    }

    /// Pixels whose centres lie in [low, low + side) of one axis.
    fn pixels(&self, low: f64, side: f64) -> std::ops::Range<usize> {
        self.first_pixel(low)..self.first_pixel(low + side).min(self.side)
    }

    /// The first pixel whose centre is not below `x` on one axis.
    fn first_pixel(&self, x: f64) -> usize {
        let position = (x + 1.0) * 0.5 * self.side as f64 - 0.5;
        position.ceil().max(0.0) as usize
    }
}

impl Contents for DiscImage {
    fn too_coarse(&self, _: u32) -> bool {
        false
    }

    /// Children of fewer than four pixels would be guesses.
    fn too_fine(&self, square: QuadCell) -> bool {
        square.side * 0.5 * (self.side as f64) < 8.0
    }

    fn content(&self, square: QuadCell, rect: Rect) -> Content {
        let (mut sum, mut seen) = (0.0, 0.0f64);
        for y in self.pixels(square.corner.y, square.side) {
            for x in self.pixels(square.corner.x, square.side) {
                let f = f64::from(self.values[y * self.side + x]);
                sum += f;
                seen = seen.max(f);
            }
        }
        Content {
            integral: sum * (2.0 / self.side as f64).powi(2),
            seen,
            area: rect.area(),
        }
    }

    fn bound(&self, _: Rect, content: &Content) -> f32 {
        content.seen as f32
    }

    fn total(&self) -> f64 {
        self.total
    }
}
