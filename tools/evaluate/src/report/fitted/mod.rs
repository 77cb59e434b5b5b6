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

/// The text of a fit for renderers; `name` is that of the material.
///
/// # Errors
/// [`Error::Argument`] for a fit of other lobes than one or two of GGX, which these formats don't have.
pub fn fitted_text(format: FitFormat, name: &str, fit: &ModelFit) -> Result<String> {
    let Some((material, error)) = fit.metal_rough else {
        return Err(Error::argument(
            format!("renderers' formats have no lobe like that of {}", fit.model),
            "choose --model ggx or --model ggx+ggx, or --format json",
        ));
    };
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
    /// The error of what the format holds of a fit: a metallic-roughness material, or the lobes themselves.
    fn error(self, model: &ModelFit) -> Option<f64> {
        let (_, converted) = model.metal_rough?;
        Some(match self {
            Self::MaterialX | Self::Gltf => converted,
            Self::Mitsuba | Self::Pbrt => model.error,
        })
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
