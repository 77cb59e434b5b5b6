//! Spheres under the studio, here and in Mitsuba 3: seconds to equal error. A sphere of nickel, one of a rough metal, one of a
//! diffuse material, and three spheres on a ground.
//!
//! Mitsuba renders them with `measured` and the file that `merlkit export` writes, and with a BSDF in Python that looks the table
//! up and draws by the cosine. Wants a `python3` that has mitsuba and numpy; says so and does nothing without. Vectorised
//! variants need LLVM (`DRJIT_LIBLLVM_PATH`; 14 and 15 abort, 19 works) and are left out where it is missing.
//! `cargo bench --bench beside_mitsuba -- [SCENE…]`, where a scene is a part of a name: `nickel`, `rough`, `diffuse`, `three`.

mod subject;

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use merlkit::color::{Rgb, luminance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, Surface, render};
use merlkit::sampler::{HalfVectorSettings, HalfVectorTable};
use serde_json::{Value, json};

use subject::{Files, SIDE, SKY, SUBJECTS, Subject};

const SAMPLES: [u64; 3] = [4, 16, 64];
/// On average, where they are shared out by noise, which takes 16.
const SHARED_SAMPLES: [u64; 3] = [16, 32, 64];
/// Pictures of each, of which the error is the spread.
const SEEDS: u64 = 4;
/// relMSE that is to be reached.
const TARGETS: [f64; 2] = [1e-3, 1e-4];

/// One of the renderers, set up in one way.
struct Contender {
    name: &'static str,
    renderer: Renderer,
}

#[derive(Clone, Copy)]
enum Renderer {
    /// Ours, as many paths to every pixel.
    Even,
    /// Ours, more of them where the picture is noisy.
    Shared,
    /// Mitsuba by variant and material.
    Mitsuba(&'static str, &'static str),
}

impl Contender {
    fn is_ours(&self) -> bool {
        !matches!(self.renderer, Renderer::Mitsuba(..))
    }

    fn samples(&self) -> [u64; SAMPLES.len()] {
        if matches!(self.renderer, Renderer::Shared) {
            SHARED_SAMPLES
        } else {
            SAMPLES
        }
    }
}

const CONTENDERS: [Contender; 5] = [
    Contender {
        name: "merlkit, half-vector 64KB",
        renderer: Renderer::Even,
    },
    Contender {
        name: "merlkit, half-vector 64KB, adaptive",
        renderer: Renderer::Shared,
    },
    Contender {
        name: "Mitsuba scalar_rgb, measured",
        renderer: Renderer::Mitsuba("scalar_rgb", "measured"),
    },
    Contender {
        name: "Mitsuba llvm_ad_rgb, measured",
        renderer: Renderer::Mitsuba("llvm_ad_rgb", "measured"),
    },
    Contender {
        name: "Mitsuba llvm_ad_rgb, plugin in Python",
        renderer: Renderer::Mitsuba("llvm_ad_rgb", "plugin"),
    },
];

type Picture = Vec<Rgb>;

/// This library, with what it has loaded.
struct Ours {
    scene: Scene,
}

impl Ours {
    /// From the embedded networks to a scene, the samplers included.
    fn load(subject: &Subject, sky: &Path) -> Self {
        let spec = subject.spec(sky);
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, |material, _| {
            let brdf = Arc::new(subject.brdf(material));
            let sampler = HalfVectorTable::build(&*brdf, HalfVectorSettings::default())?;
            Ok(Surface {
                brdf,
                sampler: Some(Arc::new(sampler) as Arc<dyn DirectionSampler>),
            })
        });
        Self {
            scene: scene.expect("a scene"),
        }
    }

    /// The picture and seconds.
    fn render(&self, shared: bool, samples: u64, seed: u64) -> (Picture, f64) {
        let budget = if shared {
            Budget::Adaptive(samples)
        } else {
            Budget::Even(samples)
        };
        let settings = RenderSettings {
            width: SIDE,
            height: SIDE,
            seed,
            points: PointSet::Lattice,
            budget,
        };
        let start = Instant::now();
        let picture = render(&self.scene, &settings, &|_| {})
            .and_then(|rendered| rendered.film.to_image())
            .expect("a picture")
            .into_pixels();
        (picture, start.elapsed().as_secs_f64())
    }
}

/// Mitsuba in a process of its own.
struct Mitsuba {
    child: Child,
    requests: ChildStdin,
    replies: BufReader<ChildStdout>,
    out: PathBuf,
}

impl Mitsuba {
    fn start(files: &Files) -> Option<Self> {
        let has = Command::new("python3")
            .args(["-c", "import mitsuba, numpy"])
            .output();
        if !has.is_ok_and(|o| o.status.success()) {
            return None;
        }
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/mitsuba/render.py");
        let mut python = Command::new("python3");
        python
            .arg(script)
            .arg(&files.scene)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = python.spawn().ok()?;
        let (requests, replies) = (child.stdin.take()?, BufReader::new(child.stdout.take()?));
        Some(Self {
            child,
            requests,
            replies,
            out: files.folder.path().join("picture"),
        })
    }

    /// After it went away.
    fn restart(&mut self, files: &Files) {
        if let Some(again) = Self::start(files) {
            *self = again;
        }
    }

    /// The picture, seconds to load and seconds to render; `None` if it went away.
    fn render(
        &mut self,
        peer: (&str, &str),
        samples: u64,
        seed: u64,
    ) -> Option<(Picture, f64, f64)> {
        let (variant, material) = peer;
        let request = json!({"variant": variant, "material": material, "samples": samples, "seed": seed, "out": self.out});
        writeln!(self.requests, "{request}").ok()?;
        let mut line = String::new();
        self.replies.read_line(&mut line).ok()?;
        let reply: Value = serde_json::from_str(&line).ok()?;
        let bytes = std::fs::read(&self.out).ok()?;
        let numbers: Vec<f32> = bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        let picture = numbers.chunks_exact(3).map(Rgb::from_slice).collect();
        Some((picture, reply["load"].as_f64()?, reply["render"].as_f64()?))
    }
}

impl Drop for Mitsuba {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What was measured of a contender.
#[derive(Default)]
struct Record {
    /// Seconds from files or networks to a scene; of Mitsuba without starting Python.
    load: f64,
    /// Pictures and seconds by number of samples and seed.
    runs: [Vec<(Picture, f64)>; SAMPLES.len()],
}

impl Record {
    /// Mean of the pictures with most samples, by luminance.
    fn mean(&self) -> Vec<f64> {
        let runs = &self.runs[SAMPLES.len() - 1];
        let pixel = |i| {
            runs.iter()
                .map(|(p, _)| f64::from(luminance(p[i])))
                .sum::<f64>()
                / runs.len() as f64
        };
        (0..SIDE * SIDE).map(pixel).collect()
    }

    /// Seconds, the median, and relMSE of pictures of the `k`th number of samples: their variance over the squared mean, which knows of no
    /// reference; ε is a hundredth of the squared mean of all.
    fn point(&self, k: usize, mask: &[bool]) -> (f64, f64) {
        let (runs, mean) = (&self.runs[k], self.mean());
        let mut seconds: Vec<f64> = runs.iter().map(|r| r.1).collect();
        seconds.sort_by(f64::total_cmp);
        let seen: Vec<usize> = (0..mask.len()).filter(|&i| mask[i]).collect();
        let level = seen.iter().map(|&i| mean[i]).sum::<f64>() / seen.len() as f64;
        let error = |&i: &usize| {
            let values: Vec<f64> = runs
                .iter()
                .map(|(p, _)| f64::from(luminance(p[i])))
                .collect();
            let centre = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - centre).powi(2)).sum::<f64>()
                / (values.len() - 1) as f64;
            variance / (mean[i] * mean[i] + 0.01 * level * level)
        };
        (
            seconds[seconds.len() / 2],
            seen.iter().map(error).sum::<f64>() / seen.len() as f64,
        )
    }

    fn points(&self, mask: &[bool]) -> Vec<(f64, f64)> {
        (0..SAMPLES.len()).map(|k| self.point(k, mask)).collect()
    }
}

/// Seconds to a relMSE by the power law through the two points next to it, and whether it lies beyond all points: there
/// errors fall as those of independent samples.
fn seconds_to(target: f64, points: &[(f64, f64)]) -> (f64, bool) {
    let (seconds, error) = points[points.len() - 1];
    let Some(next) = points.iter().position(|p| p.1 <= target) else {
        return (seconds * error / target, true);
    };
    let ((s0, e0), (s1, e1)) = (points[next.max(1) - 1], points[next.max(1)]);
    (
        s0 * (target / e0).powf((s1 / s0).ln() / (e1 / e0).ln()),
        next == 0,
    )
}

/// Brightness of all objects against ours, and the median over its pixels of the relative difference.
fn beside(mean: &[f64], ours: &[f64], mask: &[bool]) -> (f64, f64) {
    let seen = || (0..mask.len()).filter(|&i| mask[i]);
    let sum = |picture: &[f64]| seen().map(|i| picture[i]).sum::<f64>();
    let mut differences: Vec<f64> = seen().map(|i| (mean[i] / ours[i] - 1.0).abs()).collect();
    differences.sort_by(f64::total_cmp);
    (
        sum(mean) / sum(ours) - 1.0,
        differences[differences.len() / 2],
    )
}

/// All contenders in turn, seed after seed, so that a machine that changes speed does so for all. Those that fail are left out.
fn measure(
    subject: &Subject,
    files: &Files,
    mitsuba: &mut Mitsuba,
) -> Vec<(&'static Contender, Record)> {
    let start = Instant::now();
    let library = Ours::load(subject, &files.sky);
    let loaded = start.elapsed().as_secs_f64();
    // Mitsuba tells with its first picture.
    let load = |c: &Contender| if c.is_ours() { loaded } else { 0.0 };
    let record = |c| {
        (
            c,
            Some(Record {
                load: load(c),
                ..Record::default()
            }),
        )
    };
    let mut records: Vec<_> = CONTENDERS.iter().map(record).collect();
    for seed in 0..SEEDS {
        for (contender, slot) in &mut records {
            let Some(mut record) = slot.take() else {
                continue;
            };
            let all = contender
                .samples()
                .iter()
                .enumerate()
                .try_for_each(|(k, &samples)| {
                    let (picture, load, seconds) = match contender.renderer {
                        Renderer::Mitsuba(variant, material) => {
                            mitsuba.render((variant, material), samples, seed)?
                        }
                        ours => {
                            let (picture, seconds) =
                                library.render(matches!(ours, Renderer::Shared), samples, seed);
                            (picture, 0.0, seconds)
                        }
                    };
                    record.load += load;
                    record.runs[k].push((picture, seconds));
                    Some(())
                });
            match all {
                Some(()) => *slot = Some(record),
                None => {
                    println!("{}: left out, Mitsuba could not", contender.name);
                    mitsuba.restart(files);
                }
            }
        }
    }
    records
        .into_iter()
        .filter_map(|(c, r)| Some((c, r?)))
        .collect()
}

fn report(subject: &Subject, records: &[(&'static Contender, Record)], mask: &[bool]) {
    println!(
        "\n{}: {SIDE} × {SIDE} pixels, studio of {} × {}, direct light by MIS, {SEEDS} seeds",
        subject.description(),
        SKY[0],
        SKY[1]
    );
    println!(
        "relMSE over pixels of the objects, from the spread of seeds; seconds of rendering alone, the median"
    );
    let ours: Vec<&Record> = records
        .iter()
        .filter(|(c, _)| c.is_ours())
        .map(|(_, r)| r)
        .collect();
    let [even, shared] = ours[..] else { return };
    let ours = [even, shared].map(|record| record.points(mask));
    for (contender, record) in records {
        let points = record.points(mask);
        let (brightness, median) = beside(&record.mean(), &even.mean(), mask);
        println!("\n{}: loaded in {:.2} s", contender.name, record.load);
        println!(
            "  brightness {:+.3} % of ours, pixels differ by {:.2} % in the median",
            100.0 * brightness,
            100.0 * median
        );
        for (samples, (seconds, error)) in contender.samples().iter().zip(&points) {
            println!("  {samples:3} samples a pixel: {seconds:7.3} s, relMSE {error:.2e}");
        }
        for target in TARGETS {
            let (seconds, beyond) = seconds_to(target, &points);
            let note = if beyond { ", extrapolated" } else { "" };
            let [even, shared] = [0, 1].map(|i| seconds / seconds_to(target, &ours[i]).0);
            println!(
                "  to {target:.0e}: {seconds:.3} s{note}; {even:.2} × ours, {shared:.2} × ours adaptive"
            );
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&String> = words.iter().filter(|word| *word != "--bench").collect();
    for subject in &SUBJECTS {
        let is_asked = words.is_empty() || words.iter().any(|w| subject.name.contains(w.as_str()));
        if !is_asked {
            continue;
        }
        let files = Files::new(subject);
        let Some(mut mitsuba) = Mitsuba::start(&files) else {
            println!("nothing to compare with: no python3 with mitsuba and numpy");
            return;
        };
        let records = measure(subject, &files, &mut mitsuba);
        report(subject, &records, &subject.mask(&files.sky));
    }
}
