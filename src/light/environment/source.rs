//! Environments by name: the one place that says which there are, for every command.

use std::path::{Path, PathBuf};

use super::{Environment, SkySampling, broad_lamps, studio};
use crate::color::Rgb;
use crate::error::list_words;
use crate::image::read_exr;
use crate::light::Light;
use crate::light::light_source::{LightSource, Placement};
use crate::{Error, Result};

/// Where an environment's radiance comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// The built-in studio, see [`studio`].
    Studio,
    /// Two broad lamps over a gradient, see [`broad_lamps`].
    BroadLamps,
    /// Equal radiance from everywhere.
    Uniform(Rgb),
    /// An equirectangular OpenEXR file.
    File(PathBuf),
}

impl EnvironmentSource {
    /// The environment that a word names, one of [`Self::words`]: `studio` or `environment`, `lamps`, `uniform` (radiance 1)
    /// or `uniform:RADIANCE` with one number or three for red, green and blue, or the path of an .exr file.
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
    /// Those of [`read_exr`]; [`Error::Argument`] for radiance that is negative or not finite.
    pub fn load_map(&self, sampling: SkySampling) -> Result<Environment> {
        match self {
            Self::Studio => Ok(studio(sampling)),
            Self::BroadLamps => Ok(broad_lamps(sampling)),
            Self::Uniform(radiance) => Environment::uniform(*radiance),
            Self::File(path) => {
                let map = read_exr(path)?;
                Environment::new(map.width(), map.height(), map.into_pixels(), sampling)
            }
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
            let extension = Path::new(word).extension()?;
            extension
                .eq_ignore_ascii_case("exr")
                .then(|| Ok(EnvironmentSource::File(word.into())))
        }
    }
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
                format!("\"{text}\" is no radiance of a uniform environment"),
                "give one number ≥ 0 or three, as in uniform:0.5 or uniform:0.2,0.4,0.8",
            )
        })
}

impl LightSource for EnvironmentSource {
    const WORDS: &'static [&'static str] = &[
        "studio (or environment)",
        "lamps",
        "uniform[:RADIANCE]",
        "FILE.exr",
    ];

    fn from_word(word: &str, _placement: &Placement) -> Option<Result<Self>> {
        read_word(word)
    }

    fn describe(&self) -> String {
        match self {
            Self::Studio => "environment (built-in studio)".into(),
            Self::BroadLamps => "environment (two broad lamps)".into(),
            Self::Uniform(_) => "environment (uniform)".into(),
            Self::File(path) => format!("environment {}", path.display()),
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
            // The built-in ones are; a file's pixels are checked when it is loaded.
            Self::Studio | Self::BroadLamps | Self::File(_) => true,
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
        let file = EnvironmentSource::File("a/sky.Exr".into());
        assert_eq!(named("a/sky.Exr"), file);
    }

    #[test]
    fn other_words_and_radiance_outside_its_domain_are_refused() {
        for (word, expected) in [
            ("sky", "no environment is called \"sky\""),
            ("point", "no environment is called \"point\""),
            ("exr", "no environment"),
            ("uniform:", "no radiance"),
            ("uniform:1,2", "no radiance"),
            ("uniform:-1", "no radiance"),
            ("uniform:nan", "no radiance"),
            ("uniform:inf", "no radiance"),
        ] {
            let error = EnvironmentSource::from_name(word).unwrap_err().to_string();
            assert!(error.contains(expected), "{word}: {error}");
        }
        let error = EnvironmentSource::from_name("x").unwrap_err().to_string();
        assert!(
            error.contains("give studio (or environment), lamps, uniform[:RADIANCE] or FILE.exr")
        );
    }
}
