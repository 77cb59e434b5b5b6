//! What a study asks, in the words of its file.

use merlkit::material::{LookupRule, Material};
use merlkit::{Error, Result};
use serde::Deserialize;

use super::plan::StudyPlan;
use super::task::{CheckTask, EstimateTask, FitTask, StudyTask, TileTask, parse_sampler};

/// Tasks of a study, at most: every process reads the whole list, and every result is a file.
pub const MOST_TASKS: usize = 1_000_000;

/// A study: materials × samplers × angles × seeds, and what is wanted of each material. Read from TOML or JSON.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudySpec {
    /// Paths, names and formulas.
    pub materials: Vec<String>,
    /// How tables are interpolated.
    pub lookup: LookupRule,
    /// Samplers with their settings.
    pub samplers: Vec<String>,
    /// Polar angles of `wo` of the estimates, degrees.
    pub thetas: Vec<f64>,
    /// Seeds 1 to this number.
    pub seeds: u64,
    /// Draws of an estimate, and of each statistical check.
    pub draws: usize,
    /// Whether samplers are checked.
    pub checks: bool,
    /// Models that are fitted to each material.
    pub models: Vec<String>,
    /// Pictures of each material with each sampler.
    pub pictures: Option<StudyPictures>,
}

impl Default for StudySpec {
    fn default() -> Self {
        Self {
            materials: Vec::new(),
            lookup: LookupRule::default(),
            samplers: Vec::new(),
            thetas: Vec::new(),
            seeds: 1,
            draws: 10_000,
            checks: false,
            models: Vec::new(),
            pictures: None,
        }
    }
}

/// Pictures of a study: those of `merlkit render`, cut into tiles.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudyPictures {
    /// Words after `render --light`.
    pub lights: Vec<String>,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Sides of a tile, pixels; those at the right and at the bottom may be smaller.
    pub tile: usize,
    /// Paths per pixel.
    pub spp: u64,
    /// Surfaces on a path, at most.
    pub bounces: u32,
    /// Seed of the pictures.
    pub seed: u64,
}

impl Default for StudyPictures {
    fn default() -> Self {
        Self {
            lights: vec!["environment".into()],
            size: [480, 360],
            tile: 120,
            spp: 64,
            bounces: 8,
            seed: 0,
        }
    }
}

impl StudySpec {
    /// The list of tasks, those of a material together, so that a process that runs neighbours loads it once.
    ///
    /// # Errors
    /// [`Error::Argument`] for a study of no tasks or of more than [`MOST_TASKS`], for a task outside its domain, and for a
    /// material that does not exist or that a sampler does not support.
    pub fn plan(&self) -> Result<StudyPlan> {
        self.check_count()?;
        self.check_materials()?;
        let mut tasks = Vec::new();
        for material in &self.materials {
            for sampler in &self.samplers {
                self.add_draws(material, sampler, &mut tasks);
                if let Some(pictures) = &self.pictures {
                    self.add_tiles(material, sampler, pictures, &mut tasks);
                }
            }
            if !self.models.is_empty() {
                tasks.push(StudyTask::Fit(FitTask {
                    material: material.clone(),
                    lookup: self.lookup,
                    models: self.models.clone(),
                }));
            }
        }
        StudyPlan::new(tasks)
    }

    fn add_draws(&self, material: &str, sampler: &str, tasks: &mut Vec<StudyTask>) {
        for seed in 1..=self.seeds {
            for theta in &self.thetas {
                tasks.push(StudyTask::Estimate(EstimateTask {
                    material: material.into(),
                    lookup: self.lookup,
                    sampler: sampler.into(),
                    theta: *theta,
                    seed,
                    draws: self.draws,
                }));
            }
            if self.checks {
                tasks.push(StudyTask::Check(CheckTask {
                    material: material.into(),
                    lookup: self.lookup,
                    sampler: sampler.into(),
                    seed,
                    draws: self.draws,
                }));
            }
        }
    }

    /// The tiles of a picture, row after row.
    fn add_tiles(
        &self,
        material: &str,
        sampler: &str,
        pictures: &StudyPictures,
        tasks: &mut Vec<StudyTask>,
    ) {
        let [width, height] = pictures.size;
        for top in (0..height).step_by(pictures.tile) {
            for left in (0..width).step_by(pictures.tile) {
                tasks.push(StudyTask::Tile(TileTask {
                    material: material.into(),
                    lookup: self.lookup,
                    sampler: sampler.into(),
                    lights: pictures.lights.clone(),
                    bounces: pictures.bounces,
                    spp: pictures.spp,
                    seed: pictures.seed,
                    picture: pictures.size,
                    corner: [left, top],
                    size: [
                        pictures.tile.min(width - left),
                        pictures.tile.min(height - top),
                    ],
                }));
            }
        }
    }

    /// Counts the tasks before there is memory for them.
    fn check_count(&self) -> Result<()> {
        let count = self.count_tasks();
        if count.is_some_and(|count| count > 0 && count <= MOST_TASKS as u128) {
            return Ok(());
        }
        match count {
            Some(0) => Err(Error::argument(
                "a study without tasks",
                "name materials, and thetas, checks or pictures for samplers, or models to fit",
            )),
            _ => Err(Error::argument(
                format!("a study of more than {MOST_TASKS} tasks"),
                "make several studies of it, or take fewer seeds, angles or tiles",
            )),
        }
    }

    /// How many tasks there are; `None` if that is no number.
    fn count_tasks(&self) -> Option<u128> {
        let each_seed = self.thetas.len() as u128 + u128::from(self.checks);
        let mut each_sampler = each_seed.checked_mul(u128::from(self.seeds))?;
        if let Some(pictures) = &self.pictures {
            if pictures.tile == 0 {
                return None;
            }
            let [columns, rows] = pictures
                .size
                .map(|side| side.div_ceil(pictures.tile) as u128);
            each_sampler = each_sampler.checked_add(columns.checked_mul(rows)?)?;
        }
        let samplers = each_sampler.checked_mul(self.samplers.len() as u128)?;
        let each_material = samplers.checked_add(u128::from(!self.models.is_empty()))?;
        each_material.checked_mul(self.materials.len() as u128)
    }

    /// Reads the head of each material, and asks each sampler for its needs.
    fn check_materials(&self) -> Result<()> {
        let mut samplers = Vec::new();
        for sampler in &self.samplers {
            samplers.push(parse_sampler(sampler)?);
        }
        for name in &self.materials {
            let facts = Material::resolve(name)?.facts()?;
            for sampler in &samplers {
                sampler.check_supports(&facts)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> StudySpec {
        StudySpec {
            materials: vec!["nickel".into(), "lambert:reflectance=0.5".into()],
            samplers: vec!["cosine".into(), "half-vector:2KB".into()],
            thetas: vec![10.0, 60.0, 80.0],
            seeds: 2,
            checks: true,
            models: vec!["ggx".into()],
            pictures: Some(StudyPictures {
                size: [50, 30],
                tile: 20,
                ..StudyPictures::default()
            }),
            ..StudySpec::default()
        }
    }

    #[test]
    fn tasks_are_counted_before_they_are_made_and_tiles_cover_the_picture() {
        let plan = small().plan().unwrap();
        assert_eq!(plan.tasks().len() as u128, small().count_tasks().unwrap());
        assert_eq!(plan.tasks().len(), 2 * (2 * (2 * 4 + 6) + 1));
        let mut pixels = 0;
        for planned in plan.tasks() {
            if let StudyTask::Tile(tile) = &planned.task {
                pixels += tile.size[0] * tile.size[1];
            }
        }
        assert_eq!(pixels, 4 * 50 * 30);
    }

    #[test]
    fn studies_that_nobody_can_run_are_refused_at_once() {
        let pictures = |size, tile| {
            Some(StudyPictures {
                size,
                tile,
                ..StudyPictures::default()
            })
        };
        let bad = [
            StudySpec {
                seeds: u64::MAX,
                ..small()
            },
            StudySpec {
                seeds: 1 << 20,
                ..small()
            },
            StudySpec {
                pictures: pictures([usize::MAX; 2], 1),
                ..small()
            },
            StudySpec {
                pictures: pictures([1 << 20, 1 << 20], 1 << 12),
                ..small()
            },
            StudySpec {
                pictures: pictures([50, 30], 0),
                ..small()
            },
            StudySpec {
                thetas: vec![f64::INFINITY],
                ..small()
            },
            StudySpec {
                thetas: vec![10.0, 10.0],
                ..small()
            },
            StudySpec {
                draws: 0,
                ..small()
            },
            StudySpec {
                materials: vec![],
                ..small()
            },
            StudySpec {
                materials: vec!["no-such".into()],
                ..small()
            },
            StudySpec {
                materials: vec!["nickel".into(); 2],
                ..small()
            },
            StudySpec {
                samplers: vec!["file".into()],
                ..small()
            },
            StudySpec {
                models: vec!["no-such".into()],
                ..small()
            },
        ];
        for spec in bad {
            assert!(spec.plan().is_err(), "{spec:?}");
        }
    }
}
