//! The materials of a command that takes many: a folder means the materials in it, and a file that can't be read keeps no other
//! from being done.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::material::Material;

use crate::failure::Outcome;
use crate::output;

/// Names of files that are meant as materials, whatever they hold.
const MATERIAL_EXTENSIONS: [&str; 2] = ["binary", "bsdf"];

/// What could not be read, each with its reason.
#[derive(Debug, Default)]
pub struct Unreadable(Vec<Error>);

impl Unreadable {
    /// Keeps the reason why a material could not be read.
    pub fn push(&mut self, reason: Error) {
        self.0.push(reason);
    }

    /// Ends a command that has done `done` materials: lists what could not be read, with status 2 if there is anything and
    /// `status` otherwise.
    pub fn end(self, done: usize, status: ExitCode) -> Outcome {
        for reason in &self.0 {
            output::message(&format!("merlkit: {reason}"));
        }
        let count = self.0.len();
        if count == 0 {
            return Ok(status);
        }
        if count + done > 1 {
            output::message(&format!(
                "merlkit: {count} of {} materials could not be read",
                count + done
            ));
        }
        Ok(ExitCode::from(2))
    }
}

/// Resolves arguments before any work begins, and reads enough of each file to know that it is whole.
///
/// # Errors
/// That of [`Material::resolve`] for a word that names nothing; [`Error::Io`] for a folder that can't be listed,
/// [`Error::Argument`] for one without materials; the last material's own if none can be read.
pub fn resolve(arguments: &[String]) -> Result<(Vec<Material>, Unreadable), Error> {
    let (mut materials, mut unreadable) = (Vec::new(), Unreadable::default());
    for argument in expand_folders(arguments)? {
        let material = Material::resolve(&argument)?;
        match material.facts() {
            Ok(_) => materials.push(material),
            Err(reason) => unreadable.push(reason),
        }
    }
    if materials.is_empty()
        && let Some(last) = unreadable.0.pop()
    {
        // There is nothing to go on with.
        for reason in &unreadable.0 {
            output::message(&format!("merlkit: {reason}"));
        }
        return Err(last);
    }
    Ok((materials, unreadable))
}

/// The arguments, each folder replaced by the paths of the materials in it, in the order of their names.
///
/// # Errors
/// As [`resolve`].
pub fn expand_folders(arguments: &[String]) -> Result<Vec<String>, Error> {
    let mut out = Vec::new();
    for argument in arguments {
        if Path::new(argument).is_dir() {
            out.extend(materials_in(Path::new(argument))?);
        } else {
            out.push(argument.clone());
        }
    }
    Ok(out)
}

/// Paths of the materials in a folder; says which other files are left out.
fn materials_in(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = std::fs::read_dir(folder).map_err(|e| Error::io(folder, "list", e))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.is_file());
    files.sort();
    let (mut found, mut others) = (Vec::new(), Vec::new());
    for path in files {
        let text = path.to_string_lossy().into_owned();
        if is_meant_as_material(&path) || Material::resolve(&text).is_ok_and(|m| m.facts().is_ok())
        {
            found.push(text);
        } else {
            let name = path.file_name().unwrap_or_default();
            others.push(name.to_string_lossy().into_owned());
        }
    }
    if found.is_empty() {
        return Err(Error::argument(
            format!("{} has no materials in it", folder.display()),
            "name MERL binaries or .bsdf files, or a folder that contains some",
        ));
    }
    if !others.is_empty() {
        output::message(&format!(
            "merlkit: note: {}: skipped files that are not materials: {}",
            folder.display(),
            others.join(", ")
        ));
    }
    Ok(found)
}

fn is_meant_as_material(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    extension.is_some_and(|e| MATERIAL_EXTENSIONS.contains(&e.as_str()))
}
