//! Mitsuba 3: the fit as it is, by blended BSDFs, and as the principled one.

use super::{FitExport, join_numbers, show_number};
use crate::measure::fit::FittedLobe;

/// A scene of two BSDFs. NAME is the fit itself: a blend of n parts is their sum if each is n times as bright, so the colours of
/// the parts may exceed 1. NAME_principled has the parameters of metallic-roughness materials.
pub(super) fn write(export: &FitExport<'_>) -> String {
    let count = export.lobes().len() as f64 + 1.0;
    let diffuse = format!(
        "<bsdf type=\"diffuse\">\n{}</bsdf>\n",
        color("reflectance", export.fit.diffuse.map(|c| c * count))
    );
    let mut parts = vec![diffuse];
    for lobe in export.lobes() {
        parts.push(conductor(lobe, count));
    }
    let body = format!("{}{}", blend(&parts, &export.name), principled(export));
    format!(
        "<!-- {} -->\n<scene version=\"3.0.0\">\n{body}</scene>\n",
        export.xml_comment()
    )
}

/// A blend of all parts in equal amounts: the first with the weight 1/n, the blend of the others with (n − 1)/n.
fn blend(parts: &[String], name: &str) -> String {
    let id = if name.is_empty() {
        String::new()
    } else {
        format!(" id=\"{name}\"")
    };
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [first, others @ ..] => {
            let weight = others.len() as f64 / parts.len() as f64;
            format!(
                "<bsdf type=\"blendbsdf\"{id}>\n<float name=\"weight\" value=\"{weight}\" />\n{first}{}</bsdf>\n",
                blend(others, "")
            )
        }
    }
}

/// GGX microfacets of the fitted index, times the colour.
fn conductor(lobe: &FittedLobe, scale: f64) -> String {
    let value = |key| show_number(lobe.shape(key).unwrap_or(0.1));
    format!(
        "<bsdf type=\"roughconductor\">\n<string name=\"distribution\" value=\"ggx\" />\n\
         <float name=\"alpha_u\" value=\"{}\" />\n<float name=\"alpha_v\" value=\"{}\" />\n\
         <float name=\"eta\" value=\"{}\" />\n<float name=\"k\" value=\"0\" />\n{}</bsdf>\n",
        value("ax"),
        value("ay"),
        value("nreal"),
        color("specular_reflectance", lobe.colour.map(|c| c * scale))
    )
}

/// A linear colour whose channels may exceed 1.
fn color(name: &str, value: [f64; 3]) -> String {
    format!(
        "<texture type=\"srgb\" name=\"{name}\">\n<rgb name=\"color\" value=\"{}\" />\n\
         <boolean name=\"unbounded\" value=\"true\" />\n</texture>\n",
        join_numbers(&value, " ")
    )
}

/// Disney's principled BSDF: α are r²/a and r²·a, a = √(1 − 0.9·anisotropic), and a dielectric reflects 0.08·specular.
fn principled(export: &FitExport<'_>) -> String {
    let material = &export.material;
    let [ax, ay] = material.alpha;
    let anisotropic = ((1.0 - ax.min(ay) / ax.max(ay)) / 0.9).min(1.0);
    let coat = match material.coat {
        // The plugin's coat has the weight 1/4 of this parameter, and its roughness runs the other way.
        Some([weight, alpha]) => format!(
            "<float name=\"clearcoat\" value=\"{}\" />\n<float name=\"clearcoat_gloss\" value=\"{}\" />\n",
            show_number(weight),
            show_number(((0.1 - alpha) / 0.099).clamp(0.0, 1.0))
        ),
        None => String::new(),
    };
    format!(
        "<bsdf type=\"principled\" id=\"{}_principled\">\n<rgb name=\"base_color\" value=\"{}\" />\n\
         <float name=\"metallic\" value=\"{}\" />\n<float name=\"roughness\" value=\"{}\" />\n\
         <float name=\"anisotropic\" value=\"{}\" />\n<float name=\"specular\" value=\"{}\" />\n{coat}</bsdf>\n",
        export.name,
        join_numbers(&material.base_color, " "),
        show_number(material.metallic),
        show_number(material.mean_alpha().sqrt()),
        show_number(anisotropic),
        show_number(0.5 * material.specular)
    )
}
