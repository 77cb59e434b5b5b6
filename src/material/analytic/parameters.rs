//! The parameters of a formula: read from text, checked against their domains, and written out in full.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::color::Rgb;
use crate::{Error, Result};

/// Parameters as they were given; a model asks for each of those that it has.
pub(super) struct Parameters {
    model: &'static str,
    given: BTreeMap<String, String>,
    /// Those asked for so far, with their values, as they are written out.
    known: Vec<(&'static str, String)>,
}

impl Parameters {
    /// Takes "key=value,key=value" apart; the text may be empty.
    ///
    /// # Errors
    /// [`Error::Argument`] for a piece that is no key=value, and for a key that is given twice.
    pub fn parse(model: &'static str, text: &str) -> Result<Self> {
        let mut given = BTreeMap::new();
        for piece in text.split(',').map(str::trim).filter(|p| !p.is_empty()) {
            let Some((key, value)) = piece.split_once('=') else {
                return Err(Error::argument(
                    format!("\"{piece}\" is no parameter of {model}"),
                    "write parameters as key=value",
                ));
            };
            let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
            if given.contains_key(&key) {
                return Err(Error::argument(
                    format!("{key} of {model} is given twice"),
                    "give it once",
                ));
            }
            given.insert(key, value);
        }
        Ok(Self {
            model,
            given,
            known: Vec::new(),
        })
    }

    /// A linear RGB colour: one number for all channels, or three with slashes, as in 0.8/0.5/0.2.
    ///
    /// # Errors
    /// [`Error::Argument`] for what is no such number, or is outside `domain`.
    pub fn colour(
        &mut self,
        key: &'static str,
        domain: RangeInclusive<f32>,
        default: f32,
    ) -> Result<Rgb> {
        let colour = match self.given.remove(key) {
            None => Rgb::splat(default),
            Some(value) => match parse_colour(&value, &domain) {
                Some(colour) => colour,
                None => return Err(self.outside(key, &value, &domain)),
            },
        };
        let [r, g, b] = colour.to_array();
        let text = if r == g && g == b {
            format!("{r}")
        } else {
            format!("{r}/{g}/{b}")
        };
        self.known.push((key, text));
        Ok(colour)
    }

    /// The model's text with every parameter, once the model has asked for all that it has.
    ///
    /// # Errors
    /// [`Error::Argument`] for a parameter that the model did not ask for.
    pub fn finish(self) -> Result<String> {
        if let Some(key) = self.given.keys().next() {
            let names: Vec<&str> = self.known.iter().map(|(key, _)| *key).collect();
            return Err(Error::argument(
                format!("{} has no parameter {key}", self.model),
                format!("choose from {}", names.join(", ")),
            ));
        }
        let mut text = self.model.to_owned();
        for (number, (key, value)) in self.known.iter().enumerate() {
            text.push(if number == 0 { ':' } else { ',' });
            text.push_str(&format!("{key}={value}"));
        }
        Ok(text)
    }

    fn outside(&self, key: &str, value: &str, domain: &RangeInclusive<f32>) -> Error {
        Error::argument(
            format!("{key}={value} of {}", self.model),
            format!(
                "choose one number of {} to {}, or three with slashes for red, green and blue",
                domain.start(),
                domain.end()
            ),
        )
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
