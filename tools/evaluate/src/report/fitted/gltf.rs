//! glTF 2.0: a metallic-roughness material, with the extensions for what the fit has besides.

use serde_json::{Map, Value, json};

use super::FitExport;

/// A document of one material. Roughness is √α. Anisotropic lobes become KHR_materials_anisotropy, a second lobe becomes
/// KHR_materials_clearcoat, a sheen KHR_materials_sheen, and a dielectric that reflects less than 4 % KHR_materials_specular.
pub(super) fn write(export: &FitExport<'_>) -> String {
    let material = &export.material;
    let [r, g, b] = material.base_color.map(round);
    let [ax, ay] = material.alpha;
    let mut extensions = Map::new();
    if material.specular < 1.0 {
        let factor = json!({ "specularFactor": round(material.specular) });
        extensions.insert("KHR_materials_specular".into(), factor);
    }
    if let Some([weight, alpha]) = material.coat {
        let coat = json!({
            "clearcoatFactor": round(weight),
            "clearcoatRoughnessFactor": round(alpha.sqrt()),
        });
        extensions.insert("KHR_materials_clearcoat".into(), coat);
    }
    if let Some(sheen) = material.sheen {
        let layer = json!({
            "sheenColorFactor": sheen.color.map(round),
            "sheenRoughnessFactor": round(sheen.alpha.sqrt()),
        });
        extensions.insert("KHR_materials_sheen".into(), layer);
    }
    if ax != ay {
        extensions.insert("KHR_materials_anisotropy".into(), anisotropy(ax, ay));
    }
    let mut definition = json!({
        "name": export.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0],
            "metallicFactor": round(material.metallic),
            // With the extension this is the roughness of the smoother axis.
            "roughnessFactor": round(ax.min(ay).sqrt()),
        },
    });
    let used: Vec<Value> = extensions.keys().map(|key| json!(key)).collect();
    let mut document = json!({
        "asset": {
            "version": "2.0",
            "generator": format!("merlkit {}", env!("CARGO_PKG_VERSION")),
            "extras": { "comment": export.comment },
        },
    });
    if !used.is_empty() {
        definition["extensions"] = Value::Object(extensions);
        document["extensionsUsed"] = Value::Array(used);
    }
    document["materials"] = json!([definition]);
    format!("{document:#}\n")
}

/// The strength s of α_t = α_b + (1 − α_b)·s², t being the rougher axis, and the angle of that axis from x.
fn anisotropy(ax: f64, ay: f64) -> Value {
    let (smooth, rough) = (ax.min(ay), ax.max(ay));
    let strength = ((rough - smooth) / (1.0 - smooth)).sqrt();
    let rotation = if ax > ay {
        0.0
    } else {
        std::f64::consts::FRAC_PI_2
    };
    json!({ "anisotropyStrength": round(strength), "anisotropyRotation": rotation })
}

/// Six digits after the point.
fn round(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}
