//! The settings of lobes as text: keys and domains.

use super::Lobe;
use super::settings::{KINDS, LobeKind, LobeParameters, LobeSettings};
use crate::sampler::settings::importance;
use crate::sampler::{Field, Settings};
use crate::{Error, Result};

/// The word for parameters that are fitted to the material.
const FITTED: &str = "fitted";

impl Settings for LobeSettings {
    type Method = Lobe;

    fn fields() -> Vec<Field<Self>> {
        let kind = Field::choice(
            "kind",
            KINDS,
            "which lobe",
            |s: &Self| s.kind,
            |s, value| s.kind = value,
        );
        vec![
            kind.standing_alone(&LobeKind::ALL.map(LobeKind::name))
                .always_shown(),
            Field::form(
                "parameters",
                "fitted, or ALONG/ACROSS/DIFFUSE as in 0.1/0.1/0.05",
                "shape along and across the axes, and fraction of draws that follow the cosine",
                |s: &Self| show_parameters(s.parameters),
                |s, text| match parse_parameters(text) {
                    Some(parameters) => {
                        s.parameters = parameters;
                        true
                    }
                    None => false,
                },
            ),
            Field::choice(
                "axes",
                &[("incidence", false), ("surface", true)],
                "what shapes are along: the plane of incidence, or the surface's x",
                |s: &Self| s.surface_axes,
                |s, value| s.surface_axes = value,
            ),
            importance(|s: &Self| s.importance, |s, value| s.importance = value),
        ]
    }

    /// The domain of parameters depends on the kind of lobe.
    fn check_together(&self) -> Result<()> {
        let Some(LobeParameters {
            along,
            across,
            diffuse,
        }) = self.parameters
        else {
            return Ok(());
        };
        let kind = self.kind;
        let [low, high] = kind.domain();
        let inside = |v: f32| (low..=high).contains(&v);
        if !inside(along) || !inside(across) || !(0.0..=1.0).contains(&diffuse) {
            return Err(Error::argument(
                format!(
                    "lobe:{} with parameters {along}, {across} and {diffuse}",
                    kind.name()
                ),
                format!("choose shapes from {low} to {high} and a diffuse fraction from 0 to 1"),
            ));
        }
        let has_two = matches!(kind, LobeKind::AshikhminShirley | LobeKind::Ward);
        if along != across && !has_two {
            return Err(Error::argument(
                format!("lobe:{} with shapes {along} and {across}", kind.name()),
                "give the same shape along both axes",
            ));
        }
        Ok(())
    }
}

fn show_parameters(parameters: Option<LobeParameters>) -> String {
    match parameters {
        Some(p) => format!("{}/{}/{}", p.along, p.across, p.diffuse),
        None => FITTED.to_owned(),
    }
}

/// Three numbers, or `Some(None)` for the word that means fitted ones.
fn parse_parameters(text: &str) -> Option<Option<LobeParameters>> {
    if text.eq_ignore_ascii_case(FITTED) {
        return Some(None);
    }
    let mut numbers = text.split('/').map(|number| number.parse::<f32>().ok());
    let parameters = LobeParameters {
        along: numbers.next()??,
        across: numbers.next()??,
        diffuse: numbers.next()??,
    };
    numbers.next().is_none().then_some(Some(parameters))
}
