//! Spheres that are drawn one after another, each by itself, and kept in a folder until all of them are there.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use merlkit::Error;
use merlkit::files::{Overwrite, write_new};
use merlkit::image::{Image, read_exr, write_exr};
use merlkit::material::Material;
use merlkit::render::{Refinement, Rendering, Tile as RefinedTile};
use sha2::{Digest, Sha256};

use crate::failure::Failure;
use crate::interrupt::StoppableWork;
use crate::output;
use crate::picture::{Files, LoadedParts, Picture};
use crate::progress::Progress;
use crate::provenance::Checksums;
use crate::render_costs::CostStage;

/// A picture that becomes a part of a larger one, or a frame: in most cases of one sphere.
pub struct Tile<'a> {
    /// What its files are called, without an extension.
    name: String,
    /// Its scene and its settings.
    pub picture: Picture<'a>,
}

impl<'a> Tile<'a> {
    /// A tile of the picture's material. `key` is that of [`tile_key`], and `variant` distinguishes the tiles of one material.
    pub fn new(key: &str, variant: &str, picture: Picture<'a>) -> Self {
        Self {
            name: format!("{key}{variant}"),
            picture,
        }
    }
}

/// A name that follows from the materials of a picture and from their content: what has changed is drawn again.
///
/// # Errors
/// As [`Material::sha256`].
pub fn tile_key(materials: &[Material], sums: &mut Checksums) -> Result<String, Error> {
    let (name, sum) = match materials {
        [material] => (material.name(), sums.find(material)?),
        _ => {
            let mut all = String::new();
            for material in materials {
                all.push_str(&sums.find(material)?);
            }
            ("together", to_hex(&Sha256::digest(all)))
        }
    };
    Ok(format!("{name}-{}", &sum[..16.min(sum.len())]))
}

fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What was drawn before a signal came.
pub struct Drawn {
    /// How many tiles are finished.
    pub finished: usize,
    /// The tile that was being drawn, as it was then.
    pub unfinished: Option<Image>,
}

impl Drawn {
    /// The pictures of the tiles in their order, as far as there are any.
    ///
    /// # Errors
    /// As [`TileFolder::read`].
    pub fn read(self, folder: &TileFolder, tiles: &[Tile<'_>]) -> Result<Vec<Image>, Error> {
        let finished = tiles[..self.finished].iter();
        let mut images: Vec<Image> = finished
            .map(|tile| folder.read(tile))
            .collect::<Result<_, _>>()?;
        images.extend(self.unfinished);
        Ok(images)
    }
}

/// Shown when a signal comes.
const STOPPING: &str = "merlkit: stopping once every pixel of this sphere has the same number of paths (press Ctrl-C again to stop now)";

/// Draws tiles and lets `finish` make files of them: of all, or after a signal of those that are there. Then the folder says how
/// to go on, and this does not return.
///
/// # Errors
/// Those of [`TileFolder::open`], [`TileFolder::draw`] and `finish`.
pub fn draw_tiles<T>(
    folder: &TileFolder,
    tiles: &[Tile<'_>],
    layout: &str,
    finish: impl FnOnce(Drawn) -> Result<T, Failure>,
) -> Result<Option<T>, Failure> {
    let Some(first) = tiles.first() else {
        return Ok(None);
    };
    folder.open(&describe_settings(&first.picture, layout)?)?;
    let work = StoppableWork::begin(STOPPING);
    let outcome = match folder.draw(tiles, &work) {
        Ok(drawn) => {
            let count = drawn.finished;
            finish(drawn).and_then(|done| {
                match count == tiles.len() {
                    true => folder.remove()?,
                    false => folder.say_kept(count, tiles.len()),
                }
                Ok(done)
            })
        }
        Err(error) => {
            folder.remove_without_tiles();
            Err(error.into())
        }
    };
    match outcome {
        Ok(done) => work.end(Ok(())).map(|()| Some(done)),
        Err(failure) => work.end(Err(failure)).map(|()| None),
    }
}

/// The settings that all tiles of a folder are drawn with.
const SETTINGS: &str = "settings.txt";

/// Finished tiles of a picture that is not finished.
pub struct TileFolder {
    folder: PathBuf,
    resume: bool,
}

impl TileFolder {
    /// The folder of tiles of `files`.
    pub fn named(files: &Files, resume: bool) -> Self {
        Self {
            folder: files.exr.with_extension("tiles"),
            resume,
        }
    }

    /// Refuses, before the work, to go on with nothing, and to begin where tiles of an interrupted picture lie.
    ///
    /// # Errors
    /// [`Error::Argument`] for both.
    pub fn check(&self) -> Result<(), Error> {
        let shown = self.folder.display();
        match (self.resume, self.folder.exists()) {
            (true, false) => Err(Error::argument(
                format!("nothing to resume: there is no {shown}"),
                "omit --resume to start again, or name the output of the interrupted command",
            )),
            (false, true) => Err(Error::argument(
                format!("{shown} holds the spheres of an interrupted command"),
                "continue with --resume, or remove the folder to start again",
            )),
            _ => Ok(()),
        }
    }

    /// Makes the folder, or with --resume goes on with it if its tiles were drawn with the same settings.
    ///
    /// # Errors
    /// [`Error::Argument`] for other settings; [`Error::Io`] for a folder that can't be read or written.
    fn open(&self, settings: &str) -> Result<(), Error> {
        let record = self.folder.join(SETTINGS);
        if self.resume {
            let found = fs::read_to_string(&record).map_err(|e| Error::io(&record, "read", e))?;
            return match differing_lines(&found, settings) {
                None => Ok(()),
                Some(lines) => Err(Error::argument(
                    format!(
                        "{} was drawn with other settings: {lines}",
                        self.folder.display()
                    ),
                    "repeat the command that was interrupted, or remove the folder to start again",
                )),
            };
        }
        fs::create_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, "create", e))?;
        write_new(&record, Overwrite::Refuse, |out| {
            let written = out.write_all(settings.as_bytes());
            written.map_err(|e| Error::io(&record, "write", e))
        })
    }

    /// Draws the tiles that the folder does not have yet, as far as no signal comes.
    ///
    /// # Errors
    /// Those of loading, rendering, reading and writing.
    fn draw(&self, tiles: &[Tile<'_>], work: &StoppableWork) -> Result<Drawn, Error> {
        let pixels = tiles.iter().map(|tile| tile.picture.pixels()).sum();
        let progress = Progress::new("drawing", pixels);
        let mut parts = LoadedParts::default();
        for (finished, tile) in tiles.iter().enumerate() {
            let path = self.path_of(tile, "exr");
            if path.exists() {
                progress.advance_by(tile.picture.pixels());
                continue;
            }
            let unfinished = match work.should_stop() {
                true => None,
                false => match self.draw_tile(tile, &path, &mut parts, work, &progress)? {
                    None => continue,
                    unfinished => unfinished,
                },
            };
            return Ok(Drawn {
                finished,
                unfinished,
            });
        }
        Ok(Drawn {
            finished: tiles.len(),
            unfinished: None,
        })
    }

    /// Draws a tile to its file. Returns what it shows if a signal came first; then it can be gone on with.
    fn draw_tile(
        &self,
        tile: &Tile<'_>,
        path: &Path,
        parts: &mut LoadedParts,
        work: &StoppableWork,
        progress: &Progress,
    ) -> Result<Option<Image>, Error> {
        let picture = &tile.picture;
        let scene = parts.load(picture)?;
        let mut rendering = Rendering::begin(scene, &picture.settings)?;
        let partial = self.path_of(tile, "partial");
        let goes_on = partial.exists();
        if goes_on {
            rendering.restore(&partial, &picture.facts())?;
        }
        let advance = |pixels| progress.advance_by(pixels);
        let start = Instant::now();
        let is_finished = rendering.advance(&|| work.should_stop(), &advance);
        if let Some(costs) = picture.costs {
            costs.add(CostStage::Rendering, start);
        }
        if !is_finished {
            rendering.save(&partial, &picture.facts())?;
            return rendering.into_rendered().film.to_image().map(Some);
        }
        let rendered = rendering.into_rendered();
        if let Some(refinement) = &rendered.refinement {
            self.write_refinement(tile, refinement)?;
        }
        write_exr(path, &rendered.film.to_image()?, Overwrite::Replace)?;
        if goes_on {
            fs::remove_file(&partial).map_err(|e| Error::io(&partial, "remove", e))?;
        }
        Ok(None)
    }

    /// The picture of a tile that was drawn.
    ///
    /// # Errors
    /// As [`read_exr`], and [`Error::Argument`] for a file of another size.
    pub fn read(&self, tile: &Tile<'_>) -> Result<Image, Error> {
        let path = self.path_of(tile, "exr");
        let image = read_exr(&path)?;
        let settings = &tile.picture.settings;
        if (image.width(), image.height()) != (settings.width, settings.height) {
            let what = format!("{} has another size", path.display());
            return Err(Error::argument(what, "remove it"));
        }
        Ok(image)
    }

    /// How far all tiles came to a target error; `None` if there was none.
    ///
    /// # Errors
    /// [`Error::Io`] if a record can't be read.
    pub fn read_refinement(&self, tiles: &[Tile<'_>]) -> Result<Option<Refinement>, Error> {
        let mut all: Option<Refinement> = None;
        for tile in tiles {
            let path = self.path_of(tile, "json");
            if !path.exists() {
                continue;
            }
            let bytes = fs::read(&path).map_err(|e| Error::io(&path, "read", e))?;
            let record: RefinementRecord = serde_json::from_slice(&bytes).map_err(|_| {
                let what = format!("{} is damaged", path.display());
                Error::argument(what, "remove the folder to start again")
            })?;
            let sum = all.get_or_insert(Refinement {
                tiles: Vec::new(),
                paths: 0,
                traced: 0,
            });
            sum.paths += record.paths;
            sum.traced += record.traced;
            for (pixels, error, reached) in record.tiles {
                sum.tiles.push(RefinedTile {
                    pixels: vec![0; pixels],
                    error,
                    reached,
                });
            }
        }
        Ok(all)
    }

    fn write_refinement(&self, tile: &Tile<'_>, refinement: &Refinement) -> Result<(), Error> {
        let tiles = refinement.tiles.iter();
        let record = RefinementRecord {
            tiles: tiles
                .map(|t| (t.pixels.len(), t.error, t.reached))
                .collect(),
            paths: refinement.paths,
            traced: refinement.traced,
        };
        let path = self.path_of(tile, "json");
        write_new(&path, Overwrite::Replace, |out| {
            serde_json::to_writer(out, &record).map_err(|e| Error::io(&path, "write", e.into()))
        })
    }

    fn path_of(&self, tile: &Tile<'_>, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", tile.name))
    }

    /// Says how many spheres are kept.
    fn say_kept(&self, finished: usize, all: usize) {
        output::message(&format!(
            "merlkit: {finished} of {all} spheres are kept in {}; the same command with --resume goes on",
            self.folder.display()
        ));
    }

    /// After a failure: a folder without a tile has nothing to go on with. If it can't be removed, the next run says that it is
    /// there.
    fn remove_without_tiles(&self) {
        let entries = fs::read_dir(&self.folder).map_or(0, Iterator::count);
        if entries <= 1 {
            let _ = self.remove();
        }
    }

    /// Removes the folder: the picture is finished.
    ///
    /// # Errors
    /// [`Error::Io`] if it can't be removed.
    fn remove(&self) -> Result<(), Error> {
        fs::remove_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, "remove", e))
    }
}

/// What is kept of a [`Refinement`]: pixels, error and success of each tile.
#[derive(serde::Serialize, serde::Deserialize)]
struct RefinementRecord {
    tiles: Vec<(usize, f64, bool)>,
    paths: u64,
    traced: u64,
}

/// The lines of the first text that the second has otherwise, with "; " between them; `None` if there are none.
fn differing_lines(found: &str, expected: &str) -> Option<String> {
    if found == expected {
        return None;
    }
    let mut lines = Vec::new();
    for line in found.lines() {
        if !expected.lines().any(|other| other == line) {
            lines.push(line);
        }
    }
    Some(lines.join("; "))
}

/// All that the tiles of a folder have in common, as text; `layout` is what the caller adds.
///
/// # Errors
/// [`Error::Io`] if the file of a light can't be read.
fn describe_settings(picture: &Picture<'_>, layout: &str) -> Result<String, Error> {
    let mut text = format!("merlkit {}\n", env!("CARGO_PKG_VERSION"));
    for (name, value) in picture.facts() {
        text += &format!("{name} {value}\n");
    }
    text += &format!("settings {:?}\n{layout}\n", picture.settings);
    for sum in picture.checksums_of_maps()? {
        text += &format!("map {sum}\n");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_differ_are_named() {
        assert_eq!(differing_lines("a\nb\n", "a\nb\n"), None);
        let lines = differing_lines("a\nseed 1\n", "a\nseed 2\n");
        assert_eq!(lines.as_deref(), Some("seed 1"));
    }
}
