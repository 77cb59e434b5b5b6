//! A material's header and the run-time header as C and C++.

use crate::support::half_vector_preset;
use std::f64::consts::TAU;

use glam::{Vec2, Vec3};
use merlkit::color::Rgb;
use merlkit::export::Export;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::material::merl::write;
use merlkit::sampler::HalfVectorSettings;

use crate::has;
use crate::program::{
    Answer, Beyond, COMPILERS, Kind, Program, Question, compare, expected, questions,
};
use crate::support::noise_table;

const DRAWS: usize = 100_000;

fn export(material: &str, lookup: LookupRule, settings: HalfVectorSettings) -> Export {
    let material = Material::resolve(material).unwrap();
    Export::new(&material, &material.load(lookup).unwrap(), settings).unwrap()
}

/// Answers beyond 10⁻⁵ that are allowed of [`DRAWS`]: where rounding puts a direction on the other side of an edge of a row or
/// bin. With gcc on x86-64 they are 3 at most.
const ALLOWED: Beyond = Beyond {
    draws: 10,
    densities: 10,
    values: 10,
};

/// Compares programs of each compiler and header with the library.
fn agree(export: &Export, compilers: &[(&str, &[&str])]) {
    let questions = questions(export, DRAWS, 7);
    let expected = expected(export, &questions);
    for &compiler in compilers.iter().filter(|c| has(c.0, &["--version"])) {
        for kind in Kind::ALL {
            let folder = tempfile::tempdir().unwrap();
            let program = Program::new(kind, export, folder.path(), compiler, |text| text);
            let beyond = compare(&program.ask(&questions), &expected, 1e-5);
            assert!(
                beyond.within(ALLOWED),
                "{kind:?}, {}: {beyond:?}",
                compiler.0
            );
        }
    }
}

#[test]
fn nickel_agrees_by_every_rule_and_in_both_languages() {
    use LookupRule::{Centred, Floor, Linear};
    for (rule, size) in [(Floor, "2KB"), (Linear, "64KB"), (Centred, "16KB")] {
        agree(
            &export("nickel", rule, half_vector_preset(size)),
            &COMPILERS,
        );
    }
}

#[test]
fn teflon_agrees_by_every_rule_and_in_both_languages() {
    use LookupRule::{Centred, Floor, Linear};
    for (rule, size) in [(Floor, "1MB"), (Linear, "8KB"), (Centred, "4KB")] {
        agree(
            &export("teflon", rule, half_vector_preset(size)),
            &COMPILERS,
        );
    }
}

/// Unrelated values with holes, in a table of each kind. Interpolated, they tell 10⁻⁵ of a bin.
#[test]
fn noise_with_holes_agrees_by_every_rule() {
    let (folder, compiler) = (tempfile::tempdir().unwrap(), COMPILERS[0]);
    if !has(compiler.0, &["--version"]) {
        return;
    }
    for bins in [180, 360] {
        let path = folder.path().join(format!("noise {bins}.binary"));
        write(&noise_table(bins, 5, 3), &path, Overwrite::Refuse).unwrap();
        for (rule, most) in LookupRule::ALL.into_iter().zip([1e-5, 1e-3, 1e-3]) {
            let export = export(path.to_str().unwrap(), rule, half_vector_preset("2KB"));
            let questions = questions(&export, DRAWS, 8);
            let expected = expected(&export, &questions);
            for kind in Kind::ALL {
                let program = Program::new(kind, &export, folder.path(), compiler, |text| text);
                let beyond = compare(&program.ask(&questions), &expected, most);
                assert!(
                    beyond.within(ALLOWED),
                    "{kind:?}, {bins} {rule:?}: {beyond:?}"
                );
            }
        }
    }
}

/// Directions at which something ends or is undefined.
fn difficult_directions() -> Vec<Vec3> {
    let slanted = spherical(1.0, 2.0).as_vec3();
    vec![
        Vec3::Z,
        slanted,
        spherical(1.0, -TAU / 4.0).as_vec3(),
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(-0.6, 0.0, 0.8),
        Vec3::new(1e-20, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 1e-9),
        Vec3::new(-1.0, 0.0, f32::MIN_POSITIVE),
        Vec3::new(0.0, -1.0, 1e-4),
        slanted * 1e-30,
        slanted * 3.0,
        slanted * 1e30,
        Vec3::splat(f32::MAX),
        // None of these is a direction above the horizon.
        Vec3::ZERO,
        -slanted,
        Vec3::X,
        Vec3::new(0.0, 1.0, -0.0),
        Vec3::new(1.0, 0.0, -1e-9),
        Vec3::new(f32::MAX, 0.0, 1e-9),
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::new(0.0, f32::NAN, 1.0),
        Vec3::new(0.0, 0.0, f32::NAN),
        Vec3::new(f32::INFINITY, 0.0, 1.0),
        Vec3::new(0.0, f32::NEG_INFINITY, 1.0),
        Vec3::new(0.0, 0.0, f32::INFINITY),
    ]
}

fn difficult_questions() -> Vec<Question> {
    let (directions, last) = (difficult_directions(), 1f32.next_down());
    let points = [
        (0.0, 0.0),
        (last, last),
        (0.0, last),
        (last, 0.0),
        (0.5, 0.5),
        (1e-30, 0.25),
        (0.999, 1e-9),
    ];
    let pairs = directions
        .iter()
        .flat_map(|&wo| directions.iter().map(move |&w| (wo, w)));
    pairs
        .flat_map(|(wo, w)| {
            points.map(|(x, y)| Question {
                wo,
                u: Vec2::new(x, y),
                w,
            })
        })
        .collect()
}

#[test]
fn degenerate_inputs_are_as_in_the_library() {
    for (rule, size) in [(LookupRule::Floor, "64KB"), (LookupRule::Linear, "2KB")] {
        let export = export("nickel", rule, half_vector_preset(size));
        let questions = difficult_questions();
        let expected = expected(&export, &questions);
        for compiler in COMPILERS.into_iter().filter(|c| has(c.0, &["--version"])) {
            for kind in Kind::ALL {
                let folder = tempfile::tempdir().unwrap();
                let program = Program::new(kind, &export, folder.path(), compiler, |text| text);
                let here = format!("{kind:?}, {}", compiler.0);
                assert_degenerate(&questions, &program.ask(&questions), &expected, &here);
            }
        }
    }
}

/// What is found is finite, and zero where it is expected to be.
fn assert_degenerate(questions: &[Question], found: &[Answer], expected: &[Answer], program: &str) {
    for ((question, found), expected) in questions.iter().zip(found).zip(expected) {
        let here = format!("{program}: {question:?}\n{found:?}\n{expected:?}");
        assert!(
            found.wi.is_finite()
                && found.drawn.is_finite()
                && found.pdf.is_finite()
                && found.f.is_finite(),
            "{here}"
        );
        let zeros = |a: &Answer| [a.drawn == 0.0, a.pdf == 0.0, a.f == Rgb::ZERO];
        assert_eq!(zeros(found), zeros(expected), "{here}");
        assert!(found.wi.abs_diff_eq(expected.wi, 1e-5), "{here}");
    }
    // On an edge of a bin, and at the seam opposite wo, either side is right; at the horizon, f32 tells little of a
    // density.
    let beyond = compare(found, expected, 1e-5);
    let few = questions.len() / 50;
    let most = Beyond {
        draws: few,
        densities: few,
        values: few,
    };
    assert!(beyond.within(most), "{program}: {beyond:?}");
}

/// Points outside the unit square are held at its edge, and no number counts as 0.
#[test]
fn points_outside_the_square_are_drawn_from() {
    let (compiler, export) = (
        COMPILERS[0],
        export("nickel", LookupRule::Floor, half_vector_preset("2KB")),
    );
    if !has(compiler.0, &["--version"]) {
        return;
    }
    let question = |x: f32| Question {
        wo: Vec3::new(0.6, 0.0, 0.8),
        u: Vec2::splat(x),
        w: Vec3::Z,
    };
    let outside = [f32::NAN, -1.0, f32::NEG_INFINITY, 1.0, 2.0, f32::INFINITY].map(question);
    let edges = expected(&export, &[0.0, 1f32.next_down()].map(question));
    let expected = [0, 0, 0, 1, 1, 1].map(|k| edges[k]);
    for kind in Kind::ALL {
        let folder = tempfile::tempdir().unwrap();
        let program = Program::new(kind, &export, folder.path(), compiler, |text| text);
        assert_eq!(
            compare(&program.ask(&outside), &expected, 1e-5),
            Beyond::default()
        );
    }
}

/// Headers that are wrong in the code or in one number of a table are told from right ones.
#[test]
fn the_comparison_rejects_wrong_headers() {
    let (compiler, export) = (
        COMPILERS[0],
        export("nickel", LookupRule::Floor, half_vector_preset("2KB")),
    );
    if !has(compiler.0, &["--version"]) {
        return;
    }
    let questions = questions(&export, 20_000, 9);
    let expected = expected(&export, &questions);
    let folder = tempfile::tempdir().unwrap();
    let beyond = |edit: &dyn Fn(String) -> String| {
        compare(
            &Program::new(Kind::Material, &export, folder.path(), compiler, edit).ask(&questions),
            &expected,
            1e-5,
        )
    };
    let replaced = |from: &'static str, to: &'static str| {
        move |text: String| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        }
    };
    let jacobian = beyond(&replaced("16.0f * len", "16.001f * len"));
    assert!(
        jacobian.draws == 20_000 && jacobian.densities > 19_000 && jacobian.values < 20,
        "{jacobian:?}"
    );
    let direction = beyond(&replaced(
        "about.s * x + about.c * y",
        "about.s * x + about.c * y + 2e-5f",
    ));
    assert!(
        direction.draws > 19_000 && direction.densities < 20,
        "{direction:?}"
    );
    let value = beyond(&replaced(
        "90 * merlkit_bin(at.theta_h, 90)",
        "90 * merlkit_bin(at.theta_h + 0.01f, 90)",
    ));
    assert!(value.draws < 20 && value.values > 100, "{value:?}");
    for (array, line) in [
        ("cosines", 0),
        ("edges_fixed", 1),
        ("words", 8),
        ("words", 14),
        ("words", 32),
    ] {
        let wrong = beyond(&|text: String| spoil(&text, array, line));
        assert!(
            wrong.draws > 20 && wrong.densities > 20,
            "{array}, line {line}: {wrong:?}"
        );
    }
}

/// The header with the last number in a line of an array made a little smaller. Of the words, lines 1 to 9 hold probabilities,
/// those to 14 slopes, and those from 16 on densities.
fn spoil(text: &str, array: &str, line: usize) -> String {
    let start = text.find(&format!(" nickel_{array}[")).unwrap();
    let line = text[start..].lines().nth(line + 1).unwrap();
    let number = line.trim_end_matches(',').rsplit(' ').next().unwrap();
    let less = match number.strip_prefix("0x") {
        Some(word) => {
            format!(
                "{:#010x}u",
                u32::from_str_radix(word.trim_end_matches('u'), 16).unwrap() - 0x0404_0404
            )
        }
        None => format!(
            "{:?}f",
            number.trim_end_matches('f').parse::<f32>().unwrap() * 0.999
        ),
    };
    text[..start].to_owned() + &text[start..].replacen(number, &less, 1)
}

#[test]
fn headers_are_the_same_every_time_and_plain() {
    let make = || {
        export(
            "blue-metallic-paint",
            LookupRule::Centred,
            half_vector_preset("2KB"),
        )
        .header()
    };
    let text = make();
    assert_eq!(text, make());
    assert!(text.is_ascii() && !text.contains(['\\', '@', '\t']) && !text.contains("NAME"));
    assert!(text.lines().all(|l| l.trim_end() == l));
    assert!(text.starts_with(
        "// blue-metallic-paint.h: a measured material for C99, C++11, GLSL 4.30 and GLSL ES 3.00"
    ));
    for expected in [
        "SHA-256 ",
        "by the centred lookup",
        "by 7 tables of\n// 22 rows and 3 segments, folded.",
        "4374000 little-endian f32",
        "MIT licence, Copyright (c) 2022 asztr",
        "#ifndef blue_metallic_paint_H\n",
        "\n#endif // blue_metallic_paint_H\n",
        "merlkit_draw blue_metallic_paint_sample(merlkit_vec3 wo, float u1, float u2)",
        "float blue_metallic_paint_pdf(merlkit_vec3 wo, merlkit_vec3 wi)",
        "merlkit_vec3 blue_metallic_paint_eval(MERLKIT_VALUES merlkit_vec3 wo, merlkit_vec3 wi)",
    ] {
        assert!(text.contains(expected), "{expected}");
    }
}
