//! How many paths a picture takes, and by which points.

use merlkit::Error;
use merlkit::points::PointSet;
use merlkit::render::{Budget, RenderSettings};

use crate::args;

/// The budget of paths, their points and their seed.
#[derive(Clone, clap::Args)]
pub struct PathOptions {
    /// Paths per pixel [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub spp: Option<u64>,
    /// Spend the paths where the first of them found noise; needs --spp 16 or more
    #[arg(long, conflicts_with = "target_error")]
    pub adaptive: bool,
    /// Points of each pixel [default: lattice; sobol from --spp 512 and with --target-error]
    #[arg(long, value_name = "random|sobol|lattice", hide_possible_values = true, value_parser = args::named(&POINTS))]
    pub points: Option<PointSet>,
    /// Sample each 16 × 16 tile that shows an object until its estimated relative RMS error is about E: 0.05 or 5%. The halves
    /// of a tile stop one another, which keeps means unbiased; a finished tile can exceed E somewhat
    #[arg(long, value_name = "E", conflicts_with = "spp", value_parser = args::target_error)]
    pub target_error: Option<f64>,
    /// Maximum paths per pixel with --target-error, at least 16 [default: 4096]
    #[arg(long, value_name = "N", requires = "target_error", value_parser = clap::value_parser!(u64).range(16..))]
    pub max_spp: Option<u64>,
    /// Seed of all random numbers [default: 0]
    #[arg(long, value_name = "K", default_value_t = 0, hide_default_value = true)]
    pub seed: u64,
}

const POINTS: [(&str, PointSet); 3] = [
    ("random", PointSet::Random),
    ("sobol", PointSet::Sobol),
    ("lattice", PointSet::Lattice),
];
/// Paths per pixel, where nothing is said.
const SPP: u64 = 64;
/// Paths per pixel that a target error may take, where nothing is said.
const MAX_SPP: u64 = 4096;
/// Paths per pixel from which Sobol points leave less error than lattices (docs/light-and-brdf.md has what was measured).
const SOBOL_FROM: u64 = 512;

impl PathOptions {
    /// Settings of each tile of so many pixels across and down.
    ///
    /// # Errors
    /// [`Error::Argument`] for points that need another budget.
    pub fn settings(&self, [width, height]: [usize; 2]) -> Result<RenderSettings, Error> {
        let spp = self.spp.unwrap_or(SPP);
        let budget = match self.target_error {
            Some(error) => Budget::ToError {
                error,
                most: self.max_spp.unwrap_or(MAX_SPP),
            },
            None if self.adaptive => Budget::Adaptive(spp),
            None => Budget::Even(spp),
        };
        let points = match (self.points, self.target_error) {
            (Some(PointSet::Lattice), Some(_)) => {
                let what = "a lattice needs a path count that is known in advance";
                return Err(Error::argument(
                    what,
                    "omit --points lattice or --target-error",
                ));
            }
            (None, Some(_)) => PointSet::Sobol,
            (None, None) if spp >= SOBOL_FROM => PointSet::Sobol,
            (points, _) => points.unwrap_or(PointSet::Lattice),
        };
        Ok(RenderSettings {
            width,
            height,
            seed: self.seed,
            points,
            budget,
        })
    }
}
