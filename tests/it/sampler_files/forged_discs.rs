//! Files of the adaptive disc whose trees contradict themselves.

use super::*;

#[test]
fn forged_trees_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "NaN for a bound",
            |f| f.set_f32("leaf.bound", 2, f32::NAN),
            "leaf 2 of tree 0",
        ),
        (
            "infinity for a bound",
            |f| f.set_f32("leaf.bound", 0, f32::INFINITY),
            "leaf 0 of tree 0",
        ),
        (
            "a bound of 0",
            |f| f.set_f32("leaf.bound", 1, 0.0),
            "leaf 1 of tree 0",
        ),
        (
            "a bound below 0",
            |f| f.set_f32("leaf.bound", 1, -1.0),
            "leaf 1 of tree 0",
        ),
        (
            "a leaf too deep",
            |f| f.set_u32("leaf.code", 3, 15 << 28),
            "leaf 3 of tree 0",
        ),
        (
            "a leaf beside the disc's square",
            |f| f.set_u32("leaf.code", 3, 1 << 28 | 2),
            "leaf 3 of tree 0",
        ),
        (
            "probabilities that fall",
            |f| f.set_u32("leaf.upper", 5, 0),
            "probabilities of tree 0",
        ),
        (
            "probabilities below 1",
            |f| {
                let last = f.u32("tree.start", 1) as usize - 1;
                f.set_u32("leaf.upper", last, u32::MAX - 1);
            },
            "sum to 1",
        ),
        (
            "starts past the end",
            |f| f.set_u32("tree.start", 6, u32::MAX),
            "starts that partition",
        ),
        (
            "starts that fall",
            |f| f.set_u32("tree.start", 3, 1),
            "starts that partition",
        ),
        (
            "a first start other than 0",
            |f| f.set_u32("tree.start", 0, 1),
            "starts that partition",
        ),
        (
            "a tree without leaves",
            |f| f.set_u32("tree.start", 1, 0),
            "0 leaves",
        ),
        (
            "NaN for an integral",
            |f| f.set_f32("tree.integral", 4, f32::NAN),
            "tree 4",
        ),
        (
            "an integral below 0",
            |f| f.set_f32("tree.integral", 4, -0.5),
            "tree 4",
        ),
        (
            "a dark tree with leaves",
            |f| f.set_f32("tree.integral", 4, 0.0),
            "tree 4",
        ),
        ("a short tensor", |f| f.cut("leaf.bound", 4), "equal length"),
        (
            "a missing tree",
            |f| {
                f.cut("tree.start", 4);
                f.cut("tree.integral", 4);
            },
            "7 trees",
        ),
        (
            "another number of trees",
            |f| f.settings("tables", 8.into()),
            "8 trees",
        ),
        (
            "no trees at all",
            |f| f.settings("tables", 0.into()),
            "tables=0",
        ),
        (
            "more trees than can be counted",
            |f| f.settings("tables", u64::MAX.into()),
            "tables=18446744073709551615",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("leaf.code");
            },
            "a tensor \"leaf.code\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("leaf.code").unwrap().0 = Dtype::I32,
            "U32, found I32",
        ),
        (
            "a depth past its domain",
            |f| f.settings("depth", 99.into()),
            "depth=99",
        ),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[0].clone(), &forgeries);
}

#[test]
fn forged_warps_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a child before its parent",
            |f| f.set_u32("node.first", 3, 3),
            "node 3 of tree 0",
        ),
        (
            "a child in another tree",
            |f| f.set_u32("node.first", 0, u32::MAX),
            "node 0 of tree 0",
        ),
        (
            "five children",
            |f| f.set_u16("node.inner", 1, 31),
            "node 1 of tree 0",
        ),
        (
            "starts that fall",
            |f| f.set_u32("tree.start", 2, 0),
            "starts that partition",
        ),
        (
            "starts past the end",
            |f| f.set_u32("tree.start", 4, u32::MAX),
            "starts that partition",
        ),
        ("a missing tree", |f| f.cut("tree.start", 4), "4 trees"),
        (
            "more trees than can be counted",
            |f| f.settings("tables", u64::MAX.into()),
            "tables=18446744073709551615",
        ),
        (
            "a missing split",
            |f| f.cut("node.split", 2),
            "three splits",
        ),
        (
            "another kind of tree",
            |f| f.settings("leaves", "envelope".into()),
            "a tensor \"leaf.upper\"",
        ),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[3].clone(), &forgeries);
}
