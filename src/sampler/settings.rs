//! Settings of samplers as text: `64KB,rows=50`.
//!
//! A method declares each of its settings once, as a [`Field`]: key, domain, meaning, and how it is read and written. Parsing,
//! printing, the checks of domains, the list that `merlkit samplers NAME` prints and all errors follow from that declaration.

use std::fmt::Display;
use std::ops::{Bound, RangeBounds, RangeInclusive};
use std::str::FromStr;

use serde::Serialize;

use super::knots::TableChoice;
use crate::Error;
use crate::brdf::Importance;
use crate::error::list_words;

/// Settings with a name.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
#[derive(Clone, Debug)]
pub struct Preset<S> {
    /// The word that selects them, in front of other settings.
    pub name: &'static str,
    /// What they are, without a full stop.
    pub meaning: String,
    /// The settings.
    pub settings: S,
}

impl<S> Preset<S> {
    /// A preset by its name and meaning.
    pub fn new(name: &'static str, meaning: impl Into<String>, settings: S) -> Self {
        Self {
            name,
            meaning: meaning.into(),
            settings,
        }
    }

    /// What a list of presets says about it.
    pub(super) fn facts(self) -> PresetFacts {
        PresetFacts {
            name: self.name,
            meaning: self.meaning,
        }
    }
}

/// One setting of `S`.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
pub struct Field<S> {
    key: &'static str,
    meaning: &'static str,
    domain: String,
    /// Values that may be given without the key, which is how they are printed.
    words: Vec<&'static str>,
    always_shown: bool,
    get: Box<dyn Fn(&S) -> String>,
    set: SetText<S>,
}

/// Sets a value from its text, and answers whether the text was understood and within the domain; if not, nothing is set.
type SetText<S> = Box<dyn Fn(&mut S, &str) -> bool>;

impl<S: 'static> Field<S> {
    /// A setting with a text of its own form, which `domain` describes. `set` answers whether it understood a text and found
    /// it within the domain.
    pub fn form(
        key: &'static str,
        domain: impl Into<String>,
        meaning: &'static str,
        get: impl Fn(&S) -> String + 'static,
        set: impl Fn(&mut S, &str) -> bool + 'static,
    ) -> Self {
        Self {
            key,
            meaning,
            domain: domain.into(),
            words: Vec::new(),
            always_shown: false,
            get: Box::new(get),
            set: Box::new(set),
        }
    }

    /// A number of things within a range.
    pub fn count(
        key: &'static str,
        range: RangeInclusive<usize>,
        meaning: &'static str,
        get: fn(&S) -> usize,
        set: fn(&mut S, usize),
    ) -> Self {
        let domain = describe(&range);
        let set = move |settings: &mut S, text: &str| {
            let value = parse_within(text, &range);
            value.map(|value| set(settings, value)).is_some()
        };
        Self::form(key, domain, meaning, move |s| get(s).to_string(), set)
    }

    /// A number of things within a range, or the word `absent` for none.
    pub fn optional_count(
        key: &'static str,
        absent: &'static str,
        range: RangeInclusive<usize>,
        meaning: &'static str,
        get: fn(&S) -> Option<usize>,
        set: fn(&mut S, Option<usize>),
    ) -> Self {
        let domain = format!("{absent}, or {}", describe(&range));
        let set = move |settings: &mut S, text: &str| {
            let value = parse_optional(text, absent, &range);
            value.map(|value| set(settings, value)).is_some()
        };
        Self::form(key, domain, meaning, move |s| show(get(s), absent), set)
    }

    /// A finite real number within a range.
    pub fn real(
        key: &'static str,
        range: impl RangeBounds<f64> + 'static,
        meaning: &'static str,
        get: fn(&S) -> f64,
        set: fn(&mut S, f64),
    ) -> Self {
        let domain = describe(&range);
        let set = move |settings: &mut S, text: &str| {
            let value = parse_within(text, &range).filter(|value| f64::is_finite(*value));
            value.map(|value| set(settings, value)).is_some()
        };
        Self::form(key, domain, meaning, move |s| get(s).to_string(), set)
    }

    /// A real number within a range, infinity among them if the range has no end, or the word `absent` for none.
    pub fn optional_real(
        key: &'static str,
        absent: &'static str,
        range: impl RangeBounds<f64> + 'static,
        meaning: &'static str,
        get: fn(&S) -> Option<f64>,
        set: fn(&mut S, Option<f64>),
    ) -> Self {
        let domain = format!("{absent}, or {}", describe(&range));
        let set = move |settings: &mut S, text: &str| {
            let value = parse_optional(text, absent, &range);
            value.map(|value| set(settings, value)).is_some()
        };
        Self::form(key, domain, meaning, move |s| show(get(s), absent), set)
    }

    /// One of a few values that have names.
    pub fn choice<T: Copy + PartialEq + 'static>(
        key: &'static str,
        values: &'static [(&'static str, T)],
        meaning: &'static str,
        get: fn(&S) -> T,
        set: fn(&mut S, T),
    ) -> Self {
        let names: Vec<&str> = values.iter().map(|v| v.0).collect();
        let get = move |settings: &S| {
            let value = get(settings);
            let named = values.iter().find(|v| v.1 == value);
            named.map_or_else(String::new, |v| v.0.to_owned())
        };
        let set = move |settings: &mut S, text: &str| {
            let named = values.iter().find(|v| v.0.eq_ignore_ascii_case(text));
            named.map(|v| set(settings, v.1)).is_some()
        };
        Self::form(key, list_words(&names), meaning, get, set)
    }

    /// Allows each of these values without the key.
    #[must_use]
    pub fn standing_alone(mut self, words: &[&'static str]) -> Self {
        self.words = words.to_vec();
        self
    }

    /// Prints the value even where it is that of the default.
    #[must_use]
    pub fn always_shown(mut self) -> Self {
        self.always_shown = true;
        self
    }

    /// The word in front of the `=`.
    pub(super) fn key(&self) -> &'static str {
        self.key
    }

    /// The value, as text.
    pub(super) fn value(&self, settings: &S) -> String {
        (self.get)(settings)
    }

    /// Sets the value from its text, and answers whether the text was understood and within the domain.
    pub(super) fn set(&self, settings: &mut S, text: &str) -> bool {
        (self.set)(settings, text)
    }

    /// What a list of settings says about it.
    pub(super) fn facts(self, default: &S) -> SettingFacts {
        SettingFacts {
            key: self.key,
            default: self.value(default),
            standing_alone: self.words,
            domain: self.domain,
            meaning: self.meaning,
        }
    }

    /// The setting as it is printed: the value alone, or behind its key.
    fn text(&self, settings: &S) -> String {
        let value = self.value(settings);
        if self.words.contains(&value.as_str()) {
            value
        } else {
            format!("{}={value}", self.key)
        }
    }

    /// The error for a value outside the domain.
    pub(super) fn refused(&self, name: &str, value: &str) -> Error {
        Error::argument(
            format!("{}={value} is outside the domain of {name}", self.key),
            format!("choose {}", self.domain),
        )
    }
}

/// The setting that most methods have: the scalar of a colour that draws are proportional to.
pub(super) fn importance<S: 'static>(
    get: fn(&S) -> Importance,
    set: fn(&mut S, Importance),
) -> Field<S> {
    Field::choice(
        "importance",
        &[
            ("mean", Importance::Mean),
            ("luminance", Importance::Luminance),
        ],
        "scalar that draws are proportional to, of red, green and blue",
        get,
        set,
    )
    .standing_alone(&["mean", "luminance"])
}

/// The setting of methods that spend some draws on the cosine.
pub(super) fn floor<S: 'static>(get: fn(&S) -> f64, set: fn(&mut S, f64)) -> Field<S> {
    let meaning = "fraction of draws that follow the cosine, so that no direction is left out";
    Field::real("floor", 0.0..=1.0, meaning, get, set)
}

/// The setting of methods that have tables at several polar angles of `wo`.
pub(super) fn table_choice<S: 'static>(
    get: fn(&S) -> TableChoice,
    set: fn(&mut S, TableChoice),
) -> Field<S> {
    Field::choice(
        "choice",
        &[
            ("mixture", TableChoice::Mixture),
            ("nearest", TableChoice::Nearest),
        ],
        "what is used for a wo between two tables",
        get,
        set,
    )
    .standing_alone(&["mixture", "nearest"])
}

/// What a list of settings says about one of them.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SettingFacts {
    /// The word in front of the `=`.
    pub key: &'static str,
    /// Values that may be given without the key.
    pub standing_alone: Vec<&'static str>,
    /// What values there are.
    pub domain: String,
    /// The value by default.
    pub default: String,
    /// What it does, without a full stop.
    pub meaning: &'static str,
}

/// What a list of settings says about a preset.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) asks a method for its settings and needs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PresetFacts {
    /// The word that selects the settings.
    pub name: &'static str,
    /// What they are.
    pub meaning: String,
}

/// The settings in which `settings` differs from `base`, and those that are always shown, as they are printed.
pub(super) fn differing_words<S: 'static>(
    fields: &[Field<S>],
    base: &S,
    settings: &S,
) -> Vec<String> {
    let mut words = Vec::new();
    for field in fields {
        if field.always_shown || field.value(base) != field.value(settings) {
            words.push(field.text(settings));
        }
    }
    words
}

/// The setting that an item of a text names, and the value it gives.
pub(super) fn find_field<'a, S>(
    fields: &'a [Field<S>],
    item: &'a str,
) -> Option<(&'a Field<S>, &'a str)> {
    if let Some((key, value)) = item.split_once('=') {
        let field = fields
            .iter()
            .find(|f| f.key.eq_ignore_ascii_case(key.trim()))?;
        return Some((field, value.trim()));
    }
    for field in fields {
        if field.words.iter().any(|w| w.eq_ignore_ascii_case(item)) {
            return Some((field, item));
        }
    }
    None
}

/// The error for an item that names no setting, with what it may have meant.
pub(super) fn unknown_setting<S>(
    name: &str,
    fields: &[Field<S>],
    presets: &[Preset<S>],
    item: &str,
) -> Error {
    let list = format!("`merlkit samplers {name}` lists what can be set");
    let (key, has_value) = match item.split_once('=') {
        Some((key, _)) => (key.trim(), true),
        None => (item, false),
    };
    if item.is_empty() {
        return Error::argument(
            format!("{name} is followed by an empty setting"),
            format!("leave out the colon or comma; {list}"),
        );
    }
    if let Some(field) = fields.iter().find(|f| !has_value && f.key == key) {
        return Error::argument(
            format!("{key} of {name} has no value"),
            format!("write {key}=VALUE, which is {}", field.domain),
        );
    }
    let mut words: Vec<&str> = fields.iter().map(|f| f.key).collect();
    words.extend(fields.iter().flat_map(|f| f.words.iter().copied()));
    words.extend(presets.iter().map(|p| p.name));
    let fix = match most_alike(key, &words) {
        Some(word) => format!("did you mean {word}? {list}"),
        None if words.is_empty() => "write its name alone".to_owned(),
        None => list,
    };
    Error::argument(format!("no setting of {name} is called {key}"), fix)
}

/// The word that is spelt most like `word`, if any is similar at all.
pub(super) fn most_alike<'a>(word: &str, words: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let mut best = None;
    let mut most = 0.7;
    for &other in words {
        let likeness = strsim::jaro_winkler(&word, &other.to_lowercase());
        // The last of equals, if any is above the least likeness that counts.
        if likeness > 0.7 && likeness >= most {
            (best, most) = (Some(other), likeness);
        }
    }
    best
}

/// A number from its text, if it lies within a range.
fn parse_within<T: FromStr + PartialOrd>(text: &str, range: &impl RangeBounds<T>) -> Option<T> {
    text.parse().ok().filter(|value| range.contains(value))
}

/// A number within a range, or `Some(None)` for the word that means none.
fn parse_optional<T: FromStr + PartialOrd>(
    text: &str,
    absent: &str,
    range: &impl RangeBounds<T>,
) -> Option<Option<T>> {
    if text.eq_ignore_ascii_case(absent) {
        Some(None)
    } else {
        parse_within(text, range).map(Some)
    }
}

/// A number, or the word for none.
fn show<T: Display>(value: Option<T>, absent: &str) -> String {
    value.map_or_else(|| absent.to_owned(), |value| value.to_string())
}

/// A range in words: "1 to 1024", "above 1", "from 0 to below 1".
fn describe<T: Display>(range: &impl RangeBounds<T>) -> String {
    match (range.start_bound(), range.end_bound()) {
        (Bound::Included(low), Bound::Included(high)) => format!("{low} to {high}"),
        (Bound::Included(low), Bound::Excluded(high)) => format!("{low} to below {high}"),
        (Bound::Excluded(low), Bound::Included(high)) => format!("above {low}, up to {high}"),
        (Bound::Excluded(low), Bound::Excluded(high)) => format!("above {low} and below {high}"),
        (Bound::Included(low), Bound::Unbounded) => format!("{low} or more"),
        (Bound::Excluded(low), Bound::Unbounded) => format!("above {low}"),
        (Bound::Unbounded, Bound::Included(high)) => format!("at most {high}"),
        (Bound::Unbounded, Bound::Excluded(high)) => format!("below {high}"),
        (Bound::Unbounded, Bound::Unbounded) => "any number".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_described_in_words() {
        assert_eq!(describe(&(1..=1024)), "1 to 1024");
        assert_eq!(describe(&(0.0..1.0)), "0 to below 1");
        assert_eq!(describe(&(0.0..)), "0 or more");
        let above = (Bound::Excluded(1.0), Bound::Unbounded);
        assert_eq!(describe(&above), "above 1");
    }

    #[test]
    fn words_are_listed() {
        assert_eq!(list_words(&["a"]), "a");
        assert_eq!(list_words(&["a", "b"]), "a or b");
        assert_eq!(list_words(&["a", "b", "c"]), "a, b or c");
    }
}
