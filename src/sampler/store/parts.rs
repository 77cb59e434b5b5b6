//! Which tensors each sampler has, and the invariants that sampling from them relies on.

use std::sync::Arc;

use super::tensors::{Tensors, TensorsOut};
use crate::Result;
use crate::distribution;
use crate::distribution::Curves;
use crate::geometry::Symmetry;
use crate::material::merl::MerlBrdf;
use crate::sampler::adaptive_disc::{
    DEEPEST, Forest, Leaf, MOST_LEAVES, Node, Trees, WHOLE, Warps,
};
use crate::sampler::cascade_cdf::Tables;
use crate::sampler::factored::Terms;
use crate::sampler::half_vector_table as square;
use crate::sampler::half_vector_table::{MERL_PARTS, NODE_SUM, ONE, SQUARE_PARTS, STEEPEST};
use crate::sampler::{
    AdaptiveDisc, AdaptiveDiscSettings, ByAzimuth, ByAzimuthSettings, CascadeCdf,
    CascadeCdfSettings, Factored, FactoredSettings, HalfVectorSettings, HalfVectorTable,
    LeafChoice, Lobe, LobeParameters, LobeSettings,
};

pub(super) fn write_trees(trees: &Trees, out: &mut TensorsOut) {
    match trees {
        Trees::Rejecting(forest) => write_forest(forest, out),
        Trees::Warped(warps) => write_warps(warps, out),
    }
}

fn write_warps(warps: &Warps, out: &mut TensorsOut) {
    out.add("node.split", warps.nodes.iter().flat_map(|n| n.split));
    out.add("node.inner", warps.nodes.iter().map(|n| n.inner));
    out.add("node.first", warps.nodes.iter().map(|n| n.first));
    out.add("tree.start", warps.starts.iter().copied());
}

fn write_forest(forest: &Forest, out: &mut TensorsOut) {
    out.add("leaf.upper", forest.leaves.iter().map(|l| l.upper));
    out.add("leaf.bound", forest.leaves.iter().map(|l| l.bound));
    out.add("leaf.code", forest.leaves.iter().map(|l| l.code));
    out.add("tree.start", forest.starts.iter().copied());
    out.add("tree.integral", forest.integrals.iter().copied());
}

pub(super) fn read_disc(
    tensors: &Tensors,
    brdf: Arc<MerlBrdf>,
    settings: AdaptiveDiscSettings,
) -> Result<AdaptiveDisc> {
    let trees = match settings.leaves {
        LeafChoice::Warp => Trees::Warped(read_warps(tensors, settings.tables)?),
        LeafChoice::Envelope | LeafChoice::Integral => {
            Trees::Rejecting(read_forest(tensors, settings.tables)?)
        }
    };
    AdaptiveDisc::from_parts(brdf, settings, trees)
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
    let nodes: Vec<Node> = split
        .chunks_exact(3)
        .zip(&inner)
        .zip(&first)
        .map(|((s, &inner), &first)| Node {
            split: [s[0], s[1], s[2]],
            inner,
            first,
        })
        .collect();
    for (k, range) in starts.windows(2).enumerate() {
        let sound = |i: u32| {
            let node = &nodes[i as usize];
            let children =
                u64::from(node.first)..u64::from(node.first) + u64::from(node.inner.count_ones());
            let inside =
                children.is_empty() || (node.first > i && children.end <= u64::from(range[1]));
            node.inner < 16 && inside
        };
        if let Some(i) = (range[0]..range[1]).find(|&i| !sound(i)) {
            let found = format!("{:?}", nodes[i as usize]);
            let expected = format!("a sound node {i} of tree {k}");
            return Err(tensors.invalid_in("node.first", i as usize, &expected, found));
        }
    }
    Ok(Warps { nodes, starts })
}

fn read_forest(tensors: &Tensors, tables: usize) -> Result<Forest> {
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
    let leaves: Vec<Leaf> = upper
        .iter()
        .zip(&bound)
        .zip(&code)
        .map(|((&upper, &bound), &code)| Leaf { upper, bound, code })
        .collect();
    for (k, (range, &integral)) in starts.windows(2).zip(&integrals).enumerate() {
        check_tree(
            tensors,
            k,
            range[0] as usize,
            &leaves[range[0] as usize..range[1] as usize],
            integral,
        )?;
    }
    Ok(Forest::new(leaves, starts, integrals))
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
    let sound = |l: &Leaf| {
        let (depth, places) = (l.code >> 28, [l.code >> 14 & 0x3fff, l.code & 0x3fff]);
        let bound = l.bound.is_finite() && l.bound > 0.0;
        bound && depth <= DEEPEST && places.iter().all(|&p| p >> depth == 0)
    };
    if let Some(i) = leaves.iter().position(|l| !sound(l)) {
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

pub(super) fn write_tables(tables: &Tables, out: &mut TensorsOut) {
    write_curves("marginal", &tables.marginal, out);
    write_curves("conditional", &tables.conditional, out);
}

fn write_curves(name: &str, curves: &Curves, out: &mut TensorsOut) {
    out.add(&format!("{name}.start"), curves.starts.iter().copied());
    out.add(
        &format!("{name}.position"),
        curves.positions.iter().copied(),
    );
    out.add(&format!("{name}.cdf"), curves.cdf.iter().copied());
}

pub(super) fn read_cascade(tensors: &Tensors, settings: CascadeCdfSettings) -> Result<CascadeCdf> {
    let marginal = read_curves(tensors, "marginal", settings.theta_h)?;
    let conditional = read_curves(tensors, "conditional", settings.phi_h)?;
    if marginal.len() != settings.tables {
        let expected = format!("{} marginals", settings.tables);
        return Err(tensors.invalid_in("marginal.start", 0, &expected, marginal.len().to_string()));
    }
    let pieces: usize = (0..marginal.len()).map(|k| marginal.segments(k)).sum();
    if pieces != conditional.len() {
        let expected = format!("a conditional for each of {pieces} pieces of the marginals");
        return Err(tensors.invalid_in(
            "conditional.start",
            0,
            &expected,
            conditional.len().to_string(),
        ));
    }
    if let Some((k, piece, curve)) = piece_without_conditional(&marginal, &conditional) {
        let expected = format!("piece {piece} of marginal {k} to have a conditional with mass");
        let at = conditional.starts[curve] as usize;
        return Err(tensors.invalid_in("conditional.cdf", at, &expected, "an empty one"));
    }
    CascadeCdf::from_parts(settings, Tables::new(marginal, conditional))
}

/// A piece of a marginal that can be drawn though its conditional is empty: marginal, piece and conditional.
fn piece_without_conditional(
    marginal: &Curves,
    conditional: &Curves,
) -> Option<(usize, usize, usize)> {
    let mut next = 0;
    for k in 0..marginal.len() {
        for piece in 0..marginal.segments(k) {
            let s = marginal.segment(k, piece);
            if s.c1 > s.c0 && conditional.is_void(next) {
                return Some((k, piece, next));
            }
            next += 1;
        }
    }
    None
}

/// Reads curves over the grid 0..=`cells`: knots rise from 0 to `cells`, probabilities from 0 to 1 or stay 0.
fn read_curves(tensors: &Tensors, name: &str, cells: usize) -> Result<Curves> {
    let starts = tensors.get(&format!("{name}.start"))?;
    let positions = tensors.get(&format!("{name}.position"))?;
    let curves = Curves::from_parts(starts, positions, tensors.get(&format!("{name}.cdf"))?);
    let fail = |part: &str, at: usize, what: String| {
        let expected = format!("{name} curves over {cells} cells");
        Err(tensors.invalid_in(&format!("{name}.{part}"), at, &expected, what))
    };
    if curves.starts.first() != Some(&0)
        || curves.starts.last().map(|&s| s as usize) != Some(curves.cdf.len())
        || !curves.starts.is_sorted()
    {
        return fail("start", 0, "starts that do not partition the knots".into());
    }
    if !curves.positions.is_empty() && curves.positions.len() != curves.cdf.len() {
        let found = format!(
            "{} positions for {} values",
            curves.positions.len(),
            curves.cdf.len()
        );
        return fail("position", 0, found);
    }
    for k in 0..curves.len() {
        let range = curves.starts[k] as usize..curves.starts[k + 1] as usize;
        if !rises(&curves.cdf[range.clone()]) {
            return fail(
                "cdf",
                range.start,
                format!("curve {k} that does not rise from 0 to 1"),
            );
        }
        if !fits(&curves, &range, cells) {
            return fail(
                "position",
                range.start,
                format!("curve {k} whose knots do not rise from 0 to {cells}"),
            );
        }
    }
    Ok(curves)
}

/// From 0 to 1, or 0 throughout.
fn rises(cdf: &[u16]) -> bool {
    match cdf {
        [0, .., last] => cdf.is_sorted() && (*last == distribution::WHOLE || *last == 0),
        _ => false,
    }
}

/// A knot at every position of the grid, or knots that rise over it.
fn fits(curves: &Curves, range: &std::ops::Range<usize>, cells: usize) -> bool {
    if curves.positions.is_empty() {
        return range.len() - 1 == cells;
    }
    let p = &curves.positions[range.clone()];
    p[0] == 0 && usize::from(p[p.len() - 1]) == cells && p.is_sorted_by(|a, b| a < b)
}

/// One half-vector table, or several one after the other.
pub(super) fn write_half_vectors(all: &[&square::Stored], out: &mut TensorsOut) {
    out.add(
        "knot.cosine",
        all.iter().flat_map(|t| t.cosines.iter().copied()),
    );
    out.add("row.edge", all.iter().flat_map(|t| t.edges.iter().copied()));
    out.add("row.cdf", all.iter().flat_map(|t| t.rows.iter().copied()));
    out.add(
        "row.slope",
        all.iter().flat_map(|t| t.slopes.iter().copied()),
    );
    out.add(
        "row.density",
        all.iter().flat_map(|t| t.nodes.iter().copied()),
    );
}

pub(super) fn read_half_vector(
    tensors: &Tensors,
    settings: HalfVectorSettings,
) -> Result<HalfVectorTable> {
    check_half_vector(tensors, &settings)?;
    read_nth(tensors, settings, 0, 1)
}

fn check_half_vector(tensors: &Tensors, settings: &HalfVectorSettings) -> Result<()> {
    settings
        .check()
        .map_err(|e| tensors.invalid("settings within their domains", e.to_string()))
}

/// Reads the table of each azimuth.
pub(super) fn read_by_azimuth(
    tensors: &Tensors,
    settings: ByAzimuthSettings,
    symmetry: Symmetry,
) -> Result<ByAzimuth> {
    settings
        .check()
        .map_err(|e| tensors.invalid("settings within their domains", e.to_string()))?;
    check_half_vector(tensors, &settings.table)?;
    let count = settings.azimuths;
    let tables = (0..count)
        .map(|k| read_nth(tensors, settings.table, k, count))
        .collect::<Result<_>>()?;
    Ok(ByAzimuth::from_parts(settings, symmetry, tables))
}

/// Reads half-vector table `k` of `count`.
fn read_nth(
    tensors: &Tensors,
    settings: HalfVectorSettings,
    k: usize,
    count: usize,
) -> Result<HalfVectorTable> {
    let (rows, width) = (settings.tables * settings.rows, settings.segments + 1);
    let tables = square::Stored {
        cosines: tensors.get_nth("knot.cosine", settings.tables, k, count)?,
        edges: tensors.get_nth("row.edge", settings.rows + 1, k, count)?,
        rows: tensors.get_nth("row.cdf", rows, k, count)?,
        slopes: tensors.get_nth("row.slope", rows, k, count)?,
        nodes: tensors.get_nth("row.density", rows * width, k, count)?,
        width,
    };
    match broken_rule(&tables) {
        Some((name, rule)) => Err(tensors.invalid_in(name, 0, rule, "others")),
        None => Ok(HalfVectorTable::from_parts(settings, tables)),
    }
}

/// The tensor of a half-vector table whose values are not what they must be, and what that is.
fn broken_rule(tables: &square::Stored) -> Option<(&'static str, &'static str)> {
    let c = &tables.cosines;
    let rows = tables.edges.len() - 1;
    let cosines = c[0] == 1.0 && c[c.len() - 1] > 0.0 && c.is_sorted_by(|a, b| a > b);
    let ends = [tables.edges[0], tables.edges[rows]].map(usize::from) == [0, SQUARE_PARTS];
    let hinge = tables.edges.contains(&(MERL_PARTS as u16));
    let edges = ends && hinge && tables.edges.is_sorted_by(|a, b| a < b);
    let rise = |t: &[u16]| t[0] > 0 && t[t.len() - 1] == ONE && t.is_sorted_by(|a, b| a < b);
    let sum = |row: &[u16]| {
        row.windows(2)
            .map(|p| u32::from(p[0]) + u32::from(p[1]))
            .sum::<u32>()
    };
    let whole = |row: &[u16]| row.iter().all(|&n| n > 0) && sum(row) == NODE_SUM;
    [
        (
            cosines,
            "knot.cosine",
            "values that fall from 1 and stay above 0",
        ),
        (
            edges,
            "row.edge",
            "values that rise from 0 to 79 by way of 63",
        ),
        (
            tables.rows.chunks(rows).all(rise),
            "row.cdf",
            "tables that rise from above 0 to 65535",
        ),
        (
            tables
                .slopes
                .iter()
                .all(|s| s.unsigned_abs() <= STEEPEST as u8),
            "row.slope",
            "values within ±122",
        ),
        (
            tables.nodes.chunks(tables.width).all(whole),
            "row.density",
            "rows above 0 that are normalised",
        ),
    ]
    .into_iter()
    .find(|rule| !rule.0)
    .map(|rule| (rule.1, rule.2))
}

pub(super) fn write_lobe(parameters: &LobeParameters, out: &mut TensorsOut) {
    let LobeParameters {
        along,
        across,
        diffuse,
    } = *parameters;
    out.add("lobe.parameter", [along, across, diffuse]);
}

/// Reads the parameters that the record states too; their domains are checked where a lobe is put together.
pub(super) fn read_lobe(tensors: &Tensors, settings: LobeSettings) -> Result<Lobe> {
    let stored = tensors.get::<f32>("lobe.parameter")?;
    let [along, across, diffuse] = stored[..] else {
        return Err(tensors.invalid_in("lobe.parameter", 0, "3 values", stored.len().to_string()));
    };
    let parameters = LobeParameters {
        along,
        across,
        diffuse,
    };
    if settings.parameters != Some(parameters) {
        let expected = format!("the parameters of the record, {:?},", settings.parameters);
        return Err(tensors.invalid_in("lobe.parameter", 0, &expected, format!("{stored:?}")));
    }
    Lobe::with(settings, parameters)
}

pub(super) fn write_factors(terms: &Terms, out: &mut TensorsOut) {
    out.add("term.weight", terms.weights.iter().copied());
    write_curves("theta", &terms.theta, out);
    write_curves("phi", &terms.phi, out);
}

/// Reads terms, of which every one that a table draws from has curves with mass.
pub(super) fn read_factored(tensors: &Tensors, settings: FactoredSettings) -> Result<Factored> {
    let factors = settings.factors.ok_or_else(|| {
        tensors.invalid("the factors of a factored sampler in the record", "none")
    })?;
    settings.check()?;
    let terms = Terms {
        weights: tensors.get("term.weight")?,
        theta: read_curves(tensors, "theta", factors.theta)?,
        phi: read_curves(tensors, "phi", factors.phi)?,
    };
    for (name, curves) in [("theta", &terms.theta), ("phi", &terms.phi)] {
        if !curves.positions.is_empty() {
            let found = format!("{} positions", curves.positions.len());
            return Err(tensors.invalid_in(
                &format!("{name}.position"),
                0,
                "knots at every cell",
                found,
            ));
        }
    }
    let count = factors.terms();
    for (name, expected, found) in [
        ("theta.start", count, terms.theta.len()),
        ("phi.start", count, terms.phi.len()),
        ("term.weight", settings.tables * count, terms.weights.len()),
    ] {
        if expected != found {
            let expected = format!("{expected} of {count} terms");
            return Err(tensors.invalid_in(name, 0, &expected, found.to_string()));
        }
    }
    for (k, row) in terms.weights.chunks_exact(count).enumerate() {
        let drawn = |l: usize| !terms.theta.is_void(l) && !terms.phi.is_void(l);
        let sound = |l: usize| row[l] == 0.0 || (row[l] > 0.0 && row[l] <= 1.0 && drawn(l));
        let whole = row.iter().map(|&w| f64::from(w)).sum::<f64>() <= 1.0 + 1e-6;
        if let Some(l) = (0..count).find(|&l| !sound(l) || !whole) {
            let expected = format!("shares of table {k} within 0..1, of terms that can be drawn,");
            return Err(tensors.invalid_in(
                "term.weight",
                k * count + l,
                &expected,
                format!("{row:?}"),
            ));
        }
    }
    Factored::from_parts(settings, terms)
}
