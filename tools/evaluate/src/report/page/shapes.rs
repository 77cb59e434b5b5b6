//! What materials and samplers look like.

use super::Section;
use super::html::{charts, paragraph, subheading};
use crate::measure::compare::{Comparison, MaterialCharts};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let first = comparison.charts.first()?;
    let note = format!(
        "The viewer wo stands at {}° from the normal, on the left. Discs show the hemisphere of light directions from above, \
         with directions as each sampler draws them; of the adaptive disc also the squares it divides the disc into. Polar \
         plots show the plane of incidence: first the lobe f·cos θi at several angles, then the density each sampler should \
         have and the one it has. The closer these two, the smaller the error.",
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
