//! The density of a half-vector table in f64, from the tensors of its file, by the steps of docs/half-vector-table.md.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec2, DVec3};
use safetensors::SafeTensors;

/// Rows that are MERL's own bins of θh, and parts of the rest.
const MERL: usize = 63;
const UPPER: f64 = 16.0;

/// Tables over the half-vector square, as stored.
pub struct Oracle {
    fold: bool,
    rows: usize,
    cosines: Vec<f64>,
    edges: Vec<f64>,
    cdf: Vec<f64>,
    slopes: Vec<f64>,
    nodes: Vec<f64>,
}

impl Oracle {
    /// Reads the bytes of a sampler file that is known to be good.
    pub fn new(bytes: &[u8], fold: bool) -> Self {
        let file = SafeTensors::deserialize(bytes).unwrap();
        let values = |name: &str, width: usize, value: fn(&[u8]) -> f64| -> Vec<f64> {
            file.tensor(name)
                .unwrap()
                .data()
                .chunks(width)
                .map(value)
                .collect()
        };
        let u16s = |b: &[u8]| u16::from_le_bytes([b[0], b[1]]).into();
        let edges = values("row.edge", 2, u16s);
        Self {
            fold,
            rows: edges.len() - 1,
            edges,
            cosines: values("knot.cosine", 4, |b| {
                f32::from_le_bytes([b[0], b[1], b[2], b[3]]).into()
            }),
            cdf: values("row.cdf", 2, u16s),
            slopes: values("row.slope", 1, |b| f64::from(b[0] as i8) / 128.0),
            nodes: values("row.density", 2, u16s),
        }
    }

    /// Density per solid angle, and how far, in relative units, the cap of the half vector is from the nearest edge of a row:
    /// nearer than rounding, another row may be right as well.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        let (wo, wi) = (wo.normalize(), wi.normalize());
        let sin_o = DVec2::new(wo.x, wo.y).length();
        let (c, s) = if sin_o > 0.0 {
            (wo.x / sin_o, wo.y / sin_o)
        } else {
            (1.0, 0.0)
        };
        let m = DVec3::new(
            sin_o + c * wi.x + s * wi.y,
            c * wi.y - s * wi.x,
            wo.z + wi.z,
        );
        let (rho, length) = (m.x.hypot(m.y), m.length());
        let (sin_h, cos_h) = (rho / length, m.z / length);
        let cap = 0.5 * rho * rho / (length * (length + m.z));
        let caps = self.caps(sin_o, wo.z);
        let row = caps[1..self.rows]
            .iter()
            .filter(|&&edge| edge <= cap)
            .count();
        let from_edge = caps
            .iter()
            .map(|e| (cap / e - 1.0).abs())
            .fold(f64::INFINITY, f64::min);
        let mix = self.mixture(wo.z);
        let (low, width) = (caps[row], caps[row + 1] - caps[row]);
        let before = if row > 0 {
            mix(&self.cdf, row - 1)
        } else {
            0.0
        };
        let mass = (mix(&self.cdf, row) - before) / 65535.0;
        let along = mass * (1.0 + mix(&self.slopes, row) * (2.0 * (cap - low) / width - 1.0));
        let q = (m.y.atan2(m.x) / 4.0).tan();
        let widest = widest(sin_o, wo.z, sin_h, cos_h);
        let across = self.across((q / widest).clamp(-1.0, 1.0), row, &mix);
        (
            along * across / (width * 16.0 * length * widest / (1.0 + q * q)),
            from_edge,
        )
    }

    /// Half the versed sine of each row's edges.
    fn caps(&self, sin_o: f64, cos_o: f64) -> Vec<f64> {
        let merl = |bin: f64| (FRAC_PI_4 * (bin / 90.0).powi(2)).sin().powi(2);
        let top = 0.5 * (1.0 - cos_o / (2.0 * (1.0 + sin_o)).sqrt());
        let cap = |&edge: &f64| {
            let beyond = (edge - MERL as f64).max(0.0) / UPPER;
            merl(edge.min(MERL as f64)) * (1.0 - beyond) + beyond * top
        };
        self.edges.iter().map(cap).collect()
    }

    /// What stands at an index of a table, mixed of the two tables about a cosine.
    fn mixture(&self, cos_o: f64) -> impl Fn(&[f64], usize) -> f64 {
        let tables = self.cosines.len();
        let b = self
            .cosines
            .iter()
            .filter(|&&c| c > cos_o)
            .count()
            .min(tables - 1);
        let a = b.saturating_sub(1);
        let (high, low) = (self.cosines[a], self.cosines[b]);
        let share = if high > low {
            ((high - cos_o) / (high - low)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        // Shares are multiples of 2⁻¹⁶ in the table too.
        let share = (share * 65536.0 + 0.5).floor() / 65536.0;
        move |values, index| {
            let stride = values.len() / tables;
            values[a * stride + index] * (1.0 - share) + values[b * stride + index] * share
        }
    }

    /// Density over the azimuth's share of its range.
    fn across(&self, b: f64, row: usize, mix: &impl Fn(&[f64], usize) -> f64) -> f64 {
        let nodes = self.nodes.len() / self.cosines.len() / self.rows;
        let segments = nodes - 1;
        let at = if self.fold { b.abs() } else { 0.5 * (b + 1.0) } * segments as f64;
        let k = (at as usize).min(segments - 1);
        let node = |i| mix(&self.nodes, row * nodes + i);
        (node(k) + (node(k + 1) - node(k)) * (at - k as f64)) * segments as f64 / 65534.0
    }
}

/// tan(φ/4) of the widest azimuth that reflects above the horizon.
fn widest(sin_o: f64, cos_o: f64, sin_h: f64, cos_h: f64) -> f64 {
    let (sines, cosines) = (
        2.0 * sin_h * cos_h * sin_o,
        (cos_h - sin_h) * (cos_h + sin_h) * cos_o,
    );
    let (far, near) = (
        (sines - cosines).max(0.0),
        (cosines + sines).max(f32::MIN_POSITIVE.into()),
    );
    (near.sqrt() / (far.sqrt() + (near + far).sqrt())).max(1e-6)
}
