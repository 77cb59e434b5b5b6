//! Which tensors each sampler has, and the invariants that sampling from them relies on.

use std::sync::Arc;

use super::tensors::{Tensors, TensorsOut};
use crate::Result;
use crate::brdf::Measured;
use crate::dist::Curves;
use crate::sampler::adaptive_disc::{Forest, Node};
use crate::sampler::cascade_cdf::Tables;
use crate::sampler::{AdaptiveDisc, AdaptiveDiscSettings, CascadeCdf, CascadeCdfSettings};

pub(super) fn write_forest(forest: &Forest, out: &mut TensorsOut) {
    out.add("node.weight", forest.nodes.iter().map(|n| n.weight));
    out.add("node.bound", forest.nodes.iter().map(|n| n.bound));
    out.add("node.children", forest.nodes.iter().map(|n| n.children));
    out.add("root", forest.roots.iter().copied());
    out.add("integral", forest.integrals.iter().copied());
}

pub(super) fn read_disc(
    tensors: &Tensors,
    brdf: Arc<Measured>,
    settings: AdaptiveDiscSettings,
) -> Result<AdaptiveDisc> {
    let (weight, bound) = (tensors.get::<f32>("node.weight")?, tensors.get::<f32>("node.bound")?);
    let children = tensors.get::<u32>("node.children")?;
    let roots = tensors.get::<u32>("root")?;
    let integrals = tensors.get::<f32>("integral")?;
    let lengths = [bound.len(), children.len()];
    if lengths.iter().any(|&l| l != weight.len()) || roots.len() != integrals.len() {
        return Err(
            tensors.invalid("tensors of equal length for nodes, and for trees", format!("{lengths:?}"))
        );
    }
    let nodes: Vec<Node> = weight
        .iter()
        .zip(&bound)
        .zip(&children)
        .map(|((&weight, &bound), &children)| Node { weight, bound, children })
        .collect();
    check_forest(tensors, &nodes, &roots, &integrals, settings.tables)?;
    AdaptiveDisc::from_parts(brdf, settings, nodes, &roots, &integrals)
}

/// A descent from any root ends, stays in its tree, and never meets a division by zero.
fn check_forest(
    tensors: &Tensors,
    nodes: &[Node],
    roots: &[u32],
    integrals: &[f32],
    trees: usize,
) -> Result<()> {
    if roots.len() != trees || roots.first() != Some(&0) || !roots.is_sorted_by(|a, b| a < b) {
        return Err(
            tensors.invalid(format!("{trees} trees, one after the other"), format!("{} roots", roots.len()))
        );
    }
    let ends = roots.iter().skip(1).map(|&r| r as usize).chain([nodes.len()]);
    for (k, (root, end)) in roots.iter().map(|&r| r as usize).zip(ends).enumerate() {
        let tree = nodes.get(root..end).filter(|t| !t.is_empty());
        let Some(tree) = tree else {
            return Err(
                tensors.invalid(format!("tree {k} within {} nodes", nodes.len()), format!("{root}..{end}"))
            );
        };
        let light = integrals[k];
        if !light.is_finite() || light < 0.0 || (light > 0.0 && tree[0].weight <= 0.0) {
            return Err(tensors.invalid(format!("a finite integral ≥ 0 for tree {k}"), format!("{light}")));
        }
        for (i, node) in tree.iter().enumerate() {
            if !node_is_sound(node, root + i, nodes, end) {
                return Err(tensors.invalid(
                    format!("node {} to hold finite values ≥ 0 and four later nodes of its tree", root + i),
                    format!("{node:?}"),
                ));
            }
        }
    }
    Ok(())
}

fn node_is_sound(node: &Node, position: usize, nodes: &[Node], end: usize) -> bool {
    let finite = |x: f32| x.is_finite() && x >= 0.0;
    if !finite(node.weight) || !finite(node.bound) {
        return false;
    }
    if node.children == 0 {
        return node.weight == 0.0 || node.bound > 0.0;
    }
    let first = node.children as usize;
    first > position
        && first + 4 <= end
        && (node.weight == 0.0 || nodes[first..first + 4].iter().any(|c| c.weight > 0.0))
}

pub(super) fn write_tables(tables: &Tables, out: &mut TensorsOut) {
    for (name, curves) in [("marginal", &tables.marginal), ("conditional", &tables.conditional)] {
        out.add(&format!("{name}.start"), curves.starts.iter().copied());
        out.add(&format!("{name}.position"), curves.positions.iter().copied());
        out.add(&format!("{name}.cdf"), curves.cdf.iter().copied());
    }
}

pub(super) fn read_cascade(tensors: &Tensors, settings: CascadeCdfSettings) -> Result<CascadeCdf> {
    let marginal = read_curves(tensors, "marginal", settings.theta_h)?;
    let conditional = read_curves(tensors, "conditional", settings.phi_h)?;
    if marginal.len() != settings.tables {
        return Err(tensors.invalid(format!("{} marginals", settings.tables), format!("{}", marginal.len())));
    }
    let pieces: usize = (0..marginal.len()).map(|k| marginal.segments(k)).sum();
    if pieces != conditional.len() {
        return Err(tensors.invalid(
            format!("a conditional for each of {pieces} pieces of the marginals"),
            format!("{}", conditional.len()),
        ));
    }
    if let Some((k, piece)) = piece_without_conditional(&marginal, &conditional) {
        return Err(tensors.invalid(
            format!("piece {piece} of marginal {k} to have a conditional with mass"),
            "an empty one".to_owned(),
        ));
    }
    CascadeCdf::from_parts(settings, Tables::new(marginal, conditional))
}

/// A piece of a marginal that can be drawn though its conditional is empty.
fn piece_without_conditional(marginal: &Curves, conditional: &Curves) -> Option<(usize, usize)> {
    let mut next = 0;
    for k in 0..marginal.len() {
        for piece in 0..marginal.segments(k) {
            let s = marginal.segment(k, piece);
            if s.c1 > s.c0 && conditional.is_void(next) {
                return Some((k, piece));
            }
            next += 1;
        }
    }
    None
}

/// Reads curves over the grid 0..=`cells`: knots rise from 0 to `cells`, probabilities from 0 to 1 or stay 0.
fn read_curves(tensors: &Tensors, name: &str, cells: usize) -> Result<Curves> {
    let curves = Curves {
        starts: tensors.get(&format!("{name}.start"))?,
        positions: tensors.get(&format!("{name}.position"))?,
        cdf: tensors.get(&format!("{name}.cdf"))?,
    };
    let fail = |what: String| Err(tensors.invalid(format!("{name} curves over {cells} cells"), what));
    if curves.starts.first() != Some(&0)
        || curves.starts.last().map(|&s| s as usize) != Some(curves.cdf.len())
        || !curves.starts.is_sorted()
    {
        return fail("starts that do not partition the knots".into());
    }
    let every = curves.positions.is_empty();
    if !every && curves.positions.len() != curves.cdf.len() {
        return fail(format!("{} positions for {} values", curves.positions.len(), curves.cdf.len()));
    }
    for k in 0..curves.len() {
        let range = curves.starts[k] as usize..curves.starts[k + 1] as usize;
        let cdf = &curves.cdf[range.clone()];
        let ends = match cdf {
            [first, .., last] => *first == 0.0 && (*last == 1.0 || cdf.iter().all(|&c| c == 0.0)),
            _ => false,
        };
        if !ends || !cdf.iter().all(|c| c.is_finite()) || !cdf.is_sorted() {
            return fail(format!("curve {k} that does not rise from 0 to 1"));
        }
        let fits = if every {
            cdf.len() == cells + 1
        } else {
            let p = &curves.positions[range];
            p[0] == 0 && usize::from(p[p.len() - 1]) == cells && p.is_sorted_by(|a, b| a < b)
        };
        if !fits {
            return fail(format!("curve {k} whose knots do not rise from 0 to {cells}"));
        }
    }
    Ok(curves)
}
