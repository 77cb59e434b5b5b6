//! The C header: templates that hold the code, filled with a material's arrays.
//!
//! In the templates `NAME` begins every identifier of a material, and `@…@` is a key whose value is filled in. The text is ASCII
//! without backslashes, and its floats are the shortest decimals that are read back to the bit.

use super::contents::Export;
use super::identifier::identifier;
use crate::geometry::half_vector_chart::ChartEdge;
use crate::material::merl::LookupRule;
use crate::sampler::{NODE_UNIT, ROW_UNIT, Stored};

const TOP: &str = include_str!("header/top.h");
const SHARED: &str = include_str!("header/shared.h");
const TABLE: &str = include_str!("header/table.h");
const FLOOR: &str = include_str!("header/floor.h");
const TRILINEAR: &str = include_str!("header/trilinear.h");
const LOAD: &str = include_str!("header/load.h");

pub(super) fn text(export: &Export) -> String {
    let name = identifier(&export.name);
    let eval = if export.brdf.rule() == LookupRule::Floor {
        FLOOR
    } else {
        TRILINEAR
    };
    let parts = [
        TOP,
        &format!("#ifndef {name}_H\n#define {name}_H\n\n"),
        SHARED,
        "\n",
        TABLE,
        eval,
        LOAD,
        &format!("\n#endif // {name}_H\n"),
    ];
    fill(&parts.concat().replace("NAME", &name), &values(export))
}

/// Every `@key@` of a template by its value. Values are taken as they are.
fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut filled = String::new();
    // Every second piece is a key.
    for (i, piece) in template.split('@').enumerate() {
        if i % 2 == 0 {
            filled += piece;
        } else if let Some((_, value)) = values.iter().find(|v| v.0 == piece) {
            filled += value;
        }
    }
    filled
}

fn values(export: &Export) -> Vec<(&'static str, String)> {
    let mut values = description(export);
    values.extend(arrays(&export.table.to_stored()));
    values
}

/// The description in the header's comments, and the numbers in its code.
fn description(export: &Export) -> Vec<(&'static str, String)> {
    let settings = export.table.settings();
    let segments = settings.segments as f32;
    let centred = export.brdf.rule() == LookupRule::Centred;
    vec![
        ("FILE", printable(&export.name)),
        ("VERSION", env!("CARGO_PKG_VERSION").into()),
        ("SHA256", export.sha256.clone()),
        ("LOOKUP", export.brdf.rule().name().into()),
        ("IMPORTANCE", settings.importance.name().into()),
        ("LICENCE", licence(export.embedded).into()),
        ("FLOATS", (3 * export.dimensions().cells()).to_string()),
        ("PHI_BINS", export.dimensions().phi_d_bins.to_string()),
        ("TABLES", settings.tables.to_string()),
        ("ROWS", settings.rows.to_string()),
        ("SEGMENTS", settings.segments.to_string()),
        ("NODES", (settings.segments + 1).to_string()),
        ("EDGES", (settings.rows + 1).to_string()),
        ("FOLD", u8::from(settings.fold).to_string()),
        ("FOLDED", if settings.fold { ", folded" } else { "" }.into()),
        ("ROW_UNIT", format!("{ROW_UNIT:?}")),
        // In the library's order of operations, for the same bits.
        (
            "NODE_UNIT",
            format!("{:?}", 0.5 * (2.0 * segments * NODE_UNIT)),
        ),
        ("PER_SEGMENT", format!("{:?}", 1.0 / segments)),
        (
            "STANDING",
            if centred {
                "their centres"
            } else {
                "their lower edges"
            }
            .into(),
        ),
        ("OFFSET", if centred { "0.5" } else { "0.0" }.into()),
    ]
}

/// The tables of the half-vector sampler as initialisers. Small numbers share words: first those of CDF and slopes, then densities.
fn arrays(stored: &Stored) -> Vec<(&'static str, String)> {
    let cdf = words(&to_u32(&stored.rows), 16);
    let density = words(&to_u32(&stored.nodes), 16);
    let slopes = slope_words(&stored.slopes);
    let density_from = cdf.len() + slopes.len();
    let mut arrays = edges(stored);
    arrays.extend([
        (
            "COSINE",
            lines(stored.cosines.iter().map(|x| format!("{x:?}f"))),
        ),
        ("CDF_WORDS", cdf.len().to_string()),
        ("CDF", lines(cdf.iter().map(hexadecimal))),
        ("DENSITY_FROM", density_from.to_string()),
        ("WORDS", (density_from + density.len()).to_string()),
        ("SLOPE", lines(slopes.iter().map(hexadecimal))),
        ("DENSITY", lines(density.iter().map(hexadecimal))),
    ]);
    arrays
}

/// The edges of the rows: the fixed part of each, and the weight of the part that moves with `wo`.
fn edges(stored: &Stored) -> Vec<(&'static str, String)> {
    let mut edges = Vec::new();
    for &edge in &stored.edges {
        edges.push(ChartEdge::new(usize::from(edge)));
    }
    vec![
        (
            "EDGE_FIXED",
            lines(edges.iter().map(|e| format!("{:?}f", e.fixed()))),
        ),
        (
            "EDGE_SHARE",
            lines(edges.iter().map(|e| format!("{:?}f", e.weight()))),
        ),
    ]
}

fn to_u32(numbers: &[u16]) -> Vec<u32> {
    numbers.iter().map(|&x| u32::from(x)).collect()
}

/// Slopes in words. A slope of −128 to 127 is stored as 0 to 255.
fn slope_words(slopes: &[i8]) -> Vec<u32> {
    let mut numbers = Vec::with_capacity(slopes.len());
    for &slope in slopes {
        numbers.push((i32::from(slope) + 128) as u32);
    }
    words(&numbers, 8)
}

/// Numbers of `bits` each in words of 32, the first in the lowest bits.
fn words(numbers: &[u32], bits: usize) -> Vec<u32> {
    let mut words = Vec::with_capacity(numbers.len().div_ceil(32 / bits));
    for chunk in numbers.chunks(32 / bits) {
        let mut word = 0;
        for &number in chunk.iter().rev() {
            word = word << bits | number;
        }
        words.push(word);
    }
    words
}

fn hexadecimal(word: &u32) -> String {
    format!("{word:#010x}u")
}

/// Numbers of an initialiser, eight a line.
fn lines(numbers: impl Iterator<Item = String>) -> String {
    let all: Vec<String> = numbers.collect();
    all.chunks(8)
        .map(|line| format!("    {},\n", line.join(", ")))
        .collect()
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
    fn words_hold_numbers_from_the_lowest_bits() {
        assert_eq!(words(&[1, 2, 3], 16), [0x0002_0001, 3]);
        assert_eq!(words(&[1, 2, 3, 4, 255], 8), [0x0403_0201, 255]);
        assert_eq!(lines(["1".into(), "2".into()].into_iter()), "    1, 2,\n");
    }

    #[test]
    fn names_stay_within_a_comment() {
        assert_eq!(printable("a b\\"), "a b_");
        assert_eq!(printable("x\n#error ??/ é@CDF@"), "x_#error __/ __CDF_");
    }

    #[test]
    fn every_key_of_the_templates_is_known() {
        let known = [
            "FILE",
            "VERSION",
            "SHA256",
            "LOOKUP",
            "IMPORTANCE",
            "LICENCE",
            "FLOATS",
            "PHI_BINS",
            "TABLES",
            "ROWS",
            "SEGMENTS",
            "NODES",
            "EDGES",
            "FOLD",
            "FOLDED",
            "ROW_UNIT",
            "NODE_UNIT",
            "PER_SEGMENT",
            "STANDING",
            "OFFSET",
            "COSINE",
            "EDGE_FIXED",
            "EDGE_SHARE",
            "CDF_WORDS",
            "CDF",
            "DENSITY_FROM",
            "SLOPE",
            "WORDS",
            "DENSITY",
        ];
        let all = [TOP, SHARED, TABLE, FLOOR, TRILINEAR, LOAD].concat();
        for key in all.split('@').skip(1).step_by(2) {
            assert!(known.contains(&key), "{key}");
        }
        assert!(all.is_ascii() && !all.contains('\\'));
    }
}
