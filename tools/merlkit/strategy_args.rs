//! How light from lights with an extent is found.

use merlkit::Error;
use merlkit::distribution::Heuristic;
use merlkit::render::Strategy;

/// The strategy of this name, with the settings that belong to it.
///
/// # Errors
/// [`Error::Argument`] for a setting of another strategy.
pub fn read_strategy(
    name: &str,
    heuristic: Option<Heuristic>,
    candidates: Option<u32>,
) -> Result<Strategy, Error> {
    match (name, heuristic, candidates) {
        (name, Some(_), _) if name != "mis" => Err(no_effect(name, "--heuristic", "mis")),
        (name, _, Some(_)) if name != "ris" => Err(no_effect(name, "--candidates", "ris")),
        ("light", ..) => Ok(Strategy::Light),
        ("brdf", ..) => Ok(Strategy::Brdf),
        ("ris", _, candidates) => Ok(Strategy::Ris {
            candidates: candidates.unwrap_or(Strategy::CANDIDATES),
        }),
        (_, heuristic, _) => Ok(Strategy::Mis(heuristic.unwrap_or_default())),
    }
}

/// The error for an option that belongs to the strategy `wanted` only.
fn no_effect(strategy: &str, option: &str, wanted: &str) -> Error {
    Error::argument(
        format!("{option} has no effect with --strategy {strategy}"),
        format!("omit it, or pass --strategy {wanted}"),
    )
}
