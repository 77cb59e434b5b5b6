//! Which samplers a request may have built: those whose tables fit into memory and are ready while somebody waits.

use merlkit::sampler::SamplerSpec;

use crate::query::shorten;
use crate::refusal::Refusal;

/// Longer texts are no sampler's.
const LONGEST_TEXT: usize = 400;

/// The largest values of settings by their keys.
const MOST: [(&str, f64); 5] = [
    ("tables", 128.0),
    ("azimuths", 32.0),
    ("grid", 1024.0),
    ("rows", 128.0),
    ("segments", 256.0),
];

/// The smallest values of settings by their keys.
const LEAST: [(&str, f64); 1] = [("n-max", 1.1)];

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
            return Err(refuse(text, key, "at most", most));
        }
    }
    for (key, least) in LEAST {
        if number(&spec, key).is_some_and(|value| value < least) {
            return Err(refuse(text, key, "at least", least));
        }
    }
    Ok(spec)
}

/// A setting that is a number.
fn number(spec: &SamplerSpec, key: &str) -> Option<f64> {
    spec.setting(key)?.parse().ok()
}

fn refuse(text: &str, key: &str, bound: &str, limit: f64) -> Refusal {
    Refusal::bad(format!(
        "{}: the page builds samplers with {key} of {bound} {limit}; `merlkit build` has no such limit",
        shorten(text)
    ))
}
