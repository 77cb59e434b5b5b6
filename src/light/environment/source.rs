//! Environments by name: the one place that says which there are, for every command.

use std::path::{Path, PathBuf};

use super::map_file::load_map_file;
use super::{Environment, RadianceClamp, SkySampling, broad_lamps, studio};
use crate::color::Rgb;
use crate::error::list_words;
use crate::light::Light;
use crate::light::light_source::{LightSource, Placement};
use crate::{Error, Result};

/// Where an environment's radiance comes from.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// The built-in studio, see [`studio`].
    Studio,
    /// Two broad lamps over a gradient, see [`broad_lamps`].
    BroadLamps,
    /// Equal radiance from everywhere.
    Uniform(Rgb),
    /// A map by latitude and longitude, in any format of [`crate::image::read_image`].
    File {
        /// The file.
        path: PathBuf,
        /// What becomes of pixels that are too bright; infinite ones are refused if nothing is said.
        clamp: Option<RadianceClamp>,
    },
}

impl EnvironmentSource {
    /// The environment that a word names, one of [`Self::words`]: `studio` or `environment`, `lamps`, `uniform` (radiance 1)
    /// or `uniform:RADIANCE` with one number or three for red, green and blue, or the path of a file, which may be followed by
    /// `:clamp` ([`RadianceClamp::Infinite`]) or `:clamp=MAX`. A word is a path if it has an extension or a folder's
    /// name, or if there is a file of that name.
    ///
    /// # Errors
    /// [`Error::Argument`] for another word, or for radiance that is negative or not finite.
    pub fn from_name(name: &str) -> Result<Self> {
        read_word(name).unwrap_or_else(|| {
            Err(Error::argument(
                format!("no environment is called \"{name}\""),
                format!("give {}", Self::words()),
            ))
        })
    }

    /// All words that name environments, as a list for people.
    pub fn words() -> String {
        list_words(Self::WORDS)
    }

    /// Loads it.
    ///
    /// # Errors
    /// Those of [`crate::image::read_image`]; [`Error::Unsupported`] for a file that is not twice as wide as high, or with
    /// pixels that are NaN, infinite (unless they are to be clamped) or more negative than compression and resampling leave;
    /// [`Error::Argument`] for radiance that is negative or not finite.
    pub fn load_map(&self, sampling: SkySampling) -> Result<Environment> {
        match self {
            Self::Studio => Ok(studio(sampling)),
            Self::BroadLamps => Ok(broad_lamps(sampling)),
            Self::Uniform(radiance) => Environment::uniform(*radiance),
            Self::File { path, clamp } => load_map_file(path, *clamp, sampling),
        }
    }
}

/// What a word names; `None` if no environment is called so.
fn read_word(word: &str) -> Option<Result<EnvironmentSource>> {
    match word {
        "environment" | "studio" => Some(Ok(EnvironmentSource::Studio)),
        "lamps" => Some(Ok(EnvironmentSource::BroadLamps)),
        "uniform" => Some(Ok(EnvironmentSource::Uniform(Rgb::ONE))),
        _ => {
            if let Some(radiance) = word.strip_prefix("uniform:") {
                return Some(read_radiance(radiance).map(EnvironmentSource::Uniform));
            }
            read_file_word(word)
        }
    }
}

/// A path, with or without `:clamp` or `:clamp=MAX`; `None` if the word is no path.
fn read_file_word(word: &str) -> Option<Result<EnvironmentSource>> {
    let (path, clamp) = match word.rsplit_once(":clamp") {
        // A file's own name goes before.
        _ if Path::new(word).is_file() => (word, Ok(None)),
        Some((path, "")) => (path, Ok(Some(RadianceClamp::Infinite))),
        Some((path, value)) if value.starts_with('=') => (path, read_clamp(&value[1..]).map(Some)),
        _ => (word, Ok(None)),
    };
    names_a_file(path).then(|| {
        Ok(EnvironmentSource::File {
            path: path.into(),
            clamp: clamp?,
        })
    })
}

/// What the file is, its content says; here, whether a file is meant at all. Numbers have no extension, as in `area:2.5`.
fn names_a_file(word: &str) -> bool {
    let path = Path::new(word);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    extension.starts_with(|c: char| c.is_ascii_alphabetic())
        || path.components().count() > 1
        || path.is_file()
}

fn read_clamp(text: &str) -> Result<RadianceClamp> {
    let limit = text.trim().parse().ok();
    limit
        .filter(|r: &f32| r.is_finite() && *r > 0.0)
        .map(RadianceClamp::Above)
        .ok_or_else(|| {
            Error::argument(
                format!("\"{text}\" is not a radiance to clamp to"),
                "give a number > 0, as in sky.exr:clamp=1000, or :clamp alone, which lowers only infinite values",
            )
        })
}

/// One number for all channels, or three with commas between them.
fn read_radiance(text: &str) -> Result<Rgb> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let radiance = match numbers.as_deref() {
        Some(&[grey]) => Some(Rgb::splat(grey)),
        Some(&[red, green, blue]) => Some(Rgb::new(red, green, blue)),
        _ => None,
    };
    radiance
        .filter(|r| r.is_finite() && r.min_element() >= 0.0)
        .ok_or_else(|| {
            Error::argument(
                format!("\"{text}\" is not a radiance of a uniform environment"),
                "give one number ≥ 0 or three, as in uniform:0.5 or uniform:0.2,0.4,0.8",
            )
        })
}

impl LightSource for EnvironmentSource {
    const WORDS: &'static [&'static str] = &[
        "studio",
        "lamps",
        "uniform[:RADIANCE]",
        "FILE[:clamp[=MAX]]",
    ];

    fn from_word(word: &str, _placement: &Placement) -> Option<Result<Self>> {
        read_word(word)
    }

    fn describe(&self) -> String {
        match self {
            Self::Studio => "environment (built-in studio)".into(),
            Self::BroadLamps => "environment (two broad lamps)".into(),
            Self::Uniform(_) => "environment (uniform)".into(),
            Self::File { path, .. } => format!("environment {}", path.display()),
        }
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn is_dark(&self) -> bool {
        matches!(self, Self::Uniform(radiance) if *radiance == Rgb::ZERO)
    }

    fn is_valid(&self) -> bool {
        match self {
            Self::Uniform(radiance) => radiance.is_finite() && radiance.min_element() >= 0.0,
            Self::File {
                clamp: Some(RadianceClamp::Above(limit)),
                ..
            } => limit.is_finite() && *limit > 0.0,
            // The built-in ones are; a file's pixels are checked when it is loaded.
            Self::Studio | Self::BroadLamps | Self::File { .. } => true,
        }
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn load(&self, sampling: SkySampling) -> Result<Box<dyn Light>> {
        Ok(Box::new(self.load_map(sampling)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_their_environments() {
        let named = |word| EnvironmentSource::from_name(word).unwrap();
        assert_eq!(named("environment"), EnvironmentSource::Studio);
        assert_eq!(named("studio"), EnvironmentSource::Studio);
        assert_eq!(named("lamps"), EnvironmentSource::BroadLamps);
        assert_eq!(named("uniform"), EnvironmentSource::Uniform(Rgb::ONE));
        let grey = EnvironmentSource::Uniform(Rgb::splat(0.25));
        assert_eq!(named("uniform:0.25"), grey);
        let blue = EnvironmentSource::Uniform(Rgb::new(0.0, 0.5, 1e3));
        assert_eq!(named("uniform:0, 0.5, 1e3"), blue);
        let file = |path: &str, clamp| EnvironmentSource::File {
            path: path.into(),
            clamp,
        };
        assert_eq!(named("a/sky.Exr"), file("a/sky.Exr", None));
        assert_eq!(named("sky.jpg"), file("sky.jpg", None));
        assert_eq!(named("a/sky"), file("a/sky", None));
        let infinite = Some(RadianceClamp::Infinite);
        assert_eq!(named("a:b.hdr:clamp"), file("a:b.hdr", infinite));
        let above = Some(RadianceClamp::Above(100.0));
        assert_eq!(named("sky.hdr:clamp=1e2"), file("sky.hdr", above));
        assert_eq!(named("sky.hdr:clamped"), file("sky.hdr:clamped", None));
    }

    #[test]
    fn other_words_and_radiance_outside_its_domain_are_refused() {
        for (word, expected) in [
            ("sky", "no environment is called \"sky\""),
            ("point", "no environment is called \"point\""),
            ("exr", "no environment"),
            ("studio:2.5", "no environment"),
            ("studio:clamp", "no environment"),
            ("sky.exr:clamp=0", "not a radiance to clamp to"),
            ("sky.exr:clamp=inf", "not a radiance to clamp to"),
            ("sky.exr:clamp=", "not a radiance to clamp to"),
            ("uniform:", "not a radiance"),
            ("uniform:1,2", "not a radiance"),
            ("uniform:-1", "not a radiance"),
            ("uniform:nan", "not a radiance"),
            ("uniform:inf", "not a radiance"),
        ] {
            let error = EnvironmentSource::from_name(word).unwrap_err().to_string();
            assert!(error.contains(expected), "{word}: {error}");
        }
        let error = EnvironmentSource::from_name("x").unwrap_err().to_string();
        assert!(error.contains("give studio, lamps, uniform[:RADIANCE] or FILE[:clamp"));
    }
}
