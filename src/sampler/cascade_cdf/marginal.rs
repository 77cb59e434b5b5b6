//! The curves over θh, to be looked at.

use super::CascadeCdf;

/// The marginal CDF over θh of one table.
#[derive(Clone, Debug, PartialEq)]
pub struct Marginal {
    /// Polar angle of `wo` that the table was built for, radians.
    pub theta_o: f64,
    /// (θh in radians, probability below it) at every edge of a cell, as stored; none for a material without light.
    pub curve: Vec<(f64, f64)>,
    /// The same at the knots that are stored.
    pub knots: Vec<(f64, f64)>,
}

impl CascadeCdf {
    /// The marginal of the table whose angle is nearest to the polar angle `theta_o`, radians; an angle that is not finite
    /// counts as 0.
    pub fn marginal(&self, theta_o: f64) -> Marginal {
        let k = self.knots.nearest(theta_o);
        let marginal = &self.tables.marginal;
        let (mut curve, mut knots) = (Vec::new(), Vec::new());
        if !marginal.is_void(k) {
            let theta = |cell: f64| self.axis.theta(cell / self.settings.theta_h as f64);
            knots.push((0.0, 0.0));
            knots.extend((0..marginal.segments(k)).map(|i| {
                let piece = marginal.segment(k, i);
                (theta(piece.x1), piece.c1)
            }));
            curve.extend((0..=self.settings.theta_h).map(|cell| {
                let piece = marginal.at(k, cell as f64);
                let t = (cell as f64 - piece.x0) / (piece.x1 - piece.x0);
                (theta(cell as f64), piece.c0 * (1.0 - t) + piece.c1 * t)
            }));
        }
        Marginal { theta_o: self.knots.theta(k), curve, knots }
    }
}
