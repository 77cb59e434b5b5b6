//! What holds at a place of a GRF scene: names, attributes, and where it lies.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use merlkit::color::Rgb;
use merlkit::material::merl::embedded_names;

use super::tree::{Attribute, AttributeValue, BrdfWords, Definition, ModelWords, TransformStep};
use super::words::{GrfFault, formula_text, sampler_text};

/// The attributes that hold for what follows.
#[derive(Clone, Debug)]
pub(super) struct Looks {
    pub(super) brdf: BrdfWords,
    pub(super) colour: DVec3,
    pub(super) sampler: Option<ModelWords>,
    /// Radiance of the faces.
    pub(super) emission: Option<Rgb>,
}

impl Default for Looks {
    /// Diffuse, as the editor of the thesis has it.
    fn default() -> Self {
        Self {
            brdf: BrdfWords::Model(ModelWords {
                name: "diffuse".into(),
                parameters: vec![("kd".into(), super::tree::ParameterValue::Number(0.54))],
            }),
            colour: DVec3::ONE,
            sampler: None,
            emission: None,
        }
    }
}

/// Names that have a meaning here, the innermost last.
#[derive(Debug, Default)]
pub(super) struct Names {
    known: Vec<Definition>,
}

/// Names that mean names, at most.
const MOST_STEPS: usize = 16;

impl Names {
    /// Adds names. Returns how many there were.
    pub(super) fn open(&mut self, definitions: &[Definition]) -> usize {
        let before = self.known.len();
        self.known.extend_from_slice(definitions);
        before
    }

    /// Forgets all but the first names.
    pub(super) fn close(&mut self, before: usize) {
        self.known.truncate(before);
    }

    /// What a name means among those of a kind.
    fn find(&self, name: &str, is_kind: fn(&AttributeValue) -> bool) -> Option<&AttributeValue> {
        for definition in self.known.iter().rev() {
            if definition.name == name && is_kind(&definition.meaning.value) {
                return Some(&definition.meaning.value);
            }
        }
        None
    }

    /// Changes looks as an attribute says.
    ///
    /// # Errors
    /// A colour that has no name of that kind, and radiance that is negative or not finite.
    pub(super) fn apply(&self, attribute: &Attribute, looks: &mut Looks) -> Result<(), GrfFault> {
        match &attribute.value {
            AttributeValue::Rgb(colour) => looks.colour = *colour,
            AttributeValue::NamedRgb(name) => match self.find(name, is_colour) {
                Some(AttributeValue::Rgb(colour)) => looks.colour = *colour,
                _ => return Err(self.unknown("colour", name)),
            },
            AttributeValue::Brdf(brdf) => looks.brdf = self.resolve_brdf(brdf).clone(),
            AttributeValue::Pdf(words) => looks.sampler = Some(self.resolve_pdf(words).clone()),
            AttributeValue::Emission(radiance) => looks.emission = read_emission(*radiance)?,
            AttributeValue::Texture => {}
        }
        Ok(())
    }

    /// What a BRDF without parameters is called by, or itself where nothing is called so.
    fn resolve_brdf<'a>(&'a self, brdf: &'a BrdfWords) -> &'a BrdfWords {
        let mut found = brdf;
        for _ in 0..MOST_STEPS {
            let BrdfWords::Model(words) = found else {
                break;
            };
            match self.find(&words.name, is_brdf) {
                Some(AttributeValue::Brdf(meaning)) if words.parameters.is_empty() => {
                    // `ward = brdf ward` means the model.
                    if meaning == found {
                        break;
                    }
                    found = meaning;
                }
                _ => break,
            }
        }
        found
    }

    fn resolve_pdf<'a>(&'a self, words: &'a ModelWords) -> &'a ModelWords {
        match self.find(&words.name, is_pdf) {
            Some(AttributeValue::Pdf(meaning)) if words.parameters.is_empty() => meaning,
            _ => words,
        }
    }

    fn unknown(&self, kind: &str, name: &str) -> GrfFault {
        let mut names: Vec<&str> = Vec::new();
        for definition in &self.known {
            names.push(&definition.name);
        }
        let fix = match names.is_empty() {
            true => "define it: def NAME = … begin … end".to_owned(),
            false => format!("the names here are {}", names.join(", ")),
        };
        (format!("no {kind} is called {name} here"), fix)
    }

    /// The MATERIAL of some looks; paths are relative to `folder`.
    ///
    /// # Errors
    /// A BRDF that is none, and a file that is not there.
    pub(super) fn material_text(&self, looks: &Looks, folder: &Path) -> Result<String, GrfFault> {
        match &looks.brdf {
            BrdfWords::Model(words) => {
                let text = formula_text(words, looks.colour);
                let is_bare = words.parameters.is_empty();
                text.map_err(|fault| match is_bare && !is_model(&words.name) {
                    true => self.unknown("BRDF", &words.name),
                    false => fault,
                })
            }
            // Measured values have colours of their own.
            BrdfWords::Measured(file) => measured_text(file, folder),
            BrdfWords::Combine(terms) => {
                let mut texts = Vec::new();
                for (weight, name) in terms {
                    let term = BrdfWords::Model(ModelWords {
                        name: name.clone(),
                        parameters: Vec::new(),
                    });
                    let BrdfWords::Model(words) = self.resolve_brdf(&term) else {
                        return Err((
                            format!("{name} is no formula"),
                            "combine formulas; measured values are drawn alone".into(),
                        ));
                    };
                    texts.push(formula_text(words, *weight * looks.colour)?);
                }
                Ok(texts.join("+"))
            }
        }
    }

    /// The sampler of some looks as `--sampler` takes it, if they name one.
    ///
    /// # Errors
    /// A sampler that is none.
    pub(super) fn sampler_text(&self, looks: &Looks) -> Result<Option<String>, GrfFault> {
        looks.sampler.as_ref().map(sampler_text).transpose()
    }
}

/// The radiance of faces; `None` if they emit nothing.
fn read_emission(radiance: DVec3) -> Result<Option<Rgb>, GrfFault> {
    let channels = radiance.as_vec3();
    if !(channels.is_finite() && radiance.min_element() >= 0.0) {
        return Err((
            format!("an emission of {radiance}"),
            "give finite channels ≥ 0".into(),
        ));
    }
    let emits = radiance != DVec3::ZERO;
    Ok(emits.then(|| Rgb::from_array(channels.to_array())))
}

fn is_colour(value: &AttributeValue) -> bool {
    matches!(value, AttributeValue::Rgb(_))
}

fn is_brdf(value: &AttributeValue) -> bool {
    matches!(value, AttributeValue::Brdf(_))
}

fn is_pdf(value: &AttributeValue) -> bool {
    matches!(value, AttributeValue::Pdf(_))
}

fn is_model(name: &str) -> bool {
    merlkit::material::analytic::ModelFacts::parse(&name.to_ascii_lowercase()).is_ok()
}

/// The file of measured values, or the built-in material of its name.
fn measured_text(file: &str, folder: &Path) -> Result<String, GrfFault> {
    let path = folder.join(file);
    if path.is_file() {
        return Ok(path.display().to_string());
    }
    let stem = Path::new(file).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy();
    if embedded_names().iter().any(|name| **name == *stem) {
        return Ok(stem.into_owned());
    }
    Err((
        format!("there is no file {}", path.display()),
        "put the file there, or name a built-in material of `merlkit list`".into(),
    ))
}

/// Steps as one map: the first that is written applies first.
pub(super) fn compose(steps: &[TransformStep]) -> DAffine3 {
    let mut all = DAffine3::IDENTITY;
    for step in steps {
        let step = match *step {
            TransformStep::Scale(factors) => DAffine3::from_scale(factors),
            TransformStep::Translation(offset) => DAffine3::from_translation(offset),
            // About x first, then y, then z: R = Rz·Ry·Rx.
            TransformStep::Rotation(angles) => DAffine3::from_mat3(
                DMat3::from_rotation_z(angles.z)
                    * DMat3::from_rotation_y(angles.y)
                    * DMat3::from_rotation_x(angles.x),
            ),
        };
        all = step * all;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_apply_in_the_order_in_which_they_are_written() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let turn = TransformStep::Rotation(DVec3::new(quarter, 0.0, 0.0));
        let shift = TransformStep::Translation(DVec3::new(0.0, 0.5, 0.0));
        // y goes to z, and is shifted then.
        let moved = compose(&[turn, shift]).transform_point3(DVec3::Y);
        assert!(moved.abs_diff_eq(DVec3::new(0.0, 0.5, 1.0), 1e-12));
        let moved = compose(&[shift, turn]).transform_point3(DVec3::Y);
        assert!(moved.abs_diff_eq(DVec3::new(0.0, 0.0, 1.5), 1e-12));
        // About x before z: y goes to z and stays there.
        let both = TransformStep::Rotation(DVec3::new(quarter, 0.0, quarter));
        let moved = compose(&[both]).transform_vector3(DVec3::Y);
        assert!(moved.abs_diff_eq(DVec3::Z, 1e-12));
    }
}
