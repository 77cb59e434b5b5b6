//! A picture that Ctrl-C stops: kept as far as it is, with what it needs to go on, and gone on with by `render --resume`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use merlkit::Error;
use merlkit::files::{Overwrite, RegularFile, check_writable};
use merlkit::material::{Material, Origin};
use merlkit::render::{Refinement, Rendering};

use crate::failure::Failure;
use crate::interrupt::StoppableWork;
use crate::output;
use crate::picture::{Files, Picture, map_file};
use crate::provenance;
use crate::render_costs::CostStage;

/// Shown when a signal comes.
const STOPPING: &str = "merlkit: stopping once every pixel has the same number of paths (press Ctrl-C again to stop now and discard the picture)";

/// A picture, its files, and whether it goes on.
pub struct Resumable<'a> {
    /// The picture.
    pub picture: &'a Picture<'a>,
    /// Its files.
    pub files: &'a Files,
    /// Whether existing pictures may be replaced.
    pub overwrite: Overwrite,
    /// Whether an unfinished picture is to be finished.
    pub resume: bool,
}

/// Refuses, before the work, to go on with nothing, and to begin where an unfinished picture lies.
///
/// # Errors
/// [`Error::Argument`] for both; otherwise as [`Files::check`].
pub fn check_files(files: &Files, overwrite: Overwrite, resume: bool) -> Result<(), Error> {
    let partial = files.partial.display();
    match (resume, files.partial.exists()) {
        (true, false) => Err(Error::argument(
            format!("nothing to resume: there is no {partial}"),
            "omit --resume to start a new picture, or name the output of the interrupted one",
        )),
        (false, true) => Err(Error::argument(
            format!("{partial} is the saved state of an interrupted render"),
            "continue with --resume, or remove the file to start again",
        )),
        (true, true) => {
            check_writable(&files.partial, Overwrite::Replace)?;
            files.check(Overwrite::Replace)
        }
        (false, false) => files.check(overwrite),
    }
}

impl Resumable<'_> {
    /// Loads, renders, and writes the pictures. On a signal it writes what there is, says how to go on, and does not return.
    /// Returns how far the picture came, given a target error.
    ///
    /// # Errors
    /// Those of loading, building, rendering and writing, and of [`Rendering::restore`].
    pub fn render(&self) -> Result<Option<Refinement>, Failure> {
        let sources = Sources::of_picture(self.picture);
        let scene = self.picture.load()?;
        let mut rendering = Rendering::begin(&scene, &self.picture.settings)?;
        if self.resume {
            rendering.restore(&self.files.partial, &self.facts(&sources)?)?;
        }
        let work = StoppableWork::begin(STOPPING);
        let progress = self.picture.progress();
        let advance = |pixels| progress.advance_by(pixels);
        let start = Instant::now();
        let finished = rendering.advance(&|| work.should_stop(), &advance);
        if let Some(costs) = self.picture.costs {
            costs.add(CostStage::Rendering, start);
        }
        drop(progress);
        let outcome = if finished {
            self.write(rendering)
        } else {
            self.keep(rendering, &sources).map(|()| None)
        };
        match outcome {
            Ok(refinement) => work.end(Ok(())).map(|()| refinement),
            Err(error) => work.end(Err(error.into())).map(|()| None),
        }
    }

    /// Writes a finished picture; what it needed to go on is needed no more.
    fn write(&self, rendering: Rendering<'_>) -> Result<Option<Refinement>, Error> {
        let rendered = rendering.into_rendered();
        let overwrite = if self.resume {
            Overwrite::Replace
        } else {
            self.overwrite
        };
        let image = rendered.film.to_image()?;
        self.files
            .write(image, &self.picture.finish, None, overwrite)?;
        if self.resume {
            let partial = &self.files.partial;
            fs::remove_file(partial).map_err(|e| Error::io(partial, "remove", e))?;
        }
        Ok(rendered.refinement)
    }

    /// Writes an unfinished picture: first what it needs to go on.
    fn keep(&self, rendering: Rendering<'_>, sources: &Sources) -> Result<(), Error> {
        rendering.save(&self.files.partial, &self.facts(sources)?)?;
        let done = rendering.describe_progress();
        let comment = unfinished(&format!("{done}, seed {}", self.picture.settings.seed));
        let image = rendering.into_rendered().film.to_image()?;
        // Another picture may have come there meanwhile, unless it is the one that is gone on with.
        let overwrite = if self.resume {
            Overwrite::Replace
        } else {
            self.overwrite
        };
        self.files
            .write(image, &self.picture.finish, Some(comment), overwrite)?;
        output::message(&format!(
            "merlkit: {} has {done}; the same command with --resume finishes it",
            self.files.exr.display()
        ));
        Ok(())
    }

    /// All that the pixels follow from, apart from the settings.
    fn facts(&self, sources: &Sources) -> Result<Vec<(String, String)>, Error> {
        let picture = self.picture;
        let scene = &picture.scene;
        let mut facts = picture.facts();
        for (name, material) in scene.materials.iter().zip(picture.materials) {
            let sum = match material.origin() {
                Origin::File(path) => sources.checksum(path)?,
                Origin::Embedded(_) | Origin::Formula(_) => material.sha256()?,
            };
            facts.push((format!("material {name}"), sum));
        }
        for path in scene.lights.iter().filter_map(map_file) {
            let name = format!("light {}", path.display());
            facts.push((name, sources.checksum(path)?));
        }
        Ok(facts)
    }
}

/// The files that a picture is made from, and when they were written last. Their checksums are taken when they are needed, which
/// is seldom.
struct Sources {
    written: Vec<(PathBuf, Option<SystemTime>)>,
}

impl Sources {
    /// As they are now, before they are loaded.
    fn of_picture(picture: &Picture<'_>) -> Self {
        let materials = picture.materials.iter().filter_map(material_file);
        let lights = picture.scene.lights.iter().filter_map(map_file);
        let mut written = Vec::new();
        for path in materials.chain(lights) {
            written.push((path.to_owned(), time_written(path)));
        }
        Self { written }
    }

    /// SHA-256 of a file; of one that was written since, words that are no checksum, so that nobody goes on with it.
    fn checksum(&self, path: &Path) -> Result<String, Error> {
        let is_unchanged = self
            .written
            .iter()
            .any(|(known, time)| known == path && time.is_some() && *time == time_written(path));
        if is_unchanged {
            RegularFile::open(path)?.sha256()
        } else {
            Ok("a file that was changed during the render".into())
        }
    }
}

fn time_written(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|m| m.modified()).ok()
}

fn material_file(material: &Material) -> Option<&Path> {
    match material.origin() {
        Origin::File(path) => Some(path),
        Origin::Embedded(_) | Origin::Formula(_) => None,
    }
}

/// The comment of a picture that is not finished.
pub fn unfinished(done: &str) -> String {
    format!("unfinished: {done}; to finish it: {}", command_to_resume())
}

/// The command of this process with `--resume`, as a shell takes it.
fn command_to_resume() -> String {
    let mut arguments = provenance::arguments();
    if !arguments.iter().any(|argument| argument == "--resume") {
        arguments.push("--resume".into());
    }
    provenance::write_command(&arguments)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_changed_has_no_checksum() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "abc").unwrap();
        let sources = Sources {
            written: vec![(path.clone(), time_written(&path))],
        };
        assert!(sources.checksum(&path).unwrap().starts_with("ba7816bf"));
        let later = SystemTime::now() + std::time::Duration::from_secs(5);
        let file = fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(later).unwrap();
        assert!(sources.checksum(&path).unwrap().contains("changed"));
    }
}
