//! What draws do: rejections of the factored BRDF, counts of leaves, and many directions by one descent.

use std::hint::black_box;

use glam::{DVec2, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use merlkit::Result;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{reflect_about, spherical};
use merlkit::points::{PointSet, Stream};
use merlkit::sampler::{AdaptiveDisc, Cell, Sampler};

use super::bench::{ThesisBench, build, published_disc};
use super::exhibit::{Exhibit, ResultCell, ResultTable, write_ratio};
use super::quadtrees::viewer;
use super::subjects::{Subject, factorisation, measured, model, models};
use crate::measure::cost::{TimedBatch, costs};

/// Draws of figure 5.2, of which 827 were kept.
const FIGURE_DRAWS: usize = 2500;
const FIGURE_KEPT: f64 = 827.0;
/// Angles of the viewer, degrees.
const ANGLES: [f64; 4] = [30.0, 60.0, 75.0, 85.0];

/// Percent of draws that give no direction.
fn lost_percent(sampler: &dyn DirectionSampler, degrees: f64, draws: usize, seed: u64) -> f64 {
    let wo = viewer(degrees);
    let mut lost = 0;
    for index in 0..draws as u64 {
        let u = PointSet::Random.point(seed, index, 0);
        lost += usize::from(sampler.sample(wo, u).is_none());
    }
    100.0 * lost as f64 / draws as f64
}

/// Percent of half vectors, uniform over the hemisphere, that reflect the viewer's direction below the horizon.
fn lost_uniform_percent(degrees: f64, draws: usize, seed: u64) -> f64 {
    let wo = viewer(degrees).as_dvec3();
    let mut random = Stream::new(seed);
    let mut lost = 0;
    for _ in 0..draws {
        // cosθ is uniform in [0, 1) over the hemisphere.
        let theta = random.next_f64().acos();
        let h = spherical(theta, std::f64::consts::TAU * random.next_f64());
        lost += usize::from(reflect_about(wo, h).z <= 0.0);
    }
    100.0 * lost as f64 / draws as f64
}

/// Section 5.5 and figure 5.2: draws that the factored BRDF loses.
pub(super) fn rejections(bench: &mut ThesisBench) -> Result<Exhibit> {
    let heading = ["sampler", "30°", "60°", "75°", "85°"];
    let mut table = ResultTable::new(
        "Percent of draws lost below the horizon, by the viewer's angle: factored BRDFs of table 6.19",
        &heading,
    );
    for subject in models() {
        let lost: Vec<f64> = bench.piece(&format!("5.5/{}", subject.name), |plan| {
            let material = subject.load()?;
            let (sampler, _) = build(&material, &factorisation(subject.name, 0.0)?)?;
            let mut lost = Vec::new();
            for degrees in ANGLES {
                lost.push(lost_percent(
                    sampler.as_dyn(),
                    degrees,
                    FIGURE_DRAWS,
                    plan.seed,
                ));
            }
            Ok(lost)
        })?;
        let mut row = vec![ResultCell::from(subject.name)];
        row.extend(lost.iter().map(|&percent| ResultCell::from(percent)));
        table.push(row);
    }
    let ward: [Vec<f64>; 2] = bench.piece("5.5/lobes", |plan| {
        let material = model("ward")?.load()?;
        let (lobe, _) = build(&material, &"lobe:ward,parameters=0.2/0.2/0".parse()?)?;
        let mut found = [Vec::new(), Vec::new()];
        for degrees in ANGLES {
            found[0].push(lost_percent(lobe.as_dyn(), degrees, plan.draws, plan.seed));
            found[1].push(lost_uniform_percent(degrees, plan.draws, plan.seed));
        }
        Ok(found)
    })?;
    let mut others = ResultTable::new(
        "Percent of draws lost by other ways to draw half vectors for Ward's BRDF",
        &heading,
    );
    for (name, lost) in ["Ward's own lobe, α 0.2", "uniform half vectors"]
        .iter()
        .zip(&ward)
    {
        let mut row = vec![ResultCell::from(*name)];
        row.extend(lost.iter().map(|&percent| ResultCell::from(percent)));
        others.push(row);
    }
    Ok(describe_rejections(
        bench.plan.draws,
        &ward,
        vec![table, others],
    ))
}

/// What figure 5.2 is, with its results.
fn describe_rejections(draws: usize, ward: &[Vec<f64>; 2], tables: Vec<ResultTable>) -> Exhibit {
    let printed = 100.0 * (1.0 - FIGURE_KEPT / FIGURE_DRAWS as f64);
    Exhibit {
        name: "5.5".into(),
        title: "Section 5.5, figure 5.2: rejections of the factored BRDF".into(),
        method: format!("{FIGURE_DRAWS} draws at each angle, without a cosine part; the other ways with {} draws.", draws),
        differences: "The thesis doesn't say the viewer's angle of its figure. Its factorisation has 16 azimuths of the viewer.".into(),
        findings: vec![format!(
            "The thesis keeps 827 of 2500 draws for Ward's BRDF: {printed:.0} % are lost. That many are lost by half vectors that are uniform over \
             the hemisphere ({:.0} % at 60°), and not by Ward's own lobe ({:.0} % there): the loss is that of its factorisation, not of the \
             method.",
            ward[1][1], ward[0][1]
        )],
        tables,
        pictures: Vec::new(),
    }
}

/// How well counts of leaves follow their probabilities.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct LeafCounts {
    leaves: usize,
    draws: usize,
    /// Largest |n_i/m − I_i/I|.
    largest: f64,
    /// Σ (n_i − m·p_i)²/(m·p_i) over the leaves, per degree of freedom.
    chi_square: f64,
}

/// Materials that drawing is tried on.
fn drawn_subjects() -> Result<Vec<Subject>> {
    let mut subjects = vec![model("ward")?, model("phong")?];
    let mut tables = measured("6.23");
    tables.retain(|subject| ["nickel", "teflon"].contains(&subject.name));
    subjects.extend(tables);
    Ok(subjects)
}

/// Section 6.4.1: n_i/m against I_i/I.
pub(super) fn leaf_counts(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "Draws in each leaf of a tree, n_i of m, against the leaf's fraction of the integral, I_i/I",
        &[
            "BRDF",
            "leaves",
            "draws m",
            "largest |n_i/m − I_i/I|",
            "χ² a degree of freedom",
        ],
    );
    let mut worst = 0.0f64;
    for subject in drawn_subjects()? {
        let counts: LeafCounts = bench.piece(&format!("6.4.1/{}", subject.name), |plan| {
            let material = subject.load()?;
            // An odd number of trees has one at 45°.
            let spec = published_disc([3, plan.image], &material, "")?;
            let (sampler, _) = build(&material, &spec)?;
            Ok(count_leaves(&sampler, plan.draws, plan.seed))
        })?;
        worst = worst.max(counts.chi_square);
        table.push(vec![
            subject.name.into(),
            counts.leaves.into(),
            counts.draws.into(),
            counts.largest.into(),
            counts.chi_square.into(),
        ]);
    }
    Ok(Exhibit {
        name: "6.4.1".into(),
        title: "Section 6.4.1: draws in leaves against the leaves' integrals".into(),
        method: "adaptive-disc:published, the tree of 45° with the viewer at 45°. χ² is 1 in the mean where draws follow the integrals, and \
                 within 1 ± 2√(2/leaves) in 95 % of the runs."
            .into(),
        differences: "The thesis shows this as a picture for one BRDF.".into(),
        findings: vec![format!(
            "Draws follow the leaves' integrals: the largest χ² a degree of freedom is {worst:.2}."
        )],
        tables: vec![table],
        pictures: Vec::new(),
    })
}

/// Draws from the tree of 45° and counts its leaves.
fn count_leaves(sampler: &Sampler, draws: usize, seed: u64) -> LeafCounts {
    let cells = sampler
        .downcast::<AdaptiveDisc>()
        .map_or_else(Vec::new, |disc| disc.subdivision(45f64.to_radians()).cells);
    let mut counts = vec![0u64; cells.len()];
    let wo = viewer(45.0);
    let mut found = 0;
    for index in 0..draws as u64 {
        let drawn = sampler
            .as_dyn()
            .sample(wo, PointSet::Random.point(seed, index, 0));
        if let Some(drawn) = drawn
            && let Some(cell) = find_cell(&cells, drawn.wi)
        {
            counts[cell] += 1;
            found += 1;
        }
    }
    let (mut largest, mut chi_square, mut leaves) = (0.0f64, 0.0, 0);
    for (cell, &count) in cells.iter().zip(&counts) {
        let expected = cell.share * f64::from(found);
        largest = largest.max((count as f64 / f64::from(found) - cell.share).abs());
        // Leaves that hold few draws would need other statistics.
        if expected >= 5.0 {
            chi_square += (count as f64 - expected).powi(2) / expected;
            leaves += 1;
        }
    }
    LeafCounts {
        leaves,
        draws,
        largest,
        chi_square: chi_square / (leaves.max(2) - 1) as f64,
    }
}

/// The leaf that a direction lies in.
fn find_cell(cells: &[Cell], wi: Vec3) -> Option<usize> {
    let p = DVec2::new(f64::from(wi.x), f64::from(wi.y));
    cells.iter().position(|cell| {
        let t = (p - cell.corner) / cell.side;
        t.cmpge(DVec2::ZERO).all() && t.cmplt(DVec2::ONE).all()
    })
}

/// N draws, one at a time.
struct SingleDraws<'a> {
    sampler: &'a dyn DirectionSampler,
    points: &'a [Vec2],
}

impl TimedBatch for SingleDraws<'_> {
    fn run(&self, _: u64) -> usize {
        for &u in self.points {
            black_box(self.sampler.sample(viewer(45.0), u));
        }
        self.points.len()
    }
}

/// N draws by one descent.
struct SharedDraws<'a> {
    sampler: &'a Sampler,
    count: usize,
}

impl TimedBatch for SharedDraws<'_> {
    fn run(&self, round: u64) -> usize {
        black_box(
            self.sampler
                .draw_stratified(viewer(45.0), self.count, round),
        );
        self.count
    }
}

/// Numbers of directions a hit.
const DIRECTIONS: [usize; 4] = [25, 100, 400, 2500];

/// Algorithm 15: N directions by one descent.
pub(super) fn one_descent(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut table = ResultTable::new(
        "Nanoseconds of a draw: N by one descent against N single draws",
        &[
            "BRDF",
            "N",
            "one descent, ns",
            "single, ns",
            "single over one descent",
        ],
    );
    let mut ratios = Vec::new();
    for subject in drawn_subjects()? {
        let found: Vec<[f64; 2]> = bench.piece(&format!("descent/{}", subject.name), |plan| {
            let material = subject.load()?;
            let spec = published_disc([3, plan.image], &material, "")?;
            let (sampler, _) = build(&material, &spec)?;
            Ok(time_descents(&sampler, plan.seed))
        })?;
        for (&count, &[shared, single]) in DIRECTIONS.iter().zip(&found) {
            ratios.push(single / shared);
            table.push(vec![
                subject.name.into(),
                count.into(),
                shared.into(),
                single.into(),
                (single / shared).into(),
            ]);
        }
    }
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    Ok(Exhibit {
        name: "algorithm-15".into(),
        title: "Algorithm 15: N directions of a hit by one descent".into(),
        method: "adaptive-disc:published at a tree's own angle of 45°; single draws take given points, the descent makes its own numbers.".into(),
        differences: "The thesis prints no times for this alone. Our descent also spreads the directions over the leaves, which lowers the \
                      noise; that isn't counted here."
            .into(),
        findings: vec![format!(
            "N draws by one descent are {} to {} times as quick as single draws.",
            write_ratio(least),
            write_ratio(most)
        )],
        tables: vec![table],
        pictures: Vec::new(),
    })
}

/// Nanoseconds of a draw for each of [`DIRECTIONS`]: by one descent, and alone.
fn time_descents(sampler: &Sampler, seed: u64) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for count in DIRECTIONS {
        let mut points = Vec::with_capacity(count);
        for index in 0..count as u64 {
            points.push(PointSet::Random.point(seed, index, 0));
        }
        let shared = SharedDraws { sampler, count };
        let single = SingleDraws {
            sampler: sampler.as_dyn(),
            points: &points,
        };
        let costs = costs(&[&shared, &single]);
        found.push([costs[0].ns, costs[1].ns]);
    }
    found
}
