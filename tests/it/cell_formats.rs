//! Compact cells of a table: how far they move its values, what they refuse, and that all that reads the table reads the same.

use std::path::Path;
use std::sync::Arc;

use crate::support;
use glam::{Vec3, Vec4};
use merlkit::brdf::Brdf;
use merlkit::files::Overwrite;
use merlkit::material::merl::{
    CellFormat, HardCase, Header, MerlBrdf, MerlTable, RoundingError, decode_embedded, load, write,
};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::store::{SamplerFile, encode};
use merlkit::{Error, SamplerSpec};
use merlkit_evaluate::measure::check::{CheckSettings, check_directions, check_sampler};

const COMPACT: [CellFormat; 2] = [CellFormat::F16, CellFormat::Rgb9e5];

fn rounded(table: &MerlTable, format: CellFormat) -> MerlTable {
    table.clone().with_cell_format(format).unwrap()
}

/// Relative errors of a channel's values above 0, in rising order.
fn relative_errors(exact: &MerlTable, found: &MerlTable, channel: usize) -> Vec<f64> {
    let mut errors = Vec::new();
    for (exact, found) in exact.cells().zip(found.cells()) {
        if exact[channel] > 0.0 {
            let (exact, found) = (f64::from(exact[channel]), f64::from(found[channel]));
            errors.push((found - exact).abs() / exact);
        }
    }
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn cells_as_they_were_read_keep_their_bits_and_report_no_errors() {
    let nickel = decode_embedded("nickel").unwrap();
    let same = rounded(&nickel, CellFormat::F32);
    assert!(same.cells().eq(nickel.cells()));
    assert_eq!(same.rounding_errors(), None);
    assert_eq!(same.bytes(), 16 * Header { phi_d_bins: 180 }.cells());
}

#[test]
fn compact_cells_keep_their_bounds_and_their_errors_are_those_reported() {
    // Black obsidian has values over twelve decades, and red plastic dark channels in bright cells.
    for name in ["nickel", "black-obsidian", "red-plastic"] {
        let exact = decode_embedded(name).unwrap();
        for (format, bytes) in [(CellFormat::F16, 2), (CellFormat::Rgb9e5, 4)] {
            let found = rounded(&exact, format);
            assert_eq!(bytes * found.bytes(), exact.bytes());
            assert_eq!(found.cell_format(), format);
            let reported = found.rounding_errors().unwrap();
            for (channel, reported) in reported.into_iter().enumerate() {
                let errors = relative_errors(&exact, &found, channel);
                let last = errors.len() - 1;
                let expected = [errors[last / 2], errors[last - last / 1000], errors[last]];
                let figures = [reported.median, reported.permille, reported.greatest];
                for (expected, figure) in expected.into_iter().zip(figures) {
                    let figure = f64::from(figure);
                    assert!(
                        (figure - expected).abs() <= 1e-6 * expected,
                        "{name} {format:?}"
                    );
                }
                let zeroed = errors.iter().filter(|&&e| e == 1.0).count() as u64;
                assert_eq!(reported.zeroed, zeroed, "{name} {format:?}");
            }
            assert_bounds(name, &exact, &found);
        }
    }
}

/// Half a unit in the last place: of each value in f16, of the cell's greatest channel in rgb9e5.
fn assert_bounds(name: &str, exact: &MerlTable, found: &MerlTable) {
    for (exact, found) in exact.cells().zip(found.cells()) {
        let error = (found - exact).abs();
        let bound = match found == exact {
            true => Vec4::ZERO,
            false => bound_of_cell(exact),
        };
        let bound = match exact_format(found, exact) {
            true => bound.min(exact * 2f32.powi(-11)),
            false => bound,
        };
        assert!(error.cmple(bound).all(), "{name}: {exact} {found}");
    }
}
