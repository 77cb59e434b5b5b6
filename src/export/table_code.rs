//! The part of run-time code that every language has: the table, draws, densities and values.

use super::templates::{DRAW, Entry, FLOOR, LINEAR, fill};
use crate::sampler::NODE_UNIT;

const TABLE: &str = include_str!("templates/runtime/table.h");
const EVAL: &str = include_str!("templates/runtime/eval.h");

/// Words of a file's head that a table is opened by.
pub(super) const HEAD_WORDS: [(&str, usize); 6] = [
    ("WORD_5", 5),
    ("WORD_6", 6),
    ("WORD_7", 7),
    ("WORD_8", 8),
    ("WORD_9", 9),
    ("WORD_10", 10),
];

/// What the run-time header and shaders call the functions that a material's header begins with the material's name.
const FUNCTIONS: [(&str, &str); 7] = [
    ("NAME_about", "merlkit_prepare"),
    ("NAME_draw", "merlkit_draw_prepared"),
    ("NAME_density_of", "merlkit_pdf_prepared"),
    ("NAME_sample", "merlkit_sample"),
    ("NAME_pdf", "merlkit_pdf"),
    ("NAME_WORD", "MERLKIT_WORD"),
    ("NAME_VALUE(", "merlkit_table_value(table, "),
];

/// Settings that are constants in a material's header and members of a table here.
const MEMBERS: [(&str, &str); 11] = [
    ("NAME_TABLES", "tables"),
    ("NAME_ROWS", "rows"),
    ("NAME_SEGMENTS", "segments"),
    ("NAME_FOLD", "fold"),
    ("NAME_PHI_BINS", "phi_bins"),
    ("NAME_CDF", "cdf"),
    ("NAME_SLOPES", "slopes"),
    ("NAME_DENSITY", "density"),
    ("NAME_NODE_UNIT", "node_unit"),
    ("NAME_PER_SEGMENT", "per_segment"),
    ("NAME_OFFSET", "offset"),
];

/// The code from the table to `eval`; `owner` is what its members are reached by.
pub(super) fn table_code(entries: &[Entry], owner: &str) -> String {
    let mut template = [TABLE, DRAW, "\n", FLOOR, "\n", LINEAR, EVAL].concat();
    for (from, to) in FUNCTIONS {
        template = template.replace(from, to);
    }
    for (from, member) in MEMBERS {
        template = template.replace(from, &format!("{owner}{member}"));
    }
    fill(&template.replace("NAME", "merlkit_table"), entries)
}

/// How a table is a parameter, an argument, and an owner of members.
pub(super) fn table_entries(parameter: &str, owner: &str) -> Vec<Entry> {
    vec![
        ("TABLE", parameter.into()),
        ("VALUES", parameter.into()),
        ("PASS", "table, ".into()),
        ("PASS_VALUES", "table, ".into()),
        ("T", owner.into()),
        ("EVAL_FLOOR", "merlkit_eval_floor".into()),
        ("EVAL_LINEAR", "merlkit_eval_linear".into()),
        ("NODE_UNIT", format!("{NODE_UNIT:?}")),
    ]
}
