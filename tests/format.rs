//! The embedded materials against an independent decoder, and the file format there and back.

mod support;

use merlkit::files::Overwrite;
use merlkit::merl::{Header, MerlTable, SCALE, decode_embedded, load, write};

#[test]
fn embedded_materials_decode_to_the_golden_values() {
    let mut worst = 0.0f64;
    let mut tables = std::collections::BTreeMap::new();
    for row in support::golden("golden_decode.csv") {
        let table: &MerlTable =
            tables.entry(row[0].clone()).or_insert_with(|| decode_embedded(&row[0]).unwrap());
        let [h, d, p]: [usize; 3] = std::array::from_fn(|i| row[i + 1].parse().unwrap());
        for c in 0..3 {
            let expected: f64 = row[4 + c].parse().unwrap();
            if expected < 0.0 {
                assert!(!table.is_valid(h, d, p), "{row:?}");
            } else {
                // The network's output is ln(1 + f_r); computed in f32, that is where its rounding error is even.
                let decoded = f64::from(table.rgb(h, d, p)[c]).ln_1p();
                worst = worst.max((decoded - (expected * SCALE[c]).ln_1p()).abs());
            }
        }
    }
    assert_eq!(tables.len(), 10);
    assert!(worst < 5e-6, "ln(1 + f_r) differs by {worst:e}");
}
