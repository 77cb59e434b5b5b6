//! Points of charts, of many lanes side by side.

use crate::geometry::half_vector_chart::ChartPoint;
use crate::lanes::Columns;

/// Lanes that go through the stages of a batch together: their columns fit the fastest cache.
pub(in crate::sampler) const LANES: usize = 64;

/// Points of charts, in columns.
pub(in crate::sampler) struct PointLanes {
    numbers: Columns<f32, 3, LANES>,
    tan2_theta_h: [f64; LANES],
}

impl PointLanes {
    #[inline(always)]
    pub(in crate::sampler) fn new() -> Self {
        Self {
            numbers: Columns::splat([0.0; 3]),
            tan2_theta_h: [0.0; LANES],
        }
    }

    #[inline(always)]
    pub(in crate::sampler) fn get(&self, lane: usize) -> ChartPoint {
        let [cap, azimuth_fraction, jacobian] = self.numbers.get(lane);
        ChartPoint {
            cap,
            tan2_theta_h: self.tan2_theta_h[lane],
            azimuth_fraction,
            jacobian,
        }
    }

    #[inline(always)]
    pub(in crate::sampler) fn tan2_theta_h(&self, lane: usize) -> f64 {
        self.tan2_theta_h[lane]
    }

    #[inline(always)]
    pub(in crate::sampler) fn set(&mut self, lane: usize, point: ChartPoint) {
        let numbers = [point.cap, point.azimuth_fraction, point.jacobian];
        self.numbers.set(lane, numbers);
        self.tan2_theta_h[lane] = point.tan2_theta_h;
    }
}
