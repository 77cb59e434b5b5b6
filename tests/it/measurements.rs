//! Lists of measurements and arrays of numpy as MERL tables; gaps and their filling.

use std::path::PathBuf;
use std::sync::Arc;

use crate::measured_data::data_folder;
use glam::Vec3;
use merlkit::Loaded;
use merlkit::brdf::Brdf;
use merlkit::files::Overwrite;
use merlkit::material::measurements::{
    AngleUnit, MeasurementKind, Measurements, fill_gaps, read_array,
};
use merlkit::material::merl::{Header, LookupRule, MerlBrdf, MerlTable};
use merlkit::material::merl::{decode_embedded, load, write};
use tempfile::TempDir;

const HEADER: Header = Header { phi_d_bins: 180 };

fn file(content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("list.csv");
    std::fs::write(&path, content).unwrap();
    (folder, path)
}

fn read(text: &str) -> Measurements {
    let (_folder, path) = file(text);
    assert_eq!(MeasurementKind::detect(&path), Some(MeasurementKind::List));
    Measurements::read(&path, None).unwrap()
}

fn refusal(text: &str) -> String {
    let (_folder, path) = file(text);
    Measurements::read(&path, None).unwrap_err().to_string()
}

/// f_r that the list's table has for a pair, by angles in degrees.
fn value(list: &Measurements, [theta_i, phi_i, theta_o, phi_o]: [f64; 4]) -> Vec3 {
    let brdf = MerlBrdf::new(Arc::new(list.to_table().0), LookupRule::Floor);
    let direction = |theta: f64, phi: f64| {
        merlkit::geometry::spherical(theta.to_radians(), phi.to_radians()).as_vec3()
    };
    brdf.eval(direction(theta_o, phi_o), direction(theta_i, phi_i))
}

#[test]
fn named_columns_are_read_in_any_order_unit_and_separator() {
    let pair = [10.0, 5.0, 40.0, 130.0];
    let rgb = Vec3::new(0.1, 0.25, 0.5);
    for text in [
        "# measured in 2026\ntheta_i,phi_i,theta_o,phi_o,r,g,b\n10,5,40,130,0.1,0.25,0.5\n",
        "B;G;R;Phi R;Theta R;Phi In;Theta In\n0.5;0.25;0.1;130;40;5;10\n",
        "theta_i[rad] phi_i[rad] theta_o[rad] phi_o[rad] red green blue\n\
         0.17453293 0.08726646 0.69813170 2.26892803 0.1 0.25 0.5\n",
        "LAB_NAME x\nNUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,Red,Green,Blue\n\
         0.17453293,0.08726646,0.69813170,2.26892803,0.1,0.25,0.5\n",
    ] {
        let list = read(text);
        assert_eq!(list.count(), 1, "{text}");
        assert_eq!(value(&list, pair), rgb, "{text}");
        assert!(list.notes().is_empty(), "{:?}", list.notes());
    }
    let grey = read("theta_i,phi_i,theta_o,phi_o,value\n10,5,40,130,0.3\n");
    assert_eq!(value(&grey, pair), Vec3::splat(0.3));
}

#[test]
fn half_and_difference_angles_are_read() {
    // θh = 30°, θd = 0: both directions are the half vector.
    let list = read("theta_h,theta_d,phi_d,value\n30,0,0,0.7\n");
    assert_eq!(value(&list, [30.0, 0.0, 30.0, 0.0]), Vec3::splat(0.7));
    // θh = 0, θd = 40°: the mirror direction.
    let list = read("theta_h,theta_d,phi_d,value\n0,40.5,0.5,0.2\n");
    assert_eq!(value(&list, [40.5, 0.5, 40.5, 180.5]), Vec3::splat(0.2));
}

#[test]
fn wavelengths_become_colours_in_light_of_d65() {
    // A flat spectrum is grey, in CSV and in Cornell's lists alike.
    let list = read("theta_i,phi_i,theta_o,phi_o,650nm,450nm,550nm\n10,5,40,130,0.4,0.4,0.4\n");
    let found = value(&list, [10.0, 5.0, 40.0, 130.0]);
    assert!(
        (found - Vec3::splat(0.4)).abs().max_element() < 1e-6,
        "{found}"
    );
    let cornell =
        "# Cornell\n# num wls\n3\n\n# wls\n400 550\n700\n\n# rows\n0.2 0.1 0.6 2.5 0.1 0.1 0.9\n";
    let list = read(cornell);
    let red = value(&list, [0.2f64, 0.1, 0.6, 2.5].map(f64::to_degrees));
    assert!(red.x > 2.0 * red.z, "{red}");
}

#[test]
fn pairs_in_one_bin_are_averaged_and_the_rest_is_a_gap() {
    let list = read(
        "theta_i,phi_i,theta_o,phi_o,value\n10,0,40.2,180,0.2\n10,0,40.3,180,0.4\n95,0,10,0,1\n20,0,20,180,nan\n",
    );
    assert_eq!(list.count(), 2);
    let notes = list.notes().join("; ");
    assert!(
        notes.contains("left out with a direction at or below the horizon: 1")
            && notes.contains("without a finite"),
        "{notes}"
    );
    let (table, notes) = list.to_table();
    assert!(
        notes[0].starts_with("measurements: 2, in 1 of"),
        "{notes:?}"
    );
    assert!((value(&list, [10.0, 0.0, 40.2, 180.0]).x - 0.3).abs() < 1e-6);
    assert!(table.count_gaps() > 1_000_000);
    let brdf = MerlBrdf::new(Arc::new(table), LookupRule::Floor);
    assert!((list.median_error(&brdf) - 0.5).abs() < 1e-3);
}

#[test]
fn lists_without_azimuths_lie_in_the_plane_of_incidence() {
    let list = read("theta_i,theta_o,value\n30,30.2,0.9\n30,-10,0.1\n");
    assert!(
        list.notes()[0].contains("plane of incidence"),
        "{:?}",
        list.notes()
    );
    assert_eq!(value(&list, [30.0, 0.0, 30.2, 180.0]), Vec3::splat(0.9));
    assert_eq!(value(&list, [30.0, 0.0, 10.0, 0.0]), Vec3::splat(0.1));
}

#[test]
fn what_breaks_the_grammar_is_named_with_its_place() {
    let heading = "theta_i,phi_i,theta_o,phi_o,value\n";
    let many = format!("{heading}{}", "0.5,0.1,1.2,3.1,0.2\n".repeat(20));
    for (text, says) in [
        ("a,b,c\n1,2,3\n", "theta_i and theta_o not among them"),
        (
            "theta_i,phi_i,theta_o,phi_o\n1,2,3,4\n",
            "columns r, g and b",
        ),
        (
            &format!("{heading}1,2,3\n"),
            "at byte 34: expected 5 numbers, found 3",
        ),
        (
            &format!("{heading}1,2,x,4,5\n"),
            "expected numbers, found x",
        ),
        (heading, "rows of numbers"),
        ("# nothing\n", "names of columns"),
        (&many, "pass --angles radians"),
        (
            "VARS theta_i,phi_i,theta_s,phi_s,value\n30,0,40,180,0.1\n",
            "pass --angles degrees",
        ),
        (
            "NUM_POINTS 3\nVARS theta_i,phi_i,theta_s,phi_s,value\n0.1,0,0.2,0,0.1\n",
            "3 rows, as NUM_POINTS",
        ),
        ("2\n400 500 600\n1 1 1 1 1 1\n", "2 wavelengths"),
        ("3\n400 500\n", "3 wavelengths"),
        ("2\n900 1000\n0.1 0.1 0.1 0.1 1 1\n", "which have a colour"),
        (
            "theta_i,phi_i,theta_o,phi_o,value\ninf,0,0,0,1\n",
            "finite angles",
        ),
    ] {
        let found = refusal(text);
        assert!(found.contains(says), "{text:?}: {found}");
    }
    let (_folder, path) = file(&many);
    let list = Measurements::read(&path, Some(AngleUnit::Radians)).unwrap();
    assert_eq!(list.count(), 20);
}

/// The columns of `.npy` files: [type, shape, values of channel `c` in cell `k`].
fn npy(descr: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let head = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let mut out = b"\x93NUMPY\x01\0".to_vec();
    out.extend((head.len() as u16).to_le_bytes());
    out.extend(head.as_bytes());
    out.extend(bytes);
    out
}

#[test]
fn arrays_of_both_layouts_and_precisions_are_tables() {
    let value = |cell: usize, channel: usize| {
        if cell == 7 {
            f64::NAN
        } else {
            (cell % 1000) as f64 + 0.25 * channel as f64
        }
    };
    let cells = HEADER.cells();
    let (mut last, mut first) = (Vec::new(), Vec::new());
    for k in 0..3 * cells {
        last.extend((value(k / 3, k % 3) as f32).to_le_bytes());
        first.extend(value(k % cells, k / cells).to_le_bytes());
    }
    for bytes in [
        npy("<f4", "90, 90, 180, 3", &last),
        npy("<f8", "3, 90, 90, 180", &first),
    ] {
        let (_folder, path) = file(bytes);
        assert_eq!(MeasurementKind::detect(&path), Some(MeasurementKind::Array));
        let table = read_array(&path, false).unwrap();
        assert_eq!(table.census().nan, 1);
        for cell in [0usize, 8, 999, 1_457_999] {
            let found = table.cell(cell);
            assert_eq!(found.x, value(cell, 0) as f32);
            assert_eq!(found.z, value(cell, 2) as f32);
        }
    }
    for (bytes, says) in [
        (npy("<f4", "90, 90, 180", &last), "the shape of a table"),
        (npy(">f4", "90, 90, 180, 3", &last), "of type <f4 or <f8"),
        (
            npy("<f4", "90, 90, 180, 3", &last[..100]),
            "bytes of numbers",
        ),
        (b"\x93NUMPY\x01\0\xff\xff{".to_vec(), "a head"),
        (b"PK\x03\x04 no archive".to_vec(), "an .npz archive"),
    ] {
        let (_folder, path) = file(bytes);
        let found = read_array(&path, false).unwrap_err().to_string();
        assert!(found.contains(says), "{found}");
    }
}

#[test]
fn gaps_are_filled_marked_and_told() {
    // Every cell with an odd sum of indices is a gap, and so is all of θd < 20 and φd < 90, which mirror images have.
    let nickel = decode_embedded("nickel").unwrap();
    let table = MerlTable::from_fn(HEADER, |h, d, p| {
        if (h + d + p) % 2 == 1 || (d < 20 && p < 90) {
            [-1.0; 3]
        } else {
            nickel.rgb(h, d, p).as_dvec3().to_array()
        }
    });
    assert!(table.count_gaps() > 400_000);
    let filled = fill_gaps(&table);
    assert_eq!(filled.count_gaps(), 0);
    let mut errors = Vec::new();
    for (cell, (found, had)) in filled.cells().zip(table.cells()).enumerate() {
        let is_filled = filled.filled().binary_search(&(cell as u32)).is_ok();
        assert_eq!(is_filled, had.w == 0.0 && found.w == 1.0);
        if had.w == 1.0 {
            assert_eq!(found, had);
        } else if is_filled && nickel.cell(cell).w == 1.0 {
            let expected = nickel.cell(cell);
            errors.push((found.x / expected.x - 1.0).abs());
        }
    }
    errors.sort_by(f32::total_cmp);
    assert!(
        errors[errors.len() / 2] < 0.03,
        "{}",
        errors[errors.len() / 2]
    );
    assert!(
        errors[errors.len() * 95 / 100] < 0.1,
        "{}",
        errors[errors.len() * 95 / 100]
    );

    // The mark survives the file, and every loader tells.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("filled.binary");
    write(&filled, &path, Overwrite::Refuse).unwrap();
    // A file that is open for writing is not mapped.
    let mapped = load(&path).unwrap();
    let writer = std::fs::OpenOptions::new().append(true).open(&path);
    let copied = load(&path).unwrap();
    drop(writer);
    for read in [mapped, copied] {
        assert_eq!(read.filled(), filled.filled());
        assert!(read.cells().eq(filled.cells()));
        let measured = MerlBrdf::new(Arc::new(read), LookupRule::Floor);
        let notes = Loaded::from_table(Arc::new(measured)).notes().join("; ");
        assert!(
            notes.contains("were filled in from others, not measured"),
            "{notes}"
        );
    }
    // A table without gaps has no marks.
    write(&nickel, &path, Overwrite::Replace).unwrap();
    assert!(load(&path).unwrap().filled().is_empty());
}

#[test]
fn nothing_can_be_filled_from_nothing() {
    let empty = MerlTable::from_fn(HEADER, |_, _, _| [-1.0; 3]);
    let filled = fill_gaps(&empty);
    assert!(filled.filled().is_empty());
    assert!(filled.cells().eq(empty.cells()));
}

/// Real scattered measurements, where they are.
#[test]
fn cornells_measurements_are_read() {
    let Some(folder) = data_folder("other") else {
        return;
    };
    let list = Measurements::read(&folder.join("cornell_garnet_red.brdf"), None).unwrap();
    assert_eq!(list.count(), 1439);
    let filled = fill_gaps(&list.to_table().0);
    assert_eq!(filled.count_gaps(), 0);
    // A red paint: its diffuse colour at 30°, 0° is the 9 % that the list has at 650 nm there.
    let brdf = MerlBrdf::new(Arc::new(filled), LookupRule::Floor);
    assert!(list.median_error(&brdf) < 0.001);
    let rgb = brdf.eval(Vec3::new(0.0, 0.5, 0.75f32.sqrt()), Vec3::Z);
    assert!(rgb.x > 3.0 * rgb.y && (0.01..0.1).contains(&rgb.x), "{rgb}");
}
