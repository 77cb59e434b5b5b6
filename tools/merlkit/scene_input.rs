//! The scene file of a command.

use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit::files::RegularFile;
use merlkit::render::SceneSpec;
use merlkit_scene::SceneDescription;

use crate::output;
use crate::picture::Files;

/// A scene that was read from a file.
pub struct SceneInput {
    /// The scene, without the mirrors, the depth and the strategy.
    pub spec: SceneSpec,
    /// Samplers of its materials, where the file says any.
    pub samplers: Vec<Option<String>>,
    /// The line of headers that names the file.
    signature: String,
}

impl SceneInput {
    /// Builds a scene that was read from `path`, and says how many triangles were left out.
    ///
    /// # Errors
    /// As [`SceneDescription::build`], and those of reading the file.
    pub fn build(path: &Path, scene: &SceneDescription) -> Result<Self, Error> {
        let built = scene.build()?;
        if built.dropped > 0 {
            output::message(&format!(
                "merlkit: {} of {} triangles have no area and were left out",
                built.dropped,
                built.dropped + built.triangles
            ));
        }
        let sum = RegularFile::open(path)?.sha256()?;
        Ok(Self {
            spec: built.spec,
            samplers: scene.samplers.clone(),
            signature: format!("scene: {}, SHA-256 {sum}", path.display()),
        })
    }

    /// The same files, whose headers name the scene as well.
    pub fn sign(&self, files: Files) -> Files {
        let words = files.provenance.iter().chain([&self.signature]);
        let words: Vec<&str> = words.map(String::as_str).collect();
        Files {
            provenance: Some(words.join("\n")),
            ..files
        }
    }
}

/// The scene file among some arguments, if there is one.
///
/// # Errors
/// [`Error::Argument`] for a scene file that is not alone.
pub fn find_scene_file(arguments: &[String]) -> Result<Option<PathBuf>, Error> {
    let is_scene = arguments.iter().any(|argument| {
        Path::new(argument)
            .extension()
            .is_some_and(|e| e == "toml" || e == "grf")
    });
    match (is_scene, arguments) {
        (false, _) => Ok(None),
        (true, [scene]) => Ok(Some(scene.into())),
        (true, _) => Err(Error::argument(
            "a scene file and other materials",
            "name the scene file alone: it says which materials it needs",
        )),
    }
}
