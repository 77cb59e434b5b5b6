//! The light over a point.

use merlkit::Error;
use merlkit::light::{Environment, EnvironmentSource, SkySampling};

/// The option's help is the same wherever it is.
#[derive(Clone, Debug, clap::Args)]
pub struct SkyArgs {
    #[arg(long, value_name = "LIGHT", default_value = "lamps", help = help())]
    pub environment: String,
}

fn help() -> String {
    format!(
        "What lights the point, whose normal is the zenith: {}; lamps are two broad ones, and only light sampling finds the \
         studio's small sun quickly",
        EnvironmentSource::words()
    )
}

impl SkyArgs {
    /// Loads it.
    ///
    /// # Errors
    /// [`Error::Argument`] for another name; those of reading the file.
    pub fn load(&self) -> Result<Environment, Error> {
        EnvironmentSource::from_name(&self.environment)?.load_map(SkySampling::Importance)
    }
}
