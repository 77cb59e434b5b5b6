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
        ("term.weight", settings.tables * count, terms.weights.len()),
    ] {
        if expected != found {
            let expected = format!("{expected} of {count} terms");
            return Err(tensors.invalid_in(name, 0, &expected, found.to_string()));
        }
    }
    for (k, row) in terms.weights.chunks_exact(count).enumerate() {
        let drawn = |l: usize| !terms.theta.is_void(l) && !terms.phi.is_void(l);
        let sound = |l: usize| row[l] == 0.0 || (row[l] > 0.0 && row[l] <= 1.0 && drawn(l));
        let whole = row.iter().map(|&w| f64::from(w)).sum::<f64>() <= 1.0 + 1e-6;
        if let Some(l) = (0..count).find(|&l| !sound(l) || !whole) {
            let expected = format!("shares of table {k} within 0..1, of terms that can be drawn,");
            return Err(tensors.invalid_in(
                "term.weight",
                k * count + l,
                &expected,
                format!("{row:?}"),
            ));
        }
    }
    Ok(terms)
}
