//! Rendering a scene to files: what `render` and `demo` share.

use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable};
use merlkit::image::{write_exr, write_png};
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::render::{
    EffectPlan, Refined, Scene, SceneSpec, Settings, Surface, render, render_allocated,
    render_to_error,
};
use merlkit::sampler::SamplerSpec;

use crate::progress::Progress;

/// A scene and everything its picture depends on.
pub struct Picture<'a> {
    /// The scene; nothing is loaded.
    pub scene: &'a SceneSpec,
    /// What will be computed.
    pub plan: &'a EffectPlan,
    /// Materials in the order of the scene's.
    pub materials: &'a [Material],
    /// What tables say between their samples.
    pub lookup: LookupRule,
    /// How directions are drawn, where any are.
    pub sampler: &'a SamplerSpec,
    /// Size, samples and seed.
    pub settings: Settings,
    /// Where its paths go.
    pub spending: Spending,
    /// Exposure of the PNG, stops.
    pub exposure: f32,
}

/// Where a picture's paths go.
#[derive(Clone, Copy)]
pub enum Spending {
    /// As many to every pixel.
    Even,
    /// More to where the picture is noisy, about as many in all.
    Adaptive,
    /// As many as each tile needs to come down to an error, at most the settings' samples a pixel.
    ToError(f64),
}

impl Picture<'_> {
    /// Loads what the plan calls for, renders, and writes both files; tells how far it came, given a target error.
    ///
    /// # Errors
    /// Those of loading, building, rendering and writing.
    pub fn render(&self, files: &Files, overwrite: Overwrite) -> Result<Option<Refined>, Error> {
        let scene = Scene::build(self.scene, self.plan, |i, directions| {
            self.surface(i, directions)
        })?;
        let progress = Progress::new("rendering", self.settings.width * self.settings.height);
        let advance = |pixels| progress.advance_by(pixels);
        let (plan, settings) = (self.plan, &self.settings);
        let (image, refined) = match self.spending {
            Spending::Even => (render(&scene, plan, settings, &advance)?.to_image()?, None),
            Spending::Adaptive => (
                render_allocated(&scene, plan, settings, &advance)?.to_image()?,
                None,
            ),
            Spending::ToError(error) => {
                let refined = render_to_error(&scene, plan, settings, error, &advance)?;
                (refined.film.to_image()?, Some(refined))
            }
        };
        drop(progress);
        write_exr(&files.exr, &image, overwrite)?;
        write_png(&files.png, &image, self.exposure, overwrite)?;
        Ok(refined)
    }

    fn surface(&self, material: usize, directions: bool) -> Result<Surface, Error> {
        let brdf = self.materials[material].load(self.lookup)?;
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

/// The two files of a picture.
pub struct Files {
    /// Linear RGB.
    pub exr: PathBuf,
    /// Tone-mapped sRGB.
    pub png: PathBuf,
}

impl Files {
    /// NAME.exr and NAME.png; an extension of either kind in `name` is left out first.
    pub fn named(name: &Path) -> Self {
        let is_picture = name.extension().is_some_and(|e| e == "exr" || e == "png");
        let stem = if is_picture {
            name.with_extension("")
        } else {
            name.to_owned()
        };
        let with = |extension: &str| {
            let mut path = stem.clone().into_os_string();
            path.push(extension);
            PathBuf::from(path)
        };
        Self {
            exr: with(".exr"),
            png: with(".png"),
        }
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
