//! MaterialX 1.39: the fit as an OpenPBR surface and as a standard surface.

use std::fmt::Write;

use super::{FitExport, join_numbers, show_number};

/// A document of two materials, NAME_openpbr and NAME_standard. Both shaders square their roughness to get α.
pub(super) fn write(export: &FitExport<'_>) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {} -->\n<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n",
        export.xml_comment()
    );
    shader(
        &mut text,
        export,
        "openpbr",
        "open_pbr_surface",
        &openpbr(export),
    );
    shader(
        &mut text,
        export,
        "standard",
        "standard_surface",
        &standard(export),
    );
    text + "</materialx>\n"
}

/// A shader with its inputs, each a name, a type and a value, and the material that refers to it.
fn shader(
    text: &mut String,
    export: &FitExport<'_>,
    suffix: &str,
    node: &str,
    inputs: &[(&str, &str, String)],
) {
    let name = format!("{}_{suffix}", export.name);
    let _ = writeln!(
        text,
        "  <{node} name=\"{name}_shader\" type=\"surfaceshader\">"
    );
    for (input, kind, value) in inputs {
        let _ = writeln!(
            text,
            "    <input name=\"{input}\" type=\"{kind}\" value=\"{value}\" />"
        );
    }
    let _ = writeln!(
        text,
        "  </{node}>\n  <surfacematerial name=\"{name}\" type=\"material\">\n    \
         <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{name}_shader\" />\n  </surfacematerial>"
    );
}

/// OpenPBR: α along the rougher axis is r²·√(2/(1 + q²)) and q times that along the other, q = 1 − anisotropy.
fn openpbr<'a>(export: &FitExport<'_>) -> Vec<(&'a str, &'a str, String)> {
    let material = &export.material;
    let [ax, ay] = material.alpha;
    let (smooth, rough) = (ax.min(ay), ax.max(ay));
    let ratio = smooth / rough;
    let square = rough * (0.5 * (1.0 + ratio * ratio)).sqrt();
    let mut inputs = vec![
        (
            "base_color",
            "color3",
            join_numbers(&material.base_color, ", "),
        ),
        ("base_metalness", "float", show_number(material.metallic)),
        ("specular_weight", "float", show_number(material.specular)),
        ("specular_roughness", "float", show_number(square.sqrt())),
        ("specular_ior", "float", "1.5".into()),
        (
            "specular_roughness_anisotropy",
            "float",
            show_number(1.0 - ratio),
        ),
    ];
    if let Some([weight, alpha]) = material.coat {
        inputs.push(("coat_weight", "float", show_number(weight)));
        inputs.push(("coat_roughness", "float", show_number(alpha.sqrt())));
        inputs.push(("coat_ior", "float", "1.5".into()));
        inputs.push(("coat_darkening", "float", "0".into()));
    }
    inputs
}

/// The standard surface: α are r²/a and r²·a, a = √(1 − 0.98·anisotropy).
fn standard<'a>(export: &FitExport<'_>) -> Vec<(&'a str, &'a str, String)> {
    let material = &export.material;
    let [ax, ay] = material.alpha;
    let ratio = ax.min(ay) / ax.max(ay);
    let anisotropy = ((1.0 - ratio) / 0.98).min(1.0);
    let rotation = if ay > ax { "0.25" } else { "0" };
    let mut inputs = vec![
        ("base", "float", "1".into()),
        (
            "base_color",
            "color3",
            join_numbers(&material.base_color, ", "),
        ),
        ("metalness", "float", show_number(material.metallic)),
        ("specular", "float", show_number(material.specular)),
        (
            "specular_roughness",
            "float",
            show_number(material.mean_alpha().sqrt()),
        ),
        ("specular_IOR", "float", "1.5".into()),
        ("specular_anisotropy", "float", show_number(anisotropy)),
        ("specular_rotation", "float", rotation.into()),
    ];
    if let Some([weight, alpha]) = material.coat {
        inputs.push(("coat", "float", show_number(weight)));
        inputs.push(("coat_roughness", "float", show_number(alpha.sqrt())));
    }
    inputs
}
