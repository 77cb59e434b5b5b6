//! BRDFs given by a formula: "lambert:reflectance=0.5", "ward:sx=0.2,sy=0.4,ks=0.5,kd=0.5".
//!
//! A model is one file here and one line in `MODELS`. Its text is its name and its parameters, `name:key=value,key=value`;
//! parameters that are left out keep the model's defaults. Keys are in any case. Every model has a colour `rgb`, white unless
//! it is given. Models whose printed formula in Montes's thesis differs from the sound one have `form=printed`. Several
//! formulas with `+` between them are their sum.

mod ashikhmin;
mod beardmaxwell;
mod blinn;
mod constant;
mod coupled;
mod cylinder_cap;
mod disney;
mod facts;
mod fresnel;
mod ggx;
#[cfg(test)]
mod golden;
mod he;
mod lafortune;
mod lambert;
mod minnaert;
mod model;
mod oren;
mod pair;
mod parameters;
mod parse;
mod phong;
mod poulin;
mod schlick;
mod sheen;
mod special;
mod specular;
mod strauss;
mod sum;
#[cfg(test)]
mod sweep;
mod torrance;
mod ward;
mod words;

pub(crate) use constant::Lambert;
pub use facts::ModelFacts;
pub use parameters::ParameterFacts;

use super::format::{MaterialFormat, Origin, TableReading};
use super::{Loaded, MaterialFacts};
use crate::brdf::Brdf;
use crate::{Error, Result};
use facts::excess_note;
use model::Model;
use parse::{Parsed, parse_formula};
use std::sync::Arc;
use sum::{SumBrdf, split_terms};
use words::nearest_words;

/// All models.
const MODELS: [Model; 22] = [
    lambert::MODEL,
    lambert::DIFFUSE,
    specular::MODEL,
    minnaert::MODEL,
    phong::MODEL,
    blinn::MODEL,
    blinn::LEWIS,
    torrance::MODEL,
    ward::MODEL,
    schlick::MODEL,
    oren::MODEL,
    lafortune::MODEL,
    coupled::MODEL,
    ashikhmin::MODEL,
    strauss::MODEL,
    beardmaxwell::MODEL,
    he::MODEL,
    poulin::MODEL,
    ggx::MODEL,
    ggx::COATED,
    disney::MODEL,
    sheen::MODEL,
];

/// Texts that name a model and its parameters.
pub(super) struct Formulas;

impl MaterialFormat for Formulas {
    fn recognises(&self, origin: &Origin) -> bool {
        matches!(origin, Origin::Formula(_))
    }

    fn facts(&self, origin: &Origin) -> Result<MaterialFacts> {
        // Building a formula takes no time.
        let (brdf, _) = read_sum(&origin.path().to_string_lossy())?;
        Ok(Loaded::from_brdf(brdf).facts())
    }

    fn load(&self, origin: &Origin, _: TableReading) -> Result<Loaded> {
        let (brdf, albedo_bound) = read_sum(&origin.path().to_string_lossy())?;
        let notes = excess_note(&*brdf, albedo_bound).into_iter().collect();
        let loaded = Loaded::from_brdf(brdf);
        Ok(loaded.with_reading("values of a formula").with_notes(notes))
    }
}

impl ModelFacts {
    /// All models with their default parameters.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::with_capacity(MODELS.len());
        for model in &MODELS {
            all.extend(Self::parse(model.name));
        }
        all
    }

    /// The model that a text such as "ward" or "ward:sx=0.1" names, with its parameters.
    ///
    /// # Errors
    /// [`Error::Argument`] for a name that is no model, with the nearest names, and for a parameter that is unknown, given
    /// twice or outside its domain.
    pub fn parse(text: &str) -> Result<Self> {
        if split_terms(text).len() > 1 {
            return Err(Error::argument(
                format!("\"{text}\" is a sum of models"),
                "name one model alone",
            ));
        }
        Ok(Self::describe(parse(text)?))
    }

    /// The BRDF of a formula or of a sum of them, without the search for albedos above 1 that loading a material includes.
    ///
    /// # Errors
    /// As [`Self::parse`], for each formula.
    pub fn brdf(text: &str) -> Result<Arc<dyn Brdf>> {
        Ok(read_sum(text)?.0)
    }
}

/// The formula that `argument` means, with all its parameters spelt out; `None` for what does not read as a formula.
///
/// # Errors
/// [`Error::Argument`] for `name:key=value` of a name that is no model, and for a parameter that is unknown, given twice or
/// outside its domain.
pub(super) fn canonical_text(argument: &str) -> Result<Option<String>> {
    let terms = split_terms(argument);
    if !terms.iter().any(|term| is_formula(term)) {
        return Ok(None);
    }
    let mut texts = Vec::with_capacity(terms.len());
    for term in terms {
        texts.push(parse(term)?.text);
    }
    Ok(Some(texts.join("+")))
}

/// Whether a text is meant as a formula: a model's name, or anything that sets a parameter.
fn is_formula(text: &str) -> bool {
    let sets_a_parameter = text.split_once(':').is_some_and(|(_, s)| s.contains('='));
    sets_a_parameter || find_model(text).is_some()
}

/// The BRDF of a formula or of a sum, and a bound of its albedo in white where one is known.
fn read_sum(text: &str) -> Result<(Arc<dyn Brdf>, Option<f64>)> {
    let mut terms = Vec::new();
    let mut bound = Some(0.0);
    for term in split_terms(text) {
        let parsed = parse(term)?;
        let properties = parsed.formula.properties();
        bound = bound.zip(properties.albedo_bound).map(|(a, b)| a + b);
        terms.push(parsed.brdf());
    }
    let brdf = match <[_; 1]>::try_from(terms) {
        Ok([only]) => only,
        Err(terms) => Arc::new(SumBrdf { terms }),
    };
    Ok((brdf, bound))
}

/// The names of all models.
pub(super) fn model_names() -> impl Iterator<Item = &'static str> {
    MODELS.iter().map(|model| model.name)
}

/// The model whose name is in front of the colon of `argument`.
fn find_model(argument: &str) -> Option<&'static Model> {
    let name = argument.split(':').next()?;
    MODELS.iter().find(|model| model.name == name)
}

/// The formula that `argument` names.
fn parse(argument: &str) -> Result<Parsed> {
    match find_model(argument) {
        Some(model) => parse_formula(model, argument),
        None => Err(unknown_model(argument)),
    }
}

fn unknown_model(argument: &str) -> Error {
    let name = argument.split(':').next().unwrap_or(argument);
    let names: Vec<&str> = model_names().collect();
    Error::argument(
        format!("no model is called \"{name}\""),
        format!(
            "did you mean {}? `merlkit models` shows all of them",
            nearest_words(name, &names, 3).join(", ")
        ),
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
            ("wrad:sx=0.2", "\"wrad\"", "ward"),
            ("ward:sz=0.2", "no parameter sz", "sx, sy, ks, kd"),
            ("ward:sx=0", "sx=0", "0.001 to 10"),
            ("ward:sx=nan", "sx=nan", "0.001 to 10"),
            ("ward:sx=1e999", "sx=1e999", "0.001 to 10"),
            ("ward:rgb=2", "rgb=2", "0 to 1"),
            ("ashikhmin:nu=20,EX=20", "ex|nu", "once"),
            ("phong:form=right", "form=right", "sound or printed"),
            ("ward:form=printed", "no parameter form", "sx"),
            ("schlick:ly=2", "Ly=2", "T or F"),
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
    fn keys_are_in_any_case_and_have_aliases() {
        let text = canonical_text("ashikhmin:NU=25,ks=0.39").unwrap();
        let spelt = "ashikhmin:ex=25,ey=10,Rs=0.39,Rd=0.5";
        assert_eq!(text.as_deref(), Some(spelt));
        let text = canonical_text("phong:Form=printed,colour=0.5/0.25/1").unwrap();
        let spelt = "phong:n=50,ks=0.4,kd=0.6,form=printed,rgb=0.5/0.25/1";
        assert_eq!(text.as_deref(), Some(spelt));
        assert_eq!(canonical_text(spelt).unwrap(), text);
    }

    #[test]
    fn a_sum_adds_its_terms_and_is_written_in_full() {
        let text = canonical_text("lambert:reflectance=0.2+ward:SX=0.1,sy=0.1").unwrap();
        let text = text.unwrap();
        assert_eq!(
            text,
            "lambert:reflectance=0.2+ward:sx=0.1,sy=0.1,ks=0.05,kd=0.4"
        );
        let (wo, wi) = (Vec3::new(0.1, 0.0, 1.0), Vec3::new(-0.2, 0.1, 1.0));
        let value = |text: &str| ModelFacts::brdf(text).unwrap().eval(wo, wi);
        let terms = value("lambert:reflectance=0.2") + value("ward:sx=0.1,sy=0.1");
        assert!((value(&text) - terms).abs().max_element() < 1e-6);
        assert!(ModelFacts::brdf(&text).unwrap().is_isotropic());
        let brushed = ModelFacts::brdf("lambert+ward:sx=0.1,sy=0.2").unwrap();
        assert!(!brushed.is_isotropic());
        let message = canonical_text("lambert:reflectance=0.2+wrad:sx=0.1")
            .unwrap_err()
            .to_string();
        assert!(message.contains("ward"), "{message}");
    }

    #[test]
    fn channels_are_set_one_by_one_or_together() {
        let value = |text: &str| parse(text).unwrap().brdf().eval(Vec3::Z, Vec3::Z);
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
