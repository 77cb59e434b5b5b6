//! Named tables that are hard on lookups, samplers and renderers: what measured data may hold at its worst.

use std::path::Path;

use super::write::write_raw;
use super::{Header, MerlTable, SCALE};
use crate::Result;
use crate::files::Overwrite;

/// A difficult table, made by a function of the bins.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// Its name, in kebab-case.
    pub name: &'static str,
    /// What is difficult about it, in a few words.
    pub about: &'static str,
    /// Whether it reflects only in the first bin of θh, which is 0.011° wide.
    pub is_narrow: bool,
    /// Whether neighbouring cells differ by 10¹² and more, so that no quadrature settles.
    pub is_torn: bool,
    /// Bins of φd: 180 or 360.
    phi_d_bins: usize,
    /// f_r by bin `(theta_h, theta_d, phi_d)`; may be negative, NaN or infinite.
    value: fn(usize, usize, usize) -> [f64; 3],
}

impl HardCase {
    /// All cases, the simplest first.
    pub const ALL: [Self; 22] = [
        case("black", "all zero", |_, _, _| [0.0; 3]),
        case("void", "all invalid", |_, _, _| [-1.0; 3]),
        case("one-cell", "one bin is not zero", |h, d, p| {
            grey((h, d, p) == (12, 30, 77), 2.0, 0.0)
        }),
        narrow(
            "one-row",
            "light in the first bin of theta_h only",
            |h, _, _| grey(h == 0, 1e4, 0.0),
        ),
        case("one-channel", "only red is not zero", |_, _, _| {
            [0.3, 0.0, 0.0]
        }),
        case("constant", "the same everywhere", |_, _, _| {
            [0.2, 0.25, 0.3]
        }),
        case("bright", "albedo of 9", |_, _, _| [3.0; 3]),
        narrow(
            "peak",
            "a highlight of 1e8 times the mean value",
            |h, _, _| grey(h == 0, 1e6, 1e-4),
        ),
        torn(
            "spikes",
            "one cell in 5000 is 1e12 times the others",
            |h, d, p| grey(noise(h, d, p, 0) < 1.0 / 5000.0, 1e10, 1e-2),
        ),
        case(
            "islands",
            "zeros in 15 % of the cells, in patches",
            |h, d, p| grey(noise(h / 7, d / 9, p / 20, 0) < 0.15, 0.0, 0.2),
        ),
        case(
            "holes",
            "a third of the cells is not a number",
            |h, d, p| {
                if (h + d + p) % 3 == 0 {
                    [f64::NAN; 3]
                } else {
                    [0.1, 0.2, (h as f64 + 1.0) * 0.01]
                }
            },
        ),
        case(
            "poisoned",
            "negative, NaN and infinite cells among valid ones",
            poisoned,
        ),
        case(
            "asymmetric",
            "100 times brighter for phi_d below 90 degrees",
            |_, _, p| grey(p < 90, 0.6, 0.006),
        ),
        HardCase {
            name: "asymmetric-360",
            about: "1000 times brighter for phi_d below 180 degrees, 360 bins of phi_d",
            is_narrow: false,
            is_torn: false,
            phi_d_bins: 360,
            value: |_, _, p| grey(p < 180, 0.6, 0.0006),
        },
        case("noise", "white noise of ±100 %", |h, d, p| {
            [0, 1, 2].map(|channel| 0.4 * noise(h, d, p, channel))
        }),
        case("checkerboard", "zero in every other cell", |h, d, p| {
            grey((h + d + p) % 2 == 0, 0.4, 0.0)
        }),
        case(
            "smallest",
            "cells between f32's smallest numbers, 1e-45 and 1e-38",
            |h, d, p| [10f64.powf(-38.0 - 6.8 * noise(h, d, p, 0)); 3],
        ),
        case(
            "largest",
            "cells within a part in a hundred of f32's largest, 3.4e38",
            |h, d, p| [f64::from(f32::MAX) * (1.0 - 0.01 * noise(h, d, p, 0)); 3],
        ),
        narrow(
            "narrow-highlight",
            "1e7 in the first bin of theta_h over an ordinary Lambertian",
            |h, _, _| grey(h == 0, 1e7, 0.3 * std::f64::consts::FRAC_1_PI),
        ),
        case(
            "steep-at-grazing",
            "noisy and rising as the inverse cube of the cosine of theta_d, as quotients of small cosines are",
            |h, d, p| {
                let cosine = ((90.0 - d as f64 - 0.5) * 1f64.to_radians()).sin();
                [0, 1, 2].map(|channel| 0.05 * (0.2 + noise(h, d, p, channel)) / cosine.powi(3))
            },
        ),
        case(
            "garbage-at-grazing",
            "1e6 where theta_d is 88 degrees and more, next to black elsewhere",
            |_, d, _| grey(d >= 88, 1e6, 3e-4 * std::f64::consts::FRAC_1_PI),
        ),
        torn(
            "every-magnitude",
            "cells spread evenly in the logarithm from 1e-38 to 1e38",
            |h, d, p| [10f64.powf(76.0 * noise(h / 5, d / 5, p / 10, 0) - 38.0); 3],
        ),
    ];

    /// The case called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|case| case.name == name)
    }

    /// Dimensions of the table.
    pub fn header(&self) -> Header {
        Header {
            phi_d_bins: self.phi_d_bins,
        }
    }

    /// The table. Cells that are negative, NaN or infinite are invalid, as from a file.
    pub fn table(&self) -> MerlTable {
        MerlTable::from_fn(self.header(), self.value)
    }

    /// Writes the case as a MERL binary with its negative, NaN and infinite values as they are; loading the file gives
    /// [`Self::table`] to the bit.
    ///
    /// # Errors
    /// As [`super::write`].
    pub fn write(&self, path: &Path, overwrite: Overwrite) -> Result<()> {
        let bins = self.phi_d_bins;
        write_raw(self.header(), path, overwrite, |cell, channel| {
            let row = cell / bins;
            let value = (self.value)(
                row / super::THETA_D_BINS,
                row % super::THETA_D_BINS,
                cell % bins,
            )[channel];
            // As the table has it; dividing the f64 itself could come back as the neighbouring f32.
            f64::from(value as f32) / SCALE[channel]
        })
    }
}

const fn case(
    name: &'static str,
    about: &'static str,
    value: fn(usize, usize, usize) -> [f64; 3],
) -> HardCase {
    HardCase {
        name,
        about,
        is_narrow: false,
        is_torn: false,
        phi_d_bins: 180,
        value,
    }
}

const fn narrow(
    name: &'static str,
    about: &'static str,
    value: fn(usize, usize, usize) -> [f64; 3],
) -> HardCase {
    HardCase {
        is_narrow: true,
        ..case(name, about, value)
    }
}

const fn torn(
    name: &'static str,
    about: &'static str,
    value: fn(usize, usize, usize) -> [f64; 3],
) -> HardCase {
    HardCase {
        is_torn: true,
        ..case(name, about, value)
    }
}

fn grey(one: bool, yes: f64, no: f64) -> [f64; 3] {
    [if one { yes } else { no }; 3]
}

/// Every eleventh cell has a channel that no measurement gives.
fn poisoned(h: usize, d: usize, p: usize) -> [f64; 3] {
    let bad = [
        -0.5,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
        -0.0,
    ];
    let k = 180 * (90 * h + d) + p;
    let mut value = [0.1, 0.2, 0.3];
    if k.is_multiple_of(11) {
        value[k % 3] = bad[k / 11 % bad.len()];
    }
    value
}

/// An unrelated number in [0, 1) for every bin and channel (Murmur3's finaliser over a packed index).
fn noise(h: usize, d: usize, p: usize, channel: usize) -> f64 {
    let mut z = ((h * 512 + d) * 512 + p) as u64 * 4 + channel as u64 + 1;
    for factor in [0xff51_afd7_ed55_8ccd, 0xc4ce_b9fe_1a85_ec53] {
        z = (z ^ (z >> 33)).wrapping_mul(factor);
    }
    z ^= z >> 33;
    (z >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::merl::load;

    #[test]
    fn files_hold_the_tables_and_what_is_wrong_with_them() {
        let folder = tempfile::tempdir().unwrap();
        for name in [
            "poisoned",
            "every-magnitude",
            "smallest",
            "largest",
            "asymmetric-360",
        ] {
            let case = HardCase::named(name).unwrap();
            let path = folder.path().join(name);
            case.write(&path, Overwrite::Refuse).unwrap();
            let (table, loaded) = (case.table(), load(&path).unwrap());
            assert_eq!(table.census(), loaded.census(), "{name}");
            assert!(table.cells().eq(loaded.cells()), "{name}");
        }
    }

    #[test]
    fn cases_are_what_they_are_called() {
        let census = HardCase::named("poisoned").unwrap().table().census();
        assert!(
            census.nan > 0 && census.infinite > 0 && census.negative > 0,
            "{census:?}"
        );
        let share = |name: &str, of: fn(&glam::Vec4) -> bool| {
            let table = HardCase::named(name).unwrap().table();
            table.cells().filter(of).count() as f64 / table.cells().len() as f64
        };
        assert!((share("islands", |c| c.x == 0.0) - 0.15).abs() < 0.03);
        assert_eq!(share("void", |c| c.w == 0.0), 1.0);
        assert!(share("smallest", |c| c.x > 0.0 && c.x < f32::MIN_POSITIVE) > 0.5);
        assert_eq!(share("largest", |c| c.x >= 3.3e38 && c.w == 1.0), 1.0);
    }
}
