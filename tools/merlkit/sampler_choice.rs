//! How directions of a material are drawn in a picture: by a sampler that is built, or by one that a file holds.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use merlkit::Error;
use merlkit::files::RegularFile;
use merlkit::material::{Loaded, Material};
use merlkit::sampler::store::{SamplerFile, looks_like_sampler_file};
use merlkit::sampler::{Sampler, SamplerSpec};

use crate::sampler_args;

/// What `--sampler` is followed by where a file may be named.
pub const VALUE: &str = "NAME[:SETTING,…]|FILE";

/// A sampler to build, or a file that holds one.
#[derive(Clone, Debug)]
pub enum SamplerChoice {
    /// Built for each material.
    Built(SamplerSpec),
    /// Read from a file, for the material that it was built for.
    Stored {
        /// The file.
        path: PathBuf,
        /// The method and its settings, as the file records them.
        spec: SamplerSpec,
        /// SHA-256 of the file: another file of the same name makes another picture.
        sha256: String,
    },
}

impl FromStr for SamplerChoice {
    type Err = Error;

    /// # Errors
    /// Those of a sampler's text; for a sampler file those of reading it.
    fn from_str(text: &str) -> Result<Self, Error> {
        let path = Path::new(text);
        if !(path.is_file() && looks_like_sampler_file(path)) {
            return text.parse().map(Self::Built);
        }
        let spec = SamplerFile::open(path)?.record().spec.clone();
        Ok(Self::Stored {
            path: path.to_owned(),
            spec,
            sha256: RegularFile::open(path)?.sha256()?,
        })
    }
}

impl SamplerChoice {
    /// The method and its settings, for people.
    pub fn label(&self) -> String {
        match self {
            Self::Built(spec) => spec.to_string(),
            Self::Stored { path, spec, .. } => format!("{spec} ({})", path.display()),
        }
    }

    /// All that the draws follow from, apart from the material.
    pub fn key(&self) -> String {
        match self {
            Self::Built(spec) => spec.to_string(),
            Self::Stored { spec, sha256, .. } => format!("{spec}, file of SHA-256 {sha256}"),
        }
    }

    /// Refuses, before the work, a material that the sampler can't be built for, or was not built for.
    ///
    /// # Errors
    /// [`Error::Argument`] for such a material; those of reading either file.
    pub fn check_supports(&self, material: &Material) -> Result<(), Error> {
        match self {
            Self::Built(spec) => spec.check_supports(&material.facts()?),
            Self::Stored { path, spec, .. } => {
                spec.check_supports(&material.facts()?)?;
                SamplerFile::open(path)?.check_material(material)
            }
        }
    }

    /// Builds the sampler, or reads it.
    ///
    /// # Errors
    /// Those of [`SamplerSpec::build`], [`SamplerFile::open`] and [`SamplerFile::into_sampler`].
    pub fn build(&self, material: &Loaded) -> Result<Sampler, Error> {
        match self {
            Self::Built(spec) => spec.build(material),
            Self::Stored { path, .. } => SamplerFile::open(path)?.into_sampler(material),
        }
    }
}

/// The sampler of each of `names`: the only one that was given, or one for each in their order.
///
/// # Errors
/// [`Error::Argument`] for another number of samplers, and for a file that serves several materials.
fn assign_samplers(given: &[SamplerChoice], names: &[String]) -> Result<Vec<SamplerChoice>, Error> {
    if let [only] = given {
        let is_stored = matches!(only, SamplerChoice::Stored { .. });
        let several = names.iter().any(|name| *name != names[0]);
        if is_stored && several {
            return Err(Error::argument(
                format!("one sampler file for {} materials", names.len()),
                "pass --sampler once for each material, in their order",
            ));
        }
        return Ok(vec![only.clone(); names.len()]);
    }
    if given.len() != names.len() {
        return Err(Error::argument(
            format!("{} samplers for {} materials", given.len(), names.len()),
            "pass --sampler once, or once for each material, in their order",
        ));
    }
    Ok(given.to_vec())
}

/// The sampler of each material: what the command line gives, or else what a scene file says of the material, or else the default.
///
/// # Errors
/// As [`assign_samplers`], and those of a sampler that the scene names.
pub fn choose_samplers(
    given: &[SamplerChoice],
    said: &[Option<String>],
    names: &[String],
) -> Result<Vec<SamplerChoice>, Error> {
    if !given.is_empty() {
        return assign_samplers(given, names);
    }
    let mut samplers = Vec::with_capacity(names.len());
    for i in 0..names.len() {
        let text = said.get(i).and_then(Option::as_deref);
        samplers.push(text.unwrap_or(sampler_args::DEFAULT).parse()?);
    }
    Ok(samplers)
}

/// The samplers of the materials of one scene, each of which is there once in the order of its first name.
///
/// # Errors
/// [`Error::Argument`] for a material that is named again with another sampler.
pub fn merge_samplers(
    names: &[String],
    samplers: Vec<SamplerChoice>,
) -> Result<Vec<SamplerChoice>, Error> {
    let mut merged: Vec<(&String, SamplerChoice)> = Vec::new();
    for (name, sampler) in names.iter().zip(samplers) {
        match merged.iter().find(|(known, _)| *known == name) {
            None => merged.push((name, sampler)),
            Some((_, first)) if first.key() == sampler.key() => {}
            Some((_, first)) => {
                return Err(Error::argument(
                    format!(
                        "{name} has two samplers in one scene: {}, {}",
                        first.label(),
                        sampler.label()
                    ),
                    "give each material one sampler, or omit --together",
                ));
            }
        }
    }
    Ok(merged.into_iter().map(|(_, sampler)| sampler).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    fn choices(text: &str) -> Vec<SamplerChoice> {
        text.split(' ').map(|word| word.parse().unwrap()).collect()
    }

    fn labels(choices: &[SamplerChoice]) -> Vec<String> {
        choices.iter().map(SamplerChoice::label).collect()
    }

    #[test]
    fn one_sampler_serves_all_and_several_go_one_by_one() {
        let three = names("a b a");
        let all = assign_samplers(&choices("cosine"), &three).unwrap();
        assert_eq!(labels(&all), ["cosine"; 3]);
        let each = assign_samplers(&choices("cosine adaptive-disc cosine"), &three).unwrap();
        let merged = merge_samplers(&three, each).unwrap();
        assert_eq!(labels(&merged), ["cosine", "adaptive-disc"]);
        assert!(assign_samplers(&choices("cosine cosine"), &three).is_err());
        let differing = choices("cosine cosine adaptive-disc");
        assert!(merge_samplers(&three, differing).is_err());
    }
}
