//! The curves, to be looked at.

use std::f64::consts::TAU;

use super::CascadeCdf;
use crate::distribution::Curves;

/// One CDF of one table.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler;
/// [`Sampler::downcast`](crate::sampler::Sampler::downcast) gives the method whose tables these are.
#[derive(Clone, Debug, PartialEq)]
pub struct CdfCurve {
    /// Polar angle of `wo` that the table was built for, radians.
    pub theta_o: f64,
    /// The θh that it speaks of, radians: all of them for the marginal, those of one of its pieces for a conditional.
    pub theta_h: [f64; 2],
    /// (θh or φh in radians, probability below it) at every edge of a cell, as stored; none for a material without light.
    pub curve: Vec<(f64, f64)>,
    /// The same at the knots that are stored.
    pub knots: Vec<(f64, f64)>,
}

impl CascadeCdf {
    /// The marginal over θh of the table whose angle is nearest to the polar angle `theta_o`, radians; an angle that is not
    /// finite counts as 0.
    pub fn marginal(&self, theta_o: f64) -> CdfCurve {
        let k = self.knots.polar.nearest(theta_o);
        let cells = self.settings.theta_h;
        let (curve, knots) = shown(&self.tables.marginal, k, cells, |cell| self.theta_h(cell));
        CdfCurve {
            theta_o: self.knots.polar.theta(k),
            theta_h: [0.0, self.theta_h(cells as f64)],
            curve,
            knots,
        }
    }

    /// The conditional over φh, counted from `wo`, of the same table and of the piece of the marginal that holds its median:
    /// half of the draws have a smaller θh.
    pub fn conditional(&self, theta_o: f64) -> CdfCurve {
        let k = self.knots.polar.nearest(theta_o);
        let theta_o = self.knots.polar.theta(k);
        if self.tables.marginal.is_void(k) {
            return CdfCurve {
                theta_o,
                theta_h: [0.0; 2],
                curve: Vec::new(),
                knots: Vec::new(),
            };
        }
        let piece = self.tables.marginal.find(k, 0.5);
        let cells = self.settings.phi_h;
        let conditional = self.tables.first[k] as usize + piece.index;
        let phi = |cell: f64| cell / cells as f64 * TAU;
        let (curve, knots) = shown(&self.tables.conditional, conditional, cells, phi);
        CdfCurve {
            theta_o,
            theta_h: [self.theta_h(piece.x0), self.theta_h(piece.x1)],
            curve,
            knots,
        }
    }

    /// θh at a coordinate of the grid.
    fn theta_h(&self, cell: f64) -> f64 {
        self.axis.theta(cell / self.settings.theta_h as f64)
    }
}

type CurvePoints = Vec<(f64, f64)>;

/// A curve at every edge of `cells` and at its knots.
fn shown(
    curves: &Curves,
    k: usize,
    cells: usize,
    angle: impl Fn(f64) -> f64,
) -> (CurvePoints, CurvePoints) {
    if curves.is_void(k) {
        return (Vec::new(), Vec::new());
    }
    let mut knots = vec![(angle(0.0), 0.0)];
    for i in 0..curves.segments(k) {
        let piece = curves.segment(k, i);
        knots.push((angle(piece.x1), piece.c1));
    }
    // Between knots the curve is linear: (1 − t) c0 + t c1.
    let mut curve = Vec::with_capacity(cells + 1);
    for cell in 0..=cells {
        let cell = cell as f64;
        let piece = curves.find_segment(k, cell);
        let t = (cell - piece.x0) / (piece.x1 - piece.x0);
        curve.push((angle(cell), piece.c0 * (1.0 - t) + piece.c1 * t));
    }
    (curve, knots)
}
