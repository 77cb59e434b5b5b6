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

/// Half a unit in the last place: of each value in f16, and in rgb9e5 of the cell's greatest channel, or the least unit of the table.
fn assert_bounds(name: &str, exact: &MerlTable, found: &MerlTable) {
    let greatest = exact
        .cells()
        .map(|cell| cell.truncate().max_element())
        .fold(0.0, f32::max);
    for (exact, cell) in exact.cells().zip(found.cells()) {
        let bound = match found.cell_format() {
            CellFormat::F32 => Vec3::ZERO,
            CellFormat::F16 => exact.truncate() * 2f32.powi(-11),
            CellFormat::Rgb9e5 => {
                let brightest = exact.truncate().max_element();
                // A channel that rounding carries past a power of two is 0.1 % below it.
                Vec3::splat((brightest * 1.001 / 512.0).max(greatest * 2f32.powi(-39)))
            }
        };
        let error = (cell - exact).truncate().abs();
        assert!(error.cmple(bound).all(), "{name}: {exact} became {cell}");
        assert_eq!(cell.w, exact.w, "{name}");
    }
}

#[test]
fn invalid_cells_stay_invalid_and_black_cells_stay_black() {
    for name in ["black", "void", "poisoned", "holes", "islands", "one-cell"] {
        let exact = HardCase::named(name).unwrap().table();
        for format in COMPACT {
            let found = rounded(&exact, format);
            for (number, (exact, cell)) in exact.cells().zip(found.cells()).enumerate() {
                let valid = found.valid_channels(number);
                assert_eq!(valid, [exact.w == 1.0; 3], "{name} {format:?} {number}");
                let is_black = |cell: Vec4| cell.truncate() == Vec3::ZERO;
                assert!(is_black(cell) || !is_black(exact), "{name} {number}");
            }
            assert_eq!(found.census(), exact.census());
            assert_eq!(found.count_gaps(), exact.count_gaps());
        }
    }
    let black = rounded(&HardCase::named("black").unwrap().table(), CellFormat::F16);
    assert_eq!(black.rounding_errors(), Some([RoundingError::default(); 3]));
}

#[test]
fn a_dark_channel_that_becomes_black_is_counted() {
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |h, _, _| match h {
        0 => [1.0, 1e-4, 1.0],
        _ => [1.0; 3],
    });
    let found = rounded(&table, CellFormat::Rgb9e5);
    let [red, green, _] = found.rounding_errors().unwrap();
    assert_eq!((red.zeroed, red.greatest), (0, 0.0));
    assert_eq!((green.zeroed, green.greatest), (90 * 180, 1.0));
    let notes = Loaded::from_table(Arc::new(MerlBrdf::new(found.into(), LookupRule::Floor)));
    let notes = notes.notes().join("; ");
    assert!(notes.contains("16200 values above 0 became 0"), "{notes}");
    // f16 keeps it.
    let [_, green, _] = rounded(&table, CellFormat::F16).rounding_errors().unwrap();
    assert!(green.zeroed == 0 && green.greatest < 5e-4, "{green:?}");
}

#[test]
fn values_follow_the_cells_by_every_rule() {
    let nickel = Arc::new(decode_embedded("nickel").unwrap());
    for (format, bound) in [(CellFormat::F16, 5e-4), (CellFormat::Rgb9e5, 4e-3)] {
        let found = Arc::new(rounded(&nickel, format));
        for rule in LookupRule::ALL {
            let brdf = MerlBrdf::new(found.clone(), rule);
            let exact = MerlBrdf::new(nickel.clone(), rule);
            let mut moved = 0;
            for (wo, wi) in support::pairs(3000, 5) {
                // A literal reading of the same table.
                let (expected, _) = support::naive::eval(&found, rule, wo, wi);
                let value = brdf.eval(wo, wi);
                let error = (value.as_dvec3() - expected).abs().max_element();
                assert!(
                    error <= 1e-3 * expected.max_element(),
                    "{format:?} {rule:?}"
                );
                let exact = exact.eval(wo, wi);
                let error = (value - exact).abs().max_element();
                assert!(error <= bound * exact.max_element(), "{format:?} {rule:?}");
                moved += u32::from(value != exact);
            }
            assert!(moved > 1000, "{format:?} {rule:?}: {moved}");
        }
    }
}

/// A file of which one cell has no green.
fn torn_file(folder: &Path) -> String {
    let path = folder.join("torn.binary");
    let header = Header { phi_d_bins: 180 };
    let table = MerlTable::from_fn(header, |_, _, _| [0.1, 0.2, 0.3]);
    write(&table, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let green = 12 + 8 * (header.cells() + 777);
    bytes[green..green + 8].copy_from_slice(&(-1f64).to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn partial_cells_and_values_beyond_the_formats_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let torn = Material::resolve(&torn_file(folder.path())).unwrap();
    for format in COMPACT {
        let apart = torn.clone().with_channels_apart(true);
        let error = apart.with_cell_format(format).load(LookupRule::Linear);
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("1 cells hold a value in some channels only")
                && error.contains(format.name())
                && error.contains("--table f32"),
            "{error}"
        );
        let whole = torn.clone().with_cell_format(format);
        assert!(whole.load(LookupRule::Linear).is_ok());
        let largest = HardCase::named("largest").unwrap().table();
        let error = largest.with_cell_format(format);
        assert!(matches!(error, Err(Error::Argument { .. })));
    }
    let apart = torn.with_channels_apart(true);
    assert!(apart.load(LookupRule::Linear).is_ok());
}

#[test]
fn samplers_on_compact_cells_pass_their_checks_and_files_remember_the_format() {
    for (format, sampler) in [
        (CellFormat::F16, "half-vector:2KB"),
        (CellFormat::F16, "adaptive-disc"),
        (CellFormat::Rgb9e5, "half-vector:2KB"),
    ] {
        let material = Material::resolve("red-plastic")
            .unwrap()
            .with_cell_format(format);
        let loaded = material.load(LookupRule::Floor).unwrap();
        assert!(
            loaded
                .reading()
                .ends_with(&format!("in {} cells", format.name()))
        );
        let spec: SamplerSpec = sampler.parse().unwrap();
        let built = spec.build(&loaded).unwrap();
        let settings = CheckSettings {
            draws: 20_000,
            ..CheckSettings::default()
        };
        let report = check_sampler(
            built.as_dyn(),
            &**loaded.brdf(),
            &check_directions(),
            &settings,
        );
        assert!(report.pass(), "{sampler} {format:?}");
        let bytes = encode(&built, &material).unwrap();
        let file = SamplerFile::from_bytes(bytes.clone(), Path::new("stored")).unwrap();
        let (_, read) = file.load(None).unwrap();
        assert_eq!(read.table().unwrap().table().cell_format(), format);
        let other = Material::resolve("red-plastic").unwrap();
        let other = other.load(LookupRule::Floor).unwrap();
        let file = SamplerFile::from_bytes(bytes, Path::new("stored")).unwrap();
        let error = file.into_sampler(&other).unwrap_err().to_string();
        assert!(
            error.contains(&format!("--table {}", format.name())),
            "{error}"
        );
    }
}

#[test]
fn a_rounded_table_is_written_as_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rounded.binary");
    let found = rounded(&decode_embedded("nickel").unwrap(), CellFormat::F16);
    write(&found, &path, Overwrite::Refuse).unwrap();
    let read = load(&path).unwrap();
    assert!(read.cells().eq(found.cells()));
    // What is rounded already fits exactly.
    let again = rounded(&read, CellFormat::F16);
    assert_eq!(again.rounding_errors(), Some([RoundingError::default(); 3]));
}
