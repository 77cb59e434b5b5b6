//! What materials and samplers look like.

use super::Section;
use super::html::{charts, paragraph, subheading};
use crate::measure::compare::{Comparison, MaterialCharts};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let first = comparison.charts.first()?;
    let note = format!(
        "The view direction wo is at {}° from the normal, on the left. Discs show the hemisphere of light directions from \
         above, with directions drawn by each sampler; for the adaptive disc, they also show its cells. Polar plots show the \
         plane of incidence: first the lobe f·cos θi at several angles, then the ideal density and that of each sampler. The \
         closer these two are, the smaller the error.",
        first.theta_o_deg
    );
    let all: String = comparison.charts.iter().map(material).collect();
    Section::new(
        "shapes",
        "Lobes, densities, directions",
        paragraph(&note) + &all,
    )
}

/// The lobe of a material, then each density with the directions drawn from it.
fn material(of: &MaterialCharts) -> String {
    let mut pairs = vec![&of.lobe];
    for (density, disc) in of.densities.iter().zip(&of.discs) {
        pairs.extend([density, disc]);
    }
    subheading(&of.material) + &charts(pairs)
}
