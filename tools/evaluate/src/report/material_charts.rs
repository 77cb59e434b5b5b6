//! The charts of a material that the page of a comparison shows.

use super::charts::ChartSubject;
use super::curve_charts::{CurveCharts, CurveOptions};
use crate::measure::compare::{MaterialCharts, supported};
use crate::plot::{ChartSize, Polar};
use merlkit::Result;
use merlkit::material::Loaded;
use merlkit::sampler::SamplerSpec;

/// Charts of a page are as wide as a phone's screen, so that their text is large enough there; wide screens show several in a
/// row.
pub(super) const PAGE_CHART: ChartSize = ChartSize {
    width: 360.0,
    height: None,
};
/// Directions on each disc of [`material_charts`], and the seed of their draws.
const CLOUD: (usize, u64) = (600, 0);
/// Angle between `wo` and the normal in [`material_charts`], degrees; and those of the lobe alone.
const SHOWN_DEG: f64 = 45.0;
const LOBES_DEG: [f64; 4] = [10.0, 30.0, 60.0, 80.0];

/// What `material` and those of the main samplers that it supports look like: the lobe, and by sampler its density and its
/// directions.
///
/// # Errors
/// Those of building the samplers.
pub fn material_charts(material: &Loaded) -> Result<MaterialCharts> {
    let only = std::slice::from_ref(material);
    let options = CurveOptions::default();
    let lobes = CurveCharts::new(only, LOBES_DEG.to_vec(), Vec::new(), options)?;
    let mut charts = MaterialCharts {
        material: material.name().into(),
        theta_o_deg: SHOWN_DEG,
        lobe: titled(
            lobes.lobe_polar(),
            &format!("{}: lobe at several angles", material.name()),
        ),
        densities: Vec::new(),
        discs: Vec::new(),
    };
    let shown = ["adaptive-disc", "cascade-cdf", "half-vector", "cosine"];
    for spec in SamplerSpec::parse_all(&shown)? {
        if !supported(&spec, &[material.facts()]) {
            continue;
        }
        let sampler = spec.build(material)?;
        let samplers = vec![vec![sampler.clone()]];
        let densities = CurveCharts::new(only, vec![SHOWN_DEG], samplers, options)?;
        let title = format!("density of {}", spec.name());
        charts
            .densities
            .push(titled(densities.lobe_polar(), &title));
        let subject = ChartSubject::new(material, vec![SHOWN_DEG], Some(sampler));
        let mut disc = subject.disc(CLOUD.0, CLOUD.1);
        disc.caption.title = format!("directions of {}", spec.name());
        // The page says what small cells look like; there is no room for it in the legend.
        if let Some((cells, _)) = disc.labels[0].split_once(" (") {
            disc.labels[0] = cells.to_owned();
        }
        charts.discs.push(disc.svg_sized(PAGE_CHART));
    }
    Ok(charts)
}

/// A chart under a short title: the page's heading has the name of the material.
fn titled(mut chart: Polar, title: &str) -> String {
    chart.caption.title = title.into();
    chart.svg_sized(PAGE_CHART)
}
