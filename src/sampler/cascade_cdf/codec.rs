//! The cascade CDF in a file: its tensors, and what drawing relies on.

use super::settings::CascadeCdfSettings;
use super::tables::Tables;
use crate::Result;
use crate::distribution::Curves;
use crate::sampler::store::{TensorWriter, Tensors, read_curves, write_curves};

/// Adds the curves to a file.
pub(super) fn write(tables: &Tables, out: &mut TensorWriter) {
    write_curves("marginal", &tables.marginal, out);
    write_curves("conditional", &tables.conditional, out);
}

/// Reads curves, of which every one that can be drawn from has mass.
pub(super) fn read(tensors: &Tensors, settings: &CascadeCdfSettings) -> Result<Tables> {
    let marginal = read_curves(tensors, "marginal", settings.theta_h)?;
    let conditional = read_curves(tensors, "conditional", settings.phi_h)?;
    if marginal.len() != settings.count() {
        let expected = format!("{} marginals", settings.count());
        return Err(tensors.invalid_in("marginal.start", 0, &expected, marginal.len().to_string()));
    }
    let pieces: usize = (0..marginal.len()).map(|k| marginal.segments(k)).sum();
    if pieces != conditional.len() {
        let expected = format!("a conditional for each of {pieces} pieces of the marginals");
        return Err(tensors.invalid_in(
            "conditional.start",
            0,
            &expected,
            conditional.len().to_string(),
        ));
    }
    if let Some((k, piece, curve)) = piece_without_conditional(&marginal, &conditional) {
        let expected = format!("piece {piece} of marginal {k} to have a conditional with mass");
        let at = conditional.starts[curve] as usize;
        return Err(tensors.invalid_in("conditional.cdf", at, &expected, "an empty one"));
    }
    Ok(Tables::new(marginal, conditional))
}

/// A piece of a marginal that can be drawn though its conditional is empty: marginal, piece and conditional.
fn piece_without_conditional(
    marginal: &Curves,
    conditional: &Curves,
) -> Option<(usize, usize, usize)> {
    let mut next = 0;
    for k in 0..marginal.len() {
        for piece in 0..marginal.segments(k) {
            let s = marginal.segment(k, piece);
            if s.c1 > s.c0 && conditional.is_void(next) {
                return Some((k, piece, next));
            }
            next += 1;
        }
    }
    None
}
