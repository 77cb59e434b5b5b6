//! The factored BRDF in a file: its tensors, and what drawing relies on.

use super::mixture::Terms;
use super::settings::FactoredSettings;
use crate::Result;
use crate::sampler::store::{TensorWriter, Tensors, read_curves, write_curves};

/// Adds the terms to a file.
pub(super) fn write(terms: &Terms, out: &mut TensorWriter) {
    out.add("term.weight", terms.weights.iter().copied());
    write_curves("theta", &terms.theta, out);
    write_curves("phi", &terms.phi, out);
}

/// Reads terms, of which every one that a table draws from has curves with mass.
pub(super) fn read(tensors: &Tensors, settings: &FactoredSettings) -> Result<Terms> {
    let factors = settings.factors.ok_or_else(|| {
        tensors.invalid("the factors of a factored sampler in the record", "none")
    })?;
    let terms = Terms {
        weights: tensors.get("term.weight")?,
        theta: read_curves(tensors, "theta", factors.theta)?,
        phi: read_curves(tensors, "phi", factors.phi)?,
    };
    for (name, curves) in [("theta", &terms.theta), ("phi", &terms.phi)] {
        if !curves.positions.is_empty() {
            let found = format!("{} positions", curves.positions.len());
            return Err(tensors.invalid_in(
                &format!("{name}.position"),
                0,
                "knots at every cell",
                found,
            ));
        }
    }
    let count = factors.terms();
    for (name, expected, found) in [
        ("theta.start", count, terms.theta.len()),
        ("phi.start", count, terms.phi.len()),
        ("term.weight", settings.count() * count, terms.weights.len()),
    ] {
        if expected != found {
            let expected = format!("{expected} of {count} terms");
            return Err(tensors.invalid_in(name, 0, &expected, found.to_string()));
        }
    }
    check_weights(tensors, &terms, count)?;
    Ok(terms)
}

/// Rows of `count` weights: none is outside [0, 1] or that of a void term, and their sum is at most 1.
fn check_weights(tensors: &Tensors, terms: &Terms, count: usize) -> Result<()> {
    for (k, row) in terms.weights.chunks_exact(count).enumerate() {
        let sum: f64 = row.iter().map(|&weight| f64::from(weight)).sum();
        for (l, &weight) in row.iter().enumerate() {
            let is_drawn = !terms.theta.is_void(l) && !terms.phi.is_void(l);
            let is_sound = weight == 0.0 || (weight > 0.0 && weight <= 1.0 && is_drawn);
            if !is_sound || sum > 1.0 + 1e-6 {
                let expected = format!(
                    "probabilities of table {k} within 0..1, 0 for terms that cannot be drawn, and with a sum of at most 1,"
                );
                let found = format!("{row:?}");
                return Err(tensors.invalid_in("term.weight", k * count + l, &expected, found));
            }
        }
    }
    Ok(())
}
