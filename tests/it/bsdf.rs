//! `.bsdf` files: written and read, hostile ones, and what they make of a material.

use crate::measured_data::measured_files;
use crate::support;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, Vec3};
use merlkit::Error;
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::files::Overwrite;
use merlkit::geometry::{Quadrature, spherical};
use merlkit::material::Material;
use merlkit::material::merl::{BinPoint, HardCase, decode_embedded, tabulate_brdf};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::material::rgl::{
    BsdfFile, BsdfSize, Colour, RglBrdf, Tensor, looks_like_bsdf, tabulate,
};
use merlkit::points::Stream;
use merlkit_evaluate::measure::chi_square::{ChiSquareTest, ChiSquareVerdict};
use merlkit_evaluate::measure::{colour_error, draw_quality, size_within, value_errors};

const PATH: &str = "some.bsdf";

fn embedded(name: &str, rule: LookupRule) -> MerlBrdf {
    MerlBrdf::new(Arc::new(decode_embedded(name).unwrap()), rule)
}

fn preset(name: &str) -> BsdfSize {
    BsdfSize::ALL.into_iter().find(|s| s.name == name).unwrap()
}

fn exported(brdf: &dyn Brdf, size: BsdfSize) -> BsdfFile {
    tabulate(|wo, wi| brdf.eval(wo, wi), size, "test".into())
}

/// A file as other programs write them: anisotropic, stretched, with spectra.
fn general(azimuths: usize, jacobian: bool) -> BsdfFile {
    let mut random = Stream::new(3);
    let mut tensor = |shape: &[usize]| Tensor {
        shape: shape.to_vec(),
        values: (0..shape.iter().product())
            .map(|_| 0.1 + random.next_f32())
            .collect(),
    };
    let (p, t) = (azimuths, 4);
    BsdfFile {
        notes: Vec::new(),
        description: "noise".into(),
        theta_i: vec![0.0, 0.4, 0.9, 1.5],
        // Half a turn where there are more than two.
        phi_i: (0..p)
            .map(|k| -std::f32::consts::PI * (1.0 - k as f32 / (p.max(2) - 1) as f32))
            .collect(),
        jacobian,
        ndf: tensor(&[5, 6]),
        sigma: tensor(&[3, 4]),
        vndf: tensor(&[p, t, 7, 5]),
        luminance: tensor(&[p, t, 6, 6]),
        colour: Colour::Spectral {
            wavelengths: vec![400.0, 550.0, 700.0],
            spectra: tensor(&[p, t, 3, 6, 6]),
        },
    }
}

fn bytes_of(file: &BsdfFile) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f");
    let length = file.write(&path, Overwrite::Refuse).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.len() as u64, length);
    assert!(looks_like_bsdf(&path));
    bytes
}

fn read(bytes: &[u8]) -> Result<BsdfFile, Error> {
    BsdfFile::from_bytes(bytes.to_vec(), Path::new(PATH))
}

#[test]
fn files_come_back_to_the_bit() {
    let direct = exported(&embedded("nickel", LookupRule::Linear), preset("0.4MB"));
    for file in [
        direct.to_spectral(),
        direct,
        general(1, true),
        general(5, false),
    ] {
        assert_eq!(read(&bytes_of(&file)).unwrap(), file);
    }
}

/// Where an error is said to be, and the whole message.
fn refused(bytes: &[u8]) -> (u64, String) {
    let Err(error) = read(bytes) else {
        panic!("was read")
    };
    let text = error.to_string();
    assert!(text.starts_with("some.bsdf: at byte "), "{text}");
    match error {
        Error::Invalid { offset, .. } => (offset, text),
        _ => panic!("{text}"),
    }
}

/// Place of a field's entry in the list.
fn entry(bytes: &[u8], name: &str) -> usize {
    let mut wanted = (name.len() as u16).to_le_bytes().to_vec();
    wanted.extend_from_slice(name.as_bytes());
    bytes
        .windows(wanted.len())
        .position(|w| w == wanted)
        .unwrap()
}

/// The file with a field's bytes replaced, `at` counted behind its name: 0 axes, 2 type, 3 offset, 11 shape.
fn with(bytes: &[u8], name: &str, at: usize, new: &[u8]) -> Vec<u8> {
    let start = entry(bytes, name) + 2 + name.len() + at;
    let mut out = bytes.to_vec();
    out[start..start + new.len()].copy_from_slice(new);
    out
}

/// The file with a value of a field replaced.
fn with_value(bytes: &[u8], name: &str, index: usize, value: f32) -> (usize, Vec<u8>) {
    let at = entry(bytes, name) + 2 + name.len() + 3;
    let offset = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize + 4 * index;
    let mut out = bytes.to_vec();
    out[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
    (offset, out)
}

#[test]
fn containers_that_lie_are_refused_where_they_do() {
    let good = bytes_of(&general(1, true));
    let at = |name: &str| entry(&good, name) as u64;
    let cases: [(Vec<u8>, u64, &str); 13] = [
        (
            b"not a tensor file, but long enough".to_vec(),
            0,
            "tensor_file",
        ),
        (
            [&good[..12], &[2, 0], &good[14..]].concat(),
            12,
            "version 2.0",
        ),
        ([&good[..14], &[255; 4], &good[18..]].concat(), u64::MAX, ""),
        (with(&good, "vndf", 2, &[0]), u64::MAX, "type 0"),
        (with(&good, "vndf", 2, &[12]), u64::MAX, "type 12"),
        (
            with(&good, "vndf", 2, &[6]),
            at("vndf"),
            "elements of type 10",
        ),
        (
            with(&good, "vndf", 3, &u64::MAX.to_le_bytes()),
            at("vndf"),
            "data within",
        ),
        (
            with(&good, "vndf", 3, &(good.len() as u64 - 8).to_le_bytes()),
            at("vndf"),
            "data within",
        ),
        (
            with(&good, "vndf", 3, &0u64.to_le_bytes()),
            at("vndf"),
            "data from byte",
        ),
        (
            with(&good, "vndf", 11, &(1u64 << 62).to_le_bytes()),
            at("vndf"),
            "data within",
        ),
        (
            with(&good, "vndf", 11, &0u64.to_le_bytes()),
            at("vndf"),
            "values",
        ),
        (with(&good, "sigma", 0, &[1, 0]), u64::MAX, ""),
        (
            [
                &good[..entry(&good, "sigma") + 2],
                &b"vndf_"[..],
                &good[entry(&good, "sigma") + 7..],
            ]
            .concat(),
            18,
            "\"sigma\"",
        ),
    ];
    for (bytes, offset, says) in cases {
        let (found, text) = refused(&bytes);
        assert!(offset == u64::MAX || found == offset, "{offset}: {text}");
        assert!(text.contains(says), "{says}: {text}");
    }
    let twice = [
        &good[..entry(&good, "sigma") + 2],
        &b"theta"[..],
        &good[entry(&good, "sigma") + 7..],
    ]
    .concat();
    let twice = [
        &twice[..entry(&twice, "theta_i") + 2],
        &b"phi_i__"[..],
        &twice[entry(&twice, "theta_i") + 9..],
    ]
    .concat();
    refused(&twice);
    let same = with(&good, "ndf", 3, &offset_of(&good, "sigma"));
    assert!(refused(&same).1.contains("data from byte"));
    let odd = offset_of(&good, "spectra").map(|b| b ^ 1);
    assert!(refused(&with(&good, "spectra", 3, &odd)).1.contains("data"));
}

fn offset_of(bytes: &[u8], name: &str) -> [u8; 8] {
    let at = entry(bytes, name) + 2 + name.len() + 3;
    bytes[at..at + 8].try_into().unwrap()
}

#[test]
fn a_field_that_is_there_twice_is_refused() {
    let field = |offset: u64| {
        let mut out = vec![1, 0, b'a', 1, 0, 1];
        out.extend_from_slice(&offset.to_le_bytes());
        out.extend_from_slice(&1u64.to_le_bytes());
        out
    };
    let head = [&b"tensor_file\0\x01\0"[..], &2u32.to_le_bytes()].concat();
    let bytes = [head, field(64), field(65), vec![0; 16]].concat();
    assert!(refused(&bytes).1.contains("another \"a\""));
}

#[test]
fn every_cut_is_refused() {
    let good = bytes_of(&general(1, true));
    let ends = (0..500)
        .chain((500..good.len()).step_by(97))
        .chain([good.len() - 1]);
    for end in ends {
        refused(&good[..end]);
    }
}

#[test]
fn values_that_cannot_be_are_refused_where_they_stand() {
    let good = bytes_of(&general(3, true));
    let cases = [
        ("theta_i", 2, 0.4, "rising"),
        ("theta_i", 0, -0.5, "from 0"),
        ("theta_i", 3, 1.6, "from 0"),
        ("phi_i", 1, -3.2, "rising"),
        ("wavelengths", 0, 0.0, "from 1"),
        ("ndf", 7, -1e-4, "≥ 0"),
        ("luminance", 40, f32::NAN, "finite"),
        ("spectra", 11, f32::INFINITY, "finite"),
        ("vndf", 3, f32::NEG_INFINITY, "finite"),
    ];
    for (name, index, value, says) in cases {
        let (at, bytes) = with_value(&good, name, index, value);
        assert!(read(&bytes).is_err(), "{name}: {value}");
        let (found, text) = refused(&bytes);
        assert!(
            found == at as u64 && text.contains(says) && text.contains(name),
            "{at}: {text}"
        );
    }
    let mut file = general(2, true);
    file.luminance.values[36..72].fill(0.0);
    assert!(refused(&bytes_of(&file)).1.contains("not all zero"));
    let mut file = general(2, true);
    file.ndf = Tensor::filled(&[1, 4], 1.0);
    assert!(refused(&bytes_of(&file)).1.contains("at least 2"));
    let mut file = general(2, true);
    file.vndf = Tensor::filled(&[1, 4, 2, 2], 1.0);
    assert!(refused(&bytes_of(&file)).1.contains("slices for 2 phi_i"));
    let mut file = general(2, true);
    file.colour = Colour::Rgb(Tensor::filled(&[2, 4, 3, 6, 5], 1.0));
    assert!(refused(&bytes_of(&file)).1.contains("the shape [3, 6, 6]"));
}

/// Any byte changed: an error or a file that can be used; never a panic.
#[test]
fn no_damage_panics() {
    let good = bytes_of(&general(3, true));
    let mut random = Stream::new(1);
    for i in 0..3000 {
        let mut bytes = good.clone();
        let at = if i % 2 == 0 {
            random.next_u64() as usize % 400
        } else {
            random.next_u64() as usize % good.len()
        };
        bytes[at] ^= 1 << (random.next_u64() % 8);
        let Ok(file) = read(&bytes) else { continue };
        if i % 10 == 0 {
            check_values(&RglBrdf::new(file), 20);
        }
    }
}

fn check_values(rgl: &RglBrdf, count: usize) {
    let mut random = Stream::new(7);
    for (wo, wi) in support::pairs(count, 2) {
        let f = rgl.eval(wo, wi);
        assert!(f.is_finite() && f.min_element() >= 0.0, "{f} at {wo}, {wi}");
        assert!(rgl.pdf(wo, wi) >= 0.0);
        let _ = rgl.map_square(wo, DVec2::new(random.next_f64(), random.next_f64()));
    }
    for w in [Vec3::NAN, Vec3::ZERO, -Vec3::Z, Vec3::INFINITY] {
        assert_eq!(rgl.eval(w, Vec3::Z), Rgb::ZERO);
        assert_eq!(rgl.eval(Vec3::Z, w), Rgb::ZERO);
        assert_eq!(rgl.pdf(w, Vec3::Z), 0.0);
        assert_eq!(rgl.map_square(w, DVec2::splat(0.5)), None);
    }
}

/// The bars: at 6 MB, within 0.1 % in the median and 2 % in 95 of a hundred pairs.
#[test]
fn six_megabytes_reproduce_the_table() {
    for name in ["nickel", "chrome", "teflon", "blue-metallic-paint"] {
        let brdf = embedded(name, LookupRule::Linear);
        let file = exported(&brdf, preset("6MB"));
        assert!((6e6..6.2e6).contains(&(bytes_of(&file).len() as f64)));
        let rgl = RglBrdf::new(file);
        let errors = value_errors(&rgl, &brdf);
        assert!(
            errors.median < 0.001 && errors.percentile_95 < 0.02,
            "{name}: {errors:?}"
        );
        assert!(errors.albedo < 0.015, "{name}: {errors:?}");
        let draws = draw_quality(&rgl, &brdf, Importance::Luminance);
        assert!(
            draws.largest_relstd < 0.07 && draws.failed < 0.002,
            "{name}: {draws:?}"
        );
    }
}

#[test]
fn spectra_give_back_the_colours() {
    let file = exported(
        &embedded("blue-metallic-paint", LookupRule::Linear),
        preset("0.4MB"),
    );
    let spectral = file.to_spectral();
    let error = colour_error(&spectral, &file);
    assert!(error > 0.0 && error < 1e-5, "{error}");
    let Colour::Spectral {
        wavelengths,
        spectra,
    } = &spectral.colour
    else {
        panic!()
    };
    assert_eq!(spectra.shape[2], wavelengths.len());
    assert_eq!(spectral.to_spectral(), spectral);
}

#[test]
fn the_smallest_size_within_an_error_is_taken() {
    let brdf = embedded("nickel", LookupRule::Linear);
    assert_eq!(size_within(&brdf, 0.01).unwrap().0.name, "0.4MB");
    assert_eq!(size_within(&brdf, 0.002).unwrap().0.name, "1.5MB");
    let error = size_within(&brdf, 1e-6).unwrap_err().to_string();
    assert!(error.contains("the least is 0.0"), "{error}");
}

/// Also a file whose warp and density have nothing to do with each other, isotropic or not.
#[test]
fn draws_follow_the_density() {
    let direct = exported(&embedded("nickel", LookupRule::Linear), preset("1.5MB"));
    let files = [direct, general(1, true), general(5, true)];
    let angles = [0.0, 33.0, 71.0];
    let test = ChiSquareTest {
        tests: files.len() * angles.len(),
        ..ChiSquareTest::default()
    };
    for (file, name) in files
        .into_iter()
        .zip(["direct", "isotropic", "anisotropic"])
    {
        let rgl = RglBrdf::new(file);
        for degrees in angles {
            let wo = spherical(f64::to_radians(degrees), 0.6).as_vec3();
            let found = test.run(&rgl, wo);
            assert_eq!(
                found.verdict,
                ChiSquareVerdict::Pass,
                "{name}, {degrees}°: {found:?}"
            );
        }
    }
}

/// With a warp, ∫ pdf is one minus the draws below the horizon; a wrong inverse or Jacobian shows.
#[test]
fn densities_of_stretched_files_integrate_to_what_is_drawn() {
    for azimuths in [1, 5] {
        let rgl = RglBrdf::new(general(azimuths, true));
        let wo = spherical(0.5, 2.2).as_vec3();
        let sum = Quadrature::new(wo, 987).integrate(|wi| f64::from(rgl.pdf(wo, wi)));
        let mut random = Stream::new(5);
        let drawn = (0..200_000)
            .filter(|_| {
                rgl.map_square(wo, DVec2::new(random.next_f64(), random.next_f64()))
                    .is_some()
            })
            .count();
        assert!((sum - drawn as f64 / 2e5).abs() < 0.005, "{sum} {drawn}");
        assert!(sum < 0.99);
    }
}

#[test]
fn turns_that_a_file_leaves_out_change_nothing() {
    let half = RglBrdf::new(general(5, true));
    // The projected area may depend on the azimuth of `wo` even so.
    let isotropic = RglBrdf::new(general(1, false));
    assert!(isotropic.is_isotropic() && !half.is_isotropic());
    let mut differ = 0;
    for (wo, wi) in support::pairs(1000, 4) {
        let turn = |w: Vec3| Vec3::new(-w.x, -w.y, w.z);
        assert_eq!(half.eval_cos(wo, wi), half.eval_cos(turn(wo), turn(wi)));
        let spun = |w: Vec3| glam::Quat::from_rotation_z(1.0) * w;
        let (a, b) = (
            isotropic.eval_cos(wo, wi),
            isotropic.eval_cos(spun(wo), spun(wi)),
        );
        differ += usize::from((a - b).abs().max_element() > 1e-3);
    }
    // At the pole and where azimuths begin anew the noise jumps.
    assert!(differ < 100, "{differ}");
}

#[test]
fn hard_tables_can_be_written_and_drawn_from() {
    for case in HardCase::ALL {
        let brdf = MerlBrdf::new(Arc::new(case.table()), LookupRule::Floor);
        let file = read(&bytes_of(&exported(
            &brdf,
            BsdfSize {
                name: "",
                angles: 3,
                side: 12,
            },
        )))
        .unwrap();
        check_values(&RglBrdf::new(file.to_spectral()), 50);
        check_values(&RglBrdf::new(file), 50);
    }
}

/// A MERL table that is made of a file, by either rule.
#[test]
fn a_table_is_made_of_an_isotropic_file() {
    let brdf = embedded("blue-metallic-paint", LookupRule::Linear);
    let rgl = RglBrdf::new(exported(&brdf, preset("3MB")).to_spectral());
    for (point, rule) in [
        (BinPoint::Edge, LookupRule::Linear),
        (BinPoint::Centre, LookupRule::Centred),
    ] {
        let table = tabulate_brdf(&rgl, point).unwrap();
        let errors = value_errors(&MerlBrdf::new(Arc::new(table), rule), &rgl);
        assert!(
            errors.median < 0.002 && errors.percentile_95 < 0.02,
            "{errors:?}"
        );
    }
    let brushed = RglBrdf::new(general(5, true));
    let error = tabulate_brdf(&brushed, BinPoint::Edge).unwrap_err();
    assert!(error.to_string().contains("anisotropic"), "{error}");
}

/// Every value of a material is that of the file to the bit, whichever rule is asked for: resampled as a table, most would
/// differ.
fn assert_evaluated_as_it_is(path: &Path) {
    let rgl = RglBrdf::new(BsdfFile::open(path).unwrap());
    let material = Material::resolve(path.to_str().unwrap()).unwrap();
    let facts = material.facts().unwrap();
    assert_eq!(facts.symmetry, rgl.symmetry());
    assert!(!facts.has_table && facts.has_own_sampler);
    for rule in LookupRule::ALL {
        let loaded = material.load(rule).unwrap();
        assert_eq!(loaded.facts(), facts);
        assert!(loaded.table().is_none() && loaded.rule().is_none());
        let own = loaded.own_sampler().unwrap();
        for (wo, wi) in support::pairs(2000, 11) {
            let bits = |f: Rgb| f.to_array().map(f32::to_bits);
            let brdf = loaded.brdf();
            assert_eq!(bits(brdf.eval(wo, wi)), bits(rgl.eval(wo, wi)));
            assert_eq!(bits(brdf.eval_cos(wo, wi)), bits(rgl.eval_cos(wo, wi)));
            assert_eq!(own.pdf(wo, wi).to_bits(), rgl.pdf(wo, wi).to_bits());
        }
    }
}

#[test]
fn isotropic_files_are_evaluated_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("paint.bsdf");
    let brdf = embedded("blue-metallic-paint", LookupRule::Linear);
    let file = exported(&brdf, preset("0.4MB"));
    file.write(&path, Overwrite::Refuse).unwrap();
    assert_evaluated_as_it_is(&path);
    // The comparison can fail: a table of the same file has other values.
    let rgl = RglBrdf::new(file);
    let table = tabulate_brdf(&rgl, BinPoint::Centre).unwrap();
    let table = MerlBrdf::new(Arc::new(table), LookupRule::Floor);
    let differ =
        support::pairs(2000, 11).filter(|&(wo, wi)| table.eval(wo, wi) != rgl.eval(wo, wi));
    assert!(differ.count() > 1500);
}

#[test]
fn measured_files_are_evaluated_as_they_are() {
    for path in measured_files() {
        assert_evaluated_as_it_is(&path);
    }
}

/// One measurement of the database has a luminance of −7·10⁻¹¹, which its own readers take.
#[test]
fn residues_of_rounding_count_as_zero_and_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("residue.bsdf");
    let write = |value: f32| {
        let mut file = general(2, false);
        let largest = file.luminance.values.iter().copied().fold(0.0, f32::max);
        file.luminance.values[3..5].fill(value * largest);
        file.write(&path, Overwrite::Replace).unwrap();
        BsdfFile::open(&path)
    };
    let file = write(-1e-7).unwrap();
    assert_eq!(file.luminance.values[3..5], [0.0; 2]);
    assert!(
        file.notes[0].starts_with("2 values of \"luminance\""),
        "{:?}",
        file.notes
    );
    let material = Material::resolve(path.to_str().unwrap()).unwrap();
    assert_eq!(
        material.load(LookupRule::Floor).unwrap().notes(),
        file.notes
    );
    let error = write(-1e-5).unwrap_err().to_string();
    assert!(
        error.contains("luminance") && error.contains("values ≥ 0"),
        "{error}"
    );
    assert!(write(0.1).unwrap().notes.is_empty());
}

#[test]
fn spectra_outside_the_visible_have_no_colour() {
    let mut file = general(2, false);
    let Colour::Spectral { wavelengths, .. } = &mut file.colour else {
        panic!("general files have spectra");
    };
    let count = wavelengths.len();
    *wavelengths = (0..count).map(|k| 900.0 + 10.0 * k as f32).collect();
    let error = read(&bytes_of(&file)).unwrap_err().to_string();
    assert!(
        error.contains("380 to 780 nm") && error.contains("900 to"),
        "{error}"
    );
}
