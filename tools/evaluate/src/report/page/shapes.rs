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
    let one = |of: &MaterialCharts| {
        subheading(&of.material)
            + &{
                let pairs = of
                    .densities
                    .iter()
                    .zip(&of.discs)
                    .flat_map(|(density, disc)| [density, disc]);
                charts([&of.lobe]) + &charts(pairs)
            }
    };
    let all: String = comparison.charts.iter().map(one).collect();
    Section::new(
        "shapes",
        "Lobes, densities, directions",
        paragraph(&note) + &all,
    )
}
