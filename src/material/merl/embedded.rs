//! The 100 MERL materials as small networks, compiled in (Sztrajman et al. 2021; `data/nbrdf`).
//!
//! A network maps the Cartesian half and difference vectors to ln(1 + f_r): 6 → 21 → 21 → 3, rectified. It approximates
//! the measurement; it is not the measurement.

use std::f64::consts::PI;
use std::sync::LazyLock;

use byteorder::{ByteOrder, LittleEndian};
use rayon::prelude::*;

use super::{Header, MerlTable};
use crate::geometry::merl_axes::{self, THETA_D_BINS};

static WEIGHTS: &[u8] = include_bytes!("../../../data/nbrdf/merl.f32le");
static INDEX: &str = include_str!("../../../data/nbrdf/merl.json");

const HIDDEN: usize = 21;
/// φd bins that one pass of the network evaluates together; divides 180.
const LANES: usize = 36;
type Lanes = [f32; LANES];

static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| {
    #[derive(serde::Deserialize)]
    struct Index {
        materials: Vec<String>,
    }
    // The index is part of the crate; a test reads every name.
    serde_json::from_str::<Index>(INDEX)
        .map(|i| i.materials)
        .unwrap_or_default()
});

/// Names of the embedded materials, sorted.
///
/// See [`Material`](crate::material::Material) for an example that names a material, and
/// [`MerlTable`](crate::material::merl::MerlTable) for one of a table.
pub fn names() -> &'static [String] {
    &NAMES
}

/// Decodes an embedded material on all threads of the current pool; `None` if there is no such name.
///
/// See [`Material`](crate::material::Material) for an example that names a material, and
/// [`MerlTable`](crate::material::merl::MerlTable) for one of a table.
pub fn decode(name: &str) -> Option<MerlTable> {
    Some(Network::read(weights(name)?).table())
}

/// The bytes that define an embedded material.
pub(in crate::material) fn weights(name: &str) -> Option<&'static [u8]> {
    let position = names().iter().position(|n| n == name)?;
    let stride = WEIGHTS.len() / names().len();
    WEIGHTS.get(position * stride..(position + 1) * stride)
}

struct Network {
    w1: [[f32; HIDDEN]; 6],
    b1: [f32; HIDDEN],
    w2: [[f32; HIDDEN]; HIDDEN],
    b2: [f32; HIDDEN],
    w3: [[f32; 3]; HIDDEN],
    b3: [f32; 3],
}

impl Network {
    fn read(bytes: &[u8]) -> Self {
        let mut values = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|b| LittleEndian::read_f32(b));
        let mut next = || values.next().unwrap_or_default();
        Self {
            w1: std::array::from_fn(|_| std::array::from_fn(|_| next())),
            b1: std::array::from_fn(|_| next()),
            w2: std::array::from_fn(|_| std::array::from_fn(|_| next())),
            b2: std::array::from_fn(|_| next()),
            w3: std::array::from_fn(|_| std::array::from_fn(|_| next())),
            b3: std::array::from_fn(|_| next()),
        }
    }

    fn table(&self) -> MerlTable {
        let header = Header { phi_d_bins: 180 };
        let row = THETA_D_BINS * header.phi_d_bins;
        let mut values = vec![[-1.0f32; 3]; header.cells()];
        values.par_chunks_mut(row).enumerate().for_each(|(h, row)| {
            for (d, cells) in row.chunks_mut(header.phi_d_bins).enumerate() {
                for (block, out) in cells.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                    self.evaluate(h, d, block * LANES, out);
                }
            }
        });
        let at =
            |h: usize, d: usize, p: usize| values[p + header.phi_d_bins * (d + THETA_D_BINS * h)];
        MerlTable::from_fn(header, |h, d, p| at(h, d, p).map(f64::from))
    }

    /// f_r of bins `phi..phi + LANES`, −1 where a direction is below the horizon.
    fn evaluate(&self, h: usize, d: usize, phi: usize, out: &mut [[f32; 3]; LANES]) {
        let theta_h = merl_axes::theta_h_edge(h);
        let theta_d = merl_axes::theta_d(d as f64);
        let ((sh, ch), (sd, cd)) = (theta_h.sin_cos(), theta_d.sin_cos());
        let azimuth: [(f64, f64); LANES] =
            std::array::from_fn(|k| ((phi + k) as f64 / 180.0 * PI).sin_cos());
        let above: [bool; LANES] =
            std::array::from_fn(|k| ch * cd >= (sh * sd * azimuth[k].1).abs());
        if !above.contains(&true) {
            return;
        }
        let f = self.forward([sh, ch, cd].map(|x| x as f32), sd, &azimuth);
        for k in (0..LANES).filter(|&k| above[k]) {
            out[k] = f.map(|channel| channel[k].exp_m1().max(0.0));
        }
    }

    /// The network on `LANES` azimuths of one (θh, θd): its three outputs, before exponentiation.
    fn forward(
        &self,
        [sh, ch, cd]: [f32; 3],
        sd: f64,
        azimuth: &[(f64, f64); LANES],
    ) -> [Lanes; 3] {
        let x: Lanes = std::array::from_fn(|k| (sd * azimuth[k].1) as f32);
        let y: Lanes = std::array::from_fn(|k| (sd * azimuth[k].0) as f32);
        let first: [Lanes; HIDDEN] = std::array::from_fn(|j| {
            let constant =
                self.b1[j] + sh * self.w1[0][j] + ch * self.w1[2][j] + cd * self.w1[5][j];
            std::array::from_fn(|k| {
                (constant + x[k] * self.w1[3][j] + y[k] * self.w1[4][j]).max(0.0)
            })
        });
        let second: [Lanes; HIDDEN] = std::array::from_fn(|j| {
            let mut sum = [self.b2[j]; LANES];
            for (input, w) in first.iter().zip(&self.w2) {
                add_scaled(&mut sum, input, w[j]);
            }
            sum.map(|v| v.max(0.0))
        });
        std::array::from_fn(|c| {
            let mut sum = [self.b3[c]; LANES];
            for (input, w) in second.iter().zip(&self.w3) {
                add_scaled(&mut sum, input, w[c]);
            }
            sum
        })
    }
}

#[inline]
fn add_scaled(sum: &mut Lanes, input: &Lanes, weight: f32) {
    for (s, x) in sum.iter_mut().zip(input) {
        *s += x * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hundred_sorted_names_with_weights_each() {
        assert_eq!(names().len(), 100);
        assert!(names().is_sorted());
        assert_eq!(WEIGHTS.len(), 100 * 675 * 4);
        assert!(names().iter().all(|n| weights(n).is_some()));
    }
}
