//! Files of the KAIST and UTIA databases: what they become, and what is refused.

use std::f64::consts::{FRAC_1_PI, PI};
use std::path::PathBuf;
use std::sync::Arc;

use crate::grid_files::{Field, pbsdf_fields, tensor_file, utia_file};
use glam::{DVec2, DVec3, Vec3};
use merlkit::brdf::Brdf;
use merlkit::geometry::cosine_hemisphere;
use merlkit::material::measurements::{MeasurementKind, Measurements, fill_gaps};
use merlkit::material::merl::{LookupRule, MerlBrdf, MerlTable};
use merlkit::material::{Material, rgl::BsdfFile};
use tempfile::TempDir;

fn file(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("measured");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn read(bytes: &[u8], kind: MeasurementKind) -> Measurements {
    let (_folder, path) = file(bytes);
    assert_eq!(MeasurementKind::detect(&path), Some(kind));
    Measurements::read(&path, None).unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    let (_folder, path) = file(bytes);
    Measurements::read(&path, None).unwrap_err().to_string()
}

/// Pairs of directions that follow the cosine.
fn pairs() -> Vec<(Vec3, Vec3)> {
    let mut out = Vec::new();
    for k in 1..=4000 {
        let [a, b, c, d] =
            [0.8567, 0.7338, 0.6287, 0.5386].map(|step| (f64::from(k) * step).fract());
        let wo = cosine_hemisphere(DVec2::new(a, b)).as_vec3();
        let wi = cosine_hemisphere(DVec2::new(c, d)).as_vec3();
        out.push((wo, wi));
    }
    out
}

/// Median and largest relative difference of a table, by the centred lookup, from a formula, over pairs up to 70° from the normal.
fn difference(table: MerlTable, expected: impl Fn(DVec3, DVec3) -> f64) -> (f64, f64) {
    let brdf = MerlBrdf::new(Arc::new(table), LookupRule::Centred);
    let mut errors = Vec::new();
    for (wo, wi) in pairs() {
        if wo.z.min(wi.z) > 70f32.to_radians().cos() {
            let right = expected(wo.as_dvec3(), wi.as_dvec3());
            let found = f64::from(brdf.eval(wo, wi).x);
            errors.push((found / right - 1.0).abs());
        }
    }
    errors.sort_by(f64::total_cmp);
    (errors[errors.len() / 2], errors[errors.len() - 1])
}

/// Weighted by the cosine of each incident direction, the mean of both orders of 0.3 + 0.1·cosθᵢ.
fn mean_of_orders(wo: DVec3, wi: DVec3) -> f64 {
    0.3 + 0.1 * (wi.z * wi.z + wo.z * wo.z) / (wi.z + wo.z)
}

/// 0.1 + 0.4·(n·h)⁸.
fn lobe(wo: DVec3, wi: DVec3) -> f64 {
    0.1 + 0.4 * (wo + wi).normalize().z.powi(8)
}

#[test]
fn a_polarised_lambertian_comes_back() {
    let fields = pbsdf_fields([13, 7, 7], &|_, _, _| FRAC_1_PI);
    let list = read(&tensor_file(&fields), MeasurementKind::Polarised);
    let notes = list.notes().join("; ");
    assert!(
        notes.contains("polarisation was left out") && notes.contains("5 wavelengths from 450 to"),
        "{notes}"
    );
    let (table, notes) = list.to_table();
    assert_eq!(table.count_gaps(), 0);
    for cell in table.cells().filter(|cell| cell.w == 1.0) {
        let error = (cell.truncate().as_dvec3() - DVec3::splat(FRAC_1_PI)).abs();
        assert!(error.max_element() < 1e-6, "{cell}");
    }
    // A point of the grid counts once, above the horizon.
    assert!(list.count() > 100 && list.count() < 13 * 7 * 7);
    assert_eq!(notes[0], format!("measured directions: {}", list.count()));
    assert!(notes[1].contains("changes f_r by 0.000 %"), "{notes:?}");
}

#[test]
fn polarised_files_keep_lobes_orders_and_colours() {
    let grid = |f: crate::grid_files::Spectrum| {
        let bytes = tensor_file(&pbsdf_fields([37, 31, 31], f));
        read(&bytes, MeasurementKind::Polarised).to_table()
    };
    // Steps of 10° and 3° leave this error.
    let (median, largest) = difference(grid(&|wo, wi, _| lobe(wo, wi)).0, lobe);
    assert!(median < 0.002 && largest < 0.01, "{median} {largest}");
    let (table, notes) = grid(&|_, wi, _| 0.3 + 0.1 * wi.z);
    let (median, largest) = difference(table, mean_of_orders);
    assert!(median < 0.002 && largest < 0.01, "{median} {largest}");
    assert!(!notes[1].contains("changes f_r by 0.000 %"), "{notes:?}");
    // The colour of a spectrum is that of the same spectrum in a list.
    let spectrum = |nm: f64| 0.1 + (nm - 450.0) / 500.0;
    let table = grid(&|_, _, nm| spectrum(nm)).0;
    let values = [450.0, 500.0, 550.0, 600.0, 650.0].map(|nm| spectrum(nm).to_string());
    let text = format!(
        "theta_i,phi_i,theta_o,phi_o,450nm,500nm,550nm,600nm,650nm\n10,5,40,130,{}\n",
        values.join(",")
    );
    let (_folder, path) = file(text.as_bytes());
    let expected = Measurements::read(&path, None).unwrap().to_table().0;
    let cell = expected.cells().position(|c| c.w == 1.0).unwrap();
    let (found, expected) = (table.cell(cell), expected.cell(cell));
    assert!(expected.x > 2.0 * expected.z, "{expected}");
    assert!((found - expected).abs().max_element() < 1e-5, "{found}");
}

#[test]
fn unmeasured_polarised_directions_are_gaps_and_noise_below_zero_is_counted() {
    // Nothing was measured where the light is below 60°, and noise leaves values below 0 at the normal.
    let value = |_: DVec3, wi: DVec3, _: f64| match wi.z {
        z if z < 0.5 => f64::NAN,
        z if z > 0.99 => -0.01,
        _ => 0.2,
    };
    let bytes = tensor_file(&pbsdf_fields([37, 31, 31], &value));
    let list = read(&bytes, MeasurementKind::Polarised);
    let (table, notes) = list.to_table();
    let gaps = table.count_gaps();
    assert!((10_000..1_000_000).contains(&gaps), "{gaps}");
    assert!(
        notes.iter().any(|n| n.contains("which counts as 0")),
        "{notes:?}"
    );
    let filled = fill_gaps(&table);
    assert_eq!(filled.count_gaps(), 0);
    assert!(filled.filled().len() as u64 >= gaps);
}

#[test]
fn a_polarised_file_is_no_material_and_says_what_to_do() {
    let fields = pbsdf_fields([13, 7, 7], &|_, _, _| 0.2);
    let (_folder, path) = file(&tensor_file(&fields));
    let material = Material::resolve(path.to_str().unwrap()).unwrap();
    for text in [
        material.facts().unwrap_err().to_string(),
        material.load(Default::default()).unwrap_err().to_string(),
        BsdfFile::open(&path).unwrap_err().to_string(),
    ] {
        assert!(
            text.contains("polarimetric") && text.contains("`merlkit import`"),
            "{text}"
        );
    }
}

/// What is changed in the fields of a good file.
type Bend<'a> = &'a dyn Fn(&mut Vec<Field>);

#[test]
fn broken_polarised_files_are_refused_with_their_place() {
    let good = pbsdf_fields([13, 7, 7], &|_, _, _| 0.2);
    let bent = |change: Bend| {
        let mut fields = good.clone();
        change(&mut fields);
        refusal(&tensor_file(&fields))
    };
    let cases: [(Bend, &str); 9] = [
        (
            &|f| f[0].2 = vec![7, 13, 7, 5, 4, 4],
            "the shape [13, 7, 7, 5, 4, 4]",
        ),
        (&|f| f[0].1 = 9, "elements of type 10 on 6 axes"),
        (&|f| f[1].2 = vec![1, 12], "the shape [12, 7, 7, 5, 4, 4]"),
        (
            &|f| f[1].3[..4].copy_from_slice(&9f32.to_le_bytes()),
            "rising values",
        ),
        (
            &|f| f[2].3[..4].copy_from_slice(&f32::NAN.to_le_bytes()),
            "rising values",
        ),
        (
            &|f| {
                f[4].3 = [900u16, 950, 1000, 1050, 1100]
                    .iter()
                    .flat_map(|n| n.to_le_bytes())
                    .collect()
            },
            "380 to 780",
        ),
        (
            &|f| f[4].3 = [500u16; 5].iter().flat_map(|n| n.to_le_bytes()).collect(),
            "rising values",
        ),
        (&|f| drop(f.remove(2)), "a field \"theta_d\""),
        (
            &|f| f[0].3.iter_mut().for_each(|b| *b = 0xff),
            "none that is finite",
        ),
    ];
    for (change, expected) in cases {
        let text = bent(change);
        assert!(text.contains(expected), "{expected}: {text}");
    }
    // φd over half a turn.
    let half = bent(&|f| {
        f[1].3 = (0..13)
            .flat_map(|k| (k as f32 * PI as f32 / 12.0).to_le_bytes())
            .collect()
    });
    assert!(half.contains("angles over a whole turn"), "{half}");
    // Sizes beyond the file are refused before memory is taken.
    let huge = bent(&|f| f[0].2 = vec![1 << 40, 7, 7, 5, 4, 4]);
    assert!(huge.contains("data within"), "{huge}");
    // Cut off anywhere, it is an error.
    let bytes = tensor_file(&good);
    for cut in [20, 60, 150, 250, 1000, bytes.len() / 2, bytes.len() - 1] {
        let text = refusal(&bytes[..cut]);
        assert!(text.contains("at byte"), "{cut}: {text}");
    }
}

#[test]
fn a_utia_lambertian_comes_back_and_ends_at_75_degrees() {
    let list = read(&utia_file(&|_, _| [FRAC_1_PI; 3]), MeasurementKind::Utia);
    let notes = list.notes().join("; ");
    assert!(
        notes.contains("anisotropy was left out") && notes.contains("by 0.00 % (mean) and 0.00 %"),
        "{notes}"
    );
    let table = list.to_table().0;
    for cell in table.cells().filter(|cell| cell.w == 1.0) {
        let error = (cell.truncate().as_dvec3() - DVec3::splat(FRAC_1_PI)).abs();
        assert!(error.max_element() < 1e-6, "{cell}");
    }
    let brdf = MerlBrdf::new(Arc::new(table.clone()), LookupRule::Floor);
    for (wo, wi) in pairs() {
        let theta = wo.z.min(wi.z).acos().to_degrees();
        let is_black = brdf.eval(wo, wi).x == 0.0;
        // A bin reaches over two degrees.
        assert!(theta > 73.0 || !is_black, "{wo} {wi}");
        assert!(theta < 77.0 || is_black, "{wo} {wi}");
    }
    let filled = fill_gaps(&table);
    assert_eq!(filled.count_gaps(), 0);
    for cell in filled.cells().filter(|cell| cell.w == 1.0) {
        assert!((f64::from(cell.x) - FRAC_1_PI).abs() < 1e-5, "{cell}");
    }
}

#[test]
fn utia_files_keep_lobes_orders_handedness_and_colours() {
    let grid =
        |f: crate::grid_files::Colour| read(&utia_file(f), MeasurementKind::Utia).to_table().0;
    // Steps of 15° leave this error.
    let table = grid(&|wo, wi| [lobe(wo, wi); 3]);
    let (median, largest) = difference(table, lobe);
    assert!(median < 0.015 && largest < 0.15, "{median} {largest}");
    let (median, largest) = difference(grid(&|_, wi| [0.3 + 0.1 * wi.z; 3]), mean_of_orders);
    assert!(median < 0.005 && largest < 0.01, "{median} {largest}");
    // 0.2 + 0.1·sinθᵢ·sinθᵥ·sin(φᵥ − φᵢ): with the directions swapped, the sine changes its sign.
    let sine = |wo: DVec3, wi: DVec3| wi.truncate().perp_dot(wo.truncate());
    let table = grid(&|wo, wi| [0.2 + 0.1 * sine(wo, wi); 3]);
    let expected = |wo: DVec3, wi: DVec3| 0.2 + 0.1 * sine(wo, wi) * (wi.z - wo.z) / (wi.z + wo.z);
    let (median, largest) = difference(table, expected);
    assert!(median < 0.01 && largest < 0.1, "{median} {largest}");
    let table = grid(&|_, _| [0.1, 0.2, 0.4]);
    let cell = table.cells().find(|c| c.w == 1.0).unwrap();
    assert!(
        (cell.truncate() - Vec3::new(0.1, 0.2, 0.4))
            .abs()
            .max_element()
            < 1e-6
    );
}

#[test]
fn lost_anisotropy_is_told() {
    let brushed = |_: DVec3, wi: DVec3| {
        let cosine = match wi.z < 0.999 {
            true => (2.0 * wi.y.atan2(wi.x)).cos(),
            false => 0.0,
        };
        [0.2 + 0.1 * cosine; 3]
    };
    let list = read(&utia_file(&brushed), MeasurementKind::Utia);
    let notes = list.notes().join("; ");
    // The mean of |cos 2φ|/2 over 48 azimuths is cot(7.5°)/24 = 31.65 %, and the light has an azimuth at 5 of 6 elevations.
    assert!(
        notes.contains("by 26.37 % (mean) and 50.00 % (largest, light at 15°"),
        "{notes}"
    );
    let (_, largest) = difference(list.to_table().0, |_, _| 0.2);
    assert!(largest < 1e-5, "{largest}");
}

#[test]
fn utia_files_are_no_materials_and_others_of_their_size_are_not_taken_for_them() {
    let bytes = utia_file(&|_, _| [0.2; 3]);
    let answer = |bytes: &[u8]| {
        let (_folder, path) = file(bytes);
        let material = Material::resolve(path.to_str().unwrap()).unwrap();
        material.facts().unwrap_err().to_string()
    };
    let text = answer(&bytes);
    assert!(
        text.contains("UTIA") && text.contains("`merlkit import`"),
        "{text}"
    );
    assert!(!answer(&bytes[..bytes.len() - 1]).contains("UTIA"));
    let mut picture = bytes.clone();
    picture[..8].copy_from_slice(b"\x89PNG\r\n\x1a\n");
    assert!(answer(&picture).contains("a PNG picture"));
    let mut torn = bytes.clone();
    torn[800_000..800_008].copy_from_slice(&f64::NAN.to_le_bytes());
    let text = refusal(&torn);
    assert!(
        text.contains("at byte 800000") && text.contains("NaN"),
        "{text}"
    );
}

#[test]
fn broken_polarised_files_come_with_advice_for_their_kind() {
    let folder = tempfile::tempdir().unwrap();
    let mut fields = pbsdf_fields([5, 3, 3], &|_, _, _| 0.2);
    fields[0].1 = 9;
    // The fields show the kind, or the name does where the fields can't be read.
    let wrong = folder.path().join("wrong");
    std::fs::write(&wrong, tensor_file(&fields)).unwrap();
    let cut = folder.path().join("cut.pbsdf");
    std::fs::write(&cut, &tensor_file(&fields)[..40]).unwrap();
    for path in [wrong, cut] {
        let error = Measurements::read(&path, None).err().unwrap().to_string();
        assert!(error.contains("name a .pbsdf file"), "{error}");
        assert!(!error.contains("name a .bsdf file"), "{error}");
    }
}

#[test]
fn bent_polarised_files_are_read_or_refused() {
    let good = tensor_file(&pbsdf_fields([5, 3, 3], &|_, _, _| 0.2));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bent");
    let (mut state, mut refused) = (7u64, 0);
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    for _ in 0..2000 {
        let mut bytes = good.clone();
        for _ in 0..1 + random(3) {
            // In the list of fields, or in the axes behind the matrices.
            let place = match random(2) {
                0 => random(300),
                _ => good.len() - 1 - random(80),
            };
            bytes[place] = random(256) as u8;
        }
        std::fs::write(&path, &bytes).unwrap();
        match Measurements::read(&path, None) {
            Ok(grid) => assert!(grid.count() > 0),
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
    assert!(refused > 500, "{refused}");
}
