//! Bounds of a BRDF that is not a table: the largest value at points, with a margin.
//!
//! They are no bounds for certain, and at the horizon some formulas have none. So nothing relies on them: draws are accepted in
//! proportion to min(f, bound), which is their density too ([`super::masses`] has its integral), and the draws that ignore the
//! BRDF reach what is cut off.

use glam::{DVec2, Vec3};

use super::grower::{Content, Contents};
use super::quad_cell::{QuadCell, Rect};
use super::scouts::{Scouts, about_disc};
use super::slice::Slice;

/// Margin of a bound as a fraction of the range of values at the points of a square. A parabola has its top between points that
/// are a quarter of the square apart, at most an eighth of the range above the largest.
const MARGIN: f64 = 0.25;
/// Squares above this depth are split unseen: scouts are two degrees apart, and meet what the points of a square miss.
const COARSEST: u32 = 1;
/// Points along each side of a square at the rim, midpoints.
const RIM_POINTS: usize = 4;
/// Squares at the rim are split only where they waste this part of all trials: f may rise without end there, and with it the
/// number of squares.
const RIM_WASTE: f64 = 1e-3;
/// Simpson's weights of five points on [0, 1].
const SIMPSON: [f64; 5] = [1.0 / 12.0, 4.0 / 12.0, 2.0 / 12.0, 4.0 / 12.0, 1.0 / 12.0];

/// Values at points of the square itself and those that scouts met.
pub(super) struct SampledValues<'a> {
    pub slice: &'a Slice<'a>,
    pub scouts: &'a Scouts,
}

/// What the points of a square came to.
struct Seen {
    mean: f64,
    least: f64,
    largest: f64,
}

impl SampledValues<'_> {
    /// Points on the edges of the square too, where monotone functions are largest.
    fn inside(&self, rect: Rect) -> Seen {
        let mut seen = Seen {
            mean: 0.0,
            least: f64::INFINITY,
            largest: 0.0,
        };
        let mut wi = [Vec3::ZERO; SIMPSON.len() * SIMPSON.len()];
        for (k, wi) in wi.iter_mut().enumerate() {
            let cell = DVec2::new((k / SIMPSON.len()) as f64, (k % SIMPSON.len()) as f64);
            *wi = Slice::above_disc(rect.point(cell * 0.25));
        }
        let mut values = [0.0; SIMPSON.len() * SIMPSON.len()];
        self.slice.values(&wi, &mut values);
        for (i, wx) in SIMPSON.iter().enumerate() {
            for (j, wy) in SIMPSON.iter().enumerate() {
                let f = values[i * SIMPSON.len() + j];
                seen.mean += wx * wy * f;
                seen.least = seen.least.min(f);
                seen.largest = seen.largest.max(f);
            }
        }
        seen
    }

    /// Midpoints, none of them on the rim; those beyond it count as 0.
    fn across_rim(&self, rect: Rect) -> Seen {
        let mut seen = Seen {
            mean: 0.0,
            least: f64::INFINITY,
            largest: 0.0,
        };
        let cells = RIM_POINTS as f64;
        let mut wi = [Vec3::ZERO; RIM_POINTS * RIM_POINTS];
        let mut inside = 0;
        for k in 0..RIM_POINTS * RIM_POINTS {
            let cell = DVec2::new((k % RIM_POINTS) as f64, (k / RIM_POINTS) as f64);
            let p = rect.point((cell + 0.5) / cells);
            if p.length_squared() < 1.0 {
                wi[inside] = Slice::above_disc(p);
                inside += 1;
            }
        }
        let mut values = [0.0; RIM_POINTS * RIM_POINTS];
        self.slice.values(&wi[..inside], &mut values[..inside]);
        for &f in &values[..inside] {
            seen.mean += f / (cells * cells);
            seen.least = seen.least.min(f);
            seen.largest = seen.largest.max(f);
        }
        seen
    }
}

/// Squared distance of a square's farthest corner from the centre of the disc.
fn farthest(square: QuadCell) -> f64 {
    let far = square.corner.abs().max((square.corner + square.side).abs());
    far.length_squared()
}

impl Contents for SampledValues<'_> {
    fn too_coarse(&self, depth: u32) -> bool {
        depth < COARSEST
    }

    fn too_fine(&self, _: QuadCell) -> bool {
        false
    }

    fn content(&self, square: QuadCell, rect: Rect) -> Content {
        let seen = if farthest(square) < 1.0 {
            self.inside(rect)
        } else {
            self.across_rim(rect)
        };
        let met = self
            .scouts
            .largest(about_disc(square.corner), 0.5 * square.side);
        let largest = seen.largest.max(met);
        let margin = MARGIN * (largest - seen.least).max(0.0);
        Content {
            integral: seen.mean * rect.area(),
            seen: largest + margin,
            area: rect.area(),
        }
    }

    fn bound(&self, _: Rect, content: &Content) -> f32 {
        // The next number of f32 is not below it.
        let bound = (content.seen as f32).next_up();
        if content.seen > 0.0 {
            bound.min(f32::MAX)
        } else {
            0.0
        }
    }

    fn total(&self) -> f64 {
        self.scouts.integral()
    }

    fn least_waste(&self, square: QuadCell) -> f64 {
        // Within a side of the rim: 1 − r² is below twice that.
        if farthest(square) > 1.0 - 2.0 * square.side {
            RIM_WASTE * self.total()
        } else {
            0.0
        }
    }
}
