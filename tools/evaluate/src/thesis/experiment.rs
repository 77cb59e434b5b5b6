//! The list of experiments, and their names.

use merlkit::{Error, Result};

use super::bench::ThesisBench;
use super::exhibit::Exhibit;
use super::{ablation, distance, draws, gallery, measured, mesh_scene, quadtrees, spheres};

/// A table, a section or a scene of the thesis.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it repeats.
    pub title: &'static str,
    run: fn(&mut ThesisBench) -> Result<Exhibit>,
}

/// All of them, in the order of the thesis.
const EXPERIMENTS: [Experiment; 19] = [
    experiment("5.5", "rejections of the factored BRDF", draws::rejections),
    experiment("5.9", "memory of whole CDFs", measured::whole_memory),
    experiment("5.10", "compressed CDFs", measured::compression),
    experiment("distance", "readings of the compression", distance::search),
    experiment("6.3", "optimisations of the disc", ablation::ablation),
    experiment(
        "algorithm-15",
        "N directions by one descent",
        draws::one_descent,
    ),
    experiment(
        "6.4",
        "seconds of precomputation",
        quadtrees::precomputation,
    ),
    experiment("6.4.1", "draws in leaves", draws::leaf_counts),
    experiment(
        "6.5",
        "memory of a quadtree by n_max",
        quadtrees::memory_by_trials,
    ),
    experiment(
        "6.6",
        "memory of the disc and of factors",
        quadtrees::memory,
    ),
    experiment("6.23", "costs of measured materials", measured::costs),
    experiment("6.24", "seconds of drawing", measured::drawing),
    experiment("scene-1", "Cornell's room without blocks", gallery::scene_1),
    experiment("scene-2", "a sphere under an area light", spheres::scene_2),
    experiment("scene-3", "a large mesh on a floor", mesh_scene::scene_3),
    experiment("scene-4", "three jars", gallery::scene_4),
    experiment(
        "scene-5",
        "few samples of the disc, many uniform",
        spheres::scene_5,
    ),
    experiment(
        "scene-6",
        "a jar under an environment, with RIS",
        gallery::scene_6,
    ),
    experiment("scene-7", "eleven measured materials", spheres::scene_7),
];

const fn experiment(
    name: &'static str,
    title: &'static str,
    run: fn(&mut ThesisBench) -> Result<Exhibit>,
) -> Experiment {
    Experiment { name, title, run }
}

/// Names that are suggested for one that is unknown.
const SUGGESTED: usize = 3;

impl Experiment {
    /// All experiments.
    pub fn all() -> &'static [Self] {
        &EXPERIMENTS
    }

    /// The experiment of a name, with or without `table-` in front, in any case.
    ///
    /// # Errors
    /// [`Error::Argument`] for another name, with the nearest ones.
    pub fn find(name: &str) -> Result<Self> {
        let word = name.to_lowercase();
        let word = word.strip_prefix("table-").unwrap_or(&word);
        if let Some(found) = EXPERIMENTS.iter().find(|e| e.name == word) {
            return Ok(*found);
        }
        let mut ranked = Vec::new();
        for experiment in &EXPERIMENTS {
            ranked.push((strsim::jaro_winkler(word, experiment.name), experiment.name));
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let nearest: Vec<&str> = ranked.iter().take(SUGGESTED).map(|r| r.1).collect();
        Err(Error::argument(
            format!("the thesis has no experiment called {name:?} that is repeated here"),
            format!(
                "did you mean {}? `merlkit thesis --list` shows all of them",
                nearest.join(", ")
            ),
        ))
    }

    /// Runs what is not finished of it.
    ///
    /// # Errors
    /// Those of loading materials, building samplers, rendering, and keeping pieces.
    pub fn run(&self, bench: &mut ThesisBench) -> Result<Exhibit> {
        (self.run)(bench)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_others_have_neighbours() {
        for experiment in Experiment::all() {
            assert_eq!(
                Experiment::find(experiment.name).unwrap().name,
                experiment.name
            );
        }
        assert_eq!(Experiment::find("Table-6.4").unwrap().name, "6.4");
        let error = Experiment::find("algoritm-15").unwrap_err().to_string();
        assert!(error.contains("algorithm-15"), "{error}");
        assert!(Experiment::find("").is_err() && Experiment::find("../6.4").is_err());
    }
}
