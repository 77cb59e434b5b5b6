//! pbrt-v4: a mixture of a diffuse material and conductors.

use std::fmt::Write;

use super::{FitExport, join_numbers, show_number};

/// pbrt's conductors reflect less than this.
const LARGEST_REFLECTANCE: f64 = 0.999;

/// Named materials, of which NAME is the whole. A mixture with the amounts p of materials that are 1/p times as bright is their
/// sum; p is in proportion to the brightest channel, which keeps all reflectances below 1 where the sum of those is.
pub(super) fn write(export: &FitExport<'_>) -> String {
    let name = &export.name;
    let mut parts = vec![(format!("{name}_diffuse"), export.fit.diffuse)];
    for (i, lobe) in export.lobes().iter().enumerate() {
        let colour = lobe.along_normal().unwrap_or_default();
        parts.push((format!("{name}_lobe{}", i + 1), colour));
    }
    let brightest: Vec<f64> = parts.iter().map(|part| largest(part.1).max(1e-6)).collect();
    let total: f64 = brightest.iter().sum();
    let mut text = format!("# {}\n", export.comment);
    for (i, (part, colour)) in parts.iter().enumerate() {
        let scale = total / brightest[i];
        let colour = colour.map(|c| (c * scale).min(LARGEST_REFLECTANCE));
        let reflectance = join_numbers(&colour, " ");
        let _ = write!(text, "MakeNamedMaterial \"{part}\" \"string type\" ");
        let _ = match export.lobes().get(i.wrapping_sub(1)) {
            None => writeln!(text, "\"diffuse\" \"rgb reflectance\" [ {reflectance} ]"),
            Some(lobe) => {
                let [x, y] = ["ax", "ay"].map(|key| show_number(lobe.shape(key).unwrap_or(0.1)));
                writeln!(
                    text,
                    "\"conductor\" \"rgb reflectance\" [ {reflectance} ] \"float uroughness\" [ {x} ] \
                     \"float vroughness\" [ {y} ] \"bool remaproughness\" [ false ]"
                )
            }
        };
    }
    mix(&mut text, name, &parts, &brightest);
    text
}

/// The mixture of all parts: the first two, then that with the third.
fn mix(text: &mut String, name: &str, parts: &[(String, [f64; 3])], amounts: &[f64]) {
    let mut mixed = parts[0].0.clone();
    let mut sum = amounts[0];
    for (i, part) in parts.iter().enumerate().skip(1) {
        sum += amounts[i];
        let whole = if i + 1 == parts.len() {
            name.to_owned()
        } else {
            format!("{name}_mix{i}")
        };
        let amount = show_number(amounts[i] / sum);
        let _ = writeln!(
            text,
            "MakeNamedMaterial \"{whole}\" \"string type\" \"mix\" \"string materials\" [ \"{mixed}\" \"{}\" ] \
             \"float amount\" [ {amount} ]",
            part.0
        );
        mixed = whole;
    }
}

fn largest(colour: [f64; 3]) -> f64 {
    colour[0].max(colour[1]).max(colour[2])
}
