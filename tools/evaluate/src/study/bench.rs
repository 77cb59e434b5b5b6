//! Runs tasks, and keeps what the next task needs again.

use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::geometry::spherical;
use merlkit::glam::{DVec3, Vec2, Vec3};
use merlkit::image::Image;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::points::Stream;
use merlkit::render::{PlanRequest, Rendering, Scene, Surface};
use merlkit::{Result, Sampler, Wo};
use serde::Serialize;

use super::task::{CheckTask, EstimateTask, FitTask, StudyTask, TileTask, parse_sampler};
use super::tiles::encode_pixels;
use crate::measure::check::{CheckSettings, Outcome, check_directions_of, check_sampler};
use crate::measure::directional_albedo;
use crate::measure::fit::{FitPlan, ModelFit, fit_models};

/// Draws that are made together.
const BATCH: usize = 256;

/// What a task found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum StudyResult {
    /// Of weights f_r·cosθi/pdf; that of a failed draw is 0.
    Estimate {
        /// Their mean, which estimates the albedo: red, green, blue.
        mean: [f64; 3],
        /// Their standard deviation.
        deviation: [f64; 3],
        /// Draws that failed.
        failed: usize,
        /// The albedo by quadrature.
        albedo: [f32; 3],
    },
    /// Of the checks of a sampler.
    Check {
        /// Whether all passed.
        passed: bool,
        /// Those that did not.
        failures: Vec<Outcome>,
    },
    /// Of models.
    Fit {
        /// The fits in the order of the models.
        fits: Vec<ModelFit>,
    },
    /// Of a tile.
    Tile {
        /// Linear RGB row after row, as base64 of 32-bit floats with the lowest byte first.
        pixels: String,
    },
}

/// The material, the samplers and the scene of the last task, which the next one takes from here if it has the same.
#[derive(Default)]
pub struct StudyBench {
    subject: Option<StudySubject>,
}

/// A material that is loaded, and what was made of it.
struct StudySubject {
    name: String,
    lookup: LookupRule,
    loaded: Loaded,
    sampler: Option<(String, Sampler)>,
    /// By polar angle, degrees.
    albedos: Vec<(f64, Rgb)>,
    /// The scene of a whole picture.
    scene: Option<(TileTask, Scene)>,
}

impl StudyBench {
    /// Runs a task, on all threads of the current pool. The result does not depend on them, nor on the tasks before.
    ///
    /// # Errors
    /// As [`StudyTask::check`], and those of loading, building, fitting and rendering.
    pub fn run(&mut self, task: &StudyTask) -> Result<StudyResult> {
        task.check()?;
        match task {
            StudyTask::Estimate(task) => self.subject(&task.material, task.lookup)?.estimate(task),
            StudyTask::Check(task) => self.subject(&task.material, task.lookup)?.check(task),
            StudyTask::Fit(task) => self.subject(&task.material, task.lookup)?.fit(task),
            StudyTask::Tile(task) => self.subject(&task.material, task.lookup)?.draw(task),
        }
    }

    /// The material, loaded unless it was the last one's.
    fn subject(&mut self, name: &str, lookup: LookupRule) -> Result<&mut StudySubject> {
        let kept = self.subject.take();
        let is_same = |subject: &StudySubject| subject.name == name && subject.lookup == lookup;
        let subject = match kept.filter(is_same) {
            Some(subject) => subject,
            None => StudySubject {
                name: name.to_owned(),
                lookup,
                loaded: Material::resolve(name)?.load(lookup)?,
                sampler: None,
                albedos: Vec::new(),
                scene: None,
            },
        };
        Ok(self.subject.insert(subject))
    }
}

impl StudySubject {
    /// The sampler, built unless it was the last one's.
    fn sampler(&mut self, text: &str) -> Result<Sampler> {
        if let Some((known, sampler)) = &self.sampler
            && known == text
        {
            return Ok(sampler.clone());
        }
        let sampler = parse_sampler(text)?.build(&self.loaded)?;
        self.sampler = Some((text.to_owned(), sampler.clone()));
        Ok(sampler)
    }

    /// The albedo at a polar angle in degrees.
    fn albedo(&mut self, theta: f64) -> Rgb {
        for (known, albedo) in &self.albedos {
            if *known == theta {
                return *albedo;
            }
        }
        let albedo = directional_albedo(&**self.loaded.brdf(), theta.to_radians());
        self.albedos.push((theta, albedo));
        albedo
    }

    fn estimate(&mut self, task: &EstimateTask) -> Result<StudyResult> {
        let sampler = self.sampler(&task.sampler)?;
        let albedo = self.albedo(task.theta);
        let wo = spherical(task.theta.to_radians(), 0.0).as_vec3();
        let weights = draw_weights(&sampler, &**self.loaded.brdf(), wo, task);
        Ok(StudyResult::Estimate {
            mean: weights.mean.to_array(),
            deviation: weights.deviation().to_array(),
            failed: weights.failed,
            albedo: albedo.to_array(),
        })
    }

    fn check(&mut self, task: &CheckTask) -> Result<StudyResult> {
        let sampler = self.sampler(&task.sampler)?;
        let settings = CheckSettings {
            draws: task.draws,
            seed: task.seed,
            ..CheckSettings::default()
        };
        let directions = check_directions_of(self.loaded.symmetry());
        let brdf = &**self.loaded.brdf();
        let report = check_sampler(sampler.as_dyn(), brdf, &directions, &settings);
        Ok(StudyResult::Check {
            passed: report.pass(),
            failures: report.failures().cloned().collect(),
        })
    }

    fn fit(&mut self, task: &FitTask) -> Result<StudyResult> {
        let models = task.parse_models()?;
        let brdf = &**self.loaded.brdf();
        let fit = fit_models(self.loaded.name(), brdf, &models, &FitPlan::default())?;
        Ok(StudyResult::Fit { fits: fit.fits })
    }

    fn draw(&mut self, task: &TileTask) -> Result<StudyResult> {
        let picture = task.whole_picture();
        let scene = match self.scene.take() {
            Some((known, scene)) if known == picture => scene,
            _ => self.build_scene(task)?,
        };
        let image = draw_tile(&scene, task)?;
        self.scene = Some((picture, scene));
        Ok(StudyResult::Tile {
            pixels: encode_pixels(&image),
        })
    }

    fn build_scene(&mut self, task: &TileTask) -> Result<Scene> {
        let spec = task.scene(self.loaded.facts().has_mirror)?;
        Scene::build(&spec, PlanRequest::AsNeeded, |_, directions| {
            let sampler = match directions {
                true => Some(self.sampler(&task.sampler)?.shared()),
                false => None,
            };
            Ok(Surface {
                brdf: self.loaded.brdf().clone(),
                sampler,
            })
        })
    }
}

/// The pixels of a tile, with the bits of the whole picture.
fn draw_tile(scene: &Scene, task: &TileTask) -> Result<Image> {
    let settings = task.settings();
    let mut rendering = Rendering::begin_region(scene, &settings, task.corner, task.size)?;
    rendering.advance(&|| false, &|_| {});
    rendering.into_rendered().film.to_image()
}

/// Mean and spread of weights, added one after another.
#[derive(Default)]
struct RunningWeights {
    count: usize,
    failed: usize,
    mean: DVec3,
    /// Sum of squared deviations from the mean.
    squares: DVec3,
}

impl RunningWeights {
    fn add(&mut self, weight: DVec3) {
        // Welford: m ← m + (w − m)/n and S ← S + (w − m before)(w − m after).
        self.count += 1;
        let before = weight - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (weight - self.mean);
    }

    /// √(S/n).
    fn deviation(&self) -> DVec3 {
        (self.squares / self.count.max(1) as f64).map(f64::sqrt)
    }
}

/// The weights f_r·cosθi/pdf of the draws of a task.
fn draw_weights(
    sampler: &Sampler,
    brdf: &dyn Brdf,
    wo: Vec3,
    task: &EstimateTask,
) -> RunningWeights {
    let mut numbers = Stream::new(task.seed);
    let mut weights = RunningWeights::default();
    let (mut u, mut draws) = ([Vec2::ZERO; BATCH], [None; BATCH]);
    let (mut wi, mut values) = ([Vec3::Z; BATCH], [Rgb::ZERO; BATCH]);
    for start in (0..task.draws).step_by(BATCH) {
        let lanes = BATCH.min(task.draws - start);
        for u in &mut u[..lanes] {
            *u = Vec2::new(numbers.next_f32(), numbers.next_f32());
        }
        let draws = &mut draws[..lanes];
        sampler
            .as_dyn()
            .sample_batch(Wo::One(wo), &u[..lanes], draws);
        for (wi, draw) in wi.iter_mut().zip(draws.iter()) {
            *wi = draw.map_or(Vec3::Z, |draw| draw.wi);
        }
        brdf.eval_cos_batch(Wo::One(wo), &wi[..lanes], &mut values[..lanes]);
        for (draw, value) in draws.iter().zip(&values) {
            match draw {
                Some(draw) => weights.add(value.as_dvec3() / f64::from(draw.pdf)),
                None => {
                    weights.failed += 1;
                    weights.add(DVec3::ZERO);
                }
            }
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(sampler: &str, theta: f64) -> StudyTask {
        StudyTask::Estimate(EstimateTask {
            material: "ggx:ax=0.2,ay=0.2".into(),
            lookup: LookupRule::Floor,
            sampler: sampler.into(),
            theta,
            seed: 3,
            draws: 5000,
        })
    }

    #[test]
    fn estimates_are_near_the_albedo_and_do_not_depend_on_what_ran_before() {
        let tasks = [
            estimate("half-vector:2KB", 10.0),
            estimate("cosine", 10.0),
            estimate("half-vector:2KB", 60.0),
        ];
        let mut bench = StudyBench::default();
        for task in tasks {
            let result = bench.run(&task).unwrap();
            assert_eq!(StudyBench::default().run(&task).unwrap(), result);
            let StudyResult::Estimate {
                mean,
                deviation,
                albedo,
                ..
            } = result
            else {
                panic!("{result:?}");
            };
            let error = (mean[0] - f64::from(albedo[0])).abs();
            assert!(
                error < 5.0 * deviation[0] / 5000f64.sqrt() + 1e-4,
                "{task:?}: {error}"
            );
            assert!(albedo[0] > 0.1 && deviation[0] > 0.0);
        }
    }

    #[test]
    fn deviations_are_the_textbook_ones() {
        let mut weights = RunningWeights::default();
        for weight in [1.0, 2.0, 4.0, 9.0] {
            weights.add(DVec3::splat(weight));
        }
        assert!((weights.mean.x - 4.0).abs() < 1e-15);
        assert!((weights.deviation().x - 9.5f64.sqrt()).abs() < 1e-15);
    }
}
