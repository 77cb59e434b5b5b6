//! A program made of a material's header or of the run-time header, and how far its answers are from the library's.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use glam::{Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::export::{Export, identifier};
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::points::Stream;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The folder of C sources.
pub const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/export");

/// Which header a program is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The material's own, with its table.
    Material,
    /// `merlkit.h`, which loads a file.
    Runtime,
}

impl Kind {
    pub const ALL: [Self; 2] = [Self::Material, Self::Runtime];
}

/// How a compiler is asked for a program, of the header alone and without a warning.
pub const COMPILERS: [(&str, &[&str]); 2] = [
    ("gcc", &["-std=c99", "-xc"]),
    ("g++", &["-std=c++11", "-xc++"]),
];
const STRICT: [&str; 9] = [
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wdouble-promotion",
    "-Werror",
    "-O2",
];

/// A point to draw from, and a direction to ask about.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    pub wo: Vec3,
    pub u: Vec2,
    pub w: Vec3,
}

/// What a program or the library says to a question: a draw and its density, the density of `w` and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    pub wi: Vec3,
    pub drawn: f32,
    pub pdf: f32,
    pub f: Rgb,
}

/// Counts of answers that are not the library's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beyond {
    pub draws: usize,
    pub densities: usize,
    pub values: usize,
}

impl Beyond {
    pub fn within(&self, most: Self) -> bool {
        self.draws <= most.draws && self.densities <= most.densities && self.values <= most.values
    }
}

/// Compiled from a header, with its data in the file of that name.
pub struct Program {
    path: PathBuf,
    data: PathBuf,
}

impl Program {
    /// Writes the header, as `edit` leaves it, and the data into `folder`, and compiles them.
    pub fn new(
        kind: Kind,
        export: &Export,
        folder: &Path,
        compiler: (&str, &[&str]),
        edit: impl Fn(String) -> String,
    ) -> Self {
        let data = folder.join("material.data");
        let (text, driver) = match kind {
            Kind::Material => {
                export.write_values(&data, Overwrite::Replace).unwrap();
                (export.header(), "driver.c")
            }
            Kind::Runtime => {
                export.write_runtime(&data, Overwrite::Replace).unwrap();
                (runtime_header(), "runtime_driver.c")
            }
        };
        std::fs::write(folder.join("material.h"), edit(text)).unwrap();
        let defined = [
            "-DHEADER=\"material.h\"".to_owned(),
            format!("-DMATERIAL={}", name_in(&export.header())),
        ];
        let path = compile(folder, compiler, &Path::new(HERE).join(driver), &defined);
        Self { path, data }
    }

    /// A shader's text as C++, `merlkit.glsl` or `merlkit.hlsl`.
    pub fn shader(name: &str, export: &Export, folder: &Path, text: &str) -> Self {
        let data = folder.join("material.data");
        export.write_runtime(&data, Overwrite::Replace).unwrap();
        std::fs::write(folder.join(name), text).unwrap();
        let defined = [format!("-DSHADER=\"{name}\"")];
        let source = Path::new(HERE).join("shader.cpp");
        let path = compile(folder, COMPILERS[1], &source, &defined);
        Self { path, data }
    }

    pub fn ask(&self, questions: &[Question]) -> Vec<Answer> {
        let input = question_bytes(questions);
        let mut child = Command::new(&self.path)
            .arg(&self.data)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let output = std::thread::scope(|scope| {
            scope.spawn(move || stdin.write_all(&input).unwrap());
            child.wait_with_output().unwrap()
        });
        assert!(output.status.success());
        read_answers(&output.stdout)
    }
}

/// Eight floats a question.
pub fn question_bytes(questions: &[Question]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(32 * questions.len());
    for q in questions {
        for x in [q.wo.x, q.wo.y, q.wo.z, q.u.x, q.u.y, q.w.x, q.w.y, q.w.z] {
            bytes.extend(x.to_ne_bytes());
        }
    }
    bytes
}

/// Eight floats an answer.
pub fn read_answers(bytes: &[u8]) -> Vec<Answer> {
    let fours = bytes.as_chunks::<4>().0.iter();
    let floats: Vec<f32> = fours.map(|b| f32::from_ne_bytes(*b)).collect();
    let answers = floats.as_chunks::<8>().0.iter().map(|a| Answer {
        wi: Vec3::new(a[0], a[1], a[2]),
        drawn: a[3],
        pdf: a[4],
        f: Rgb::new(a[5], a[6], a[7]),
    });
    answers.collect()
}

/// The text of `merlkit.h`.
pub fn runtime_header() -> String {
    runtime_code("merlkit.h")
}

/// The text of a file with code for run-time tables.
pub fn runtime_code(name: &str) -> String {
    let mut code = Export::runtime_code().into_iter();
    code.find(|c| c.0 == name).unwrap().1
}

/// Compiles a source strictly, with `folder` for headers and for the program.
pub fn compile(
    folder: &Path,
    compiler: (&str, &[&str]),
    source: &Path,
    more: &[String],
) -> PathBuf {
    let path = folder.join("program");
    let compiled = Command::new(compiler.0)
        .args(compiler.1)
        .args(STRICT)
        .args(more)
        .arg("-I")
        .args([folder, source, Path::new("-o"), &path, Path::new("-lm")])
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    path
}

/// What the functions of a header begin with.
fn name_in(header: &str) -> String {
    let file = header
        .strip_prefix("// ")
        .and_then(|h| h.split_once(".h:"))
        .unwrap()
        .0;
    identifier(file)
}

/// What the library says.
pub fn expected(export: &Export, questions: &[Question]) -> Vec<Answer> {
    let answer = |q: &Question| {
        let draw = export.table().sample(q.wo, q.u);
        Answer {
            wi: draw.map_or(Vec3::ZERO, |d| d.wi),
            drawn: draw.map_or(0.0, |d| d.pdf),
            pdf: export.table().pdf(q.wo, q.w),
            f: export.brdf().eval(q.wo, q.w),
        }
    };
    questions.iter().map(answer).collect()
}

/// Draws about directions over the whole hemisphere, a third of them near the horizon; asked about is what the library draws
/// from another point, and every fourth time a direction from anywhere.
pub fn questions(export: &Export, count: usize, seed: u64) -> Vec<Question> {
    let mut random = Stream::new(seed);
    let mut x = || random.next_f64();
    let anywhere = |near: bool, a: f64, b: f64| {
        let theta = if near {
            FRAC_PI_2 - 0.1 * a.powi(3)
        } else {
            FRAC_PI_2 * a
        };
        let w = spherical(theta, TAU * b).as_vec3();
        Vec3::new(w.x, w.y, w.z.max(1e-9))
    };
    let mut question = |i: usize| {
        let wo = anywhere(i.is_multiple_of(3), x(), x());
        let [u, v] =
            [(); 2].map(|()| Vec2::new(x() as f32, x() as f32).min(Vec2::splat(1f32.next_down())));
        let free = anywhere(i.is_multiple_of(8), x(), x());
        let w = if i.is_multiple_of(4) {
            free
        } else {
            export.table().sample(wo, v).unwrap().wi
        };
        Question { wo, u, w }
    };
    (0..count).map(&mut question).collect()
}

/// Counts the answers that differ by more than 10⁻⁵, absolutely in the components of `wi` and relatively elsewhere; values
/// by more than `most`.
pub fn compare(found: &[Answer], expected: &[Answer], most: f32) -> Beyond {
    assert_eq!(found.len(), expected.len());
    let near = |a: f32, b: f32, most: f32| a == b || (a - b).abs() <= most * b.abs();
    let count = |good: &dyn Fn(&Answer, &Answer) -> bool| {
        found
            .iter()
            .zip(expected)
            .filter(|(a, b)| !good(a, b))
            .count()
    };
    Beyond {
        draws: count(&|a, b| a.wi.abs_diff_eq(b.wi, 1e-5) && near(a.drawn, b.drawn, 1e-5)),
        densities: count(&|a, b| near(a.pdf, b.pdf, 1e-5)),
        values: count(&|a, b| (0..3).all(|c| near(a.f[c], b.f[c], most))),
    }
}
