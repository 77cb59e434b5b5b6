//! The filters of FLIP, as separable kernels over pixels whose edges go on outwards.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

/// Weights at −radius … radius.
pub(super) struct Kernel(Vec<f64>);

impl Kernel {
    fn from_fn(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let radius = radius as i64;
        Self((-radius..=radius).map(|x| weight(x as f64)).collect())
    }

    /// Weights over their sum.
    fn normalised(mut self) -> Self {
        let sum: f64 = self.0.iter().sum();
        for weight in &mut self.0 {
            *weight /= sum;
        }
        self
    }

    /// Positive weights over their sum, and negative ones over minus theirs: a step or a point of height 1 gives 1.
    fn balanced(mut self) -> Self {
        let positive: f64 = self.0.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = -self.0.iter().filter(|w| **w < 0.0).sum::<f64>();
        for weight in &mut self.0 {
            *weight /= if *weight > 0.0 { positive } else { negative };
        }
        self
    }
}

/// A picture of three channels, rows from the top.
#[derive(Clone)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<DVec3>,
}

impl Plane {
    /// The picture filtered along x by a kernel for each channel, then along y.
    pub(super) fn filter(&self, along_x: &[&Kernel; 3], along_y: &[&Kernel; 3]) -> Self {
        self.convolve(along_x, 1).convolve(along_y, self.width)
    }

    /// The picture filtered along one axis, on which neighbours are `stride` apart.
    fn convolve(&self, kernels: &[&Kernel; 3], stride: usize) -> Self {
        let mut values = vec![DVec3::ZERO; self.values.len()];
        let rows = values.par_chunks_mut(self.width).enumerate();
        rows.for_each(|(y, row)| {
            for (x, out) in row.iter_mut().enumerate() {
                // The position on the axis, and where it begins and ends.
                let (position, length) = if stride == 1 {
                    (x, self.width)
                } else {
                    (y, self.height)
                };
                let start = y * self.width + x - position * stride;
                for channel in 0..3 {
                    let weights = &kernels[channel].0;
                    let radius = weights.len() / 2;
                    let mut sum = 0.0;
                    for (k, weight) in weights.iter().enumerate() {
                        let at = (position + k).saturating_sub(radius).min(length - 1);
                        sum += weight * self.values[start + at * stride][channel];
                    }
                    out[channel] = sum;
                }
            }
        });
        Self { values, ..*self }
    }
}

/// The eye's contrast sensitivity to Y, Cx and Cz as sums of two Gaussians (a, b): a·√(π/b)·exp(−π²x²/b), x in degrees (Johnson and
/// Fairchild 2003).
const SENSITIVITY: [[(f64, f64); 3]; 2] = [
    [(1.0, 0.0047), (1.0, 0.0053), (34.1, 0.04)],
    [(0.0, 1e-5), (0.0, 1e-5), (13.5, 0.025)],
];

/// What is seen of Y, Cx and Cz at a number of pixels a degree. The third channel's sum of two Gaussians does not separate, so
/// each channel is a sum of separable pictures.
pub(super) fn filter_by_sensitivity(plane: &Plane, pixels_a_degree: f64) -> Plane {
    // Three standard deviations of the widest Gaussian.
    let radius = (3.0 * (0.04f64 / (2.0 * PI * PI)).sqrt() * pixels_a_degree).ceil() as usize;
    let mut values = vec![DVec3::ZERO; plane.values.len()];
    let mut weights = DVec3::ZERO;
    for term in SENSITIVITY {
        // A Gaussian of two axes is the product of two of one: their kernels are not normalised, but the sum is at the end.
        let kernels = term.map(|(a, b): (f64, f64)| {
            Kernel::from_fn(radius, |x| {
                let degrees = x / pixels_a_degree;
                (a * (PI / b).sqrt()).sqrt() * (-PI * PI * degrees * degrees / b).exp()
            })
        });
        let kernels = [&kernels[0], &kernels[1], &kernels[2]];
        let filtered = plane.filter(&kernels, &kernels);
        for (sum, value) in values.iter_mut().zip(&filtered.values) {
            *sum += *value;
        }
        for channel in 0..3 {
            weights[channel] += kernels[channel].0.iter().sum::<f64>().powi(2);
        }
    }
    for value in &mut values {
        *value /= weights;
    }
    Plane { values, ..*plane }
}

/// How strong edges and points are at each pixel: x and y of the returned vectors, of lightness in the first channel.
pub(super) fn detect_features(plane: &Plane, pixels_a_degree: f64) -> Vec<[f64; 2]> {
    // The width of a feature in degrees; its Gaussian has half of that as its deviation.
    let deviation = 0.5 * 0.082 * pixels_a_degree;
    let radius = (3.0 * deviation).ceil() as usize;
    let gauss = move |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let blur = Kernel::from_fn(radius, gauss).normalised();
    let edge = Kernel::from_fn(radius, |x| -x * gauss(x)).balanced();
    let second = |x: f64| (x * x / (deviation * deviation) - 1.0) * gauss(x);
    let point = Kernel::from_fn(radius, second).balanced();
    // Channels hold the same lightness: one is filtered for edges, one for points.
    let across = plane.filter(&[&edge, &point, &blur], &[&blur, &blur, &blur]);
    let down = plane.filter(&[&blur, &blur, &blur], &[&edge, &point, &blur]);
    let mut features = Vec::with_capacity(plane.values.len());
    for (x, y) in across.values.iter().zip(&down.values) {
        features.push([x.x.hypot(y.x), x.y.hypot(y.y)]);
    }
    features
}
