//! What the header of a picture says of where it comes from.

use std::env::consts::{ARCH, OS};

use merlkit::Error;
use merlkit::material::Material;

/// Options with a value that leave the pixels as they are.
const WITH_VALUE: [&str; 4] = ["--threads", "-o", "--output", "--json"];
/// Options without one that do.
const ALONE: [&str; 3] = ["--force", "--resume", "--explain"];

/// Version, command line, and checksum of each material, a line each. The same pixels have the same words: options that say where files
/// go, and how many threads work, are left out.
///
/// # Errors
/// Those of reading a material's file.
pub fn describe(materials: &[Material]) -> Result<String, Error> {
    let mut lines = vec![
        format!("merlkit {}, {ARCH} {OS}", env!("CARGO_PKG_VERSION")),
        format!("command: {}", command(std::env::args().skip(1))),
    ];
    for material in materials {
        let line = format!(
            "material: {}, SHA-256 {}",
            material.name(),
            material.sha256()?
        );
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    Ok(lines.join("\n"))
}

/// The command line as a shell takes it, without what does not change pixels.
fn command(arguments: impl Iterator<Item = String>) -> String {
    let mut words = vec!["merlkit".to_owned()];
    let mut is_value = false;
    for argument in arguments {
        let is_left_out = is_value || ALONE.contains(&argument.as_str());
        is_value = !is_value && WITH_VALUE.contains(&argument.as_str());
        let (name, _) = argument.split_once('=').unwrap_or((&argument, ""));
        let is_short = argument.starts_with("-o") && !argument.starts_with("--");
        if !(is_left_out || is_short || WITH_VALUE.contains(&name)) {
            words.push(quote(&argument));
        }
    }
    words.join(" ")
}

/// The word in quotation marks if a shell would take it apart.
fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./:,=+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let words = command(typed.into_iter().map(str::to_owned));
        assert_eq!(words, "merlkit render nickel 'my file' --spp=4 --seed 3");
        assert_eq!(quote("it's"), "'it'\\''s'");
    }
}
