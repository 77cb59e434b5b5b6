//! The light over a point.

use merlkit::Error;
use merlkit::light::{Environment, EnvironmentSource, MapNotes, SkySampling};
use serde::Serialize;

use crate::output;

/// The option's help is the same wherever it is.
#[derive(Clone, Debug, clap::Args)]
pub struct SkyArgs {
    #[arg(long, value_name = "LIGHT", default_value = "lamps", help = help())]
    pub environment: String,
}

fn help() -> String {
    format!(
        "Environment that lights the point, whose normal is the zenith: {}. lamps has two broad lights; the studio has a small \
         sun that only light sampling finds quickly",
        EnvironmentSource::words()
    )
}

impl SkyArgs {
    /// Loads it, and says what was found and changed in its file.
    ///
    /// # Errors
    /// [`Error::Argument`] for another name; those of reading the file.
    pub fn load(&self) -> Result<Environment, Error> {
        let source = EnvironmentSource::from_name(&self.environment)?;
        let sky = source.load_map(SkySampling::Importance)?;
        print_notes(sky.notes());
        Ok(sky)
    }
}

/// Says what was found and changed in the files of environments, to standard error.
pub fn print_notes<'a>(notes: impl IntoIterator<Item = &'a MapNotes>) {
    for sentence in notes.into_iter().flat_map(MapNotes::sentences) {
        output::message(&format!("merlkit: {sentence}"));
    }
}

/// A JSON document's results, with what was found and changed in the environment's file, should there be one.
#[derive(Serialize)]
pub struct UnderSky<'a, T: Serialize> {
    #[serde(flatten)]
    pub results: T,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment_file: Option<&'a MapNotes>,
}
