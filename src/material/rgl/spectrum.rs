//! Between linear sRGB and spectra.
//!
//! Upwards by spectral primaries (Mallett & Yuksel 2019): three spectra in [0, 1] whose sum is 1, as smooth as they can be
//! while light of D65 that they reflect is exactly red, green or blue. The spectrum of a colour is linear in it, so it may be
//! of any brightness, and interpolation of spectra is interpolation of colours. The primaries here are solved for anew, linear
//! between seven wavelengths and constant outside, since a file holds a table for every wavelength.

use super::tensors::Tensor;

/// Wavelengths of upsampled spectra, nm.
pub(super) const WAVELENGTHS: [f32; 7] = [450.0, 480.0, 500.0, 550.0, 580.0, 600.0, 620.0];
/// Spectra of red, green and blue at these wavelengths.
pub(super) const PRIMARIES: [[f32; 7]; 3] = [
    [
        0.025_386_5,
        0.001_747_8,
        0.0,
        0.0,
        0.103_217_4,
        0.806_955_1,
        1.0,
    ],
    [
        0.0,
        0.156_86,
        0.905_937_7,
        1.0,
        0.844_234_9,
        0.193_044_9,
        0.0,
    ],
    [
        0.974_613_5,
        0.841_392_2,
        0.094_062_3,
        0.0,
        0.052_547_7,
        0.0,
        0.0,
    ],
];

/// A step of the tables below, nm, which begin at 380.
const STEP: f64 = 10.0;
/// Matching functions x, y, z of the CIE 1931 observer and the relative power of illuminant D65.
#[rustfmt::skip]
const OBSERVER: [[f64; 4]; 41] = [
    [0.0014, 0.0000, 0.0065, 49.975], [0.0042, 0.0001, 0.0201, 54.648], [0.0143, 0.0004, 0.0679, 82.755],
    [0.0435, 0.0012, 0.2074, 91.486], [0.1344, 0.0040, 0.6456, 93.432], [0.2839, 0.0116, 1.3856, 86.682],
    [0.3483, 0.0230, 1.7471, 104.865], [0.3362, 0.0380, 1.7721, 117.008], [0.2908, 0.0600, 1.6692, 117.812],
    [0.1954, 0.0910, 1.2876, 114.861], [0.0956, 0.1390, 0.8130, 115.923], [0.0320, 0.2080, 0.4652, 108.811],
    [0.0049, 0.3230, 0.2720, 109.354], [0.0093, 0.5030, 0.1582, 107.802], [0.0633, 0.7100, 0.0782, 104.790],
    [0.1655, 0.8620, 0.0422, 107.689], [0.2904, 0.9540, 0.0203, 104.405], [0.4334, 0.9950, 0.0087, 104.046],
    [0.5945, 0.9950, 0.0039, 100.000], [0.7621, 0.9520, 0.0021, 96.334], [0.9163, 0.8700, 0.0017, 95.788],
    [1.0263, 0.7570, 0.0011, 88.686], [1.0622, 0.6310, 0.0008, 90.006], [1.0026, 0.5030, 0.0003, 89.599],
    [0.8544, 0.3810, 0.0002, 87.699], [0.6424, 0.2650, 0.0000, 83.289], [0.4479, 0.1750, 0.0000, 83.699],
    [0.2835, 0.1070, 0.0000, 80.027], [0.1649, 0.0610, 0.0000, 80.215], [0.0874, 0.0320, 0.0000, 82.278],
    [0.0468, 0.0170, 0.0000, 78.284], [0.0227, 0.0082, 0.0000, 69.721], [0.0114, 0.0041, 0.0000, 71.609],
    [0.0058, 0.0021, 0.0000, 74.349], [0.0029, 0.0010, 0.0000, 61.604], [0.0014, 0.0005, 0.0000, 69.886],
    [0.0007, 0.0002, 0.0000, 75.087], [0.0003, 0.0001, 0.0000, 63.593], [0.0002, 0.0001, 0.0000, 46.418],
    [0.0001, 0.0000, 0.0000, 66.805], [0.0000, 0.0000, 0.0000, 63.383],
];
/// From CIE XYZ to linear sRGB (IEC 61966-2-1).
const TO_SRGB: [[f64; 3]; 3] = [
    [3.240_479, -1.537_150, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

/// Spectra of colours: `[P, T, 3, n, n]` becomes `[P, T, 7, n, n]`.
pub(super) fn to_spectra(rgb: &Tensor) -> Tensor {
    let weights: Vec<[f32; 3]> = (0..WAVELENGTHS.len())
        .map(|k| PRIMARIES.map(|p| p[k]))
        .collect();
    mix_channels(rgb, &weights)
}

/// Colours of spectra in light of D65, a spectrum of ones being white: `[P, T, K, n, n]` becomes `[P, T, 3, n, n]`. Spectra are
/// linear between wavelengths and constant outside.
pub(super) fn to_rgb(wavelengths: &[f32], spectra: &Tensor) -> Tensor {
    mix_channels(spectra, &colour_weights(wavelengths))
}

/// What each wavelength of a spectrum adds to red, green and blue: `[3][K]`.
pub(in crate::material) fn colour_weights(wavelengths: &[f32]) -> [Vec<f32>; 3] {
    let mut sums = vec![[0.0; 3]; wavelengths.len()];
    let mut white = [0.0; 3];
    for (i, [x, y, z, power]) in OBSERVER.into_iter().enumerate() {
        let nm = 380.0 + STEP * i as f64;
        // The colour of light of this wavelength in D65: M·(x̄, ȳ, z̄)·power. A spectrum that is linear between its nodes
        // gives the part `share` of it to each of the two about the wavelength.
        let rgb = TO_SRGB.map(|row| (row[0] * x + row[1] * y + row[2] * z) * power);
        for (k, share) in shares(nm, wavelengths) {
            (0..3).for_each(|c| sums[k][c] += share * rgb[c]);
        }
        (0..3).for_each(|c| white[c] += rgb[c]);
    }
    // The division makes a spectrum of ones (1, 1, 1).
    std::array::from_fn(|c| sums.iter().map(|s| (s[c] / white[c]) as f32).collect())
}

/// The two wavelengths about `nm` and their weights.
fn shares(nm: f64, wavelengths: &[f32]) -> [(usize, f64); 2] {
    let above = wavelengths.partition_point(|&w| f64::from(w) <= nm);
    match (above.checked_sub(1), wavelengths.get(above)) {
        (None, _) => [(0, 1.0), (0, 0.0)],
        (Some(low), None) => [(low, 1.0), (low, 0.0)],
        (Some(low), Some(&high)) => {
            let start = f64::from(wavelengths[low]);
            let share = (nm - start) / (f64::from(high) - start);
            [(low, 1.0 - share), (above, share)]
        }
    }
}

/// New channels on axis 2 as sums of the old ones.
fn mix_channels<W: AsRef<[f32]>>(tensor: &Tensor, weights: &[W]) -> Tensor {
    let square: usize = tensor.shape[3..].iter().product();
    let mut out = Vec::with_capacity(tensor.values.len() / tensor.shape[2] * weights.len());
    for slice in tensor.values.chunks_exact(tensor.shape[2] * square) {
        for row in weights {
            out.extend((0..square).map(|at| {
                let terms = row.as_ref().iter().zip(slice[at..].iter().step_by(square));
                terms
                    .map(|(w, v)| f64::from(*w) * f64::from(*v))
                    .sum::<f64>() as f32
            }));
        }
    }
    let mut shape = tensor.shape.clone();
    shape[2] = weights.len();
    Tensor { shape, values: out }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn there_and_back(rgb: [f32; 3]) -> Vec<f32> {
        let colour = Tensor {
            shape: vec![1, 1, 3, 1, 1],
            values: rgb.to_vec(),
        };
        to_rgb(&WAVELENGTHS, &to_spectra(&colour)).values
    }

    #[test]
    fn colours_come_back() {
        for rgb in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.3, 40.0, 0.7],
        ] {
            // Spectra are stored in f32: each channel is rounded as the largest is.
            let largest = rgb.into_iter().fold(0.0, f32::max);
            for (a, b) in there_and_back(rgb).iter().zip(rgb) {
                assert!((a - b).abs() <= 2e-6 * largest, "{rgb:?}: {a}");
            }
        }
    }

    #[test]
    fn primaries_are_reflectances_that_add_up_to_one() {
        for k in 0..WAVELENGTHS.len() {
            let at = PRIMARIES.map(|p| p[k]);
            assert!(at.iter().all(|v| (0.0..=1.0).contains(v)));
            assert!((at.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_flat_spectrum_is_grey() {
        let flat = Tensor {
            shape: vec![1, 1, 4, 1, 1],
            values: vec![0.5; 4],
        };
        for v in to_rgb(&[360.0, 500.0, 501.0, 1000.0], &flat).values {
            assert!((v - 0.5).abs() < 1e-6);
        }
    }
}
