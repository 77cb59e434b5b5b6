//! The page of the thesis's experiments: its figures and ours.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::html::{definition_list, escape, paragraph, table};
use super::pictures::image;
use super::{Section, whole_page};
use crate::report::repeated::result_sheet;
use crate::report::{Machine, Provenance};
use crate::thesis::{Exhibit, ThesisPlan, Thumbnail};

const TITLE: &str = "The experiments of the thesis of 2008, repeated";

/// One self-contained HTML page, which is well-formed XML as well, without scripts or addresses of other files. `begun` is the day of the
/// first piece.
pub fn thesis_page(
    exhibits: &[Exhibit],
    plan: &ThesisPlan,
    begun: &str,
    provenance: &Provenance,
) -> String {
    let mut sections = Vec::new();
    sections.extend(Section::new(
        "findings",
        "What agrees and what does not",
        findings(exhibits),
    ));
    let mut ids = Vec::with_capacity(exhibits.len());
    for exhibit in exhibits {
        ids.push(format!("experiment-{}", exhibit.name));
    }
    for (exhibit, id) in exhibits.iter().zip(&ids) {
        sections.extend(Section::new(id, &exhibit.title, describe(exhibit)));
    }
    whole_page(TITLE, &head(plan, begun, provenance), &sections)
}

/// What the page is, and what made it.
fn head(plan: &ThesisPlan, begun: &str, provenance: &Provenance) -> String {
    let intro = "R. Montes's thesis (Universidad de Granada, 2008) compares its adaptive disc with other samplers in tables and scenes. This page \
                 has its figures, quoted as printed, next to those of one run of merlkit thesis. Each section says how ours were measured and \
                 what differs. The thesis's machine was an AMD Opteron of its time, so ratios and orders can be compared, and seconds can't.";
    let mut origin = vec![(
        "Command",
        format!("{} (merlkit {})", provenance.command, provenance.version),
    )];
    if let Some(date) = &provenance.date {
        let days = match date == begun {
            true => date.clone(),
            false => format!("begun on {begun}, finished on {date}"),
        };
        origin.push(("Date", days));
    }
    let machine = provenance.machine.as_ref().map(Machine::sentence);
    origin.extend(machine.map(|machine| ("Machine", machine)));
    let samples: Vec<String> = plan.samples.iter().map(u64::to_string).collect();
    origin.push((
        "Extent",
        format!(
            "{}: {} trees, pictures of {} pixels a side for one object, {} samples per pixel, references with {}",
            if plan.quick { "quick" } else { "full" },
            plan.trees,
            plan.side,
            samples.join(", "),
            plan.reference_samples
        ),
    ));
    if let Some(mesh) = &plan.mesh {
        origin.push((
            "Mesh of scene 3",
            format!(
                "{}: {} vertices, {} triangles, SHA-256 {}",
                mesh.file, mesh.vertices, mesh.faces, mesh.sha256
            ),
        ));
    }
    paragraph(intro) + &definition_list(&origin)
}

/// The findings of all experiments.
fn findings(exhibits: &[Exhibit]) -> String {
    let mut text = String::new();
    for exhibit in exhibits.iter().filter(|e| !e.findings.is_empty()) {
        text += &format!(
            "<h3><a href=\"#experiment-{}\">{}</a></h3>\n<ul>\n",
            escape(&exhibit.name),
            escape(&exhibit.title)
        );
        for finding in &exhibit.findings {
            text += &format!("<li>{}</li>\n", escape(finding));
        }
        text += "</ul>\n";
    }
    text
}

/// One experiment.
fn describe(exhibit: &Exhibit) -> String {
    let mut text = definition_list(&[
        ("Ours", exhibit.method.clone()),
        ("What differs", exhibit.differences.clone()),
    ]);
    for result in &exhibit.tables {
        text += &table(&result.caption, &result_sheet(result));
    }
    if !exhibit.pictures.is_empty() {
        let figures: String = exhibit.pictures.iter().map(figure).collect();
        text += &format!("<div class=\"pictures\">\n{figures}</div>\n");
    }
    text
}

fn figure(thumbnail: &Thumbnail) -> String {
    let png = STANDARD.decode(&thumbnail.png).unwrap_or_default();
    format!(
        "<figure>{}<figcaption>{}</figcaption></figure>\n",
        image(&png, &thumbnail.caption),
        escape(&thumbnail.caption)
    )
}
