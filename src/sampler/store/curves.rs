//! Cumulative curves in a file.

use std::ops::Range;

use super::{TensorWriter, Tensors};
use crate::Result;
use crate::distribution::{Curves, WHOLE};

/// Adds curves to a file, under names that begin with `name`.
pub(in crate::sampler) fn write_curves(name: &str, curves: &Curves, out: &mut TensorWriter) {
    out.add(&format!("{name}.start"), curves.starts.iter().copied());
    out.add(
        &format!("{name}.position"),
        curves.positions.iter().copied(),
    );
    out.add(&format!("{name}.cdf"), curves.cdf.iter().copied());
}

/// Reads curves over the grid 0..=`cells`: knots rise from 0 to `cells`, probabilities from 0 to 1 or stay 0.
pub(in crate::sampler) fn read_curves(
    tensors: &Tensors,
    name: &str,
    cells: usize,
) -> Result<Curves> {
    let starts = tensors.get(&format!("{name}.start"))?;
    let positions = tensors.get(&format!("{name}.position"))?;
    let curves = Curves::from_parts(starts, positions, tensors.get(&format!("{name}.cdf"))?);
    let fail = |part: &str, at: usize, what: String| {
        let expected = format!("{name} curves over {cells} cells");
        Err(tensors.invalid_in(&format!("{name}.{part}"), at, &expected, what))
    };
    if curves.starts.first() != Some(&0)
        || curves.starts.last().map(|&s| s as usize) != Some(curves.cdf.len())
        || !curves.starts.is_sorted()
    {
        return fail("start", 0, "starts that do not partition the knots".into());
    }
    if !curves.positions.is_empty() && curves.positions.len() != curves.cdf.len() {
        let found = format!(
            "{} positions for {} values",
            curves.positions.len(),
            curves.cdf.len()
        );
        return fail("position", 0, found);
    }
    // Searches rely on both: the first knot is never above what is looked for, and the last always is.
    for k in 0..curves.len() {
        let range = curves.starts[k] as usize..curves.starts[k + 1] as usize;
        if !rises(&curves.cdf[range.clone()]) {
            return fail(
                "cdf",
                range.start,
                format!("curve {k} that does not rise from 0 to 1"),
            );
        }
        if !fits(&curves, &range, cells) {
            return fail(
                "position",
                range.start,
                format!("curve {k} whose knots do not rise from 0 to {cells}"),
            );
        }
    }
    Ok(curves)
}

/// From 0 to 1, or 0 throughout.
fn rises(cdf: &[u16]) -> bool {
    match cdf {
        [0, .., last] => cdf.is_sorted() && (*last == WHOLE || *last == 0),
        _ => false,
    }
}

/// A knot at every position of the grid, or knots that rise over it.
fn fits(curves: &Curves, range: &Range<usize>, cells: usize) -> bool {
    if curves.positions.is_empty() {
        return range.len() - 1 == cells;
    }
    let p = &curves.positions[range.clone()];
    p[0] == 0 && usize::from(p[p.len() - 1]) == cells && p.is_sorted_by(|a, b| a < b)
}
