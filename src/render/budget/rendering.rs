//! A picture that can be stopped, stored, and gone on with.

use std::path::Path;

use super::adaptive::AdaptivePicture;
use super::even::EvenPicture;
use super::partial_file;
use super::rendered::Rendered;
use super::rounds::Watch;
use super::to_error::ErrorPicture;
use super::words::{WordReader, WordWriter};
use crate::Result;
use crate::files::Overwrite;
use crate::points::PointSet;
use crate::render::coverage::measure_coverage;
use crate::render::scene::Scene;
use crate::render::settings::{Budget, PixelRegion, RenderSettings};
use crate::render::tracer::Tracer;

/// A picture as far as it has come.
///
/// It is traced in rounds of 64 paths per pixel, more in small pictures and fewer in large ones, and [`Budget::ToError`] pixel by
/// pixel. After each it can be stopped; what it has collected is sums, so that it goes on to the bits of a picture that was never stopped, in this process or, by
/// [`Self::save`] and [`Self::restore`], in another.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
pub struct Rendering<'a> {
    tracer: Tracer<'a>,
    /// As they were given.
    settings: RenderSettings,
    picture: BudgetPicture,
}

/// Rays that measure how much of a pixel objects cover where pixels have different numbers of paths.
const UNEVEN_RAYS: u64 = 256;

enum BudgetPicture {
    Even(EvenPicture),
    Adaptive(AdaptivePicture),
    ToError(ErrorPicture),
}

impl<'a> Rendering<'a> {
    /// A picture of `scene`, by the plan that it holds, without a path so far.
    ///
    /// # Errors
    /// As [`RenderSettings::check`].
    pub fn begin(scene: &'a Scene, settings: &RenderSettings) -> Result<Self> {
        settings.check()?;
        Ok(Self::begin_checked(
            scene,
            settings,
            settings.whole_region(),
        ))
    }

    /// Part of a picture: the pixels from column and row `corner` on, `size` columns and rows of them.
    ///
    /// `settings` are those of the whole picture. The film has `size`, and its pixels have the bits that they have in the whole
    /// picture, so that parts can be drawn anywhere and put together.
    ///
    /// # Errors
    /// As [`RenderSettings::check`]; [`crate::Error::Argument`] for a region without pixels or outside the picture, and for a
    /// budget other than [`Budget::Even`], since the others compare pixels of the whole picture.
    pub fn begin_region(
        scene: &'a Scene,
        settings: &RenderSettings,
        corner: [usize; 2],
        size: [usize; 2],
    ) -> Result<Self> {
        settings.check()?;
        let region = settings.check_region(corner, size)?;
        Ok(Self::begin_checked(scene, settings, region))
    }

    /// The settings are checked, and the region with them.
    fn begin_checked(scene: &'a Scene, settings: &RenderSettings, region: PixelRegion) -> Self {
        let mut traced = *settings;
        if matches!(settings.budget, Budget::ToError { .. }) && traced.points == PointSet::Lattice {
            // Lattices are for numbers of paths that are known beforehand.
            traced.points = PointSet::Sobol;
        }
        let tracer = Tracer::new(scene, traced, region);
        let picture = match settings.budget {
            Budget::Even(paths) => BudgetPicture::Even(EvenPicture::new(region, paths)),
            Budget::Adaptive(paths) => {
                BudgetPicture::Adaptive(AdaptivePicture::new(settings, paths))
            }
            Budget::ToError { error, most } => {
                BudgetPicture::ToError(ErrorPicture::new(&tracer, error, most))
            }
        };
        Self {
            tracer,
            settings: *settings,
            picture,
        }
    }

    /// Traces paths, on all threads of the current pool, until the picture is finished or `should_stop()`, which is asked from any
    /// thread between rounds; `progress` is that of [`super::render()`]. Returns whether the picture is finished.
    ///
    /// A call traces at least one round of [`Budget::Even`] and [`Budget::Adaptive`]. After a stop all pixels of the first have
    /// equally many paths; those of the second have equal parts of their number; each tile of [`Budget::ToError`] is where it was.
    /// The first paths of [`PointSet::Lattice`] lie in the left of each pixel; those of other points all over it.
    pub fn advance(
        &mut self,
        should_stop: &(dyn Fn() -> bool + Sync),
        progress: &(dyn Fn(usize) + Sync),
    ) -> bool {
        let watch = Watch {
            should_stop,
            progress,
        };
        match &mut self.picture {
            BudgetPicture::Even(picture) => picture.advance(&self.tracer, watch),
            BudgetPicture::Adaptive(picture) => picture.advance(&self.tracer, watch),
            BudgetPicture::ToError(picture) => picture.advance(&self.tracer, watch),
        }
        self.is_finished()
    }

    /// Whether the picture has all that its budget asks for.
    pub fn is_finished(&self) -> bool {
        match &self.picture {
            BudgetPicture::Even(picture) => picture.is_finished(),
            BudgetPicture::Adaptive(picture) => picture.is_finished(),
            BudgetPicture::ToError(picture) => picture.is_finished(),
        }
    }

    /// How far it is, in words: "24 of 64 paths per pixel", "120 of 300 tiles".
    pub fn describe_progress(&self) -> String {
        match &self.picture {
            BudgetPicture::Even(picture) => picture.describe_progress(),
            BudgetPicture::Adaptive(picture) => picture.describe_progress(),
            BudgetPicture::ToError(picture) => picture.describe_progress(),
        }
    }

    /// The picture as it is now. Of an unfinished [`Budget::ToError`], pixels without a path get 16 first; of others that were
    /// never advanced, it is black.
    pub fn into_rendered(self) -> Rendered {
        let coverage = self.measure_coverage();
        let mut rendered = match self.picture {
            BudgetPicture::Even(picture) => Rendered::from(picture.into_film()),
            BudgetPicture::Adaptive(picture) => Rendered::from(picture.into_film(&self.settings)),
            BudgetPicture::ToError(picture) => picture.into_rendered(&self.tracer),
        };
        if let Some(coverage) = coverage {
            rendered.film = rendered.film.with_coverage(coverage);
        }
        rendered
    }

    /// How much of each pixel objects cover, where the scene's background is left out.
    fn measure_coverage(&self) -> Option<Vec<f32>> {
        let (done, paths) = match &self.picture {
            BudgetPicture::Even(picture) => picture.paths_done(),
            // Pixels have paths of different numbers.
            BudgetPicture::Adaptive(_) | BudgetPicture::ToError(_) => (UNEVEN_RAYS, UNEVEN_RAYS),
        };
        let is_needed = self.tracer.scene.transparent;
        is_needed.then(|| measure_coverage(&self.tracer, done, paths))
    }

    /// Writes all that is needed to go on to `path`, at once or not at all, in place of a file that is there.
    ///
    /// `facts` are names and values of what the scene was made of: materials and their checksums, lights, the sampler. The
    /// settings and this library's version are added.
    ///
    /// # Errors
    /// As [`crate::files::write_new`].
    pub fn save(&self, path: &Path, facts: &[(String, String)]) -> Result<()> {
        let words: WordWriter = match &self.picture {
            BudgetPicture::Even(picture) => picture.store(),
            BudgetPicture::Adaptive(picture) => picture.store(),
            BudgetPicture::ToError(picture) => picture.store(),
        };
        let facts = self.all_facts(facts);
        partial_file::write(path, &facts, words.bytes(), Overwrite::Replace)
    }

    /// Goes on from what [`Self::save`] wrote to `path`, given the same `facts`.
    ///
    /// # Errors
    /// [`crate::Error::Argument`], naming what differs, if the file is of another picture; [`crate::Error::Invalid`] if it is damaged;
    /// [`crate::Error::Unsupported`] if it is no such file; [`crate::Error::Io`] if it can't be read. The picture is without a path
    /// then.
    pub fn restore(&mut self, path: &Path, facts: &[(String, String)]) -> Result<()> {
        let bytes = partial_file::read(path, self.most_bytes())?;
        let words = partial_file::check(path, &bytes, &self.all_facts(facts))?;
        let mut reader = WordReader::new(words);
        let restored = match &mut self.picture {
            BudgetPicture::Even(picture) => picture.restore(&mut reader),
            BudgetPicture::Adaptive(picture) => picture.restore(&mut reader),
            BudgetPicture::ToError(picture) => picture.restore(&mut reader),
        };
        if restored.is_some() && reader.is_at_end() {
            return Ok(());
        }
        *self = Self::begin_checked(self.tracer.scene, &self.settings, self.tracer.region);
        Err(partial_file::damaged(
            path,
            "numbers that paths can have left",
        ))
    }

    /// Bytes of the longest state: a pixel of a target error has a count and 24 sums, and six numbers that it shows, and its tile
    /// no more than as many again.
    fn most_bytes(&self) -> u64 {
        let pixels = (self.settings.width * self.settings.height) as u64;
        8 * 64 * pixels
    }

    fn all_facts(&self, facts: &[(String, String)]) -> Vec<(String, String)> {
        let RenderSettings {
            width,
            height,
            seed,
            points,
            budget,
        } = self.settings;
        let mut all = vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("size".into(), format!("{width}x{height}")),
            ("seed".into(), seed.to_string()),
            ("points".into(), format!("{points:?}")),
            ("budget".into(), format!("{budget:?}")),
        ];
        let region = self.tracer.region;
        if region != self.settings.whole_region() {
            all.push(("region".into(), format!("{region:?}")));
        }
        all.extend_from_slice(facts);
        all
    }
}
