//! Mitsuba 3 reads exported files as this library does.
//!
//! Runs with a `python3` that has mitsuba, or with one in a new virtual environment if `MERLKIT_MITSUBA=1` allows to fetch it;
//! skipped, saying so, otherwise.

use crate::measured_data::measured_files;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

use glam::{DVec3, Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::files::Overwrite;
use merlkit::geometry::{cosine_hemisphere, reflect_about, spherical};
use merlkit::light::{Directional, EnvironmentSource, LightSpec};
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::material::rgl::{BsdfFile, BsdfSize, Colour, RglBrdf, Tensor, tabulate};
use merlkit::points::{PointSet, Stream};
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit_evaluate::measure::chi_square::{ChiSquareTest, ChiSquareVerdict};
use merlkit_evaluate::measure::{directional_albedo, value_errors};

const ASK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mitsuba/ask.py");

/// A Python with Mitsuba, if there is one.
pub static PYTHON: LazyLock<Option<PathBuf>> = LazyLock::new(|| {
    let works = |python: &Path| {
        let asked = Command::new(python)
            .args(["-c", "import mitsuba, numpy"])
            .output();
        asked.is_ok_and(|o| o.status.success())
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mitsuba");
    let own = folder.join("bin/python");
    let found = [PathBuf::from("python3"), own.clone()]
        .into_iter()
        .find(|p| works(p));
    if found.is_some() || std::env::var_os("MERLKIT_MITSUBA").is_none_or(|v| v != "1") {
        return found;
    }
    let run = |program: &Path, arguments: &[&str]| {
        Command::new(program)
            .args(arguments)
            .output()
            .is_ok_and(|o| o.status.success())
    };
    let made = run(
        Path::new("python3"),
        &["-m", "venv", &folder.to_string_lossy()],
    ) && run(
        &own,
        &["-m", "pip", "install", "--quiet", "mitsuba", "numpy"],
    );
    (made && works(&own)).then_some(own)
});

/// Whether there is something to test with; says so if not.
fn has_mitsuba() -> bool {
    if PYTHON.is_none() {
        let note = b"skipped: no python3 with mitsuba (MERLKIT_MITSUBA=1 fetches it)\n";
        // Not by a macro, whose output the test harness would keep to itself.
        std::io::stderr().write_all(note).unwrap();
    }
    PYTHON.is_some()
}

/// An exported material in both variants.
struct Exported {
    folder: tempfile::TempDir,
    brdf: Arc<MerlBrdf>,
}

impl Exported {
    fn new(name: &str) -> Self {
        let brdf = Arc::new(MerlBrdf::new(
            Arc::new(decode_embedded(name).unwrap()),
            LookupRule::Linear,
        ));
        let size = BsdfSize::ALL.into_iter().find(|s| s.name == "3MB").unwrap();
        let file = tabulate(|wo, wi| brdf.eval(wo, wi), size, name.into());
        let folder = tempfile::tempdir().unwrap();
        file.write(&folder.path().join("rgb"), Overwrite::Refuse)
            .unwrap();
        file.to_spectral()
            .write(&folder.path().join("spectral"), Overwrite::Refuse)
            .unwrap();
        Self { folder, brdf }
    }

    fn rgl(&self, variant: &str) -> RglBrdf {
        RglBrdf::new(BsdfFile::open(&self.folder.path().join(variant)).unwrap())
    }

    fn ask(&self, kind: &str, variant: &str, numbers: &[f32]) -> Vec<f32> {
        ask_mitsuba(self.folder.path(), kind, variant, numbers)
    }
}

/// What Mitsuba answers about the file of that variant in a folder.
fn ask_mitsuba(folder: &Path, kind: &str, variant: &str, numbers: &[f32]) -> Vec<f32> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(folder.join("in"), bytes).unwrap();
    let mode = format!("scalar_{variant}");
    let output = Command::new(PYTHON.as_ref().unwrap())
        .args(["-B", ASK, kind, &mode, variant, "in", "out"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let answer = std::fs::read(folder.join("out")).unwrap();
    answer
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect()
}

const VARIANTS: [&str; 2] = ["rgb", "spectral"];

#[test]
fn values_and_densities_are_ours() {
    if !has_mitsuba() {
        return;
    }
    const PAIRS: u64 = 100_000;
    let direction =
        |i, set| cosine_hemisphere(PointSet::Random.point(5, i, set).as_dvec2()).as_vec3();
    let pairs: Vec<[Vec3; 2]> = (0..PAIRS)
        .map(|i| [direction(i, 0), direction(i, 1)])
        .collect();
    let numbers: Vec<f32> = pairs.iter().flatten().flat_map(|w| w.to_array()).collect();
    for material in ["nickel", "blue-metallic-paint"] {
        let exported = Exported::new(material);
        for variant in VARIANTS {
            let answer = exported.ask("values", variant, &numbers);
            let rgl = exported.rgl(variant);
            let width = answer.len() / pairs.len();
            let mut beyond = 0;
            for (&[wo, wi], found) in pairs.iter().zip(answer.chunks(width)) {
                let (colour, pdf) = (in_rgb(&found[..width - 1]), found[width - 1]);
                let (expected, density) = (rgl.eval_cos(wo, wi), rgl.pdf(wo, wi));
                let off =
                    (colour - expected).abs().max_element() / expected.max_element().max(1e-9);
                beyond += usize::from(off > 1e-3 || (pdf - density).abs() > 1e-3 * density);
            }
            // Mitsuba's angles are f32: a steep cell magnifies their rounding.
            assert!(
                beyond <= pairs.len() / 1000,
                "{material}, {variant}: {beyond} pairs differ"
            );
        }
    }
}

/// Pairs of `wo`, drawn by the cosine, with `wi` by the cosine and in the highlight by turns.
fn cosine_and_highlight_pairs(count: u64) -> Vec<[Vec3; 2]> {
    let mut pairs = Vec::new();
    for i in 0..count {
        let [a, b] = [0, 1].map(|set| PointSet::Random.point(5, i, set).as_dvec2());
        let wo = cosine_hemisphere(a);
        // A half vector within 17° of the normal, most of them nearer.
        let m = spherical(0.3 * b.x * b.x, std::f64::consts::TAU * b.y);
        let mirrored = reflect_about(wo, m);
        let wi = if i % 2 == 1 && mirrored.z > 0.0 {
            mirrored
        } else {
            cosine_hemisphere(b)
        };
        pairs.push([wo.as_vec3(), wi.as_vec3()]);
    }
    pairs
}

#[test]
fn measured_files_are_read_as_mitsuba_reads_them() {
    if !has_mitsuba() {
        return;
    }
    let pairs = cosine_and_highlight_pairs(10_000);
    let numbers: Vec<f32> = pairs.iter().flatten().flat_map(|w| w.to_array()).collect();
    for path in measured_files() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::copy(&path, folder.path().join("rgb")).unwrap();
        let answer = ask_mitsuba(folder.path(), "values", "rgb", &numbers);
        let rgl = RglBrdf::new(BsdfFile::open(&path).unwrap());
        let (mut beyond, mut worst) = (0, 0f32);
        for (&[wo, wi], found) in pairs.iter().zip(answer.chunks(4)) {
            // Mitsuba leaves channels below 0 as they are; here they are 0.
            let colour = Vec3::from_slice(found).max(Vec3::ZERO);
            let expected = rgl.eval_cos(wo, wi);
            let off = (colour - expected).abs().max_element() / expected.max_element().max(1e-4);
            beyond += usize::from(off > 1e-5);
            worst = worst.max(off);
        }
        // Mitsuba's angles are f32: a steep cell magnifies their rounding. Half of the pairs agree to 10⁻⁶.
        assert!(
            beyond <= pairs.len() / 50 && worst < 1e-3,
            "{}: {beyond} pairs differ, by up to {worst}",
            path.display()
        );
    }
}

/// RGB of Mitsuba's channels: three of them, or seven wavelengths of a spectrum.
fn in_rgb(channels: &[f32]) -> Rgb {
    let colour = match channels.len() {
        3 => channels.to_vec(),
        n => {
            let wavelengths = vec![450.0, 480.0, 500.0, 550.0, 580.0, 600.0, 620.0];
            let spectra = Tensor {
                shape: vec![1, 1, n, 1, 1],
                values: channels.to_vec(),
            };
            Colour::Spectral {
                wavelengths,
                spectra,
            }
            .to_rgb()
            .values
        }
    };
    Rgb::from_slice(&colour)
}

/// Gives Mitsuba's draws one after the other, whatever point is asked for, with a density of ours.
struct Replay<'a> {
    draws: Vec<Option<Vec3>>,
    next: AtomicUsize,
    density: &'a RglBrdf,
}

impl DirectionSampler for Replay<'_> {
    fn sample(&self, wo: Vec3, _: Vec2) -> Option<DirectionSample> {
        let wi = self.draws[self.next.fetch_add(1, Ordering::Relaxed)]?;
        Some(DirectionSample {
            wi,
            pdf: self.density.pdf(wo, wi),
        })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.density.pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        0
    }
}

#[test]
fn draws_follow_our_density_and_weigh_what_the_table_reflects() {
    if !has_mitsuba() {
        return;
    }
    let angles = [0.5, 31.0, 60.3, 80.0];
    let test = ChiSquareTest {
        tests: angles.len() * VARIANTS.len(),
        ..ChiSquareTest::default()
    };
    let exported = Exported::new("nickel");
    let error = value_errors(&exported.rgl("rgb"), exported.brdf.as_ref()).albedo;
    for (variant, degrees) in VARIANTS.iter().flat_map(|v| angles.map(|a| (v, a))) {
        let theta = f64::to_radians(degrees);
        let wo = spherical(theta, 0.7).as_vec3();
        let mut random = Stream::new(9);
        let mut query = || [wo.x, wo.y, wo.z, random.next_f32(), random.next_f32()];
        let numbers: Vec<f32> = (0..test.draws).flat_map(|_| query()).collect();
        let answer = exported.ask("draws", variant, &numbers);
        let rgl = exported.rgl(variant);
        let draws = answer.chunks(5).map(|d| Vec3::new(d[0], d[1], d[2]));
        let draws = draws.map(|wi| (wi.z > 0.0).then_some(wi)).collect();
        let replay = Replay {
            draws,
            next: AtomicUsize::new(0),
            density: &rgl,
        };
        let found = test.run(&replay, wo);
        assert_eq!(
            found.verdict,
            ChiSquareVerdict::Pass,
            "{variant}, {degrees}°: {found:?}"
        );
        let weights: Vec<f64> = answer.chunks(5).map(|d| f64::from(d[4])).collect();
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        let variance =
            weights.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / weights.len() as f64;
        if *variant == "rgb" {
            let albedo = f64::from(directional_albedo(exported.brdf.as_ref(), theta).x);
            let slack = 5e-4 * albedo
                + 4.0 * (variance / weights.len() as f64).sqrt()
                + 1.2 * error * albedo;
            assert!(
                (mean - albedo).abs() < slack,
                "{degrees}°: {mean} for {albedo} ± {slack}"
            );
        }
    }
}

#[test]
fn a_sphere_looks_the_same() {
    if !has_mitsuba() {
        return;
    }
    const SIDE: usize = 48;
    const BLOCK: usize = 8;
    const SAMPLES: u64 = 128;
    let exported = Exported::new("blue-metallic-paint");
    let towards = DVec3::new(0.6, 0.7, 1.0);
    let lights = vec![
        LightSpec::Environment(EnvironmentSource::Uniform(Rgb::ONE)),
        LightSpec::Directional(Directional {
            towards,
            irradiance: Rgb::ONE,
        }),
    ];
    let spec = SceneSpec {
        lights,
        depth: 1,
        ..SceneSpec::row(&["paint".to_owned()], 1.0)
    };
    let surface = |_, _| {
        let sampler: Arc<dyn DirectionSampler> = Arc::new(exported.rgl("rgb"));
        Ok(Surface {
            brdf: exported.brdf.clone(),
            sampler: Some(sampler),
        })
    };
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        seed: 7,
        points: PointSet::Random,
        budget: Budget::Even(SAMPLES),
    };
    let built = Scene::build(&spec, PlanRequest::AsNeeded, surface).unwrap();
    let ours = render(&built, &settings, &|_| {}).unwrap().film;
    let (camera, ball) = (spec.camera, spec.spheres[0].shape);
    let scene = [
        &[SIDE as f64, SAMPLES as f64][..],
        &camera.eye.to_array(),
        &camera.target.to_array(),
        &[camera.vertical_angle.to_degrees()],
        &ball.centre.to_array(),
        &[ball.radius],
        &towards.to_array(),
    ];
    let scene: Vec<f32> = scene.concat().iter().map(|&v| v as f32).collect();
    for (variant, model) in [("rgb", 0.004), ("spectral", 0.008)] {
        let theirs = exported.ask("sphere", variant, &scene);
        let blocks = SIDE / BLOCK;
        let mut sums = [DVec3::ZERO; 2];
        for block in 0..blocks * blocks {
            let (mut mean, mut noise2) = ([DVec3::ZERO; 2], DVec3::ZERO);
            for k in 0..BLOCK * BLOCK {
                let (x, y) = (
                    block % blocks * BLOCK + k % BLOCK,
                    block / blocks * BLOCK + k / BLOCK,
                );
                let at = 3 * (x + SIDE * y);
                mean[0] += ours.mean(x, y);
                mean[1] += Vec3::from_slice(&theirs[at..]).as_dvec3();
                noise2 += 2.0 * ours.standard_error(x, y).powf(2.0);
            }
            // Spectra are noise of their own.
            let slack = 6.0 * DVec3::new(noise2.x.sqrt(), noise2.y.sqrt(), noise2.z.sqrt())
                + 0.02 * mean[0];
            let off = (mean[0] - mean[1]).abs();
            assert!(
                off.cmple(slack).all(),
                "{variant}, block {block}: {mean:?}, {slack}"
            );
            (0..2).for_each(|k| sums[k] += mean[k]);
        }
        let off = (sums[1] / sums[0] - 1.0).abs();
        assert!(
            off.max_element() < model,
            "{variant}: {off} between whole pictures"
        );
    }
}
