//! Files of the half-vector table whose tensors contradict themselves.

use super::*;

#[test]
fn forged_half_vector_tables_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a knot that is no normal",
            |f| f.set_f32("knot.cosine", 0, 0.99),
            "fall from 1",
        ),
        (
            "knots that rise",
            |f| f.set_f32("knot.cosine", 2, 0.9999),
            "fall from 1",
        ),
        (
            "NaN for a knot",
            |f| f.set_f32("knot.cosine", 1, f32::NAN),
            "fall from 1",
        ),
        (
            "a knot on the horizon",
            |f| f.set_f32("knot.cosine", 6, 0.0),
            "stay above 0",
        ),
        (
            "rows that do not begin at 0",
            |f| f.set_u16("row.edge", 0, 1),
            "from 0 to 79",
        ),
        (
            "rows past the end",
            |f| f.set_u16("row.edge", 22, 80),
            "from 0 to 79",
        ),
        (
            "edges that fall",
            |f| f.set_u16("row.edge", 2, 1),
            "from 0 to 79",
        ),
        (
            "an empty first row",
            |f| f.set_u16("row.cdf", 0, 0),
            "tensor \"row.cdf\"",
        ),
        (
            "a probability below 1",
            |f| f.set_u16("row.cdf", 21, 65534),
            "tensor \"row.cdf\"",
        ),
        (
            "probabilities that fall",
            |f| f.set_u16("row.cdf", 30, 1),
            "tensor \"row.cdf\"",
        ),
        (
            "a slope that is too steep",
            |f| f.bytes("row.slope")[5] = 123,
            "row.slope",
        ),
        (
            "the steepest slope downwards",
            |f| f.bytes("row.slope")[5] = 128,
            "row.slope",
        ),
        (
            "a density of 0",
            |f| f.set_u16("row.density", 7, 0),
            "row.density",
        ),
        (
            "a density that is too large",
            |f| f.set_u16("row.density", 7, 65535),
            "row.density",
        ),
        (
            "a short tensor",
            |f| f.cut("row.slope", 1),
            "154 values in tensor \"row.slope\"",
        ),
        (
            "a shorter one",
            |f| f.cut("row.density", 2),
            "values in tensor \"row.density\"",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 8.into()),
            "8 values in tensor \"knot.cosine\"",
        ),
        (
            "another number of rows",
            |f| f.settings("rows", 23.into()),
            "24 values in tensor \"row.edge\"",
        ),
        (
            "no segments",
            |f| f.settings("segments", 0.into()),
            "segments=0",
        ),
        (
            "more segments than can be",
            |f| f.settings("segments", u64::MAX.into()),
            "segments",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("row.cdf");
            },
            "a tensor \"row.cdf\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("row.slope").unwrap().0 = Dtype::U8,
            "I8, found U8",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(
        SamplerSpec::new(HalfVectorSettings::PRESETS[0].1),
        &forgeries,
    );
}
