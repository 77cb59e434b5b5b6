//! `merlkit plot --kind disc --fit FILE`: a cloud of values on the disc.

use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit_evaluate::measure::cloud::{CloudUnits, PointCloud};
use merlkit_evaluate::plot::{Caption, Chart, Disc, DiscMark};

use crate::args;

/// Words of [`CloudUnits`].
pub const UNITS: &[(&str, CloudUnits)] = &[
    ("degrees", CloudUnits::Degrees),
    ("thesis", CloudUnits::Thesis),
];

/// A file with a cloud of values.
#[derive(clap::Args)]
pub struct CloudOptions {
    /// disc: draw the cloud of a FIT file instead of a material's directions
    #[arg(long, value_name = "FILE", conflicts_with_all = ["materials", "samplers", "theta", "samples"])]
    pub fit: Option<PathBuf>,
    /// Units of the viewer in that file: degrees, or θ in radians and φ in degrees (thesis) [default: what the numbers allow]
    #[arg(long, value_name = "degrees|thesis", hide_possible_values = true, requires = "fit", value_parser = args::named(UNITS))]
    pub fit_units: Option<CloudUnits>,
}

impl CloudOptions {
    /// The cloud as a chart.
    ///
    /// # Errors
    /// Those of reading the file, and of a viewer whose units are unknown.
    pub fn chart(&self, path: &Path) -> Result<Chart, Error> {
        let cloud = PointCloud::open(path)?;
        let [theta, phi] = cloud.viewer_degrees(self.fit_units)?;
        let mut points = Vec::with_capacity(cloud.directions.len());
        for direction in &cloud.directions {
            points.push((direction.x, direction.y));
        }
        let range = match cloud.value_range() {
            Some([low, high]) => format!(", f from {low:.3e} to {high:.3e} sr⁻¹"),
            None => String::new(),
        };
        let wo = args::direction(theta, phi);
        Ok(Chart::Disc(Disc {
            caption: Caption::new(
                format!("{}: cloud at θ = {theta:.4}°, φ = {phi:.4}°", cloud.brdf),
                format!(
                    "The hemisphere of light directions from above, {}.",
                    path.display()
                ),
            ),
            labels: [String::new(), format!("{} directions{range}", points.len())],
            points,
            marks: vec![DiscMark {
                at: (wo.x, wo.y),
                label: "wo".into(),
            }],
            ..Disc::default()
        }))
    }
}
