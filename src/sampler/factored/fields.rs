//! The settings of the factored BRDF as text: keys and domains.

use std::ops::RangeInclusive;

use super::Factored;
use super::settings::{FactoredSettings, Factors};
use crate::sampler::azimuth_knots::azimuths_field;
use crate::sampler::settings::importance;
use crate::sampler::{Field, Settings};

/// Products in a sum.
const PRODUCTS: RangeInclusive<usize> = 1..=64;
/// Cells over an angle.
const CELLS: RangeInclusive<usize> = 2..=1024;
/// The word for factors that are chosen for the material.
const FITTED: &str = "fitted";

impl Settings for FactoredSettings {
    type Method = Factored;

    fn fields() -> Vec<Field<Self>> {
        vec![
            Field::count(
                "tables",
                1..=256,
                "tables over the polar angle of wo",
                |s| s.tables,
                |s, value| s.tables = value,
            ),
            Field::form(
                "factors",
                "fitted, or JxK/THETAxPHI/AXIS/FLOOR as in 8x4/64x32/half-vector/0.01: J and K 1 to 64, cells \
                 2 to 1024, half-vector or wi, the floor 0 to 1",
                "numbers of products, cells over the angles of w, what w is, and fraction of cosine draws",
                |s: &Self| show_factors(s.factors),
                |s, text| match parse_factors(text) {
                    Some(factors) => {
                        s.factors = factors;
                        true
                    }
                    None => false,
                },
            ),
            azimuths_field(|s: &Self| s.azimuths, |s, value| s.azimuths = value),
            importance(|s: &Self| s.importance, |s, value| s.importance = value),
        ]
    }
}

fn show_factors(factors: Option<Factors>) -> String {
    let Some(f) = factors else {
        return FITTED.to_owned();
    };
    let axis = if f.half { "half-vector" } else { "wi" };
    format!(
        "{}x{}/{}x{}/{axis}/{}",
        f.outer, f.inner, f.theta, f.phi, f.floor
    )
}

/// Factors within their domains, or `Some(None)` for the word that means fitted ones.
fn parse_factors(text: &str) -> Option<Option<Factors>> {
    if text.eq_ignore_ascii_case(FITTED) {
        return Some(None);
    }
    let mut parts = text.split('/');
    let [outer, inner] = parse_pair(parts.next()?, &PRODUCTS)?;
    let [theta, phi] = parse_pair(parts.next()?, &CELLS)?;
    let half = match parts.next()? {
        "half-vector" => true,
        "wi" => false,
        _ => return None,
    };
    let floor: f64 = parts.next()?.parse().ok()?;
    let factors = Factors {
        outer,
        inner,
        theta,
        phi,
        half,
        floor,
    };
    let sound = (0.0..=1.0).contains(&floor) && parts.next().is_none();
    sound.then_some(Some(factors))
}

/// "8x4" as two numbers within a range.
fn parse_pair(text: &str, range: &RangeInclusive<usize>) -> Option<[usize; 2]> {
    let (first, second) = text.split_once(['x', 'X', '×'])?;
    let pair = [first.parse().ok()?, second.parse().ok()?];
    pair.iter().all(|n| range.contains(n)).then_some(pair)
}
