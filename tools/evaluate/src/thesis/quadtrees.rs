//! The quadtrees of the sixteen analytic BRDFs: tables 6.4, 6.5 and 6.6.

use serde::{Deserialize, Serialize};

use merlkit::Result;
use merlkit::geometry::spherical;

use super::bench::{
    BuildCost, KB, ThesisBench, TreeCounts, build, published_disc, subdivisions_of_kb,
};
use super::exhibit::{Exhibit, ResultCell, ResultTable, mean, rank_correlation, write_ratio};
use super::plan::ThesisPlan;
use super::published::{PublishedTable, published_number};
use super::subjects::{Subject, factorisation, models};
use crate::measure::cost::call_times;

/// A model's disc as published, and its factorisation.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct ModelCosts {
    disc: BuildCost,
    trees: TreeCounts,
    factored: BuildCost,
}

/// The piece that tables 6.4 and 6.6 have in common.
fn model_costs(bench: &mut ThesisBench, subject: &Subject) -> Result<ModelCosts> {
    bench.piece(&format!("model/{}", subject.name), |plan| {
        let material = subject.load()?;
        let (sampler, disc) = build(
            &material,
            &published_disc([plan.trees, plan.image], &material, "")?,
        )?;
        let (_, factored) = build(&material, &factorisation(subject.name, 0.0)?)?;
        let trees = TreeCounts::new(&sampler)?;
        Ok(ModelCosts {
            disc,
            trees,
            factored,
        })
    })
}

/// Table 6.4: seconds of precomputation.
pub(super) fn precomputation(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "Seconds of precomputation. Ours are CPU seconds.",
        &[
            "BRDF",
            "thesis, 60 trees, s",
            "thesis, s a tree",
            "ours, s a tree",
            "disc: thesis over ours",
            "thesis, factored, s",
            "ours, factored, s",
            "factored: thesis over ours",
        ],
    );
    let mut trees = Vec::new();
    for subject in models() {
        let costs = model_costs(bench, &subject)?;
        let disc = published_number("6.4", subject.name, "disc_60qt_s");
        let factored = published_number("6.4", subject.name, "factored_s");
        let each = costs.disc.seconds.cpu / costs.trees.count();
        trees.push((subject.name, each));
        table.push(vec![
            subject.name.into(),
            disc.into(),
            disc.map(|s| s / 60.0).into(),
            each.into(),
            disc.map(|s| s / 60.0 / each).into(),
            factored.into(),
            costs.factored.seconds.cpu.into(),
            factored.map(|s| s / costs.factored.seconds.cpu).into(),
        ]);
    }
    table.push_mean();
    let ours = find_seconds(&trees, "he") / find_seconds(&trees, "oren");
    let published = PublishedTable::find("6.4").map_or_else(Vec::new, |t| t.column("disc_60qt_s"));
    let published: Vec<f64> = published.into_iter().flatten().collect();
    let found: Vec<f64> = trees.iter().map(|t| t.1).collect();
    let mut findings = vec![format!(
        "He's model takes {} times as long as Oren and Nayar's with us, and 10.4 times in the thesis: a ratio that hardly depends on the machine.",
        write_ratio(ours)
    )];
    if let Some(correlation) = rank_correlation(&published, &found) {
        findings.push(format!(
            "Rank correlation of the seconds a tree with the thesis's over the 16 models: {correlation:.2}."
        ));
    }
    findings.push(
        "The means that the thesis prints (62.58 and 94.69 s) are not those of its rows (60.67 and 89.56 s).".into(),
    );
    Ok(describe_precomputation(bench, findings, table))
}

/// Seconds a tree of a model.
fn find_seconds(trees: &[(&str, f64)], name: &str) -> f64 {
    let found = trees.iter().find(|tree| tree.0 == name);
    found.map_or(f64::NAN, |tree| tree.1)
}

/// What table 6.4 is, with its results.
fn describe_precomputation(
    bench: &ThesisBench,
    findings: Vec<String>,
    table: ResultTable,
) -> Exhibit {
    Exhibit {
        name: "6.4".into(),
        title: "Table 6.4: seconds of precomputation for the 16 BRDFs".into(),
        method: method(bench),
        differences: "The machine. Our sound formulas replace the printed ones. `poulin` has two azimuths, the thesis one. The thesis's \
                      factorisation works on a matrix of 16 × 16 directions of the viewer, ours on 16 polar angles."
            .into(),
        findings,
        tables: vec![table],
        pictures: Vec::new(),
    }
}

/// How discs as published are built here.
fn method(bench: &ThesisBench) -> String {
    let ThesisPlan { trees, image, .. } = &bench.plan;
    format!(
        "adaptive-disc:published with {trees} trees from an image of {image}² pixels, n_max 2 and four subdivisions, and the factored \
         BRDF with the thesis's numbers of factors and cells (table 6.19)."
    )
}

/// Table 6.6: KB of the disc and of the factored BRDF.
pub(super) fn memory(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut all = Vec::new();
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    for subject in models() {
        let costs = model_costs(bench, &subject)?;
        theirs.extend(published_number("6.6", subject.name, "disc_kb"));
        ours.push(60.0 * costs.trees.published_kb());
        all.push((subject.name, costs));
    }
    let mut findings = vec![
        "The thesis finds the factored BRDF three times as large as the disc because it counts the matrix Y. Its factors alone are smaller \
         than most of its discs, as ours are."
            .into(),
    ];
    if let Some(correlation) = rank_correlation(&theirs, &ours) {
        findings.push(format!(
            "Rank correlation of the disc's KB with the thesis's over the 16 models: {correlation:.2}. Its Ashikhmin and Oren are never \
             subdivided; for Ashikhmin the printed algorithm gives many subdivisions, so the thesis's program differed from it."
        ));
    }
    let tables = vec![disc_table(&all), factors_table(&all)];
    Ok(describe_memory(bench, findings, tables))
}

/// The discs of table 6.6.
fn disc_table(all: &[(&str, ModelCosts)]) -> ResultTable {
    let mut table = ResultTable::new(
        "The disc: KB (1024 bytes) of 60 trees, at the thesis's 558 bytes a subdivision and in our format",
        &[
            "BRDF",
            "thesis, KB",
            "thesis, subdivisions a tree",
            "ours, subdivisions a tree",
            "ours, nodes a tree",
            "ours, leaves a tree",
            "ours at 558 bytes, KB",
            "ours, own bytes, KB",
        ],
    );
    for (name, costs) in all {
        let kb = published_number("6.6", name, "disc_kb");
        let own = costs.disc.bytes as f64 / KB * 60.0 / costs.trees.count();
        table.push(vec![
            (*name).into(),
            kb.into(),
            kb.map(|kb| subdivisions_of_kb(kb / 60.0)).into(),
            costs.trees.subdivisions.into(),
            costs.trees.nodes().into(),
            costs.trees.leaves.into(),
            (60.0 * costs.trees.published_kb()).into(),
            own.into(),
        ]);
    }
    table.push_mean();
    table
}

/// The factored BRDFs of table 6.6.
fn factors_table(all: &[(&str, ModelCosts)]) -> ResultTable {
    let mut table = ResultTable::new(
        "The factored BRDF: the thesis's KB are mainly the matrix that is factored, 8 bytes a number",
        &[
            "BRDF",
            "thesis, KB",
            "thesis, matrix alone, KB",
            "thesis, rest, KB",
            "ours, KB",
        ],
    );
    for (name, costs) in all {
        let whole = published_number("6.6", name, "factored_kb");
        let matrix = matrix_kb(name);
        table.push(vec![
            (*name).into(),
            whole.into(),
            matrix.into(),
            whole.zip(matrix).map(|(w, m)| w - m).into(),
            (costs.factored.bytes as f64 / KB).into(),
        ]);
    }
    table.push_mean();
    table
}

/// What table 6.6 is, with its results.
fn describe_memory(
    bench: &ThesisBench,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
) -> Exhibit {
    Exhibit {
        name: "6.6".into(),
        title: "Table 6.6: memory of the disc and of the factored BRDF".into(),
        method: method(bench),
        differences: "The depth is inferred from the thesis's bytes, not printed. Squares are trimmed to the disc with us, so that flat BRDFs \
                      need no subdivision at the rim. Ours are counted for as many trees as were built and scaled to 60."
            .into(),
        findings,
        tables,
        pictures: Vec::new(),
    }
}

/// KB of the thesis's matrix: uTh·uPh·pTh·pPh numbers of 8 bytes.
fn matrix_kb(name: &str) -> Option<f64> {
    let mut cells = 1.0;
    for column in ["uTh", "uPh", "pTh", "pPh"] {
        cells *= published_number("6.19", name, column)?;
    }
    Some(cells * 8.0 / KB)
}

/// The numbers of trials of table 6.5, and its columns.
const N_MAX: [(&str, &str); 4] = [
    ("1.3", "nmax1.3"),
    ("2", "nmax2.0"),
    ("2.5", "nmax2.5"),
    ("3", "nmax3.0"),
];

/// A tree at an n_max.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct NMaxCost {
    trees: TreeCounts,
    sample_ns: f64,
}

/// Table 6.5: KB of one quadtree by n_max.
pub(super) fn memory_by_trials(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut heading = vec!["BRDF".to_owned()];
    for (n_max, _) in N_MAX {
        heading.push(format!("thesis, {n_max}"));
        heading.push(format!("ours, {n_max}"));
    }
    let names: Vec<&str> = heading.iter().map(String::as_str).collect();
    let caption =
        "KB (1024 bytes) of one quadtree by n_max, ours at the thesis's 558 bytes a subdivision";
    let mut table = ResultTable::new(caption, &names);
    let mut costs: [Vec<NMaxCost>; 4] = Default::default();
    for subject in models() {
        let mut row = vec![ResultCell::from(subject.name)];
        for (i, (n_max, column)) in N_MAX.into_iter().enumerate() {
            let cost = tree_cost(bench, &subject, n_max)?;
            row.push(published_number("6.5", subject.name, column).into());
            row.push(cost.trees.published_kb().into());
            costs[i].push(cost);
        }
        table.push(row);
    }
    table.push_mean();
    let trade = trade_off(&costs);
    let is_monotone = is_falling(&table);
    let findings = vec![
        format!(
            "With us memory {} for every model. The thesis's falls up to 2.5 and rises again at 3 (Lewis from 12.4 to 304 KB), which \
             its algorithm can't do: a square that is divided at n_max 3 is divided at 2.5.",
            if is_monotone { "falls as n_max rises" } else { "doesn't fall with n_max" }
        ),
        "Its best n_max of 2 weighs memory against drawing time. The second table has both, and their product.".into(),
    ];
    Ok(Exhibit {
        name: "6.5".into(),
        title: "Table 6.5: memory of one quadtree by n_max".into(),
        method: format!(
            "adaptive-disc:published with depth 8, trees at 0°, 45° and 90° and the mean over them, from an image of {}² pixels.",
            image_side(&bench.plan)
        ),
        differences: "The thesis doesn't say which angle its tree is for. Its limit of depth differs from that of table 6.6: 8628 subdivisions \
                      at n_max 1.3 need eight. Squares are trimmed to the disc with us: without that, n_max 1.3 > 4/π divides the rim without end."
            .into(),
        findings,
        tables: vec![table, trade],
        pictures: Vec::new(),
    })
}

/// A deeper tree needs a finer image.
fn image_side(plan: &ThesisPlan) -> usize {
    2 * plan.image
}

fn tree_cost(bench: &mut ThesisBench, subject: &Subject, n_max: &str) -> Result<NMaxCost> {
    bench.piece(&format!("6.5/{}/{n_max}", subject.name), |plan| {
        let material = subject.load()?;
        let more = format!(",depth=8,n-max={n_max}");
        let (sampler, _) = build(
            &material,
            &published_disc([3, image_side(plan)], &material, &more)?,
        )?;
        let times = call_times(&[sampler.as_dyn()], plan.timed_calls, plan.seed);
        Ok(NMaxCost {
            trees: TreeCounts::new(&sampler)?,
            sample_ns: times[0].sample_ns.ns,
        })
    })
}

/// Means over the models by n_max.
fn trade_off(costs: &[Vec<NMaxCost>; 4]) -> ResultTable {
    let mut table = ResultTable::new(
        "Memory against drawing time, means over the 16 models",
        &[
            "n_max",
            "thesis, KB a tree",
            "ours, KB a tree",
            "trials a draw",
            "ns a draw",
            "KB × µs",
        ],
    );
    for ((n_max, column), costs) in N_MAX.into_iter().zip(costs) {
        let kb: Vec<f64> = costs.iter().map(|c| c.trees.published_kb()).collect();
        let trials: Vec<f64> = costs.iter().map(|c| c.trees.trials).collect();
        let ns: Vec<f64> = costs.iter().map(|c| c.sample_ns).collect();
        table.push(vec![
            n_max.into(),
            published_number("6.5", "average", column).into(),
            mean(&kb).into(),
            mean(&trials).into(),
            mean(&ns).into(),
            (mean(&kb) * mean(&ns) / 1000.0).into(),
        ]);
    }
    table
}

/// Whether ours fall, or stay, from each n_max to the next in all rows.
fn is_falling(table: &ResultTable) -> bool {
    let mut falls = true;
    for row in &table.rows {
        let mut before = f64::INFINITY;
        for cell in row.iter().skip(2).step_by(2) {
            if let ResultCell::Number(kb) = cell {
                falls &= *kb <= before;
                before = *kb;
            }
        }
    }
    falls
}

/// The direction of the viewer at a polar angle in degrees.
pub(super) fn viewer(degrees: f64) -> glam::Vec3 {
    spherical(degrees.to_radians(), 0.0).as_vec3()
}
