//! BRDFs given by a formula: "lambert:reflectance=0.5".
//!
//! A model is one file here and one line in `MODELS`. Its text is its name and its parameters, `name:key=value,key=value`;
//! parameters that are left out keep the model's defaults.

mod lambert;
mod model;
mod parameters;

use std::sync::Arc;

pub use lambert::Lambert;

use super::format::{MaterialFormat, Origin, TableReading};
use super::{Loaded, MaterialFacts};
use crate::brdf::Brdf;
use crate::{Error, Result};
use model::Model;
use parameters::Parameters;

/// All models.
const MODELS: [Model; 1] = [lambert::MODEL];

/// Texts that name a model and its parameters.
pub(super) struct Formulas;

impl MaterialFormat for Formulas {
    fn recognises(&self, origin: &Origin) -> bool {
        matches!(origin, Origin::Formula(_))
    }

    fn facts(&self, origin: &Origin) -> Result<MaterialFacts> {
        // Building a formula takes no time.
        Ok(self.load(origin, TableReading::default())?.facts())
    }

    fn load(&self, origin: &Origin, _: TableReading) -> Result<Loaded> {
        let text = origin.path().to_string_lossy();
        match parse(&text)? {
            Some((brdf, _)) => Ok(Loaded::from_brdf(brdf).with_reading("values of a formula")),
            None => Err(unknown_model(&text)),
        }
    }
}

/// The formula that `argument` means, with all its parameters spelt out; `None` for what does not read as a formula.
///
/// # Errors
/// [`Error::Argument`] for `name:key=value` of a name that is no model, and for a parameter that is unknown, given twice or
/// outside its domain.
pub(super) fn canonical_text(argument: &str) -> Result<Option<String>> {
    Ok(parse(argument)?.map(|(_, text)| text))
}

/// The BRDF of a formula and its canonical text.
fn parse(argument: &str) -> Result<Option<(Arc<dyn Brdf>, String)>> {
    let (name, settings) = argument.split_once(':').unwrap_or((argument, ""));
    let Some(model) = MODELS.iter().find(|model| model.name == name) else {
        return match settings.contains('=') {
            true => Err(unknown_model(name)),
            false => Ok(None),
        };
    };
    let mut parameters = Parameters::parse(model.name, settings)?;
    let brdf = (model.build)(&mut parameters)?;
    Ok(Some((brdf, parameters.finish()?)))
}

fn unknown_model(name: &str) -> Error {
    let names: Vec<&str> = MODELS.iter().map(|model| model.name).collect();
    Error::argument(
        format!("no formula is called \"{name}\""),
        format!("choose {}", names.join(", ")),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn refusal(text: &str) -> String {
        canonical_text(text).unwrap_err().to_string()
    }

    #[test]
    fn every_mistake_has_one_clear_answer() {
        for (text, what, fix) in [
            ("lambrt:reflectance=0.5", "\"lambrt\"", "lambert"),
            ("lambert:albedo=0.5", "no parameter albedo", "reflectance"),
            ("lambert:reflectance=1.5", "reflectance=1.5", "0 to 1"),
            ("lambert:reflectance=-0.1", "reflectance=-0.1", "0 to 1"),
            ("lambert:reflectance=nan", "reflectance=nan", "0 to 1"),
            ("lambert:reflectance=", "reflectance=", "0 to 1"),
            ("lambert:reflectance=0.1/0.2", "0.1/0.2", "three"),
            ("lambert:reflectance=0.1,reflectance=0.2", "twice", "once"),
            ("lambert:0.5", "\"0.5\"", "key=value"),
        ] {
            let message = refusal(text);
            assert!(
                message.contains(what) && message.contains(fix),
                "{text}: {message}"
            );
        }
    }

    #[test]
    fn what_is_no_formula_is_left_alone() {
        for text in ["nickel", "./lambert", "c:\\paint.bsdf", "some:thing"] {
            assert_eq!(canonical_text(text).unwrap(), None, "{text}");
        }
    }

    #[test]
    fn channels_are_set_one_by_one_or_together() {
        let value = |text: &str| parse(text).unwrap().unwrap().0.eval(Vec3::Z, Vec3::Z);
        let lambert = |r: f32, g: f32, b: f32| {
            let reflectance = Vec3::new(r, g, b);
            Lambert { reflectance }.eval(Vec3::Z, Vec3::Z)
        };
        assert_eq!(value("lambert:reflectance=0.2"), lambert(0.2, 0.2, 0.2));
        assert_eq!(
            value("lambert:reflectance=0.8/0.5/0"),
            lambert(0.8, 0.5, 0.0)
        );
        let text = canonical_text("lambert:reflectance=0.5/0.50/.5").unwrap();
        assert_eq!(text.as_deref(), Some("lambert:reflectance=0.5"));
    }
}
