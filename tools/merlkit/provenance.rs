//! What files say of where they come from.

use std::collections::HashMap;
use std::env::consts::{ARCH, OS};

use merlkit::Error;
use merlkit::material::Material;
use merlkit_evaluate::report::{MaterialChecksum, Provenance};

use crate::machine;

/// Options with a value that leave the pixels as they are.
const WITH_VALUE: [&str; 6] = ["--threads", "-o", "--output", "--json", "--csv", "--page"];
/// Options without one that do.
const ALONE: [&str; 3] = ["--force", "--resume", "--explain"];

/// Checksums of materials, each of which is taken once in a command.
#[derive(Default)]
pub struct Checksums {
    /// By the origins of the materials.
    known: HashMap<String, String>,
}

impl Checksums {
    /// The SHA-256 of a material in hexadecimal.
    ///
    /// # Errors
    /// As [`Material::sha256`].
    pub fn find(&mut self, material: &Material) -> Result<String, Error> {
        let origin = format!("{:?}", material.origin());
        if let Some(sum) = self.known.get(&origin) {
            return Ok(sum.clone());
        }
        let sum = material.sha256()?;
        self.known.insert(origin, sum.clone());
        Ok(sum)
    }
}

/// Version and command line.
pub fn record_command() -> Provenance {
    Provenance {
        version: env!("CARGO_PKG_VERSION").into(),
        command: write_command(&select(arguments())),
        ..Provenance::default()
    }
}

/// Version, command line, seed, and checksum of each material, once.
///
/// # Errors
/// Those of reading a material's file.
pub fn record(seed: Option<u64>, materials: &[Material]) -> Result<Provenance, Error> {
    let mut provenance = Provenance {
        seed,
        ..record_command()
    };
    let mut sums = Checksums::default();
    for material in materials {
        let one = MaterialChecksum {
            material: material.name().to_owned(),
            sha256: sums.find(material)?,
        };
        if !provenance.materials.contains(&one) {
            provenance.materials.push(one);
        }
    }
    Ok(provenance)
}

/// The same with the day and the machine, for times that were measured.
///
/// # Errors
/// As [`record`].
pub fn record_timed(seed: u64, materials: &[Material]) -> Result<Provenance, Error> {
    Ok(Provenance {
        date: Some(machine::today()),
        machine: Some(machine::detect()),
        ..record(Some(seed), materials)?
    })
}

/// Version, command line, and checksum of each material, a line each. The same pixels have the same words: options that say where files
/// go, and how many threads work, are left out.
///
/// # Errors
/// Those of reading a material's file.
pub fn describe(materials: &[Material], sums: &mut Checksums) -> Result<String, Error> {
    let mut lines = vec![
        format!("merlkit {}, {ARCH} {OS}", env!("CARGO_PKG_VERSION")),
        format!("command: {}", write_command(&select(arguments()))),
    ];
    for material in materials {
        let line = format!(
            "material: {}, SHA-256 {}",
            material.name(),
            sums.find(material)?
        );
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    Ok(lines.join("\n"))
}

/// The arguments of this process; what is no text is replaced.
pub fn arguments() -> Vec<String> {
    let mut arguments = Vec::new();
    for argument in std::env::args_os().skip(1) {
        arguments.push(argument.to_string_lossy().into_owned());
    }
    arguments
}

/// A command line of this program as a shell takes it.
pub fn write_command(arguments: &[String]) -> String {
    let mut words = vec!["merlkit".to_owned()];
    for argument in arguments {
        words.push(quote(argument));
    }
    words.join(" ")
}

/// The arguments without those that leave the pixels as they are.
fn select(arguments: Vec<String>) -> Vec<String> {
    let mut selected = Vec::new();
    let mut is_value = false;
    for argument in arguments {
        let is_left_out = is_value || ALONE.contains(&argument.as_str());
        is_value = !is_value && WITH_VALUE.contains(&argument.as_str());
        let name = argument.split('=').next().unwrap_or_default();
        let is_output = argument.starts_with("-o");
        if !(is_left_out || is_output || WITH_VALUE.contains(&name)) {
            selected.push(argument);
        }
    }
    selected
}

/// Whether no shell gives the character a meaning.
fn is_plain(c: char) -> bool {
    c.is_ascii_alphanumeric() || "-_./:=,%+".contains(c)
}

/// A word as a shell takes it.
fn quote(word: &str) -> String {
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(
            quote("lambert:reflectance=0.8/0.5"),
            "lambert:reflectance=0.8/0.5"
        );
        assert_eq!(quote("my file.exr"), "'my file.exr'");
        assert_eq!(quote("it's"), "'it'\\''s'");
        assert_eq!(quote(""), "''");
    }

    #[test]
    fn commands_are_those_that_make_the_same_pixels() {
        let typed = [
            "render",
            "nickel",
            "my file",
            "--threads",
            "2",
            "--spp=4",
            "-o",
            "a.exr",
            "--force",
            "-ob",
            "--output=c",
            "--seed",
            "3",
        ];
        let words = write_command(&select(typed.map(str::to_owned).to_vec()));
        assert_eq!(words, "merlkit render nickel 'my file' --spp=4 --seed 3");
    }
}
