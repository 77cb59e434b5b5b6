//! The light over a point.

use std::path::Path;

use merlkit::Error;
use merlkit::image::read_exr;
use merlkit::light::{Environment, SkySampling, lamps, studio};

/// The option's help is the same wherever it stands.
#[derive(Clone, Debug, clap::Args)]
pub struct SkyArgs {
    /// What lights the point, whose normal is the zenith: lamps (two broad ones), studio (with a small sun, which only light
    /// sampling finds quickly), or the path of an equirectangular .exr file
    #[arg(long, value_name = "LIGHT", default_value = "lamps")]
    pub environment: String,
}

impl SkyArgs {
    /// Loads it.
    ///
    /// # Errors
    /// [`Error::Argument`] for another name; those of reading the file.
    pub fn load(&self) -> Result<Environment, Error> {
        match self.environment.as_str() {
            "lamps" => lamps(SkySampling::Importance),
            "studio" => studio(SkySampling::Importance),
            file if Path::new(file)
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("exr")) =>
            {
                let image = read_exr(Path::new(file))?;
                let pixels = image.pixels().to_vec();
                Environment::new(
                    image.width(),
                    image.height(),
                    pixels,
                    SkySampling::Importance,
                )
            }
            other => Err(Error::argument(
                format!("no environment is called \"{other}\""),
                "pass --environment lamps, studio or the path of an .exr file",
            )),
        }
    }
}
