//! MaterialX 1.39: the fit as an OpenPBR surface and as a standard surface.

use std::fmt::Write;

use super::{FitExport, join_numbers, show_number};
use crate::measure::fit::{FittedLobe, SheenLayer};

/// A document of two materials, NAME_openpbr and NAME_standard. Both shaders square their roughness to get α.
pub(super) fn write(export: &FitExport<'_>) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {} -->\n<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n",
        export.xml_comment()
    );
    let base = SurfaceBase::choose(export);
    let coat = export.material.coat;
    shader(
        &mut text,
        &format!("{}_openpbr", export.name),
        "open_pbr_surface",
        &openpbr(&base, coat),
    );
    shader(
        &mut text,
        &format!("{}_standard", export.name),
        "standard_surface",
        &standard(&base, coat),
    );
    text + "</materialx>\n"
}

/// What lies below the coat.
struct SurfaceBase {
    color: [f64; 3],
    metalness: f64,
    specular: f64,
    specular_color: [f64; 3],
    ior: f64,
    alpha: [f64; 2],
    sheen: Option<SheenLayer>,
}

impl SurfaceBase {
    /// One lobe is a dielectric of the fitted index: both surfaces multiply the whole highlight by a colour, as the fit does. Of two
    /// lobes the base is the metallic-roughness one.
    fn choose(export: &FitExport<'_>) -> Self {
        let material = &export.material;
        if let [lobe] = export.highlights().as_slice()
            && let (Some(ax), Some(ay)) = (lobe.shape("ax"), lobe.shape("ay"))
            && let Some(ior) = lobe.shape("nreal")
        {
            return Self {
                color: export.fit.diffuse,
                metalness: 0.0,
                specular: 1.0,
                specular_color: lobe.colour,
                ior,
                alpha: [ax, ay],
                sheen: export.lobes().iter().find_map(FittedLobe::sheen),
            };
        }
        Self {
            color: material.base_color,
            metalness: material.metallic,
            specular: material.specular,
            specular_color: [1.0; 3],
            ior: 1.5,
            alpha: material.alpha,
            sheen: material.sheen,
        }
    }

    /// The smaller α over the larger one.
    fn ratio(&self) -> f64 {
        let [ax, ay] = self.alpha;
        ax.min(ay) / ax.max(ay)
    }
}

/// The inputs of a sheen: its weight, its colour with a largest channel of 1, and α, which both surfaces take as it is.
fn sheen_inputs(sheen: SheenLayer, names: [&str; 3]) -> Vec<(&str, &str, String)> {
    let [r, g, b] = sheen.color;
    let weight = r.max(g).max(b);
    if weight == 0.0 {
        return Vec::new();
    }
    let color = sheen.color.map(|c| c / weight);
    vec![
        (names[0], "float", show_number(weight)),
        (names[1], "color3", join_numbers(&color, ", ")),
        (names[2], "float", show_number(sheen.alpha)),
    ]
}

/// A shader with its inputs, each a name, a type and a value, and the material that refers to it.
fn shader(text: &mut String, name: &str, node: &str, inputs: &[(&str, &str, String)]) {
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
fn openpbr<'a>(base: &SurfaceBase, coat: Option<[f64; 2]>) -> Vec<(&'a str, &'a str, String)> {
    let ratio = base.ratio();
    let rough = base.alpha[0].max(base.alpha[1]);
    let square = rough * (0.5 * (1.0 + ratio * ratio)).sqrt();
    let roughness = show_number(square.sqrt());
    let anisotropy = show_number(1.0 - ratio);
    let mut inputs = vec![
        ("base_color", "color3", join_numbers(&base.color, ", ")),
        ("base_metalness", "float", show_number(base.metalness)),
        ("specular_weight", "float", show_number(base.specular)),
        (
            "specular_color",
            "color3",
            join_numbers(&base.specular_color, ", "),
        ),
        ("specular_roughness", "float", roughness),
        ("specular_ior", "float", show_number(base.ior)),
        ("specular_roughness_anisotropy", "float", anisotropy),
    ];
    if let Some([weight, alpha]) = coat {
        inputs.push(("coat_weight", "float", show_number(weight)));
        inputs.push(("coat_roughness", "float", show_number(alpha.sqrt())));
        inputs.push(("coat_ior", "float", "1.5".into()));
        inputs.push(("coat_darkening", "float", "0".into()));
    }
    if let Some(sheen) = base.sheen {
        inputs.extend(sheen_inputs(
            sheen,
            ["fuzz_weight", "fuzz_color", "fuzz_roughness"],
        ));
    }
    inputs
}

/// The standard surface: α are r²/a and r²·a, a = √(1 − 0.98·anisotropy).
fn standard<'a>(base: &SurfaceBase, coat: Option<[f64; 2]>) -> Vec<(&'a str, &'a str, String)> {
    let [ax, ay] = base.alpha;
    let anisotropy = ((1.0 - base.ratio()) / 0.98).min(1.0);
    let rotation = if ay > ax { "0.25" } else { "0" };
    // r² is the geometric mean of both α.
    let roughness = show_number((ax * ay).powf(0.25));
    let mut inputs = vec![
        ("base", "float", "1".into()),
        ("base_color", "color3", join_numbers(&base.color, ", ")),
        ("metalness", "float", show_number(base.metalness)),
        ("specular", "float", show_number(base.specular)),
        (
            "specular_color",
            "color3",
            join_numbers(&base.specular_color, ", "),
        ),
        ("specular_roughness", "float", roughness),
        ("specular_IOR", "float", show_number(base.ior)),
        ("specular_anisotropy", "float", show_number(anisotropy)),
        ("specular_rotation", "float", rotation.into()),
    ];
    if let Some([weight, alpha]) = coat {
        inputs.push(("coat", "float", show_number(weight)));
        inputs.push(("coat_roughness", "float", show_number(alpha.sqrt())));
    }
    if let Some(sheen) = base.sheen {
        inputs.extend(sheen_inputs(
            sheen,
            ["sheen", "sheen_color", "sheen_roughness"],
        ));
    }
    inputs
}
