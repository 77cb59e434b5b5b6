//! The adaptive disc in a file: its tensors, and what drawing relies on.

use super::quad_cell::{DEEPEST, QuadCell};
use super::settings::{AdaptiveDiscSettings, LeafChoice};
use super::tree::{Forest, Leaf, MOST_LEAVES, WHOLE};
use super::trees::Trees;
use super::warp::{Node, Warps};
use crate::Result;
use crate::sampler::store::{TensorWriter, Tensors};

/// Adds the trees to a file.
pub(super) fn write(trees: &Trees, out: &mut TensorWriter) {
    match trees {
        Trees::Rejecting(forest) => write_forest(forest, out),
        Trees::Warped(warps) => write_warps(warps, out),
    }
}

fn write_warps(warps: &Warps, out: &mut TensorWriter) {
    out.add("node.split", warps.nodes.iter().flat_map(|n| n.split));
    out.add("node.inner", warps.nodes.iter().map(|n| n.inner));
    out.add("node.first", warps.nodes.iter().map(|n| n.first));
    out.add("tree.start", warps.starts.iter().copied());
}

fn write_forest(forest: &Forest, out: &mut TensorWriter) {
    out.add("leaf.upper", forest.leaves.iter().map(|l| l.upper));
    out.add("leaf.bound", forest.leaves.iter().map(|l| l.bound));
    out.add("leaf.code", forest.leaves.iter().map(|l| l.code));
    out.add("tree.start", forest.starts.iter().copied());
    out.add("tree.integral", forest.integrals.iter().copied());
    if !forest.excess.is_empty() {
        out.add("tree.excess", forest.excess.iter().copied());
    }
}

/// Reads the trees. Those of a BRDF whose values may exceed their bounds come with the part of ∫ f that does.
pub(super) fn read(
    tensors: &Tensors,
    settings: &AdaptiveDiscSettings,
    may_exceed: bool,
) -> Result<Trees> {
    let count = settings.trees();
    Ok(match settings.leaves {
        LeafChoice::Warp => Trees::Warped(read_warps(tensors, count)?),
        LeafChoice::Envelope | LeafChoice::Integral => {
            Trees::Rejecting(read_forest(tensors, count, may_exceed)?)
        }
    })
}

fn read_excess(tensors: &Tensors, tables: usize, may_exceed: bool) -> Result<Vec<f32>> {
    if !may_exceed {
        return Ok(Vec::new());
    }
    let excess = tensors.get::<f32>("tree.excess")?;
    let is_sound = excess.iter().all(|e| (0.0..=1.0).contains(e));
    if excess.len() != tables || !is_sound {
        let expected = format!("a part of ∫ f, 0 to 1, for each of {tables} trees");
        let found = format!("{} numbers", excess.len());
        return Err(tensors.invalid_in("tree.excess", 0, &expected, found));
    }
    Ok(excess)
}

/// Reads trees whose nodes have their children behind them and in the same tree, no deeper than any that is built.
fn read_warps(tensors: &Tensors, tables: usize) -> Result<Warps> {
    let (split, inner) = (
        tensors.get::<u16>("node.split")?,
        tensors.get::<u16>("node.inner")?,
    );
    let first = tensors.get::<u32>("node.first")?;
    let starts = tensors.get::<u32>("tree.start")?;
    if inner.len() != first.len() || split.len() != 3 * first.len() {
        let lengths = format!("{}, {} and {}", split.len(), inner.len(), first.len());
        let expected = "three splits, a mask and a first child for each node";
        return Err(tensors.invalid_in("node.split", 0, expected, lengths));
    }
    if starts.len() != tables.saturating_add(1) {
        let found = format!("{} starts", starts.len());
        return Err(tensors.invalid_in("tree.start", 0, &format!("{tables} trees"), found));
    }
    if starts[0] != 0 || !starts.is_sorted() || starts[tables] as usize != first.len() {
        let expected = format!("starts that partition {} nodes", first.len());
        return Err(tensors.invalid_in("tree.start", 0, &expected, "others"));
    }
    let mut nodes = Vec::with_capacity(first.len());
    for (i, split) in split.as_chunks::<3>().0.iter().enumerate() {
        nodes.push(Node {
            split: *split,
            inner: inner[i],
            first: first[i],
        });
    }
    for (k, range) in starts.windows(2).enumerate() {
        for i in range[0]..range[1] {
            let node = &nodes[i as usize];
            if !is_sound_node(node, i, range[1]) {
                let expected = format!("a sound node {i} of tree {k}");
                let found = format!("{node:?}");
                return Err(tensors.invalid_in("node.first", i as usize, &expected, found));
            }
        }
    }
    Ok(Warps { nodes, starts })
}

/// Whether the children of node `i` follow it in its tree, which ends before node `end`.
fn is_sound_node(node: &Node, i: u32, end: u32) -> bool {
    let children = node.inner.count_ones();
    let last = u64::from(node.first) + u64::from(children);
    let is_inside = children == 0 || (node.first > i && last <= u64::from(end));
    node.inner < 16 && is_inside
}

fn read_forest(tensors: &Tensors, tables: usize, may_exceed: bool) -> Result<Forest> {
    let (upper, bound) = (
        tensors.get::<u32>("leaf.upper")?,
        tensors.get::<f32>("leaf.bound")?,
    );
    let code = tensors.get::<u32>("leaf.code")?;
    let starts = tensors.get::<u32>("tree.start")?;
    let integrals = tensors.get::<f32>("tree.integral")?;
    if bound.len() != upper.len() || code.len() != upper.len() {
        let lengths = format!("{}, {} and {}", upper.len(), bound.len(), code.len());
        return Err(tensors.invalid_in("leaf.upper", 0, "leaf tensors of equal length", lengths));
    }
    if integrals.len() != tables || starts.len() != integrals.len() + 1 {
        let found = format!("{} starts and {} integrals", starts.len(), integrals.len());
        return Err(tensors.invalid_in("tree.start", 0, &format!("{tables} trees"), found));
    }
    if starts[0] != 0 || !starts.is_sorted() || starts[tables] as usize != upper.len() {
        let expected = format!("starts that partition {} leaves", upper.len());
        return Err(tensors.invalid_in("tree.start", 0, &expected, "others"));
    }
    let mut leaves = Vec::with_capacity(upper.len());
    for (i, &upper) in upper.iter().enumerate() {
        leaves.push(Leaf {
            upper,
            bound: bound[i],
            code: code[i],
        });
    }
    for (k, (range, &integral)) in starts.windows(2).zip(&integrals).enumerate() {
        check_tree(
            tensors,
            k,
            range[0] as usize,
            &leaves[range[0] as usize..range[1] as usize],
            integral,
        )?;
    }
    let excess = read_excess(tensors, tables, may_exceed)?;
    if may_exceed {
        check_order(tensors, &leaves, &starts)?;
    }
    Ok(Forest::new(leaves, starts, integrals, excess))
}

/// Leaves of each tree in Z-order, in which the one that holds a point is searched for.
fn check_order(tensors: &Tensors, leaves: &[Leaf], starts: &[u32]) -> Result<()> {
    for (k, range) in starts.windows(2).enumerate() {
        let tree = &leaves[range[0] as usize..range[1] as usize];
        let is_sound = tree.windows(2).all(|pair| {
            let (first, count) = QuadCell::z_range(pair[0].code);
            first + count <= QuadCell::z_range(pair[1].code).0
        });
        if !is_sound {
            let expected = format!("leaves of tree {k} in Z-order, none within another");
            return Err(tensors.invalid_in("leaf.code", range[0] as usize, &expected, "others"));
        }
    }
    Ok(())
}

/// Whether the square of a leaf is one of its depth, and draws under its bound can be accepted.
fn is_sound_leaf(leaf: &Leaf) -> bool {
    let depth = leaf.code >> 28;
    let (column, row) = (leaf.code >> 14 & 0x3fff, leaf.code & 0x3fff);
    let is_bounded = leaf.bound.is_finite() && leaf.bound > 0.0;
    is_bounded && depth <= DEEPEST && column >> depth == 0 && row >> depth == 0
}

/// Leaves, of which `first` is the first, that can be drawn and whose draws can be accepted.
fn check_tree(
    tensors: &Tensors,
    k: usize,
    first: usize,
    leaves: &[Leaf],
    integral: f32,
) -> Result<()> {
    if !integral.is_finite() || integral < 0.0 || (integral > 0.0) == leaves.is_empty() {
        let expected = format!("an integral of tree {k} that is finite, and > 0 if it has leaves");
        let found = format!("{integral} with {} leaves", leaves.len());
        return Err(tensors.invalid_in("tree.integral", k, &expected, found));
    }
    if leaves.len() > MOST_LEAVES || leaves.last().is_some_and(|l| l.upper != WHOLE) {
        let expected =
            format!("at most {MOST_LEAVES} leaves in tree {k}, whose probabilities sum to 1");
        return Err(tensors.invalid_in(
            "leaf.upper",
            first,
            &expected,
            format!("{} leaves", leaves.len()),
        ));
    }
    if let Some(i) = leaves.iter().position(|leaf| !is_sound_leaf(leaf)) {
        let expected = format!("a sound leaf {i} of tree {k}");
        return Err(tensors.invalid_in(
            "leaf.bound",
            first + i,
            &expected,
            format!("{:?}", leaves[i]),
        ));
    }
    if let Some(i) = leaves.windows(2).position(|l| l[0].upper > l[1].upper) {
        let expected = format!("probabilities of tree {k} that rise");
        return Err(tensors.invalid_in("leaf.upper", first + i + 1, &expected, "one that falls"));
    }
    Ok(())
}
