//! What is known of a model, for lists and notes.

use serde::Serialize;

use super::parameters::ParameterFacts;
use super::parse::Parsed;
use crate::brdf::Brdf;
use crate::geometry::{Quadrature, Symmetry, spherical};

/// A model with given parameters, as it is listed.
///
/// # Examples
/// ```
/// use merlkit::material::analytic::ModelFacts;
///
/// let ward = ModelFacts::parse("ward:sx=0.2,sy=0.4")?;
/// assert!(ward.reciprocal && !ward.has_mirror);
/// for parameter in &ward.parameters {
///     println!("{parameter:?}");
/// }
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelFacts {
    /// Its name in front of the colon.
    pub name: &'static str,
    /// What it is, in a few words.
    pub summary: &'static str,
    /// The paper that describes it.
    pub source: &'static str,
    /// Its text as a MATERIAL, with these parameters.
    pub material: String,
    /// Its parameters, in the order of the text.
    pub parameters: Vec<ParameterFacts>,
    /// Whether exchanging the directions leaves f_r as it is, for these parameters.
    pub reciprocal: bool,
    /// Whether f_r has a bound over all pairs of directions.
    pub bounded: bool,
    /// Which azimuths of `wo` represent all others.
    pub symmetry: Symmetry,
    /// Whether part of the light is reflected in the mirror direction alone.
    pub has_mirror: bool,
    /// A bound of the directional albedo with a white colour; `None` where none is known.
    pub albedo_bound: Option<f64>,
}

impl ModelFacts {
    pub(super) fn describe(parsed: Parsed) -> Self {
        let properties = parsed.formula.properties();
        Self {
            name: parsed.model.name,
            summary: parsed.model.summary,
            source: parsed.model.source,
            material: parsed.text,
            parameters: parsed.parameters,
            reciprocal: properties.reciprocal,
            bounded: properties.bounded,
            symmetry: properties.symmetry,
            has_mirror: parsed.formula.mirror(1.0, parsed.rgb).is_some(),
            albedo_bound: properties.albedo_bound,
        }
    }
}

/// Angles of the viewer, in degrees, at which the albedo is looked at.
const ANGLES: [f64; 5] = [0.0, 30.0, 60.0, 75.0, 85.0];

/// Points a bin of the half vector's angle; errors are below 0.3 % for lobes of a degree and wider.
const POINTS: usize = 34;

/// Albedos that exceed 1 by less may do so by the error of the quadrature alone.
const SLACK: f64 = 5e-3;

/// The note of a formula that reflects more light than it receives; `None` for all others. `bound` is the bound that is known
/// of its albedo in white.
pub(super) fn excess_note(brdf: &dyn Brdf, bound: Option<f64>) -> Option<String> {
    if bound.is_some_and(|bound| bound <= 1.0 + 1e-9) {
        return None;
    }
    let (albedo, angle) = find_largest_albedo(brdf);
    (albedo > 1.0 + SLACK).then(|| {
        format!(
            "it reflects more light than it receives: its albedo is {albedo:.2} at {angle}\u{b0}; values are not clamped"
        )
    })
}

/// The largest albedo of a channel over [`ANGLES`], delta part included, and its angle.
fn find_largest_albedo(brdf: &dyn Brdf) -> (f64, f64) {
    let azimuths: &[f64] = if brdf.is_isotropic() {
        &[0.0]
    } else {
        &[0.0, 90.0]
    };
    let mut largest = (0.0, 0.0);
    for angle in ANGLES {
        for azimuth in azimuths {
            let wo = spherical(angle.to_radians(), azimuth.to_radians()).as_vec3();
            let mut albedo = brdf.mirror(wo).unwrap_or_default().as_dvec3();
            Quadrature::new(wo, POINTS)
                .for_each(|wi, d_sigma| albedo += brdf.eval_cos(wo, wi).as_dvec3() * d_sigma);
            if albedo.max_element() > largest.0 {
                largest = (albedo.max_element(), angle);
            }
        }
    }
    largest
}
