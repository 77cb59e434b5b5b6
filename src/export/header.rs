//! A material's own header: templates that hold the code, filled with the material's arrays.
//!
//! Its floats are the shortest decimals that are read back to the bit.

use super::contents::Export;
use super::identifier::identifier;
use super::packed::Packed;
use super::templates::{DRAW, Entry, FLOOR, LINEAR, SPELLING_C, SPELLING_GLSL};
use super::templates::{fill, shared, version_and_units};
use crate::material::merl::LookupRule;
use crate::sampler::NODE_UNIT;

const TOP: &str = include_str!("templates/header/top.h");
const ARRAYS: &str = include_str!("templates/header/arrays.h");
const VALUES: &str = include_str!("templates/header/values.h");
const LOAD: &str = include_str!("templates/header/load.h");

pub(super) fn text(export: &Export) -> String {
    let name = identifier(&export.name);
    let spelling = format!(
        "#if defined(GL_core_profile) || defined(GL_compatibility_profile) || defined(GL_ES)\n\
         {SPELLING_GLSL}#else\n{SPELLING_C}#endif\n"
    );
    let material = [
        TOP,
        ARRAYS,
        DRAW,
        VALUES,
        eval(export.brdf.rule()),
        "#endif\n",
        LOAD,
    ];
    let entries = values(export);
    let mut parts = material.map(|part| fill(&part.replace("NAME", &name), &entries));
    // What all materials share, behind the description and in front of the arrays.
    parts[0] += &format!(
        "#ifndef {name}_H\n#define {name}_H\n\n{}",
        shared(&spelling)
    );
    parts.concat() + &format!("\n#endif // {name}_H\n")
}

/// The values of a material by its lookup rule; `NAME_eval` in either case.
fn eval(rule: LookupRule) -> &'static str {
    if rule == LookupRule::Floor {
        FLOOR
    } else {
        LINEAR
    }
}

fn values(export: &Export) -> Vec<Entry> {
    let mut values = version_and_units();
    values.extend(description(export));
    values.extend(arrays(&Packed::new(&export.table.to_stored())));
    values.extend(parameters(&identifier(&export.name)));
    values
}

/// The arrays are constants, so that only `eval` has a parameter for data.
fn parameters(name: &str) -> Vec<Entry> {
    vec![
        ("TABLE", String::new()),
        ("PASS", String::new()),
        ("VALUES", "MERLKIT_VALUES ".into()),
        ("PASS_VALUES", format!("{name}_VALUES ")),
        ("EVAL_FLOOR", format!("{name}_eval")),
        ("EVAL_LINEAR", format!("{name}_eval")),
    ]
}

/// The description in the header's comments, and the numbers in its code.
fn description(export: &Export) -> Vec<Entry> {
    let settings = export.table.settings();
    let segments = settings.segments as f32;
    let centred = export.brdf.rule() == LookupRule::Centred;
    vec![
        ("FILE", printable(&export.name)),
        ("SHA256", export.sha256.clone()),
        ("LOOKUP", export.brdf.rule().name().into()),
        ("IMPORTANCE", settings.importance.name().into()),
        ("LICENCE", licence(export.embedded).into()),
        ("FLOATS", (3 * export.dimensions().cells()).to_string()),
        ("PHI_BINS", export.dimensions().phi_d_bins.to_string()),
        ("TABLES", settings.tables.to_string()),
        ("ROWS", settings.rows.to_string()),
        ("SEGMENTS", settings.segments.to_string()),
        ("EDGES", (settings.rows + 1).to_string()),
        ("FOLD", u8::from(settings.fold).to_string()),
        ("FOLDED", if settings.fold { ", folded" } else { "" }.into()),
        // In the library's order of operations, for the same bits.
        (
            "NODE_UNIT",
            format!("{:?}", 0.5 * (2.0 * segments * NODE_UNIT)),
        ),
        ("PER_SEGMENT", format!("{:?}", 1.0 / segments)),
        ("POSITIONS", positions(export.brdf.rule()).into()),
        ("OFFSET", if centred { "0.5" } else { "0.0" }.into()),
    ]
}

/// Where the values of bins are taken to lie.
fn positions(rule: LookupRule) -> &'static str {
    match rule {
        LookupRule::Floor => "each holds for its whole bin",
        LookupRule::Linear => "linear between the lower edges of bins",
        LookupRule::Centred => "linear between the centres of bins",
    }
}

/// The table as initialisers.
fn arrays(packed: &Packed) -> Vec<Entry> {
    let density_from = packed.cdf.len() + packed.slopes.len();
    vec![
        ("COSINE", lines(packed.cosines.iter().map(decimal))),
        ("EDGE_FIXED", lines(packed.edges_fixed.iter().map(decimal))),
        (
            "EDGE_WEIGHT",
            lines(packed.edges_weight.iter().map(decimal)),
        ),
        ("CDF_WORDS", packed.cdf.len().to_string()),
        ("DENSITY_FROM", density_from.to_string()),
        ("WORDS", (density_from + packed.density.len()).to_string()),
        ("WORD_LINES", lines(packed.words().map(|w| hexadecimal(&w)))),
    ]
}

fn decimal(x: &f32) -> String {
    format!("{x:?}f")
}

fn hexadecimal(word: &u32) -> String {
    format!("{word:#010x}u")
}

/// Numbers of an initialiser, eight a line. GLSL ES takes no comma behind the last.
fn lines(numbers: impl Iterator<Item = String>) -> String {
    let all: Vec<String> = numbers.collect();
    let lines: Vec<String> = all
        .chunks(8)
        .map(|line| format!("    {}", line.join(", ")))
        .collect();
    lines.join(",\n") + "\n"
}

/// A name for a comment: none of its bytes ends the line or joins it to the next.
fn printable(name: &str) -> String {
    let mut printable = String::with_capacity(name.len());
    for c in name.chars() {
        let is_plain = c.is_ascii_graphic() && !"\\?\"@".contains(c) || c == ' ';
        printable.push(if is_plain { c } else { '_' });
    }
    printable
}

fn licence(embedded: bool) -> &'static str {
    if embedded {
        "a network (Sztrajman et al. 2021; MIT licence, Copyright (c) 2022 asztr) that was fitted to a measurement of the MERL\n\
         // database (Matusik et al. 2003)."
    } else {
        "whoever measured it says what it may be used for; the MERL database (Matusik et al. 2003), for academic and research use."
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn initialisers_end_without_a_comma() {
        let numbers = (1..=9).map(|i| i.to_string());
        assert_eq!(lines(numbers), "    1, 2, 3, 4, 5, 6, 7, 8,\n    9\n");
    }

    #[test]
    fn names_stay_within_a_comment() {
        assert_eq!(printable("a b\\"), "a b_");
        assert_eq!(printable("x\n#error ??/ é@CDF@"), "x_#error __/ __CDF_");
    }

    #[test]
    fn templates_are_plain() {
        let all = [TOP, ARRAYS, VALUES, LOAD].concat();
        assert!(all.is_ascii() && !all.contains('\\'));
    }
}
