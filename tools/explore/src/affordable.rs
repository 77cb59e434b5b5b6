//! Which samplers a request may have built: those whose tables fit into memory and are ready while somebody waits.

use merlkit::sampler::SamplerSpec;

use crate::query::shorten;
use crate::refusal::Refusal;

/// Longer texts are no sampler's.
const LONGEST_TEXT: usize = 400;

/// The largest values of settings by their keys.
const MOST: [(&str, f64); 4] = [
    ("tables", 128.0),
    ("azimuths", 32.0),
    ("grid", 1024.0),
    ("n-max", 1000.0),
];
/// Azimuths that anisotropic materials have tables at where nothing is said.
const USUAL_AZIMUTHS: f64 = 8.0;
/// The most directions of `wo` that have tables.
const MOST_DIRECTIONS: f64 = 1024.0;
/// The most cells of a table, and of all tables together.
const MOST_CELLS: [f64; 2] = [524_288.0, 134_217_728.0];
/// The most products of factors, and the most cells of a factor.
const MOST_FACTORS: [f64; 2] = [256.0, 16_384.0];
/// The smallest mean number of trials of a leaf.
const LEAST_TRIALS: f64 = 1.1;
/// The same for trees whose leaves are split down to the smallest waste, below [`LEAST_WASTE`].
const LEAST_TRIALS_UNBOUNDED: f64 = 1.5;
/// See [`LEAST_TRIALS_UNBOUNDED`].
const LEAST_WASTE: f64 = 1e-4;

/// The sampler that a text names, if a request may have it built.
pub(crate) fn parse_sampler(text: &str) -> Result<SamplerSpec, Refusal> {
    if text.len() > LONGEST_TEXT {
        return Err(Refusal::bad(format!(
            "the sampler's text has {} bytes; give at most {LONGEST_TEXT}",
            text.len()
        )));
    }
    let spec: SamplerSpec = text.parse()?;
    for (key, most) in MOST {
        if number(&spec, key).is_some_and(|value| value > most) {
            return Err(refuse(text, &format!("{key} of at most {most}")));
        }
    }
    check_cells(&spec, text)?;
    check_trials(&spec, text)?;
    Ok(spec)
}

/// Refuses tables that are too many or too large.
fn check_cells(spec: &SamplerSpec, text: &str) -> Result<(), Refusal> {
    let azimuths = number(spec, "azimuths").unwrap_or(USUAL_AZIMUTHS);
    let directions = number(spec, "tables").unwrap_or(1.0) * azimuths;
    if directions > MOST_DIRECTIONS {
        let limit = format!("tables times azimuths of at most {MOST_DIRECTIONS}");
        return Err(refuse(text, &limit));
    }
    // "1024x512": cells over two angles.
    let cells: f64 = numbers(spec, "cells").iter().product();
    if cells > MOST_CELLS[0] || cells * directions > MOST_CELLS[1] {
        let limit = format!(
            "at most {} cells a table and {} in all",
            MOST_CELLS[0], MOST_CELLS[1]
        );
        return Err(refuse(text, &limit));
    }
    // "8x4/64x32/…": products of factors, and cells over two angles.
    if let [outer, inner, theta, phi, ..] = numbers(spec, "factors")[..]
        && (outer * inner > MOST_FACTORS[0] || theta * phi > MOST_FACTORS[1])
    {
        let limit = format!(
            "at most {} products of factors of {} cells",
            MOST_FACTORS[0], MOST_FACTORS[1]
        );
        return Err(refuse(text, &limit));
    }
    Ok(())
}

/// Refuses trees whose leaves are split nearly without end.
fn check_trials(spec: &SamplerSpec, text: &str) -> Result<(), Refusal> {
    let Some(n_max) = number(spec, "n-max") else {
        return Ok(());
    };
    let is_unbounded = number(spec, "waste").is_some_and(|waste| waste < LEAST_WASTE);
    let least = if is_unbounded {
        LEAST_TRIALS_UNBOUNDED
    } else {
        LEAST_TRIALS
    };
    if n_max < least {
        return Err(refuse(text, &format!("n-max of at least {least}")));
    }
    Ok(())
}

/// A setting that is a number.
fn number(spec: &SamplerSpec, key: &str) -> Option<f64> {
    spec.setting(key)?.parse().ok()
}

/// The numbers in the text of a setting: 8, 4, 64 and 32 of "8x4/64x32/wi". No others than digits are part of them.
fn numbers(spec: &SamplerSpec, key: &str) -> Vec<f64> {
    let text = spec.setting(key).unwrap_or_default();
    let pieces = text.split(|c: char| !c.is_ascii_digit());
    pieces.filter_map(|piece| piece.parse().ok()).collect()
}

fn refuse(text: &str, limit: &str) -> Refusal {
    Refusal::bad(format!(
        "{}: the page builds samplers with {limit}; `merlkit build` has no such limit",
        shorten(text)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_and_preset_is_affordable() {
        for method in SamplerSpec::methods() {
            assert!(parse_sampler(&method.to_string()).is_ok(), "{method}");
            for preset in method.preset_facts() {
                let text = format!("{}:{}", method.name(), preset.name);
                let parsed = parse_sampler(&text);
                assert!(parsed.is_ok(), "{text}: {parsed:?}");
            }
        }
    }

    #[test]
    fn samplers_that_fill_the_memory_are_refused() {
        for text in [
            "half-vector:tables=1024",
            "cascade-cdf:cells=8192x8192",
            "cascade-cdf:tables=128,cells=512x512",
            "adaptive-disc:n-max=1.01",
            "adaptive-disc:n-max=1.2,waste=0",
            "adaptive-disc:tables=128,azimuths=32",
            "adaptive-disc:grid=4096",
            "factored:factors=64x64/64x32/wi/0.01",
            "factored:factors=8x4/1024x1024/wi/0.01",
        ] {
            let refusal = parse_sampler(text).unwrap_err();
            assert!(refusal.message.contains("merlkit build"), "{refusal}");
        }
        let long = format!("half-vector:{}", "rows=9,".repeat(100));
        assert!(parse_sampler(&long).is_err());
    }
}
