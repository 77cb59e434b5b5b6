//! From the words of BRDFs and samplers to the texts that merlkit takes.

use glam::DVec3;
use merlkit::Material;
use merlkit::SamplerSpec;

use super::tree::{ModelWords, ParameterValue};

/// What a text can't be made of, and what to do about it.
pub(super) type GrfFault = (String, String);

/// The formula of a BRDF, multiplied by a colour.
///
/// # Errors
/// A name that is no model, and parameters outside their domains.
pub(super) fn formula_text(words: &ModelWords, colour: DVec3) -> Result<String, GrfFault> {
    let mut settings = Vec::new();
    for (key, value) in &words.parameters {
        settings.push(match value {
            ParameterValue::Number(number) => format!("{key}={number}"),
            ParameterValue::Flag(true) => format!("{key}=T"),
            ParameterValue::Flag(false) => format!("{key}=F"),
        });
    }
    if colour != DVec3::ONE {
        settings.push(format!("rgb={}/{}/{}", colour.x, colour.y, colour.z));
    }
    let name = words.name.to_ascii_lowercase();
    // With a parameter the text is a formula in any case, never the name of a file.
    if settings.is_empty() {
        settings.push("rgb=1".into());
    }
    let text = format!("{name}:{}", settings.join(","));
    match Material::resolve(&text) {
        Ok(_) => Ok(text),
        Err(merlkit::Error::Argument { what, fix }) => Err((what, fix)),
        Err(other) => Err((other.to_string(), "name a model of `merlkit models`".into())),
    }
}

/// The fraction of cosine draws that a method of the thesis is mixed with where it leaves directions out.
const FLOOR: f64 = 0.1;

/// The sampler of a `pdf` line.
///
/// # Errors
/// A name that is no sampler, a parameter that is missing or unknown, and values outside their domains.
pub(super) fn sampler_text(words: &ModelWords) -> Result<String, GrfFault> {
    let name = words.name.to_ascii_lowercase();
    let mut given = Given {
        words,
        used: Vec::new(),
    };
    let text = match name.as_str() {
        "diffuse" | "specular" => "cosine".to_owned(),
        "reject" => "adaptive-disc:rejection".to_owned(),
        "sphere" => cosine_lobe("cosine", given.number("exp", Some(30.0))?),
        "hemisphere" => cosine_lobe("cosine-hemisphere", given.number("exp", Some(30.0))?),
        "anisotropic" => {
            let (nu, nv) = (given.number("nu", None)?, given.number("nv", None)?);
            format!("lobe:ashikhmin-shirley,parameters={nu}/{nv}/{FLOOR},axes=surface")
        }
        "adaptive" => {
            let tables = given.number("nQT", Some(20.0))?;
            let azimuths = given.number("nAnisoQT", Some(1.0))?;
            format!("adaptive-disc:tables={tables}{}", azimuths_text(azimuths))
        }
        "cascadecdf" => {
            let (theta, phi) = (given.number("nTh", None)?, given.number("nPh", None)?);
            let tolerance = match given.flag("compress")? {
                true => "",
                false => ",tolerance=none",
            };
            format!("cascade-cdf:cells={theta}x{phi}{tolerance}")
        }
        "factored" => factored_text(&mut given)?,
        _ => {
            return Err((
                format!("no sampler of the format is called {}", words.name),
                "name diffuse, specular, reject, sphere, hemisphere, anisotropic, adaptive, cascadeCDF or factored, or one that \
                 a def names"
                    .into(),
            ));
        }
    };
    given.finish()?;
    match text.parse::<SamplerSpec>() {
        Ok(_) => Ok(text),
        Err(merlkit::Error::Argument { what, fix }) => Err((what, fix)),
        Err(other) => Err((other.to_string(), "correct the values".into())),
    }
}

fn cosine_lobe(kind: &str, exponent: f64) -> String {
    format!("lobe:{kind},parameters={exponent}/{exponent}/{FLOOR}")
}

/// One azimuth is what an isotropic material has in any case.
fn azimuths_text(azimuths: f64) -> String {
    match azimuths {
        1.0 => String::new(),
        _ => format!(",azimuths={azimuths}"),
    }
}

fn factored_text(given: &mut Given<'_>) -> Result<String, GrfFault> {
    let [u_theta, u_phi, p_theta, p_phi] = [
        given.number("uTh", None)?,
        given.number("uPh", None)?,
        given.number("pTh", None)?,
        given.number("pPh", None)?,
    ];
    let (outer, inner) = (given.number("J", None)?, given.number("K", None)?);
    let axis = match given.flag("half")? {
        true => "half-vector",
        false => "wi",
    };
    let azimuths = azimuths_text(u_phi);
    Ok(format!(
        "factored:tables={u_theta},factors={outer}x{inner}/{p_theta}x{p_phi}/{axis}/{FLOOR}{azimuths}"
    ))
}

/// The parameters of a line, and which of them were asked for.
struct Given<'a> {
    words: &'a ModelWords,
    used: Vec<&'static str>,
}

impl Given<'_> {
    /// The value of a key in any case.
    fn find(&mut self, key: &'static str) -> Option<ParameterValue> {
        self.used.push(key);
        let mut parameters = self.words.parameters.iter();
        let found = parameters.find(|(known, _)| known.eq_ignore_ascii_case(key));
        found.map(|(_, value)| *value)
    }

    fn number(&mut self, key: &'static str, default: Option<f64>) -> Result<f64, GrfFault> {
        match (self.find(key), default) {
            (Some(ParameterValue::Number(number)), _) | (None, Some(number)) => Ok(number),
            _ => Err((
                format!("{} without a number {key}", self.words.name),
                format!("add {key}=NUMBER"),
            )),
        }
    }

    fn flag(&mut self, key: &'static str) -> Result<bool, GrfFault> {
        match self.find(key) {
            None => Ok(false),
            Some(ParameterValue::Flag(flag)) => Ok(flag),
            Some(ParameterValue::Number(_)) => Err((
                format!("{key} of {} is a number", self.words.name),
                format!("write {key}=true or {key}=false"),
            )),
        }
    }

    /// Refuses parameters that nobody asked for.
    fn finish(self) -> Result<(), GrfFault> {
        for (key, _) in &self.words.parameters {
            if !self.used.iter().any(|used| used.eq_ignore_ascii_case(key)) {
                return Err((
                    format!("{} has no parameter {key}", self.words.name),
                    format!("its parameters are {}", self.used.join(", ")),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(name: &str, parameters: &[(&str, f64)]) -> ModelWords {
        let mut all = Vec::new();
        for (key, value) in parameters {
            all.push(((*key).to_owned(), ParameterValue::Number(*value)));
        }
        ModelWords {
            name: name.into(),
            parameters: all,
        }
    }

    #[test]
    fn every_sampler_of_the_format_is_one_of_ours() {
        let mut cascade = words("cascadeCDF", &[("nTh", 64.0), ("nPh", 32.0)]);
        cascade
            .parameters
            .push(("compress".into(), ParameterValue::Flag(false)));
        let factored = [
            ("uTh", 16.0),
            ("uPh", 16.0),
            ("pTh", 32.0),
            ("pPh", 16.0),
            ("J", 1.0),
            ("K", 2.0),
        ];
        for (line, expected) in [
            (words("diffuse", &[]), "cosine"),
            (words("reject", &[]), "adaptive-disc:rejection"),
            (
                words("sphere", &[("exp", 81.0)]),
                "lobe:cosine,parameters=81/81/0.1",
            ),
            (
                words("hemisphere", &[]),
                "lobe:cosine-hemisphere,parameters=30/30/0.1",
            ),
            (
                words("anisotropic", &[("nu", 25.0), ("nv", 10.0)]),
                "lobe:ashikhmin-shirley,parameters=25/10/0.1,axes=surface",
            ),
            (
                words("adaptive", &[("nqt", 90.0), ("nAnisoQT", 1.0)]),
                "adaptive-disc:tables=90",
            ),
            (cascade, "cascade-cdf:cells=64x32,tolerance=none"),
            (
                words("factored", &factored),
                "factored:tables=16,factors=1x2/32x16/wi/0.1,azimuths=16",
            ),
        ] {
            assert_eq!(sampler_text(&line).as_deref(), Ok(expected));
        }
        for line in [
            words("adaptive", &[("trees", 3.0)]),
            words("anisotropic", &[("nu", 3.0)]),
            words("sphere", &[("exp", -1.0)]),
            words("lobe", &[]),
        ] {
            assert!(sampler_text(&line).is_err(), "{line:?}");
        }
    }

    #[test]
    fn formulas_take_colours_and_keys_in_any_case() {
        let line = words(
            "Ward",
            &[("SX", 0.05), ("sy", 0.3), ("ks", 0.05), ("kd", 0.4)],
        );
        let text = formula_text(&line, DVec3::new(0.3, 0.8, 1.0)).unwrap();
        assert_eq!(text, "ward:SX=0.05,sy=0.3,ks=0.05,kd=0.4,rgb=0.3/0.8/1");
        assert!(formula_text(&words("wardd", &[]), DVec3::ONE).is_err());
        assert!(formula_text(&words("ward", &[("sx", -1.0)]), DVec3::ONE).is_err());
        assert!(formula_text(&words("oren", &[]), DVec3::splat(2.0)).is_err());
    }
}
