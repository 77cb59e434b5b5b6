//! The thesis's tables beside ours.

use super::Section;
use super::html::{paragraph, table};
use crate::measure::compare::Comparison;
use crate::report::{ThesisTable, beside_thesis};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let mut all = String::new();
    for ThesisTable { title, note, sheet } in beside_thesis(comparison) {
        all += &table(&title, &sheet);
        all += &paragraph(&note);
    }
    if all.is_empty() {
        return None;
    }
    let note = "Results from R. Montes's thesis (Universidad de Granada, 2008), compared with those of this run (“ours”). The \
                thesis measured them with the original MERL data on an AMD Opteron of 2007. A ratio is the thesis's value \
                divided by ours: above 1, ours is smaller. merlkit thesis repeats these tables and others, and measures the drawing of table \
                6.24 alone.";
    Section::new(
        "thesis",
        "Comparison with the thesis of 2008",
        paragraph(note) + &all,
    )
}
