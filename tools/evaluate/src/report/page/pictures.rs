//! Pictures side by side, with what they are off by.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::Section;
use super::families::{chosen, family, short_label};
use super::html::{charts, escape, paragraph, subheading};
use crate::measure::compare::{Comparison, PICTURE_SAMPLES, PictureComparison, PictureResult};
use crate::plot::{Axis, Caption, Lines, Marks, Scale, Series};
use crate::report::compare::{by_error, duration, flip, percent};
use crate::report::material_charts::PAGE_CHART;

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let all: String = comparison.pictures.iter().map(scene).collect();
    if all.is_empty() {
        return None;
    }
    let note = format!(
        "Pictures with {PICTURE_SAMPLES} Sobol samples per pixel, after the reference, the least error first. Below each picture \
         is its relative difference from the reference, from black (none) to white (100 % or more). The caption gives the \
         mean relative error over the lit pixels, the mean of FLIP, which is 0 where a person sees no difference, and the \
         render time on all threads. Click a picture, or press the space bar, to enlarge it or to make it small again."
    );
    Section::new("pictures", "Pictures", paragraph(&note) + &all)
}

fn scene(picture: &PictureComparison) -> String {
    let mut shown = by_error(picture);
    shown.retain(|result| !result.png.is_empty());
    let title = format!("{}: {}", picture.scene.name(), picture.material);
    let figures: String = shown.iter().map(|r| result(&title, r)).collect();
    let row = format!(
        "<div class=\"pictures\">\n{}{figures}</div>\n",
        reference(&title, picture)
    );
    subheading(&title) + &row + &errors(&title, picture)
}

fn reference(title: &str, picture: &PictureComparison) -> String {
    let reference = &picture.reference;
    let image = image(&reference.png, &format!("{title}, reference"));
    format!(
        "<figure>{image}<figcaption><b>reference</b> {} samples, {}; own error {}</figcaption></figure>\n",
        reference.samples,
        escape(&reference.label),
        percent(reference.relative_error)
    )
}

fn result(title: &str, result: &PictureResult) -> String {
    let error = percent(result.errors.mean_relative);
    let picture = image(
        &result.png,
        &format!("{title}, {}: error {error}", result.label),
    );
    let difference = image(
        &result.difference,
        &format!("{title}, {}: difference from the reference", result.label),
    );
    format!(
        "<figure>{picture}{difference}<figcaption><b>{error}</b> FLIP {}<br />{}, {}</figcaption></figure>\n",
        flip(result),
        escape(&result.label),
        duration(result.seconds.wall)
    )
}

/// A picture that grows when it is clicked; nothing if there is none.
pub(super) fn image(png: &[u8], alt: &str) -> String {
    if png.is_empty() {
        return String::new();
    }
    let alt = escape(alt);
    let data = STANDARD.encode(png);
    format!(
        "<label class=\"zoom\"><input type=\"checkbox\" aria-label=\"enlarge: {alt}\" />\
         <img alt=\"{alt}\" src=\"data:image/png;base64,{data}\" /></label>"
    )
}

/// Charts of errors against samples, if there are several numbers of them.
fn errors(title: &str, picture: &PictureComparison) -> String {
    let most = picture.results.iter().map(|r| r.samples).max().unwrap_or(0);
    if picture.results.iter().all(|r| r.samples == most) {
        return String::new();
    }
    let mut best: Vec<&PictureResult> = picture
        .results
        .iter()
        .filter(|r| r.samples == most)
        .collect();
    best.sort_by(|a, b| a.errors.mean_relative.total_cmp(&b.errors.mean_relative));
    let groups = chosen(&best, |r| &r.competitor);
    let mut pictures = Vec::new();
    for (name, group) in ["BRDF alone", "light sampling"].iter().zip(&groups) {
        if !group.is_empty() {
            pictures.push(chart(name, title, picture, group));
        }
    }
    charts(&pictures)
}

fn chart(name: &str, title: &str, picture: &PictureComparison, shown: &[&PictureResult]) -> String {
    let series = |of: &&PictureResult| {
        let same = picture
            .results
            .iter()
            .filter(|r| r.competitor == of.competitor);
        Series {
            label: short_label(&of.label),
            points: same
                .map(|r| (r.samples as f64, r.errors.mean_relative))
                .collect(),
            style: family(&of.competitor),
            marks: Marks::Each,
            ..Series::default()
        }
    };
    let caption = Caption::new(
        format!("{name}: error by samples per pixel"),
        format!(
            "{title}: mean relative error over lit pixels against samples per pixel, for the sampler of each kind that is best at \
             the highest sample count."
        ),
    );
    let x = Axis::new("samples per pixel", Scale::Log);
    let y = Axis::new("mean relative error", Scale::Log);
    Lines {
        caption,
        x,
        y,
        series: shown.iter().map(series).collect(),
    }
    .svg_sized(PAGE_CHART)
}
