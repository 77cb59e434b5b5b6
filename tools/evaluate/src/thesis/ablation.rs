//! Section 6.3: each optimisation of the disc switched off.

use serde::{Deserialize, Serialize};

use merlkit::Result;
use merlkit::points::Stream;

use super::bench::ThesisBench;
use super::exhibit::{Exhibit, ResultTable, write_ratio};
use super::plan::ThesisPlan;
use super::printed_tree::{DiscFunction, Optimisations, PrintedTree, TreeLimits};
use super::quadtrees::viewer;
use super::subjects::{Subject, measured, model};
use crate::measure::cost::thread_seconds;

/// Everything on.
const ALL: Optimisations = Optimisations {
    trim: true,
    image: true,
    together: true,
};

/// What is switched off, and the numbers of trials that it is tried at: 1.25 is below 4/π, where a square that isn't trimmed is never flat
/// enough.
const VARIANTS: [(&str, Optimisations, f64); 6] = [
    ("all on", ALL, 2.0),
    ("no trim", Optimisations { trim: false, ..ALL }, 2.0),
    (
        "no image",
        Optimisations {
            image: false,
            ..ALL
        },
        2.0,
    ),
    (
        "one by one",
        Optimisations {
            together: false,
            ..ALL
        },
        2.0,
    ),
    ("all on", ALL, 1.25),
    ("no trim", Optimisations { trim: false, ..ALL }, 1.25),
];

/// What a variant costs.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct VariantCost {
    evaluations: u64,
    subdivisions: u64,
    build_seconds: f64,
    trials: f64,
    draw_ns: f64,
}

fn measure(
    plan: &ThesisPlan,
    subject: &Subject,
    on: Optimisations,
    n_max: f64,
) -> Result<VariantCost> {
    let material = subject.load()?;
    let function = DiscFunction {
        brdf: &**material.brdf(),
        wo: viewer(45.0),
    };
    let limits = TreeLimits {
        side: plan.image,
        depth: 4,
        n_max,
    };
    let begun = thread_seconds();
    let tree = PrintedTree::build(&function, limits, on);
    let built = thread_seconds();
    let trials = tree.draw(plan.draws, &mut Stream::new(plan.seed));
    let drawn = thread_seconds();
    Ok(VariantCost {
        evaluations: tree.evaluations,
        subdivisions: tree.subdivisions,
        build_seconds: built - begun,
        trials: trials as f64 / plan.draws as f64,
        draw_ns: (drawn - built) / plan.draws as f64 * 1e9,
    })
}

/// The table of all variants.
pub(super) fn ablation(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "One tree at 45° by the thesis's algorithms: ratios are those over the first row of the same n_max",
        &[
            "BRDF",
            "switched off",
            "n_max",
            "evaluations",
            "subdivisions",
            "trials a draw",
            "build, ratio",
            "draw, ratio",
        ],
    );
    let mut subjects = vec![model("oren")?, model("phong")?, model("ward")?];
    let mut tables = measured("6.23");
    tables.retain(|subject| subject.name == "nickel");
    subjects.extend(tables);
    // Largest ratios of building and of drawing: without the trim, without the image, one by one.
    let mut largest = [0.0f64; 3];
    for subject in subjects {
        let mut base = None;
        for (k, (name, on, n_max)) in VARIANTS.into_iter().enumerate() {
            let key = format!("6.3/{}/{k}", subject.name);
            let cost: VariantCost = bench.piece(&key, |plan| measure(plan, &subject, on, n_max))?;
            if on == ALL {
                base = Some(cost);
            }
            let all = base.unwrap_or(cost);
            let build = cost.build_seconds / all.build_seconds;
            let draw = cost.draw_ns / all.draw_ns;
            match name {
                "no trim" => largest[0] = largest[0].max(draw),
                "no image" => largest[1] = largest[1].max(build),
                "one by one" => largest[2] = largest[2].max(draw),
                _ => {}
            }
            table.push(vec![
                subject.name.into(),
                name.into(),
                n_max.into(),
                (cost.evaluations as f64).into(),
                (cost.subdivisions as f64).into(),
                cost.trials.into(),
                build.into(),
                draw.into(),
            ]);
        }
    }
    Ok(describe_ablation(&bench.plan, largest, table))
}

/// What section 6.3 is, with its results.
fn describe_ablation(plan: &ThesisPlan, largest: [f64; 3], table: ResultTable) -> Exhibit {
    let [trim, image, single] = largest.map(write_ratio);
    Exhibit {
        name: "6.3".into(),
        title: "Section 6.3: the disc's optimisations, switched off one at a time".into(),
        method: format!(
            "Algorithms 12 to 15 as a program of their own: image of {}² pixels, four subdivisions, {} draws, CPU time of one thread.",
            plan.image, plan.draws
        ),
        differences: "The machine, and the BRDFs: the thesis doesn't say which its 6.3.4 timed. Where two of its algorithms are in error, the intended one \
                      runs: the search stops at the child that was chosen, and trims take the side that is nearer to the axis."
            .into(),
        findings: vec![
            format!(
                "Without the trim, a draw takes up to {trim} times as long. The thesis's 6.3.4 has 229.58 s against 8.2 s (28 times) and \
                 525.73 s against 40.36 s (13 times): more than trials alone explain here, where squares at the rim are at least half full."
            ),
            format!("Without the image, building takes up to {image} times as long: f is evaluated once a level instead of once."),
            format!("With a search for each draw, drawing takes up to {single} times as long: the rejections take most of the time."),
        ],
        tables: vec![table],
        pictures: Vec::new(),
    }
}
