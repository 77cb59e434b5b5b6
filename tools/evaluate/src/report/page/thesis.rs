//! The thesis's tables beside ours.

use super::Section;
use super::html::{paragraph, table};
use crate::measure::compare::Comparison;
use crate::report::{ThesisTable, beside_thesis};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let one = |t: &ThesisTable| table(&t.title, &t.sheet) + &paragraph(&t.note);
    let all: String = beside_thesis(comparison).iter().map(one).collect();
    if all.is_empty() {
        return None;
    }
    let note = "Figures of R. Montes's thesis (Universidad de Granada, 2008), measured on its own machine, an AMD Opteron of \
                2007, and from the MERL measurements themselves; beside them ours, of this run. Ratios are the thesis's \
                figure over ours: above 1, ours is the smaller.";
    Section::new(
        "thesis",
        "Beside the thesis of 2008",
        paragraph(note) + &all,
    )
}
