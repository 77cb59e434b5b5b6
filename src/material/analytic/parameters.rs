//! The parameters of a formula: read from text, checked against their domains, listed, and written out in full.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::DVec3;
use serde::Serialize;

use super::words::nearest_words;
use crate::color::Rgb;
use crate::{Error, Result};

/// A parameter as it is listed.
///
/// See [`ModelFacts`](crate::material::analytic::ModelFacts) for an example.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterFacts {
    /// Its key in front of `=`.
    pub key: &'static str,
    /// Other keys that mean the same.
    pub aliases: Vec<&'static str>,
    /// Its domain, in words.
    pub domain: String,
    /// Its value where it is not given.
    pub default: String,
    /// Its value here.
    pub value: String,
    /// What it is, without a full stop.
    pub meaning: &'static str,
}

/// Parameters as they were given; a model asks for each of those that it has.
pub(super) struct Parameters {
    model: &'static str,
    /// Values by their keys in lower case.
    given: BTreeMap<String, String>,
    /// Those asked for so far.
    known: Vec<KnownParameter>,
}

/// A parameter that a model has asked for.
struct KnownParameter {
    facts: ParameterFacts,
    /// Whether the default is written out too.
    always_written: bool,
}

/// What a model says of a parameter when it asks for it.
#[derive(Clone, Copy)]
pub(super) struct Declaration {
    /// The key, then its aliases, with `|` between them.
    keys: &'static str,
    meaning: &'static str,
}

impl Declaration {
    /// The key itself.
    fn key(self) -> &'static str {
        self.keys.split('|').next().unwrap_or(self.keys)
    }
}

/// A parameter by its keys, as "ex|nu", and what it means.
pub(super) const fn declare(keys: &'static str, meaning: &'static str) -> Declaration {
    Declaration { keys, meaning }
}

impl Parameters {
    /// Takes "key=value,key=value" apart; the text may be empty, and keys are in any case.
    ///
    /// # Errors
    /// [`Error::Argument`] for a piece that is no key=value, and for a key that is given twice.
    pub(super) fn parse(model: &'static str, text: &str) -> Result<Self> {
        let mut given = BTreeMap::new();
        for piece in text.split(',').map(str::trim).filter(|p| !p.is_empty()) {
            let Some((key, value)) = piece.split_once('=') else {
                return Err(Error::argument(
                    format!("\"{piece}\" is no parameter of {model}"),
                    "write parameters as key=value",
                ));
            };
            let (key, value) = (key.trim().to_lowercase(), value.trim().to_owned());
            if given.contains_key(&key) {
                return Err(given_twice(&key, model));
            }
            given.insert(key, value);
        }
        Ok(Self {
            model,
            given,
            known: Vec::new(),
        })
    }

    /// A number within `domain`.
    ///
    /// # Errors
    /// [`Error::Argument`] for what is no such number, or is given under two of its keys.
    pub(super) fn number(
        &mut self,
        parameter: Declaration,
        domain: RangeInclusive<f64>,
        default: f64,
    ) -> Result<f64> {
        let words = format!("{} to {}", domain.start(), domain.end());
        let value = match self.take(parameter)? {
            None => default,
            Some(text) => match text.parse().ok().filter(|value| domain.contains(value)) {
                Some(value) => value,
                None => return Err(self.outside(parameter, &text, format!("a number of {words}"))),
            },
        };
        self.record(parameter, words, [default.to_string(), value.to_string()]);
        Ok(value)
    }

    /// T or F.
    ///
    /// # Errors
    /// [`Error::Argument`] for any other word.
    pub(super) fn flag(&mut self, parameter: Declaration, default: bool) -> Result<bool> {
        let value = match self.take(parameter)? {
            None => default,
            Some(text) => match text.to_lowercase().as_str() {
                "t" | "true" | "1" => true,
                "f" | "false" | "0" => false,
                _ => return Err(self.outside(parameter, &text, "T or F".into())),
            },
        };
        let texts = [default, value].map(|flag| if flag { "T".to_owned() } else { "F".to_owned() });
        self.record(parameter, "T or F".into(), texts);
        Ok(value)
    }

    /// Whether the formula is the one that the thesis prints, `form=printed`, rather than the sound one.
    ///
    /// # Errors
    /// [`Error::Argument`] for a word that is neither.
    pub(super) fn is_printed(&mut self) -> Result<bool> {
        let parameter = declare(
            "form",
            "the sound formula, or the one that the thesis prints",
        );
        let domain = "sound or printed";
        let value = match self.take(parameter)? {
            None => "sound".to_owned(),
            Some(text) => text.to_lowercase(),
        };
        if value != "sound" && value != "printed" {
            return Err(self.outside(parameter, &value, domain.into()));
        }
        let is_printed = value == "printed";
        self.record(parameter, domain.into(), ["sound".into(), value]);
        self.hide_default();
        Ok(is_printed)
    }

    /// The colour that the model's values are multiplied by; white unless it is given.
    ///
    /// # Errors
    /// As [`Self::colour`].
    pub(super) fn rgb(&mut self) -> Result<DVec3> {
        let parameter = declare("rgb|colour", "colour, by which values are multiplied");
        let rgb = self.colour(parameter, 0.0..=1.0, 1.0)?;
        self.hide_default();
        Ok(rgb.as_dvec3())
    }

    /// A linear RGB colour: one number for all channels, or three with slashes, as in 0.8/0.5/0.2.
    ///
    /// # Errors
    /// [`Error::Argument`] for what is no such number, or is outside `domain`.
    pub(super) fn colour(
        &mut self,
        parameter: Declaration,
        domain: RangeInclusive<f32>,
        default: f32,
    ) -> Result<Rgb> {
        let range = format!("{} to {}", domain.start(), domain.end());
        let words = format!("one number of {range}, or three with slashes for red, green and blue");
        let colour = match self.take(parameter)? {
            None => Rgb::splat(default),
            Some(text) => match parse_colour(&text, &domain) {
                Some(colour) => colour,
                None => return Err(self.outside(parameter, &text, words)),
            },
        };
        let texts = [Rgb::splat(default), colour].map(write_colour);
        self.record(parameter, format!("{range}, or three as R/G/B"), texts);
        Ok(colour)
    }

    /// The model's text, and its parameters, once the model has asked for all that it has.
    ///
    /// # Errors
    /// [`Error::Argument`] for a parameter that the model did not ask for.
    pub(super) fn finish(self) -> Result<(String, Vec<ParameterFacts>)> {
        if let Some(key) = self.given.keys().next() {
            return Err(self.unknown(key));
        }
        let mut text = self.model.to_owned();
        let mut facts = Vec::with_capacity(self.known.len());
        let mut separator = ':';
        for known in self.known {
            let parameter = known.facts;
            if known.always_written || parameter.value != parameter.default {
                text.push(separator);
                text.push_str(&format!("{}={}", parameter.key, parameter.value));
                separator = ',';
            }
            facts.push(parameter);
        }
        Ok((text, facts))
    }

    /// Takes the value that was given under one of the parameter's keys.
    fn take(&mut self, parameter: Declaration) -> Result<Option<String>> {
        let mut value = None;
        for key in parameter.keys.split('|') {
            let text = self.given.remove(&key.to_lowercase());
            if value.is_some() && text.is_some() {
                return Err(given_twice(parameter.keys, self.model));
            }
            value = value.or(text);
        }
        Ok(value)
    }

    /// Notes a parameter, its domain, and the texts of its default and its value.
    fn record(&mut self, parameter: Declaration, domain: String, texts: [String; 2]) {
        let [default, value] = texts;
        let facts = ParameterFacts {
            key: parameter.key(),
            aliases: parameter.keys.split('|').skip(1).collect(),
            domain,
            default,
            value,
            meaning: parameter.meaning,
        };
        self.known.push(KnownParameter {
            facts,
            always_written: true,
        });
    }

    /// Leaves the default of the parameter that was noted last out of the model's text.
    fn hide_default(&mut self) {
        if let Some(known) = self.known.last_mut() {
            known.always_written = false;
        }
    }

    fn outside(&self, parameter: Declaration, value: &str, domain: String) -> Error {
        Error::argument(
            format!("{}={value} of {}", parameter.key(), self.model),
            format!("choose {domain}"),
        )
    }

    fn unknown(&self, key: &str) -> Error {
        let mut names = Vec::with_capacity(self.known.len());
        for known in &self.known {
            names.push(known.facts.key);
        }
        Error::argument(
            format!("{} has no parameter {key}", self.model),
            format!(
                "did you mean {}? It has {}",
                nearest_words(key, &names, 1).join(" or "),
                names.join(", ")
            ),
        )
    }
}

fn given_twice(key: &str, model: &str) -> Error {
    Error::argument(format!("{key} of {model} is given twice"), "give it once")
}

/// One number for a grey, three with slashes for any other colour.
fn write_colour(colour: Rgb) -> String {
    let [r, g, b] = colour.to_array();
    if r == g && g == b {
        format!("{r}")
    } else {
        format!("{r}/{g}/{b}")
    }
}

/// One number or three within `domain`, which a NaN is not.
fn parse_colour(text: &str, domain: &RangeInclusive<f32>) -> Option<Rgb> {
    let mut numbers = Vec::new();
    for piece in text.split('/') {
        let number: f32 = piece.trim().parse().ok()?;
        if !domain.contains(&number) {
            return None;
        }
        numbers.push(number);
    }
    match numbers[..] {
        [all] => Some(Rgb::splat(all)),
        [r, g, b] => Some(Rgb::new(r, g, b)),
        _ => None,
    }
}
