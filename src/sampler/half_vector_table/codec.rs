//! Half-vector tables in a file: their tensors, and what drawing relies on.

use super::tables::lookup::{NODE_SUM, ONE};
use super::tables::{STEEPEST, Stored};
use super::{ByAzimuth, HalfVectorSettings, HalfVectorTable};
use crate::Result;
use crate::geometry::Symmetry;
use crate::geometry::half_vector_chart::{MERL_PARTS, PARTS};
use crate::sampler::store::{TensorWriter, Tensors};

/// One half-vector table, or several one after the other.
pub(super) fn write(all: &[Stored], out: &mut TensorWriter) {
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

/// Reads the table of an isotropic material.
pub(super) fn read(tensors: &Tensors, settings: HalfVectorSettings) -> Result<HalfVectorTable> {
    read_nth(tensors, settings, 0, 1)
}

/// Reads the table of each azimuth.
pub(super) fn read_by_azimuth(
    tensors: &Tensors,
    settings: HalfVectorSettings,
    symmetry: Symmetry,
) -> Result<ByAzimuth> {
    let Some(count) = settings.azimuths else {
        let expected = "a number of azimuths for an anisotropic material";
        return Err(tensors.invalid(expected, "none"));
    };
    let table = HalfVectorSettings {
        azimuths: None,
        ..settings
    };
    let tables = (0..count)
        .map(|k| read_nth(tensors, table, k, count))
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
    let rows = settings.tables * settings.rows;
    let width = settings.segments + 1;
    let tables = Stored {
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

/// Whether cumulative probabilities rise from above 0 to 1.
fn is_cumulative(table: &[u16]) -> bool {
    table[0] > 0 && table[table.len() - 1] == ONE && table.is_sorted_by(|a, b| a < b)
}

/// Whether all nodes of a row are above 0, and the trapezia between them add up to [`NODE_SUM`].
fn is_normalised(row: &[u16]) -> bool {
    let mut sum = 0;
    for pair in row.windows(2) {
        sum += u32::from(pair[0]) + u32::from(pair[1]);
    }
    row.iter().all(|&n| n > 0) && sum == NODE_SUM
}

/// The tensor of a half-vector table whose values are not what they must be, and what that is.
fn broken_rule(tables: &Stored) -> Option<(&'static str, &'static str)> {
    let c = &tables.cosines;
    let rows = tables.edges.len() - 1;
    let cosines = c[0] == 1.0 && c[c.len() - 1] > 0.0 && c.is_sorted_by(|a, b| a > b);
    let ends = [tables.edges[0], tables.edges[rows]].map(usize::from) == [0, PARTS];
    let hinge = tables.edges.contains(&(MERL_PARTS as u16));
    let edges = ends && hinge && tables.edges.is_sorted_by(|a, b| a < b);
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
            tables.rows.chunks(rows).all(is_cumulative),
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
            tables.nodes.chunks(tables.width).all(is_normalised),
            "row.density",
            "rows above 0 that are normalised",
        ),
    ]
    .into_iter()
    .find(|rule| !rule.0)
    .map(|rule| (rule.1, rule.2))
}
