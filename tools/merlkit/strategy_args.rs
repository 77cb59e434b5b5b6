//! How the light of extended lights is found.

use merlkit::Error;
use merlkit::distribution::Heuristic;
use merlkit::render::{SceneSpec, Strategy};

use crate::args;

/// A strategy and its settings.
#[derive(Clone, clap::Args)]
pub struct StrategyOptions {
    /// Sampling of extended lights: of light and BRDF (mis), of one of them, or of one of --candidates from the BRDF (ris)
    /// [default: mis]
    #[arg(long, value_name = "mis|light|brdf|ris", hide_possible_values = true, default_value = "mis", hide_default_value = true, value_parser = STRATEGIES)]
    strategy: String,
    /// MIS heuristic of --strategy mis [default: power]
    #[arg(long, value_name = "power|balance", hide_possible_values = true, value_parser = args::named(&HEURISTICS))]
    heuristic: Option<Heuristic>,
    /// Number of BRDF candidates of --strategy ris, of which one is traced [default: 8]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    candidates: Option<u32>,
    /// Directions of the BRDF that look for lights at each surface of a path, which goes on along one of them [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(SceneSpec::MOST_DIRECTIONS)))]
    pub directions: Option<u32>,
}

const STRATEGIES: [&str; 4] = ["mis", "light", "brdf", "ris"];
const HEURISTICS: [(&str, Heuristic); 2] =
    [("power", Heuristic::Power), ("balance", Heuristic::Balance)];

impl StrategyOptions {
    /// Takes the directions of an option file, unless some were given or the strategy draws none to look for lights.
    pub fn take_directions(&mut self, directions: Option<u32>) {
        if matches!(self.strategy.as_str(), "mis" | "brdf") {
            self.directions = self.directions.or(directions);
        }
    }

    /// The strategy that they name.
    ///
    /// # Errors
    /// [`Error::Argument`] for an option of another strategy.
    pub fn resolve(&self) -> Result<Strategy, Error> {
        match (self.strategy.as_str(), self.heuristic, self.candidates) {
            (name, Some(_), _) if name != "mis" => Err(no_effect(name, "--heuristic", "mis")),
            (name, _, Some(_)) if name != "ris" => Err(no_effect(name, "--candidates", "ris")),
            (name @ ("light" | "ris"), ..) if self.directions.is_some() => {
                Err(no_effect(name, "--directions", "mis"))
            }
            ("light", ..) => Ok(Strategy::Light),
            ("brdf", ..) => Ok(Strategy::Brdf),
            ("ris", _, candidates) => Ok(Strategy::Ris {
                candidates: candidates.unwrap_or(Strategy::CANDIDATES),
            }),
            (_, heuristic, _) => Ok(Strategy::Mis(heuristic.unwrap_or_default())),
        }
    }
}

/// The error for an option that belongs to the strategy `wanted` only.
fn no_effect(strategy: &str, option: &str, wanted: &str) -> Error {
    Error::argument(
        format!("{option} has no effect with --strategy {strategy}"),
        format!("omit it, or pass --strategy {wanted}"),
    )
}
