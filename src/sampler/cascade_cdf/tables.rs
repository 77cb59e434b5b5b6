//! The curves that are drawn from.

use crate::distribution::{Curves, Segment};

/// The tables of all knots.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tables {
    /// One curve over θh a knot.
    pub marginal: Curves,
    /// One curve over φh for each piece of each marginal, in order.
    pub conditional: Curves,
    /// First conditional of each knot.
    pub first: Vec<u32>,
}

impl Tables {
    pub fn new(marginal: Curves, conditional: Curves) -> Self {
        let first = (0..marginal.len())
            .scan(0, |next, k| {
                let first = *next;
                *next += marginal.segments(k) as u32;
                Some(first)
            })
            .collect();
        Self {
            marginal,
            conditional,
            first,
        }
    }

    /// The conditional curve of a piece of the marginal of a table.
    #[inline(always)]
    pub fn find_conditional(&self, table: usize, piece: &Segment) -> usize {
        self.first[table] as usize + piece.index
    }
}
