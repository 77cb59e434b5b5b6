//! Files of the cascade CDF whose curves contradict themselves.

use super::*;

#[test]
fn forged_curves_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a CDF that falls",
            |f| f.set_u16("marginal.cdf", 2, 0),
            "marginal curves",
        ),
        (
            "a conditional that falls",
            |f| {
                let mut knots =
                    |c| f.u32("conditional.start", c + 1) - f.u32("conditional.start", c);
                let curve = (0..).find(|&c| knots(c) > 3).unwrap();
                let start = f.u32("conditional.start", curve) as usize;
                f.set_u16("conditional.cdf", start + 1, u16::MAX);
            },
            "conditional curves",
        ),
        (
            "a CDF that starts above 0",
            |f| f.set_u16("marginal.cdf", 0, 1),
            "curve 0",
        ),
        (
            "a CDF that ends below 1",
            |f| {
                let last = f.u32("marginal.start", 1) as usize - 1;
                f.set_u16("marginal.cdf", last, u16::MAX - 1);
            },
            "curve 0",
        ),
        (
            "starts past the end",
            |f| f.set_u32("marginal.start", 1, u32::MAX),
            "starts",
        ),
        (
            "starts that fall",
            |f| {
                let third = f.u32("conditional.start", 3);
                f.set_u32("conditional.start", 2, third + 1);
            },
            "starts",
        ),
        (
            "a first start other than 0",
            |f| f.set_u32("marginal.start", 0, 1),
            "starts",
        ),
        (
            "an empty curve",
            |f| f.set_u32("marginal.start", 1, 0),
            "curve 0",
        ),
        (
            "a knot past the grid",
            |f| {
                let last = f.u32("marginal.start", 1) as usize - 1;
                f.set_u16("marginal.position", last, 9000);
            },
            "curve 0",
        ),
        (
            "knots that fall",
            |f| f.set_u16("marginal.position", 1, 0),
            "curve 0",
        ),
        (
            "fewer knots than values",
            |f| f.cut("conditional.position", 2),
            "positions",
        ),
        (
            "a missing conditional",
            |f| {
                let knots = f.bytes("conditional.start").len() / 4;
                let last =
                    f.u32("conditional.start", knots - 1) - f.u32("conditional.start", knots - 2);
                f.cut("conditional.start", 4);
                f.cut("conditional.position", 2 * last as usize);
                f.cut("conditional.cdf", 2 * last as usize);
            },
            "a conditional for each",
        ),
        (
            "a conditional without mass",
            |f| {
                // The second piece of the first marginal has mass; its conditional is made void.
                for knot in f.u32("conditional.start", 1)..f.u32("conditional.start", 2) {
                    f.set_u16("conditional.cdf", knot as usize, 0);
                }
            },
            "piece 1 of marginal 0",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 4.into()),
            "4 marginals",
        ),
        (
            "another grid",
            |f| f.settings("theta_h", 512.into()),
            "marginal curves over 512 cells",
        ),
        (
            "another grid of φh",
            |f| f.settings("phi_h", 256.into()),
            "conditional curves over 256 cells",
        ),
        (
            "a grid past its domain",
            |f| f.settings("phi_h", 100_000.into()),
            "x100000",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("conditional.cdf");
            },
            "a tensor \"conditional.cdf\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("marginal.position").unwrap().0 = Dtype::I16,
            "U16, found I16",
        ),
        ("no tensors", |f| f.tensors.clear(), "found none"),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[1].clone(), &forgeries);
}

#[test]
fn forged_curves_with_every_knot_are_refused() {
    let forgeries: [Forgery; 3] = [
        (
            "a curve of another length",
            |f| {
                let start = f.u32("conditional.start", 1);
                f.set_u32("conditional.start", 1, start - 1);
            },
            "curve 0",
        ),
        (
            "another grid",
            |f| f.settings("theta_h", 255.into()),
            "marginal curves over 255 cells",
        ),
        (
            "a tolerance that is negative",
            |f| f.settings("tolerance", (-1.0).into()),
            "tolerance",
        ),
    ];
    assert_each_is_refused(specs()[2].clone(), &forgeries);
}
