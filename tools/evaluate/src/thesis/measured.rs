//! Measured materials: tables 5.9, 5.10, 6.23 and 6.24.

use serde::{Deserialize, Serialize};

use merlkit::Result;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::sampler::{Sampler, SamplerSpec};

use super::bench::{BuildCost, KB, ThesisBench, TreeCounts, build, published_disc};
use super::exhibit::{Exhibit, ResultTable, mean, rank_correlation, write_ratio};
use super::plan::ThesisPlan;
use super::published::{PublishedTable, published_number};
use super::subjects::{Subject, measured};
use crate::measure::cost::call_times;

/// Tables of the thesis's CDFs: 16 polar angles times 32 azimuths.
const CDF_TABLES: f64 = 512.0;
/// Trees of its discs.
const DISC_TREES: f64 = 60.0;
/// Directions of the picture of table 6.24: 450 × 200 pixels at 25 samples.
const DRAWN: f64 = 450.0 * 200.0 * 25.0;

/// What embedded materials are, where the thesis had the measurements.
const NETWORKS: &str = "The built-in materials approximate the measurements that the thesis had. Its CDFs have 512 tables, 32 azimuths \
                        of the viewer for each of 16 polar angles, of 8 bytes a number; ours have one azimuth, which is enough for isotropic \
                        materials, so KB and seconds are compared a table.";

/// Samplers of table 6.23 for a material: whole CDF, compressed CDF, disc.
fn published_specs(plan: &ThesisPlan) -> Result<[SamplerSpec; 2]> {
    let ThesisPlan { tables, cells, .. } = plan;
    Ok([
        format!("cascade-cdf:published-uniform,tables={tables}").parse()?,
        format!(
            "cascade-cdf:published,tables={tables},cells={}x{}",
            cells[0], cells[1]
        )
        .parse()?,
    ])
}

/// Table 5.9: KB of whole CDFs.
pub(super) fn whole_memory(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "KB (1024 bytes) of CDFs without compression",
        &[
            "cells, θ × φ",
            "thesis, KB",
            "nθ·nφ tables of nθ·(nφ+1)·8 bytes, KB",
            "thesis, KB a table",
            "ours, KB a table",
            "thesis over ours",
        ],
    );
    for row in PublishedTable::find("5.9").map_or_else(Vec::new, |t| t.rows()) {
        let (theta, phi): (f64, f64) = (number(row[0]), number(row[1]));
        let kb = number(row[2]);
        let cells = format!("{theta}x{phi}");
        let tables = 4;
        let cost: BuildCost = bench.piece(&format!("5.9/{cells}"), |_| {
            let spec = format!("cascade-cdf:published-uniform,tables={tables},cells={cells}");
            let material = measured("6.23")[0].load()?;
            Ok(build(&material, &spec.parse()?)?.1)
        })?;
        let each = cost.bytes as f64 / KB / f64::from(tables);
        table.push(vec![
            format!("{theta} × {phi}").into(),
            kb.into(),
            (theta * phi * theta * (phi + 1.0) * 8.0 / KB).into(),
            (kb / (theta * phi)).into(),
            each.into(),
            (kb / (theta * phi) / each).into(),
        ]);
    }
    Ok(Exhibit {
        name: "5.9".into(),
        title: "Table 5.9: memory of cascade CDFs without compression".into(),
        method: "cascade-cdf:published-uniform with four tables of the same cells, divided by four.".into(),
        differences: "The thesis's memory is that of the formula to the byte: viewers and half vectors have the same resolution. Ours stores \
                      16 bits a number."
            .into(),
        findings: vec![
            "The thesis's KB follow from its resolution alone, for any material; ours a table are smaller by the width of a number.".into(),
        ],
        tables: vec![table],
        pictures: Vec::new(),
    })
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}

/// A whole and a compressed CDF.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Compressed {
    tables: usize,
    whole: BuildCost,
    compressed: BuildCost,
}

/// A material's piece of table 5.10.
fn compressed_cost(bench: &mut ThesisBench, subject: &Subject) -> Result<Compressed> {
    bench.piece(&format!("5.10/{}", subject.name), |plan| {
        let material = subject.load()?;
        let tables = plan.tables;
        let whole = format!("cascade-cdf:published-uniform,tables={tables}").parse()?;
        let compressed = format!("cascade-cdf:published,tables={tables},cells=256x32").parse()?;
        Ok(Compressed {
            tables,
            whole: build(&material, &whole)?.1,
            compressed: build(&material, &compressed)?.1,
        })
    })
}

/// Table 5.10: compressed CDFs of 20 materials.
pub(super) fn compression(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "Compressed CDFs of 256 × 32 cells: KB (1024 bytes) a table, what compression saves, and seconds. Ours are CPU seconds.",
        &[
            "material",
            "thesis, KB",
            "thesis, KB a table",
            "ours, KB a table",
            "thesis, % saved",
            "ours, % saved",
            "thesis, s a table",
            "ours, s a table",
        ],
    );
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    for subject in measured("5.10") {
        let name = subject.name;
        let cost = compressed_cost(bench, &subject)?;
        let tables = cost.tables as f64;
        let kb = published_number("5.10", name, "compressed_kb");
        let each = cost.compressed.bytes as f64 / KB / tables;
        let saved = 100.0 * (1.0 - cost.compressed.bytes as f64 / cost.whole.bytes as f64);
        theirs.extend(kb);
        ours.push(each);
        table.push(vec![
            name.into(),
            kb.into(),
            kb.map(|kb| kb / CDF_TABLES).into(),
            each.into(),
            published_number("5.10", name, "reduction_percent").into(),
            saved.into(),
            published_number("5.10", name, "compress_s")
                .map(|s| s / CDF_TABLES)
                .into(),
            (cost.compressed.seconds.cpu / tables).into(),
        ]);
    }
    table.push_mean();
    let correlation = rank_correlation(&theirs, &ours);
    Ok(describe_compression(
        bench.plan.tables,
        vec![order_finding(correlation, 20)],
        vec![table],
    ))
}

/// What table 5.10 is, with its results.
fn describe_compression(
    tables_built: usize,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
) -> Exhibit {
    Exhibit {
        name: "5.10".into(),
        title: "Table 5.10: compressed cascade CDFs of 20 measured materials".into(),
        method: format!(
            "cascade-cdf:published,cells=256x32 with {} tables and the tolerance 0.001, against the same without compression.",
            tables_built
        ),
        differences: format!(
            "{NETWORKS} The thesis gives no tolerance and no measure of distance."
        ),
        findings,
        tables,
        pictures: Vec::new(),
    }
}

/// What a rank correlation of compressed sizes says.
fn order_finding(correlation: Option<f64>, count: usize) -> String {
    let number = correlation.map_or("none".into(), |c| format!("{c:.2}"));
    format!(
        "Rank correlation of the compressed KB with the thesis's over {count} materials: {number}. Its metals need several times the \
         memory of its fabrics, with us as much or less. `merlkit thesis distance` looks for the reading that gives its order."
    )
}

/// What the thesis's samplers cost for a material.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct MeasuredCosts {
    tables: usize,
    whole: BuildCost,
    compressed: BuildCost,
    disc: BuildCost,
    trees: TreeCounts,
    /// Nanoseconds a draw: uniform, whole CDF, compressed CDF, disc.
    draw_ns: [f64; 4],
}

/// The piece that tables 6.23 and 6.24 have in common.
fn measured_costs(bench: &mut ThesisBench, subject: &Subject) -> Result<MeasuredCosts> {
    bench.piece(&format!("measured/{}", subject.name), |plan| {
        let material = subject.load()?;
        let [whole, compressed] = published_specs(plan)?;
        let (whole, whole_cost) = build(&material, &whole)?;
        let (compressed, compressed_cost) = build(&material, &compressed)?;
        let (disc, disc_cost) = build(
            &material,
            &published_disc([plan.trees, plan.image], &material, "")?,
        )?;
        let (uniform, _) = build(&material, &"cosine".parse()?)?;
        let samplers: Vec<&dyn DirectionSampler> = [&uniform, &whole, &compressed, &disc]
            .map(Sampler::as_dyn)
            .to_vec();
        let times = call_times(&samplers, plan.timed_calls, plan.seed);
        Ok(MeasuredCosts {
            tables: plan.tables,
            whole: whole_cost,
            compressed: compressed_cost,
            disc: disc_cost,
            trees: TreeCounts::new(&disc)?,
            draw_ns: [0, 1, 2, 3].map(|i: usize| times[i].sample_ns.ns),
        })
    })
}

/// Table 6.23: seconds and KB of the measured materials.
pub(super) fn costs(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut all = Vec::new();
    for subject in measured("6.23") {
        all.push((subject.name, measured_costs(bench, &subject)?));
    }
    let (mut discs, mut compressed) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for (name, costs) in &all {
        discs[0].extend(published_number("6.23", name, "adaptive_disc_kb"));
        discs[1].push(costs.trees.published_kb());
        compressed[0].extend(published_number("6.23", name, "compressed_cdf_kb"));
        compressed[1].push(costs.compressed.bytes as f64);
    }
    let correlation = rank_correlation(&discs[0], &discs[1]);
    let ratio = mean(&discs[0]) / (DISC_TREES * mean(&discs[1]));
    let findings = vec![
        format!(
            "Disc: rank correlation of KB with the thesis's over its 11 materials {}; its mean is {} times ours at the same bytes a \
             subdivision.",
            correlation.map_or("none".into(), |c| format!("{c:.2}")),
            write_ratio(ratio)
        ),
        order_finding(rank_correlation(&compressed[0], &compressed[1]), 11),
        "Compressing takes the thesis 2500 s, but 119.78 and 113.56 s for two of its materials: another resolution, perhaps.".into(),
    ];
    let tables = vec![disc_table(&all), cdf_table(&all)];
    Ok(describe_costs(&bench.plan, findings, tables))
}

/// The discs of table 6.23.
fn disc_table(all: &[(&str, MeasuredCosts)]) -> ResultTable {
    let mut table = ResultTable::new(
        "The disc: KB (1024 bytes) of 60 trees and seconds a tree. Ours are CPU seconds.",
        &[
            "material",
            "thesis, KB",
            "ours at 558 bytes a subdivision, KB",
            "ours, own bytes, KB",
            "ours, subdivisions a tree",
            "ours, nodes a tree",
            "ours, leaves a tree",
            "thesis, s a tree",
            "ours, s a tree",
        ],
    );
    for (name, costs) in all {
        let trees = costs.trees.count();
        table.push(vec![
            (*name).into(),
            published_number("6.23", name, "adaptive_disc_kb").into(),
            (DISC_TREES * costs.trees.published_kb()).into(),
            (costs.disc.bytes as f64 / KB * DISC_TREES / trees).into(),
            costs.trees.subdivisions.into(),
            costs.trees.nodes().into(),
            costs.trees.leaves.into(),
            published_number("6.23", name, "adaptive_disc_s")
                .map(|s| s / DISC_TREES)
                .into(),
            (costs.disc.seconds.cpu / trees).into(),
        ]);
    }
    table.push_mean();
    table
}

/// The cascade CDFs of table 6.23.
fn cdf_table(all: &[(&str, MeasuredCosts)]) -> ResultTable {
    let mut table = ResultTable::new(
        "Cascade CDFs: KB (1024 bytes) and seconds a table. Ours are CPU seconds.",
        &[
            "material",
            "thesis, whole, KB",
            "ours, whole, KB",
            "thesis, compressed, KB",
            "ours, compressed, KB",
            "thesis, whole, s",
            "ours, whole, s",
            "thesis, compressed, s",
            "ours, compressed, s",
        ],
    );
    for (name, costs) in all {
        let tables = costs.tables as f64;
        table.push(vec![
            (*name).into(),
            printed_a_table(name, "uniform_cdf_kb").into(),
            (costs.whole.bytes as f64 / KB / tables).into(),
            printed_a_table(name, "compressed_cdf_kb").into(),
            (costs.compressed.bytes as f64 / KB / tables).into(),
            printed_a_table(name, "uniform_cdf_s").into(),
            (costs.whole.seconds.cpu / tables).into(),
            printed_a_table(name, "compressed_cdf_s").into(),
            (costs.compressed.seconds.cpu / tables).into(),
        ]);
    }
    table.push_mean();
    table
}

/// A figure of table 6.23 for each of its CDFs' tables.
fn printed_a_table(name: &str, column: &str) -> Option<f64> {
    published_number("6.23", name, column).map(|value| value / CDF_TABLES)
}

/// What table 6.23 is, with its results.
fn describe_costs(plan: &ThesisPlan, findings: Vec<String>, tables: Vec<ResultTable>) -> Exhibit {
    Exhibit {
        name: "6.23".into(),
        title: "Table 6.23: seconds and memory for 11 measured materials".into(),
        method: format!(
            "The presets `published` of the disc ({} trees, image of {}² pixels, four subdivisions) and of the cascade CDF ({} tables; {} × {} \
             cells before compression).",
            plan.trees, plan.image, plan.tables, plan.cells[0], plan.cells[1]
        ),
        differences: format!(
            "{NETWORKS} The machine. The disc's depth of four subdivisions is inferred from the thesis's bytes."
        ),
        findings,
        tables,
        pictures: Vec::new(),
    }
}

/// Columns of table 6.24, and what they are called here.
const DRAWING: [(&str, &str); 4] = [
    ("uniform_s", "uniform"),
    ("uniform_cdf_s", "whole CDF"),
    ("compressed_cdf_s", "compressed CDF"),
    ("adaptive_disc_s", "disc"),
];

/// Table 6.24: seconds of drawing.
pub(super) fn drawing(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut heading = vec!["material".to_owned()];
    for (_, name) in DRAWING {
        heading.push(format!("thesis, {name}, s"));
        heading.push(format!("ours, {name}, s"));
    }
    let names: Vec<&str> = heading.iter().map(String::as_str).collect();
    let mut table = ResultTable::new(
        "Seconds of drawing 2.25 million directions, density included, on one thread",
        &names,
    );
    let mut sums = [[0.0; 2]; 4];
    for subject in measured("6.24") {
        let costs = measured_costs(bench, &subject)?;
        let mut row = vec![subject.name.into()];
        for (i, (column, _)) in DRAWING.into_iter().enumerate() {
            let theirs = published_number("6.24", subject.name, column);
            let ours = costs.draw_ns[i] * 1e-9 * DRAWN;
            sums[i][0] += theirs.unwrap_or(0.0);
            sums[i][1] += ours;
            row.push(theirs.into());
            row.push(ours.into());
        }
        table.push(row);
    }
    table.push_mean();
    let mut findings = Vec::new();
    for (i, (_, name)) in DRAWING.into_iter().enumerate().skip(1) {
        findings.push(format!(
            "{name}: {} times the time of uniform draws in the thesis, {} times here.",
            write_ratio(sums[i][0] / sums[0][0]),
            write_ratio(sums[i][1] / sums[0][1])
        ));
    }
    Ok(Exhibit {
        name: "6.24".into(),
        title: "Table 6.24: seconds of drawing for measured materials".into(),
        method: "2.25·10⁶ (450 × 200 pixels, 25 samples) times the CPU time of one draw, which is measured alone: no light, no BRDF apart from what \
                 the draw needs, no random numbers."
            .into(),
        differences: "The machine. Our uniform directions are uniform on the disc (the cosine). The thesis's times may contain its random numbers."
            .into(),
        findings,
        tables: vec![table],
        pictures: Vec::new(),
    })
}
