//! What a task of a study is asked to do.

use std::path::Path;

use merlkit::material::LookupRule;
use merlkit::points::PointSet;
use merlkit::render::{Budget, RenderSettings, SceneSpec};
use merlkit::{Error, Result, SamplerSpec};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::measure::fit::FitModel;

/// Draws of a check: with fewer nothing would fail; with more, nobody would wait.
const CHECK_DRAWS: std::ops::RangeInclusive<usize> = 1000..=10_000_000;
/// Draws of an estimate.
const ESTIMATE_DRAWS: std::ops::RangeInclusive<usize> = 1..=10_000_000;
/// Paths per pixel from which Sobol points leave less error than lattices (docs/light-and-brdf.md has what was measured).
const SOBOL_FROM: u64 = 512;
/// Letters of a key's readable part, at most.
const READABLE: usize = 80;

/// A task of a study: what is asked, and of which material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum StudyTask {
    /// An estimate of the albedo.
    Estimate(EstimateTask),
    /// The checks of a sampler.
    Check(CheckTask),
    /// Models fitted to a material.
    Fit(FitTask),
    /// A tile of a picture of a material.
    Tile(TileTask),
}

/// The albedo at one angle, estimated from draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EstimateTask {
    /// Path, name or formula of the material.
    pub material: String,
    /// How its table is interpolated.
    pub lookup: LookupRule,
    /// The sampler with its settings.
    pub sampler: String,
    /// Polar angle of `wo`, degrees in [0, 90).
    pub theta: f64,
    /// Chooses the draws.
    pub seed: u64,
    /// Number of draws, 1 to 10⁷.
    pub draws: usize,
}

/// All checks of a sampler, as `merlkit check` makes them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckTask {
    /// Path, name or formula of the material.
    pub material: String,
    /// How its table is interpolated.
    pub lookup: LookupRule,
    /// The sampler with its settings.
    pub sampler: String,
    /// Chooses the draws.
    pub seed: u64,
    /// Draws of each statistical check, 1000 to 10⁷.
    pub draws: usize,
}

/// Models fitted to a material, as `merlkit fit` does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitTask {
    /// Path, name or formula of the material.
    pub material: String,
    /// How its table is interpolated.
    pub lookup: LookupRule,
    /// Models such as `ggx` or `ggx+ggx`.
    pub models: Vec<String>,
}

/// A rectangle of pixels of a picture that `merlkit render` draws of one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TileTask {
    /// Path, name or formula of the material.
    pub material: String,
    /// How its table is interpolated.
    pub lookup: LookupRule,
    /// The sampler with its settings.
    pub sampler: String,
    /// Words after `render --light`.
    pub lights: Vec<String>,
    /// Surfaces on a path, at most; ≥ 1.
    pub bounces: u32,
    /// Paths per pixel, ≥ 1.
    pub spp: u64,
    /// Seed of the whole picture.
    pub seed: u64,
    /// Columns and rows of the whole picture.
    pub picture: [usize; 2],
    /// Column and row of the tile's upper left pixel.
    pub corner: [usize; 2],
    /// Columns and rows of the tile.
    pub size: [usize; 2],
}

impl StudyTask {
    /// The material's path, name or formula.
    pub fn material(&self) -> &str {
        match self {
            Self::Estimate(task) => &task.material,
            Self::Check(task) => &task.material,
            Self::Fit(task) => &task.material,
            Self::Tile(task) => &task.material,
        }
    }

    /// The kind, as in the task's JSON.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Estimate(_) => "estimate",
            Self::Check(_) => "check",
            Self::Fit(_) => "fit",
            Self::Tile(_) => "tile",
        }
    }

    /// The name of the task's result: readable words, then 16 digits of a checksum (SHA-256) of everything that is asked. It is a
    /// file name on every system, and no path.
    ///
    /// # Errors
    /// None for a task that [`Self::check`] accepts.
    pub fn key(&self) -> Result<String> {
        // The fields have one order, that of their declarations.
        let text = serde_json::to_string(self)
            .map_err(|e| Error::argument(format!("a task without a JSON: {e}"), "report this"))?;
        let stem = Path::new(self.material()).file_stem();
        let stem = stem.map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let mut key = String::new();
        for letter in format!("{}-{stem}", self.kind()).chars().take(READABLE) {
            key.push(if letter.is_ascii_alphanumeric() {
                letter
            } else {
                '-'
            });
        }
        key.push('-');
        for byte in &Sha256::digest(text)[..8] {
            key += &format!("{byte:02x}");
        }
        Ok(key)
    }

    /// Refuses what is outside its domain. Nothing is read or loaded.
    ///
    /// # Errors
    /// [`Error::Argument`].
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Estimate(task) => {
                parse_sampler(&task.sampler)?;
                require(&ESTIMATE_DRAWS, task.draws, "draws of an estimate")?;
                if !(0.0..90.0).contains(&task.theta) {
                    let what = format!("wo at a polar angle of {} degrees", task.theta);
                    return Err(Error::argument(what, "give 0 or more, and less than 90"));
                }
                Ok(())
            }
            Self::Check(task) => {
                parse_sampler(&task.sampler)?;
                require(&CHECK_DRAWS, task.draws, "draws of a check")
            }
            Self::Fit(task) => task.parse_models().map(|_| ()),
            Self::Tile(task) => task.check(),
        }
    }
}

impl FitTask {
    /// The models, at least one.
    ///
    /// # Errors
    /// [`Error::Argument`] for an unknown model, or none.
    pub(super) fn parse_models(&self) -> Result<Vec<FitModel>> {
        if self.models.is_empty() {
            return Err(Error::argument(
                "a fit of no models",
                "name at least one, such as ggx",
            ));
        }
        self.models
            .iter()
            .map(|name| FitModel::parse(name))
            .collect()
    }
}

impl TileTask {
    /// The settings of the whole picture: those of `merlkit render`.
    pub(super) fn settings(&self) -> RenderSettings {
        let [width, height] = self.picture;
        RenderSettings {
            width,
            height,
            seed: self.seed,
            points: match self.spp >= SOBOL_FROM {
                true => PointSet::Sobol,
                false => PointSet::Lattice,
            },
            budget: Budget::Even(self.spp),
        }
    }

    /// The scene, whose material is described as a mirror or not; nothing is loaded.
    ///
    /// # Errors
    /// As [`SceneSpec::light`].
    pub(super) fn scene(&self, has_mirror: bool) -> Result<SceneSpec> {
        let [width, height] = self.picture;
        let names = std::slice::from_ref(&self.material);
        let mut scene = SceneSpec::row(names, width as f64 / height as f64);
        for light in &self.lights {
            let light = scene.light(light)?;
            scene.lights.push(light);
        }
        if has_mirror {
            scene.mirrors.push(0);
        }
        scene.depth = self.bounces;
        Ok(scene)
    }

    /// The whole picture as one tile.
    pub fn whole_picture(&self) -> Self {
        Self {
            corner: [0, 0],
            size: self.picture,
            ..self.clone()
        }
    }

    fn check(&self) -> Result<()> {
        parse_sampler(&self.sampler)?;
        self.settings().check()?;
        let is_inside = (0..2).all(|axis| {
            let end = self.corner[axis].checked_add(self.size[axis]);
            self.size[axis] > 0 && end.is_some_and(|end| end <= self.picture[axis])
        });
        if !is_inside {
            let what = format!(
                "a tile of {:?} pixels from {:?} on, of a picture of {:?}",
                self.size, self.corner, self.picture
            );
            return Err(Error::argument(what, "give tiles within the picture"));
        }
        if self.bounces == 0 || self.lights.is_empty() {
            let what = "a picture without light or without a bounce";
            return Err(Error::argument(what, "give at least one of each"));
        }
        self.scene(false).map(|_| ())
    }
}

/// The sampler that a text names.
pub(super) fn parse_sampler(text: &str) -> Result<SamplerSpec> {
    text.parse()
}

fn require(domain: &std::ops::RangeInclusive<usize>, found: usize, what: &str) -> Result<()> {
    if domain.contains(&found) {
        return Ok(());
    }
    let fix = format!("give {} to {}", domain.start(), domain.end());
    Err(Error::argument(format!("{found} {what}"), fix))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate() -> EstimateTask {
        EstimateTask {
            material: "lambert:reflectance=0.5".into(),
            lookup: LookupRule::Floor,
            sampler: "cosine".into(),
            theta: 10.0,
            seed: 1,
            draws: 1000,
        }
    }

    fn tile() -> TileTask {
        TileTask {
            material: "nickel".into(),
            lookup: LookupRule::Floor,
            sampler: "cosine".into(),
            lights: vec!["studio".into()],
            bounces: 8,
            spp: 4,
            seed: 0,
            picture: [30, 20],
            corner: [10, 0],
            size: [20, 20],
        }
    }

    #[test]
    fn keys_are_stable_file_names_that_differ_with_every_field() {
        let key = StudyTask::Estimate(estimate()).key().unwrap();
        // Results that are kept are found by a later version: a change here makes them be run again.
        assert_eq!(key, "estimate-lambert-reflectance-0-e690c238fd304f6d");
        let changed = [
            EstimateTask {
                material: "x/../../lambert:reflectance=0.5".into(),
                ..estimate()
            },
            EstimateTask {
                lookup: LookupRule::Linear,
                ..estimate()
            },
            EstimateTask {
                sampler: "factored".into(),
                ..estimate()
            },
            EstimateTask {
                theta: 10f64.next_up(),
                ..estimate()
            },
            EstimateTask {
                seed: u64::MAX,
                ..estimate()
            },
            EstimateTask {
                draws: 1001,
                ..estimate()
            },
        ];
        for task in changed {
            let other = StudyTask::Estimate(task).key().unwrap();
            assert_ne!(other, key);
            assert!(
                other.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'),
                "{other}"
            );
        }
    }

    #[test]
    fn tasks_come_back_from_json_and_know_all_their_fields() {
        for task in [
            StudyTask::Estimate(EstimateTask {
                theta: 0.1 + 0.2,
                ..estimate()
            }),
            StudyTask::Tile(tile()),
        ] {
            let text = serde_json::to_string(&task).unwrap();
            assert_eq!(serde_json::from_str::<StudyTask>(&text).unwrap(), task);
            let more = text.replacen('{', "{\"more\":1,", 1);
            assert!(serde_json::from_str::<StudyTask>(&more).is_err());
        }
    }

    #[test]
    fn what_is_outside_its_domain_is_refused() {
        assert!(StudyTask::Estimate(estimate()).check().is_ok());
        assert!(StudyTask::Tile(tile()).check().is_ok());
        let bad = [
            StudyTask::Estimate(EstimateTask {
                theta: 90.0,
                ..estimate()
            }),
            StudyTask::Estimate(EstimateTask {
                theta: f64::NAN,
                ..estimate()
            }),
            StudyTask::Estimate(EstimateTask {
                draws: 0,
                ..estimate()
            }),
            StudyTask::Estimate(EstimateTask {
                draws: usize::MAX,
                ..estimate()
            }),
            StudyTask::Estimate(EstimateTask {
                sampler: "nothing".into(),
                ..estimate()
            }),
            StudyTask::Tile(TileTask {
                size: [21, 20],
                ..tile()
            }),
            StudyTask::Tile(TileTask {
                size: [0, 20],
                ..tile()
            }),
            StudyTask::Tile(TileTask {
                corner: [usize::MAX, 0],
                ..tile()
            }),
            StudyTask::Tile(TileTask {
                picture: [usize::MAX, 20],
                ..tile()
            }),
            StudyTask::Tile(TileTask { spp: 0, ..tile() }),
            StudyTask::Tile(TileTask {
                bounces: 0,
                ..tile()
            }),
            StudyTask::Tile(TileTask {
                lights: vec![],
                ..tile()
            }),
            StudyTask::Fit(FitTask {
                material: "nickel".into(),
                lookup: LookupRule::Linear,
                models: vec!["nothing".into()],
            }),
        ];
        for task in bad {
            assert!(task.check().is_err(), "{task:?}");
        }
    }
}
