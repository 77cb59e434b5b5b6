//! Pictures of a whole turn: numbered files, or one file that moves.

use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable, write_new};
use merlkit::glam::DQuat;
use merlkit::image::{Image, encode_srgb};
use merlkit::render::SceneSpec;

use crate::args;
use crate::picture::Files;
use crate::scene_args::Finish;

/// How many frames, and what turns.
#[derive(Clone, clap::Args)]
pub struct FrameOptions {
    /// Draw N frames of a whole turn, 2 to 9999: NAME_000, NAME_001, … as EXR and PNG, or with -o NAME.gif or NAME.apng one file
    #[arg(long, value_name = "N", requires = "turn", value_parser = clap::value_parser!(u32).range(2..=9999))]
    frames: Option<u32>,
    /// What turns about the vertical: the lights, or the camera around each sphere
    #[arg(long, value_name = "light|camera", requires = "frames", hide_possible_values = true, value_parser = args::named(TURNING))]
    turn: Option<Turning>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turning {
    Light,
    Camera,
}

const TURNING: &[(&str, Turning)] = &[("light", Turning::Light), ("camera", Turning::Camera)];

impl FrameOptions {
    /// How many frames there are; `None` for a single picture.
    pub fn count(&self) -> Option<usize> {
        self.frames.map(|n| n as usize)
    }

    /// What the frames are, as text.
    pub fn describe(&self) -> String {
        match (self.frames, self.turn) {
            (Some(frames), Some(turn)) => format!("{frames} frames, {turn:?} turns"),
            _ => String::new(),
        }
    }

    /// The scene in a frame: the first is the scene as it is.
    pub fn turn(&self, scene: &SceneSpec, frame: usize) -> SceneSpec {
        let mut scene = scene.clone();
        let Some(frames) = self.frames else {
            return scene;
        };
        let angle = std::f64::consts::TAU * frame as f64 / f64::from(frames);
        match self.turn {
            Some(Turning::Camera) => {
                let from_target = scene.camera.eye - scene.camera.target;
                let turned = DQuat::from_rotation_y(angle) * from_target;
                scene.camera.eye = scene.camera.target + turned;
            }
            Some(Turning::Light) | None => scene.light_turn += angle,
        }
        scene
    }
}

/// Where frames go.
pub enum Movie {
    /// An EXR and a PNG for each.
    Numbered(Vec<Files>),
    /// One GIF of 256 colours a frame.
    Gif(PathBuf),
    /// One PNG with animation.
    Apng(PathBuf),
}

impl Movie {
    /// By the extension of `name`.
    pub fn named(name: &Path, frames: usize) -> Self {
        let extension = name.extension().unwrap_or_default();
        if extension.eq_ignore_ascii_case("gif") {
            return Self::Gif(name.to_owned());
        }
        if extension.eq_ignore_ascii_case("apng") {
            return Self::Apng(name.to_owned());
        }
        let digits = frames.saturating_sub(1).to_string().len().max(3);
        let stem = Files::named(name).exr.with_extension("");
        let numbered = (0..frames).map(|frame| {
            let mut path = stem.clone().into_os_string();
            path.push(format!("_{frame:0digits$}.exr"));
            Files::named(Path::new(&path))
        });
        Self::Numbered(numbered.collect())
    }

    /// The same files; headers of numbered ones say where they come from.
    pub fn with_provenance(mut self, provenance: &Option<String>) -> Self {
        if let Self::Numbered(files) = &mut self {
            for files in files {
                files.provenance.clone_from(provenance);
            }
        }
        self
    }

    /// Refuses files that can't be written before the work.
    ///
    /// # Errors
    /// As [`check_writable`].
    pub fn check(&self, overwrite: Overwrite) -> Result<(), Error> {
        match self {
            Self::Numbered(files) => files.iter().try_for_each(|files| files.check(overwrite)),
            Self::Gif(path) | Self::Apng(path) => check_writable(path, overwrite),
        }
    }

    /// Writes the frames, asking for one after the other.
    ///
    /// # Errors
    /// Those of `frame` and of writing.
    pub fn write(
        &self,
        count: usize,
        frame: impl Fn(usize) -> Result<Image, Error>,
        finish: &Finish,
        overwrite: Overwrite,
    ) -> Result<(), Error> {
        match self {
            Self::Numbered(files) => {
                for (number, files) in files.iter().enumerate() {
                    files.write(frame(number)?, finish, None, overwrite)?;
                }
                Ok(())
            }
            Self::Gif(path) => write_gif(path, count, frame, finish, overwrite),
            Self::Apng(path) => write_apng(path, count, frame, finish, overwrite),
        }
    }

    /// The files, the first and the last of them.
    pub fn describe(&self) -> String {
        match self {
            Self::Gif(path) | Self::Apng(path) => path.display().to_string(),
            Self::Numbered(files) => {
                let shown = files.first().into_iter().chain(files.last());
                let names: Vec<String> = shown.map(|f| f.png.display().to_string()).collect();
                format!("{}, with an EXR for each", names.join(" … "))
            }
        }
    }
}

/// Hundredths of a second a frame: a turn takes four seconds, if that is neither too fast nor too slow for a viewer.
fn delay(count: usize) -> u16 {
    (400 / count.max(1)).clamp(2, 25) as u16
}

/// A picture as bytes: width, height, four bytes a pixel.
fn encode_frame(image: Image, finish: &Finish) -> ([usize; 2], Vec<u8>) {
    let size = [image.width(), image.height()];
    let image = finish.apply(image, Vec::new());
    let bytes = encode_srgb(&image, finish.exposure);
    if bytes.len() == 4 * size[0] * size[1] {
        return (size, bytes);
    }
    let mut opaque = Vec::with_capacity(4 * size[0] * size[1]);
    for colour in bytes.chunks_exact(3) {
        opaque.extend_from_slice(colour);
        opaque.push(255);
    }
    (size, opaque)
}

fn write_error(path: &Path, error: impl std::error::Error + Send + Sync + 'static) -> Error {
    Error::io(path, "write", std::io::Error::other(error))
}

/// How thoroughly colours are chosen, from 1 to 30, the fastest.
const GIF_SPEED: i32 = 10;

fn write_gif(
    path: &Path,
    count: usize,
    frame: impl Fn(usize) -> Result<Image, Error>,
    finish: &Finish,
    overwrite: Overwrite,
) -> Result<(), Error> {
    let (size, first) = encode_frame(frame(0)?, finish);
    let sides = size.map(|side| u16::try_from(side).ok());
    let [Some(width), Some(height)] = sides else {
        return Err(Error::argument(
            "a GIF has at most 65535 pixels a side",
            "choose a smaller --size, or -o NAME.apng",
        ));
    };
    write_new(path, overwrite, |out| {
        let mut encoder =
            gif::Encoder::new(out, width, height, &[]).map_err(|e| write_error(path, e))?;
        encoder
            .set_repeat(gif::Repeat::Infinite)
            .map_err(|e| write_error(path, e))?;
        let mut pixels = first.clone();
        for number in 0..count {
            if number > 0 {
                pixels = encode_frame(frame(number)?, finish).1;
            }
            let mut shown = gif::Frame::from_rgba_speed(width, height, &mut pixels, GIF_SPEED);
            shown.delay = delay(count);
            shown.dispose = gif::DisposalMethod::Background;
            encoder
                .write_frame(&shown)
                .map_err(|e| write_error(path, e))?;
        }
        Ok(())
    })
}

fn write_apng(
    path: &Path,
    count: usize,
    frame: impl Fn(usize) -> Result<Image, Error>,
    finish: &Finish,
    overwrite: Overwrite,
) -> Result<(), Error> {
    let (size, first) = encode_frame(frame(0)?, finish);
    let [width, height] = size.map(|side| u32::try_from(side).unwrap_or(0));
    write_new(path, overwrite, |out| {
        let mut encoder = png::Encoder::new(out, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        // 0 repeats for ever.
        encoder
            .set_animated(count as u32, 0)
            .map_err(|e| write_error(path, e))?;
        encoder
            .set_frame_delay(delay(count), 100)
            .map_err(|e| write_error(path, e))?;
        if let Some(words) = finish.warning() {
            let comment = encoder.add_itxt_chunk("Comment".into(), words);
            comment.map_err(|e| write_error(path, e))?;
        }
        let mut writer = encoder.write_header().map_err(|e| write_error(path, e))?;
        writer
            .write_image_data(&first)
            .map_err(|e| write_error(path, e))?;
        for number in 1..count {
            let (_, pixels) = encode_frame(frame(number)?, finish);
            writer
                .write_image_data(&pixels)
                .map_err(|e| write_error(path, e))?;
        }
        writer.finish().map_err(|e| write_error(path, e))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_with_equally_many_digits() {
        let Movie::Numbered(files) = Movie::named(Path::new("a/turn.v2"), 12) else {
            panic!("numbered files");
        };
        assert_eq!(files[11].png, Path::new("a/turn.v2_011.png"));
        let Movie::Numbered(files) = Movie::named(Path::new("turn.png"), 1001) else {
            panic!("numbered files");
        };
        assert_eq!(files[7].exr, Path::new("turn_0007.exr"));
        assert!(matches!(Movie::named(Path::new("t.GIF"), 3), Movie::Gif(_)));
        assert!(matches!(
            Movie::named(Path::new("t.apng"), 3),
            Movie::Apng(_)
        ));
        assert_eq!([delay(2), delay(40), delay(1000)], [25, 10, 2]);
    }
}
