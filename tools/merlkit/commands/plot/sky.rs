//! `merlkit plot --kind environment`: where on an environment directions fall.

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::glam::DVec3;
use merlkit::image::Image;
use merlkit::light::{Environment, EnvironmentSource, SkySampling};
use merlkit::material::Loaded;
use merlkit::sampler::Sampler;
use merlkit_evaluate::measure::sky_draws::{
    SkyDraws, SkyStrategy, SurfaceView, map_places, sky_draws,
};
use merlkit_evaluate::plot::{Caption, Chart, SkyMap};

use crate::args;
use crate::sky::print_notes;

/// An environment, and how directions are drawn.
#[derive(clap::Args)]
pub struct SkyOptions {
    /// environment: the map, as `render` takes it: studio, lamps, uniform[:RADIANCE] or FILE[:clamp[=MAX]]
    #[arg(long, value_name = "MAP")]
    pub light: Option<String>,
    /// environment: draw by the light, by the MATERIAL's sampler, or keep --samples of --candidates from the sampler
    /// [default: light]
    #[arg(long, value_name = "light|brdf|ris", hide_possible_values = true, value_parser = ["light", "brdf", "ris"])]
    pub strategy: Option<String>,
    /// environment: candidates of --strategy ris, up to 1000000 [default: 20 for each of --samples]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub candidates: Option<u32>,
    /// environment: azimuth of wo in degrees, from the map's right edge of the middle row (+x) towards its middle (−z) [default: 0]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub phi: Option<f64>,
}

/// What a picture of an environment shows.
pub struct SkyRequest {
    /// Polar angle of wo in degrees.
    pub theta: f64,
    /// How many directions.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Stops by which the map is shown brighter.
    pub exposure: f32,
}

/// Columns of the map in the picture; it has half as many rows.
const COLUMNS: usize = 512;

impl SkyOptions {
    /// Refuses these options where another kind is plotted.
    ///
    /// # Errors
    /// [`Error::Argument`] if any was given.
    pub fn refuse_elsewhere(&self, kind: &str) -> Result<(), Error> {
        let words = self.light.is_some() || self.strategy.is_some();
        if !(words || self.candidates.is_some() || self.phi.is_some()) {
            return Ok(());
        }
        Err(Error::argument(
            format!("--light, --strategy, --candidates or --phi has no effect on --kind {kind}"),
            "omit it, or choose --kind environment",
        ))
    }

    /// Whether directions are drawn by a material's sampler.
    pub fn needs_material(&self) -> bool {
        matches!(self.strategy.as_deref(), Some("brdf" | "ris"))
    }

    /// Refuses options that don't belong together.
    ///
    /// # Errors
    /// [`Error::Argument`] for a missing or superfluous material, and for options without effect.
    pub fn check(&self, materials: usize) -> Result<(), Error> {
        let strategy = self.strategy.as_deref().unwrap_or("light");
        if self.light.is_none() {
            return Err(Error::argument(
                "--kind environment without a map",
                "pass --light FILE, or --light studio",
            ));
        }
        match (self.needs_material(), materials) {
            (true, 1) | (false, 0) => {}
            (true, _) => {
                return Err(Error::argument(
                    format!("{materials} materials for --strategy {strategy}"),
                    "name one material, from whose sampler directions are drawn",
                ));
            }
            (false, _) => {
                return Err(Error::argument(
                    "a material has no effect on --strategy light",
                    "omit it, or pass --strategy brdf or ris",
                ));
            }
        }
        if self.candidates.is_some() && strategy != "ris" {
            return Err(Error::argument(
                format!("--candidates has no effect on --strategy {strategy}"),
                "omit it, or pass --strategy ris",
            ));
        }
        if self.phi.is_some() && strategy == "light" {
            return Err(Error::argument(
                "--phi has no effect on --strategy light",
                "omit it, or pass --strategy brdf or ris",
            ));
        }
        if self.phi.is_some_and(|phi| !phi.is_finite()) {
            return Err(Error::argument(
                "an azimuth without an end",
                "choose --phi 0",
            ));
        }
        Ok(())
    }

    /// The map and what was drawn, as a chart. `subject` is the material with its sampler, where one is needed.
    ///
    /// # Errors
    /// Those of the environment's word and file.
    pub fn chart(
        &self,
        subject: Option<(&Loaded, &Sampler)>,
        request: &SkyRequest,
    ) -> Result<Chart, Error> {
        let word = self.light.as_deref().unwrap_or("studio");
        let environment = EnvironmentSource::from_name(word)?.load_map(SkySampling::Importance)?;
        print_notes(environment.notes());
        let phi = self.phi.unwrap_or(0.0);
        let candidates = self.candidates.map_or(20 * request.samples, |m| m as usize);
        let wo = args::direction(request.theta, phi).as_vec3();
        let strategy = match subject {
            None => SkyStrategy::Light,
            Some((material, sampler)) => {
                let view = SurfaceView {
                    brdf: &**material.brdf(),
                    sampler: sampler.as_dyn(),
                    wo,
                };
                match self.strategy.as_deref() {
                    Some("ris") => SkyStrategy::Ris(view, candidates),
                    _ => SkyStrategy::Brdf(view),
                }
            }
        };
        let draws = sky_draws(&environment, strategy, request.samples, request.seed);
        let mut how = describe_draws(&draws, strategy, subject);
        if subject.is_some() {
            how += &format!(", wo at θ = {}°, φ = {phi}°", request.theta);
        }
        sky_chart(word, &environment, &draws, &how, request.exposure)
    }
}

/// How many directions were drawn, and how.
fn describe_draws(
    draws: &SkyDraws,
    strategy: SkyStrategy<'_>,
    subject: Option<(&Loaded, &Sampler)>,
) -> String {
    let count = draws.directions.len();
    let Some((material, sampler)) = subject else {
        return format!("{count} drawn by the light");
    };
    let (spec, name) = (sampler.spec(), material.name());
    match strategy {
        SkyStrategy::Ris(_, candidates) => {
            format!("{count} kept of {candidates} from {spec} of {name}")
        }
        _ => format!("{count} drawn by {spec} of {name}"),
    }
}

fn sky_chart(
    word: &str,
    environment: &Environment,
    draws: &SkyDraws,
    how: &str,
    exposure: f32,
) -> Result<Chart, Error> {
    let failed = match draws.failed {
        0 => String::new(),
        failed => format!(", {failed} draws failed"),
    };
    Ok(Chart::Sky(SkyMap {
        caption: Caption::new(
            format!("{word}: {how}"),
            format!(
                "An environment as a map of latitude and longitude, with the zenith (+y) at the top and −z in the middle, {how}{failed}. \
                 Below, its luminance. The surface is level."
            ),
        ),
        image: shrink(environment)?,
        exposure,
        places: map_places(&draws.directions),
        label: format!("{how}{failed}"),
    }))
}

/// The map in the picture's size: the mean of the radiance at four points of each pixel.
fn shrink(environment: &Environment) -> Result<Image, Error> {
    let (columns, rows) = (COLUMNS, COLUMNS / 2);
    let mut pixels = Vec::with_capacity(columns * rows);
    for y in 0..rows {
        for x in 0..columns {
            let mut sum = Rgb::ZERO;
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let across = (x as f64 + dx) / columns as f64;
                let down = (y as f64 + dy) / rows as f64;
                sum += environment.radiance(place_direction(across, down));
            }
            pixels.push(0.25 * sum);
        }
    }
    Image::new(columns, rows, pixels)
}

/// The direction of a place, by fractions of the map's width and height: the inverse of [`map_places`].
fn place_direction(across: f64, down: f64) -> DVec3 {
    let longitude = (across - 0.5) * std::f64::consts::TAU;
    let (sin, cos) = (down * std::f64::consts::PI).sin_cos();
    DVec3::new(sin * longitude.sin(), cos, -sin * longitude.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_directions_are_inverses() {
        for (across, down) in [(0.1, 0.2), (0.5, 0.5), (0.9, 0.7)] {
            let place = map_places(&[place_direction(across, down)])[0];
            assert!((place.0 - across).abs() < 1e-12 && (place.1 - down).abs() < 1e-12);
        }
    }
}
