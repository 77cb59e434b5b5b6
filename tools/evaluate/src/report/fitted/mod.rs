//! Fits in the formats that renderers read.

mod gltf;
mod materialx;
mod mitsuba;
mod pbrt;

use merlkit::export::identifier;
use merlkit::{Error, Result};

use crate::measure::fit::{FittedLobe, MaterialFit, MetalRough, ModelFit};

/// A format of material definitions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitFormat {
    /// MaterialX, with an OpenPBR surface and a standard surface.
    MaterialX,
    /// A material of glTF 2.0.
    Gltf,
    /// Mitsuba 3's XML.
    Mitsuba,
    /// The text of pbrt-v4.
    Pbrt,
}

impl FitFormat {
    /// Whether the format has a sheen like that of the fits.
    pub fn has_sheen(self) -> bool {
        matches!(self, Self::MaterialX | Self::Gltf)
    }
}

/// The text of a fit for renderers; `name` is that of the material.
///
/// # Errors
/// [`Error::Argument`] for a fit of other lobes than one or two of GGX, and for a sheen in a format without one.
pub fn fitted_text(format: FitFormat, name: &str, fit: &ModelFit) -> Result<String> {
    let Some((material, error)) = fit.metal_rough else {
        return Err(Error::argument(
            format!("renderers' formats have no lobe like that of {}", fit.model),
            "choose --model ggx or --model ggx+ggx, or --format json",
        ));
    };
    if material.sheen.is_some() && !format.has_sheen() {
        return Err(Error::argument(
            format!("Mitsuba and pbrt have no sheen like that of {}", fit.model),
            "choose --format materialx, gltf or json, or --model ggx",
        ));
    }
    let export = FitExport {
        name: identifier(name),
        fit,
        material,
        comment: format!(
            "{name} as fitted by merlkit {}: {}; error {:.4}, as a metallic-roughness material {error:.4}",
            env!("CARGO_PKG_VERSION"),
            fit.material,
            fit.error
        ),
    };
    Ok(match format {
        FitFormat::MaterialX => materialx::write(&export),
        FitFormat::Gltf => gltf::write(&export),
        FitFormat::Mitsuba => mitsuba::write(&export),
        FitFormat::Pbrt => pbrt::write(&export),
    })
}

/// The fit of the least error, the first of equals, of those that a format can hold; `None` if it holds none.
pub fn best_held(format: FitFormat, fit: &MaterialFit) -> Option<&ModelFit> {
    let mut best: Option<(f64, &ModelFit)> = None;
    for model in &fit.fits {
        if let Some(error) = format.error(model)
            && best.is_none_or(|best| error < best.0)
        {
            best = Some((error, model));
        }
    }
    best.map(|best| best.1)
}

impl FitFormat {
    /// The error of what the format holds of a fit: a metallic-roughness material, or the lobes themselves, of which none may be a
    /// sheen.
    fn error(self, model: &ModelFit) -> Option<f64> {
        let (material, converted) = model.metal_rough?;
        match self {
            Self::MaterialX | Self::Gltf => Some(converted),
            Self::Mitsuba | Self::Pbrt => material.sheen.is_none().then_some(model.error),
        }
    }
}

/// A fit on its way into a file.
struct FitExport<'a> {
    /// Letters, digits and underscores.
    name: String,
    fit: &'a ModelFit,
    material: MetalRough,
    comment: String,
}

impl FitExport<'_> {
    /// The parts of the sum apart from the diffuse one.
    fn lobes(&self) -> &[FittedLobe] {
        &self.fit.lobes
    }

    /// The lobes that are no sheen.
    fn highlights(&self) -> Vec<&FittedLobe> {
        let lobes = self.lobes().iter();
        lobes.filter(|lobe| lobe.sheen().is_none()).collect()
    }

    /// The comment without what would end a comment of XML.
    fn xml_comment(&self) -> String {
        self.comment.replace("--", "-")
    }
}

/// Numbers with a separator between them.
fn join_numbers(numbers: &[f64], separator: &str) -> String {
    let mut texts = Vec::with_capacity(numbers.len());
    for number in numbers {
        texts.push(show_number(*number));
    }
    texts.join(separator)
}

/// Six digits after the point, without zeros at the end.
fn show_number(number: f64) -> String {
    let text = format!("{number:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fit::{FitModel, FitPlan, fit_models};
    use merlkit::material::analytic::ModelFacts;

    fn fit(material: &str, model: &str) -> ModelFit {
        let brdf = ModelFacts::brdf(material).unwrap();
        let plan = FitPlan {
            pairs: 300,
            validation_pairs: 300,
            ..FitPlan::default()
        };
        let models = [FitModel::parse(model).unwrap()];
        fit_models("x", &*brdf, &models, &plan)
            .unwrap()
            .fits
            .remove(0)
    }

    #[test]
    fn every_format_holds_one_and_two_lobes_of_ggx_and_no_others() {
        let text = "lambert:reflectance=0.3/0.1/0.1+ggx:ax=0.1,ay=0.1,nreal=1.5,nimag=0";
        let formats = [
            FitFormat::MaterialX,
            FitFormat::Gltf,
            FitFormat::Mitsuba,
            FitFormat::Pbrt,
        ];
        for format in formats {
            for model in ["ggx", "ggx+ggx"] {
                let written = fitted_text(format, "red -- paint", &fit(text, model)).unwrap();
                assert!(written.contains("red_paint"), "{format:?}: {written}");
                assert!(!written.contains("NaN"));
            }
            assert!(fitted_text(format, "x", &fit(text, "ward")).is_err());
        }
        let gltf = fitted_text(FitFormat::Gltf, "x", &fit(text, "ggx")).unwrap();
        let document: serde_json::Value = serde_json::from_str(&gltf).unwrap();
        let factor = &document["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"];
        // α = 0.1 is the square of the roughness, which the refined parameters come near to.
        assert!(
            (factor.as_f64().unwrap() - 0.1f64.sqrt()).abs() < 0.02,
            "{gltf}"
        );
    }

    #[test]
    fn a_sheen_is_written_where_the_format_has_one_and_refused_elsewhere() {
        let cloth =
            "lambert:reflectance=0.2+ggx:ax=0.5,ay=0.5,nreal=1.5,nimag=0+sheen:alpha=0.25,ks=0.4";
        let fit = fit(cloth, "ggx+sheen+diffuse");
        let text = fitted_text(FitFormat::Gltf, "x", &fit).unwrap();
        let document: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(document["extensionsUsed"][0], "KHR_materials_sheen");
        let sheen = &document["materials"][0]["extensions"]["KHR_materials_sheen"];
        let roughness = sheen["sheenRoughnessFactor"].as_f64().unwrap();
        // α = 0.25, which glTF's base moves a little: its diffuse part is darker where the highlight is bright.
        assert!((roughness - 0.5).abs() < 0.1, "{text}");
        let text = fitted_text(FitFormat::MaterialX, "x", &fit).unwrap();
        for input in ["fuzz_weight", "fuzz_color", "sheen", "sheen_roughness"] {
            assert!(text.contains(&format!("name=\"{input}\"")), "{text}");
        }
        for format in [FitFormat::Mitsuba, FitFormat::Pbrt] {
            let message = fitted_text(format, "x", &fit).unwrap_err().to_string();
            assert!(message.contains("gltf"), "{message}");
        }
    }

    #[test]
    fn numbers_are_short() {
        for (number, text) in [
            (0.5, "0.5"),
            (1.0, "1"),
            (1e-9, "0"),
            (-1e-9, "0"),
            (10.0, "10"),
        ] {
            assert_eq!(show_number(number), text);
        }
    }
}
