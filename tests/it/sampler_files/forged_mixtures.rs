//! Files of lobes and of the factored BRDF whose parameters are outside their domains.

use super::*;

#[test]
fn forged_lobes_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "another parameter",
            |f| f.set_f32("lobe.parameter", 0, 0.123),
            "parameters of the record",
        ),
        (
            "NaN for a parameter",
            |f| f.set_f32("lobe.parameter", 2, f32::NAN),
            "parameters of the record",
        ),
        ("a short tensor", |f| f.cut("lobe.parameter", 4), "3 values"),
        (
            "no parameters",
            |f| f.settings("parameters", serde_json::Value::Null),
            "parameters of the record",
        ),
        (
            "another lobe",
            |f| f.settings("kind", "magic".into()),
            "settings of a merlkit sampler",
        ),
        (
            "parameters past their domain in both places",
            |f| {
                for i in 0..3 {
                    f.set_f32("lobe.parameter", i, 0.0);
                }
                let zero = serde_json::json!({"along": 0.0, "across": 0.0, "diffuse": 0.0});
                f.settings("parameters", zero);
            },
            "ggx with parameters 0, 0 and 0",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("lobe.parameter");
            },
            "a tensor \"lobe.parameter\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("lobe.parameter").unwrap().0 = Dtype::U32,
            "F32, found U32",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(specs()[6].clone(), &forgeries);
}

#[test]
fn forged_factors_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "NaN for a share",
            |f| f.set_f32("term.weight", 8, f32::NAN),
            "probabilities of table 1",
        ),
        (
            "a share below 0",
            |f| f.set_f32("term.weight", 8, -0.1),
            "probabilities of table 1",
        ),
        (
            "a share above 1",
            |f| f.set_f32("term.weight", 8, 1.5),
            "probabilities of table 1",
        ),
        (
            "shares above 1 together",
            |f| (6..12).for_each(|i| f.set_f32("term.weight", i, 0.3)),
            "probabilities of table 1",
        ),
        (
            "a term that can't be drawn",
            |f| {
                let row = f.u32("theta.start", 1) as usize;
                (0..row).for_each(|i| f.set_u16("theta.cdf", i, 0));
            },
            "terms that cannot be drawn",
        ),
        (
            "a CDF that falls",
            |f| f.set_u16("phi.cdf", 3, 0),
            "phi curves",
        ),
        (
            "starts past the end",
            |f| f.set_u32("theta.start", 1, u32::MAX),
            "starts",
        ),
        (
            "a short tensor",
            |f| f.cut("term.weight", 4),
            "30 of 6 terms",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 6.into()),
            "36 of 6 terms",
        ),
        ("no tables", |f| f.settings("tables", 0.into()), "tables=0"),
        (
            "more tables than can be",
            |f| f.settings("tables", u64::MAX.into()),
            "tables",
        ),
        (
            "no factors",
            |f| f.settings("factors", serde_json::Value::Null),
            "factors of a factored sampler",
        ),
        (
            "other cells",
            |f| f.record["settings"]["factors"]["theta"] = 41.into(),
            "theta curves over 41",
        ),
        (
            "another J",
            |f| f.record["settings"]["factors"]["outer"] = 4.into(),
            "of 8 terms",
        ),
        (
            "no J",
            |f| f.record["settings"]["factors"]["outer"] = 0.into(),
            "factors=0x2/",
        ),
        (
            "a floor past 1",
            |f| f.record["settings"]["factors"]["floor"] = 1.5.into(),
            "/1.5",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("phi.cdf");
            },
            "a tensor \"phi.cdf\", found none",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(factored(), &forgeries);
}
