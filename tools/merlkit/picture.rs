//! Rendering a scene to files: what `render` and `demo` share.

use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable};
use merlkit::image::{Image, write_exr, write_png};
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::render::{PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit::sampler::SamplerSpec;

use crate::args;
use crate::progress::Progress;
use crate::sky::print_notes;

/// A scene and everything its picture depends on.
pub struct Picture<'a> {
    /// The scene; nothing is loaded.
    pub scene: &'a SceneSpec,
    /// Which effects will be computed.
    pub effects: PlanRequest,
    /// Materials in the order of the scene's.
    pub materials: &'a [Material],
    /// What tables say between their samples.
    pub lookup: LookupRule,
    /// How directions are drawn, where any are.
    pub sampler: &'a SamplerSpec,
    /// Size, seed and budget of paths.
    pub settings: RenderSettings,
    /// Exposure of the PNG, stops.
    pub exposure: f32,
}

impl Picture<'_> {
    /// Loads what the scene's plan calls for, renders, and writes both files.
    ///
    /// # Errors
    /// Those of loading, building, rendering and writing.
    pub fn render(&self, files: &Files, overwrite: Overwrite) -> Result<(), Error> {
        let scene = self.load()?;
        let progress = self.progress();
        let advance = |pixels| progress.advance_by(pixels);
        let rendered = render(&scene, &self.settings, &advance)?;
        drop(progress);
        files.write(&rendered.film.to_image()?, self.exposure, overwrite)
    }

    /// Loads what the scene's plan calls for, and says what is to be known of it.
    ///
    /// # Errors
    /// Those of loading and building.
    pub fn load(&self) -> Result<Scene, Error> {
        let surface = |i, directions| self.surface(i, directions);
        let scene = Scene::build(self.scene, self.effects, surface)?;
        print_notes(scene.light_notes());
        Ok(scene)
    }

    /// A bar that counts pixels.
    pub fn progress(&self) -> Progress {
        Progress::new("rendering", self.settings.width * self.settings.height)
    }

    fn surface(&self, material: usize, directions: bool) -> Result<Surface, Error> {
        let brdf = args::load(&self.materials[material], self.lookup)?;
        let sampler = if directions {
            Some(self.sampler.build(&brdf)?.shared())
        } else {
            None
        };
        Ok(Surface {
            brdf: brdf.brdf().clone(),
            sampler,
        })
    }
}

/// The files of a picture.
pub struct Files {
    /// Linear RGB.
    pub exr: PathBuf,
    /// Tone-mapped sRGB.
    pub png: PathBuf,
    /// What an unfinished picture needs to go on.
    pub partial: PathBuf,
}

impl Files {
    /// NAME.exr and NAME.png, and NAME.partial; an extension of either kind in `name` is left out first.
    pub fn named(name: &Path) -> Self {
        let is_picture = name.extension().is_some_and(|e| e == "exr" || e == "png");
        let stem = if is_picture {
            name.with_extension("")
        } else {
            name.to_owned()
        };
        let [exr, png, partial] = [".exr", ".png", ".partial"].map(|extension| {
            let mut path = stem.clone().into_os_string();
            path.push(extension);
            PathBuf::from(path)
        });
        Self { exr, png, partial }
    }

    /// Writes both; `exposure` is in stops.
    ///
    /// # Errors
    /// As [`write_exr`] and [`write_png`].
    pub fn write(&self, image: &Image, exposure: f32, overwrite: Overwrite) -> Result<(), Error> {
        write_exr(&self.exr, image, overwrite)?;
        write_png(&self.png, image, exposure, overwrite)
    }

    /// Tells of files that can't be written before the work, not after it.
    ///
    /// # Errors
    /// As [`check_writable`].
    pub fn check(&self, overwrite: Overwrite) -> Result<(), Error> {
        check_writable(&self.exr, overwrite)?;
        check_writable(&self.png, overwrite)
    }
}
