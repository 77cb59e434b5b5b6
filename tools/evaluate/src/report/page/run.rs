//! What was measured, with what and on what.

use super::Section;
use super::html::{definition_list, paragraph};
use crate::measure::compare::Comparison;
use crate::report::{Machine, Provenance};

/// What is compared, and what made the page.
pub(super) fn head(comparison: &Comparison, provenance: &Provenance) -> String {
    let intro = "A comparison of samplers for measured materials: the error of an estimate against the number of samples, the time \
                 and the memory that it takes. All results are from one run of merlkit compare; compare.json and \
                 compare.csv contain them in full.";
    let mut origin = vec![(
        "Command",
        format!("{} (merlkit {})", provenance.command, provenance.version),
    )];
    origin.extend(provenance.date.iter().map(|date| ("Date", date.clone())));
    let machine = provenance.machine.as_ref().map(Machine::sentence);
    origin.extend(machine.map(|machine| ("Machine", machine)));
    if comparison.plan.quick {
        origin.push(("Extent", QUICK.to_owned()));
    }
    format!("{}{}", paragraph(intro), definition_list(&origin))
}

const QUICK: &str = "quick: fewer samplers, angles, seeds and settings than in a full run, so the results are less precise";

/// The plan in words.
pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let plan = &comparison.plan;
    let materials: Vec<&str> = comparison
        .materials
        .iter()
        .map(|m| m.material.as_str())
        .collect();
    let (point, picture) = (&plan.point, &plan.picture);
    let angles: Vec<String> = point.theta_o_deg.iter().map(|t| format!("{t}°")).collect();
    let last = (point.first_seed + point.seeds).saturating_sub(1);
    let extent = if plan.quick { QUICK } else { "full" };
    let lines = [
        (
            "Materials",
            if materials.is_empty() {
                "none".into()
            } else {
                materials.join(", ")
            },
        ),
        ("Run", extent.to_owned()),
        (
            "Lookup",
            format!(
                "{}: how values between the samples of a table are interpolated",
                plan.lookup.name()
            ),
        ),
        ("Light on the point", plan.sky.clone()),
        ("Viewer", format!("{} from the normal", angles.join(", "))),
        (
            "Seeds",
            format!(
                "{} to {last}: {} estimates per angle",
                point.first_seed, point.seeds
            ),
        ),
        (
            "Pictures",
            format!("{}² pixels, seed {}", picture.side, picture.seed),
        ),
        (
            "Threads",
            format!(
                "{} for building and rendering; one for timing a sample",
                comparison.threads
            ),
        ),
    ];
    Section::new("run", "What was measured", definition_list(&lines))
}
