//! What every command that draws spheres can be told of their light and background.

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::image::Image;
use merlkit::light::LightSpec;
use merlkit::render::SceneSpec;
use merlkit_scene::{Background, LightEntry, SceneDescription};

/// Lights, background and the limit of paths.
#[derive(Clone, clap::Args)]
pub struct SceneOptions {
    #[arg(long = "light", value_name = "LIGHT", help = light_help())]
    lights: Vec<String>,
    /// Turn all lights about the vertical, counter-clockwise as seen from above [default: 0]
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        hide_default_value = true,
        allow_negative_numbers = true,
        value_parser = finite
    )]
    rotate: f64,
    /// What is seen past the spheres: the lights (env), nothing (none: alpha in both files), or white, black, grey or #RRGGBB
    /// [default: env]
    #[arg(long, value_name = "none|COLOUR|env")]
    background: Option<Background>,
    /// Scale paths down that carry more than X in a channel: removes fireflies and darkens the picture [default: never]
    #[arg(long, value_name = "X", value_parser = limit)]
    clamp: Option<f64>,
}

/// The light of a scene that says nothing.
const DEFAULT_LIGHT: &str = "environment";

impl SceneOptions {
    /// Puts the lights into a scene, and what else was said.
    ///
    /// # Errors
    /// As [`SceneSpec::light`].
    pub fn apply(&self, scene: &mut SceneSpec) -> Result<(), Error> {
        let names = self.light_words(&[DEFAULT_LIGHT.to_owned()]);
        let lights = names.iter().map(|name| scene.light(name));
        scene.lights = lights.collect::<Result<_, _>>()?;
        self.apply_settings(scene);
        Ok(())
    }

    /// The words of the lights that were asked for, or others where none were.
    fn light_words(&self, others: &[String]) -> Vec<String> {
        match self.lights.is_empty() {
            true => others.to_vec(),
            false => self.lights.clone(),
        }
    }

    /// Puts what was said here before what a scene file says, and a light into a scene that would have none.
    pub fn override_file(&mut self, scene: &mut SceneDescription) {
        if !self.lights.is_empty() || !scene.is_lit() {
            scene.darken();
            let words = self.light_words(&[DEFAULT_LIGHT.to_owned()]);
            scene.lights = words.into_iter().map(LightEntry::Named).collect();
        }
        self.background = self.background.or(scene.background);
    }

    /// Puts what was said besides the lights into a scene.
    pub fn apply_settings(&self, scene: &mut SceneSpec) {
        scene.light_turn = self.rotate.to_radians();
        scene.transparent = self.background() != Background::Lights;
        scene.clamp = self.clamp;
    }

    fn background(&self) -> Background {
        self.background.unwrap_or_default()
    }

    /// What becomes of the pixels in files.
    pub fn finish(&self, exposure: f32) -> Finish {
        Finish {
            exposure,
            backdrop: match self.background() {
                Background::Colour(colour) => Some(colour),
                Background::Lights | Background::Nothing => None,
            },
            clamp: self.clamp,
        }
    }

    /// Radiance of letters that can be read on the background.
    pub fn ink(&self) -> Rgb {
        match self.background() {
            Background::Lights => Rgb::ONE,
            // On paper.
            Background::Nothing => Rgb::ZERO,
            Background::Colour(colour) if colour.element_sum() > 0.5 => Rgb::ZERO,
            Background::Colour(_) => Rgb::ONE,
        }
    }
}

/// What becomes of pixels in files.
#[derive(Clone, Copy, Debug, Default)]
pub struct Finish {
    /// Exposure of the PNG, stops.
    pub exposure: f32,
    /// What shows through, if anything does.
    backdrop: Option<Rgb>,
    /// The limit of paths.
    clamp: Option<f64>,
}

impl Finish {
    /// The picture with its backdrop, whose headers will say these lines, and what a reader has to know.
    pub fn apply(&self, image: Image, mut words: Vec<String>) -> Image {
        words.extend(self.warning());
        let image = match words.is_empty() {
            true => image,
            false => image.with_comment(words.join("\n")),
        };
        match self.backdrop {
            Some(colour) => image.with_backdrop(colour),
            None => image,
        }
    }

    /// What a reader of the picture has to know.
    pub fn warning(&self) -> Option<String> {
        let clamp = self.clamp?;
        Some(format!(
            "clamped: paths that carried more than {clamp} in a channel were scaled down to it, so that bright pixels are too dark"
        ))
    }
}

fn light_help() -> String {
    format!(
        "{}: a map (EXR, HDR, PFM, PNG; its top is +y, its centre −z, its right half +x); repeatable [default: studio]",
        LightSpec::words()
    )
}

fn finite(argument: &str) -> Result<f64, String> {
    let number = argument.parse().ok();
    number
        .filter(|x: &f64| x.is_finite())
        .ok_or_else(|| "expected degrees, such as 90".into())
}

fn limit(argument: &str) -> Result<f64, String> {
    let number = argument.parse().ok();
    number
        .filter(|x: &f64| *x > 0.0 && x.is_finite())
        .ok_or_else(|| "expected a radiance above 0, such as 10".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clamped_picture_says_so() {
        let image = || Image::new(1, 1, vec![Rgb::ONE]).unwrap();
        let plain = Finish::default();
        assert_eq!(plain.apply(image(), Vec::new()), image());
        let clamped = Finish {
            clamp: Some(10.0),
            ..plain
        };
        let words = format!("{:?}", clamped.apply(image(), vec!["unfinished".into()]));
        assert!(words.contains("unfinished") && words.contains("more than 10 in a channel"));
    }
}
