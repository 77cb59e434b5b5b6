//! What materials and samplers look like.

use super::Section;
use super::html::{chart_pairs, charts, paragraph, subheading};
use crate::measure::compare::{Comparison, MaterialCharts};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let first = comparison.charts.first()?;
    let note = format!(
        "The view direction wo is at {}° from the normal, on the left. Discs show the hemisphere of light directions from \
         above, with directions drawn by each sampler; for the adaptive disc, they also show its cells, the \
         smallest as dots. Polar plots show the plane of incidence: first the lobe f·cos θi at several angles, then the ideal density and that of each sampler. The \
         closer these two are, the smaller the error.",
        first.theta_o_deg
    );
    let lobes = subheading("Lobes") + &charts(comparison.charts.iter().map(|c| &c.lobe));
    let densities: String = comparison.charts.iter().map(material).collect();
    Section::new(
        "shapes",
        "Lobes, densities, directions",
        paragraph(&note) + &lobes + &densities,
    )
}

/// Each density for a material, with the directions drawn from it.
fn material(of: &MaterialCharts) -> String {
    let mut pairs = Vec::new();
    for (density, disc) in of.densities.iter().zip(&of.discs) {
        pairs.extend([density, disc]);
    }
    subheading(&of.material) + &chart_pairs(pairs)
}
