//! Which reading of the thesis's compression gives its order of materials: measures of distance in Douglas and Peucker's algorithm.

use serde::{Deserialize, Serialize};

use merlkit::Result;
use merlkit::brdf::{Brdf, Importance};
use merlkit::geometry::{reflect_about, spherical};

use super::bench::ThesisBench;
use super::exhibit::{Exhibit, ResultTable, rank_correlation, write_ratio};
use super::plan::ThesisPlan;
use super::published::published_number;
use super::subjects::{Subject, measured};

/// How far a point is from a chord.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    /// Along the axis of probability.
    Vertical,
    /// Perpendicular to the chord, in cells and units of probability.
    Perpendicular,
    /// Perpendicular to the chord, with both axes from 0 to 1.
    Normalised,
}

/// Which curve over φ belongs to a row of θ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Conditional {
    /// That of all rows of an interval of the compressed marginal.
    Interval,
    /// One for each row.
    Row,
}

/// What curves add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    /// Probabilities: every curve ends at 1.
    Probability,
    /// f_r·cosθ·dσ as it is: a tolerance is absolute, and tighter the brighter the material.
    Value,
    /// The table's joint probability: the marginal ends at 1, and a conditional at the probability of its rows.
    Joint,
    /// Sums of f_r at equal steps of both angles, without cosine and solid angle: highlights weigh more than what they reflect.
    Raw,
}

/// A reading of the thesis's compression.
#[derive(Clone, Copy, Debug)]
struct Reading {
    measure: Measure,
    conditional: Conditional,
    level: Level,
}

const MEASURES: [(Measure, &str); 3] = [
    (Measure::Vertical, "vertical"),
    (Measure::Perpendicular, "perpendicular, cells"),
    (Measure::Normalised, "perpendicular, unit square"),
];
const CONDITIONALS: [(Conditional, &str); 2] = [
    (Conditional::Interval, "an interval"),
    (Conditional::Row, "each row"),
];
const LEVELS: [(Level, &str); 4] = [
    (Level::Probability, "probability"),
    (Level::Joint, "joint probability"),
    (Level::Value, "value"),
    (Level::Raw, "sums of f_r"),
];
/// Tolerances in the unit of the distance.
const TOLERANCES: [f64; 8] = [1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.3, 3.0];

/// All readings, with their words.
fn readings() -> Vec<(Reading, [&'static str; 3])> {
    let mut all = Vec::new();
    for (measure, measure_name) in MEASURES {
        for (conditional, conditional_name) in CONDITIONALS {
            for (level, level_name) in LEVELS {
                let reading = Reading {
                    measure,
                    conditional,
                    level,
                };
                all.push((reading, [measure_name, conditional_name, level_name]));
            }
        }
    }
    all
}

/// For cells of equal steps of θh and φh, row by row: ∫ f_r·cosθi dσ(wi), one midpoint each, and f_r there.
fn cell_values(brdf: &dyn Brdf, theta_o: f64, [rows, columns]: [usize; 2]) -> [Vec<Vec<f64>>; 2] {
    let wo = spherical(theta_o, 0.0);
    let mut values = [Vec::with_capacity(rows), Vec::with_capacity(rows)];
    for i in 0..rows {
        let theta = (i as f64 + 0.5) / rows as f64 * std::f64::consts::FRAC_PI_2;
        // dσ(h) = sinθ dθ dφ of a cell.
        let area = theta.sin() * std::f64::consts::FRAC_PI_2 * std::f64::consts::TAU
            / (rows * columns) as f64;
        let (mut masses, mut densities) = (Vec::new(), Vec::new());
        for j in 0..columns {
            let phi = (j as f64 + 0.5) / columns as f64 * std::f64::consts::TAU;
            let h = spherical(theta, phi);
            let wi = reflect_about(wo, h);
            let f = match wi.z > 0.0 {
                true => f64::from(Importance::Mean.reduce(brdf.eval(wo.as_vec3(), wi.as_vec3()))),
                false => 0.0,
            };
            // dσ(wi) = 4 (wo·h) dσ(h)
            masses.push(f * wi.z * 4.0 * wo.dot(h) * area);
            densities.push(f);
        }
        values[0].push(masses);
        values[1].push(densities);
    }
    values
}

/// 0 and the running sums of some masses, scaled so that the last is `total`; as they are for `None`.
fn cumulate(masses: impl Iterator<Item = f64>, total: Option<f64>) -> Vec<f64> {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for mass in masses {
        sum += mass;
        sums.push(sum);
    }
    if let Some(total) = total
        && sum > 0.0
    {
        for value in &mut sums {
            *value *= total / sum;
        }
    }
    sums
}

/// Douglas and Peucker's algorithm: positions of the points that are kept, ascending.
fn simplify(y: &[f64], tolerance: f64, measure: Measure) -> Vec<usize> {
    let last = y.len() - 1;
    // A step along the axis of cells, in the unit of the measure.
    let step = match measure {
        Measure::Normalised => 1.0 / last as f64,
        Measure::Vertical | Measure::Perpendicular => 1.0,
    };
    let mut keep = vec![0, last];
    let mut open = vec![(0, last)];
    while let Some((first, last)) = open.pop() {
        let slope = (y[last] - y[first]) / (last - first) as f64;
        // A vertical distance d is d/√(1 + s²) across a chord of the slope s.
        let across = match measure {
            Measure::Vertical => 1.0,
            Measure::Perpendicular | Measure::Normalised => 1.0 / (slope / step).hypot(1.0),
        };
        let (mut worst, mut most) = (first, 0.0);
        for (i, value) in y.iter().enumerate().take(last).skip(first + 1) {
            let distance = (value - y[first] - slope * (i - first) as f64).abs() * across;
            if distance > most {
                (worst, most) = (i, distance);
            }
        }
        if most > tolerance {
            keep.push(worst);
            open.extend([(first, worst), (worst, last)]);
        }
    }
    keep.sort_unstable();
    keep
}

/// Points that a table keeps by a reading.
fn count_points(cells: &[Vec<f64>], reading: Reading, tolerance: f64) -> usize {
    let row_sums: Vec<f64> = cells.iter().map(|row| row.iter().sum()).collect();
    let whole: f64 = row_sums.iter().sum();
    let is_scaled = matches!(reading.level, Level::Probability | Level::Joint);
    let total = is_scaled.then_some(1.0);
    // Step 1: the marginal over θh.
    let marginal = cumulate(row_sums.iter().copied(), total);
    let kept = simplify(&marginal, tolerance, reading.measure);
    let mut points = kept.len();
    // Step 2: the rows that have a conditional in common.
    let bounds: Vec<usize> = match reading.conditional {
        Conditional::Interval => kept,
        Conditional::Row => (0..=cells.len()).collect(),
    };
    // Step 3: the conditionals over φh.
    for pair in bounds.windows(2) {
        let rows = &cells[pair[0]..pair[1]];
        let sum: f64 = row_sums[pair[0]..pair[1]].iter().sum();
        let total = match reading.level {
            Level::Probability => Some(1.0),
            Level::Joint => Some(sum / whole),
            Level::Value | Level::Raw => None,
        };
        let columns = cells[0].len();
        let mut masses = vec![0.0; columns];
        for row in rows {
            for (mass, cell) in masses.iter_mut().zip(row) {
                *mass += cell;
            }
        }
        let conditional = cumulate(masses.into_iter(), total);
        points += simplify(&conditional, tolerance, reading.measure).len();
    }
    points
}

/// Points of a material by reading and tolerance, summed over angles of the viewer.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct PointCounts(Vec<Vec<usize>>);

fn count_material(plan: &ThesisPlan, subject: &Subject) -> Result<PointCounts> {
    let material = subject.load()?;
    let angles = if plan.quick { 4 } else { 16 };
    let cells = if plan.quick { [256, 32] } else { plan.cells };
    let mut counts = PointCounts(vec![vec![0; TOLERANCES.len()]; readings().len()]);
    for k in 0..angles {
        let theta = f64::from(k) / f64::from(angles) * std::f64::consts::FRAC_PI_2;
        let [masses, densities] = cell_values(&**material.brdf(), theta, cells);
        for ((reading, _), found) in readings().into_iter().zip(&mut counts.0) {
            let values = match reading.level {
                Level::Raw => &densities,
                Level::Probability | Level::Joint | Level::Value => &masses,
            };
            for (tolerance, points) in TOLERANCES.into_iter().zip(found.iter_mut()) {
                *points += count_points(values, reading, tolerance);
            }
        }
    }
    Ok(counts)
}

/// The search over all readings.
pub(super) fn search(bench: &mut ThesisBench) -> Result<Exhibit> {
    let subjects = measured("6.23");
    let mut counts = Vec::new();
    let mut published = Vec::new();
    for subject in &subjects {
        counts.push(bench.piece(&format!("distance/{}", subject.name), |plan| {
            count_material(plan, subject)
        })?);
        published.extend(published_number("6.23", subject.name, "compressed_cdf_kb"));
    }
    let mut heading = vec![
        "distance".to_owned(),
        "conditional of".into(),
        "curves of".into(),
    ];
    for tolerance in TOLERANCES {
        heading.push(format!("±{tolerance}"));
    }
    heading.push("points, nickel over yellow-paint, at the best".into());
    let names: Vec<&str> = heading.iter().map(String::as_str).collect();
    let caption = "Rank correlation of the points kept with the thesis's compressed KB over its 11 materials (table 6.23)";
    let mut table = ResultTable::new(caption, &names);
    let mut best = (f64::NEG_INFINITY, String::new());
    let mut largest_ratio = 0.0f64;
    for (i, (_, words)) in readings().into_iter().enumerate() {
        let mut row: Vec<_> = words.map(Into::into).to_vec();
        let mut most = (f64::NEG_INFINITY, 0);
        for (j, tolerance) in TOLERANCES.into_iter().enumerate() {
            let points: Vec<f64> = counts.iter().map(|c| c.0[i][j] as f64).collect();
            let correlation = rank_correlation(&published, &points);
            row.push(correlation.into());
            let found = correlation.unwrap_or(f64::NEG_INFINITY);
            if found > most.0 {
                most = (found, j);
            }
            if found > best.0 {
                best = (found, format!("{}, at ±{tolerance}", words.join(", ")));
            }
        }
        let ratio = nickel_over_paint(&subjects, &counts, i, most.1);
        largest_ratio = largest_ratio.max(ratio.unwrap_or(0.0));
        row.push(ratio.into());
        table.push(row);
    }
    Ok(describe_search(&best, largest_ratio, table))
}

/// What the search is, with its results.
fn describe_search(best: &(f64, String), largest_ratio: f64, table: ResultTable) -> Exhibit {
    Exhibit {
        name: "distance".into(),
        title: "Tables 5.10 and 6.23: which compression gives the thesis's order of materials".into(),
        method: "CDFs of f_r·cosθ over half vectors at equal steps of both angles, compressed by Douglas and Peucker's algorithm: three measures \
                 of distance, conditionals of each row or of an interval of the marginal, four scales of the curves, eight tolerances."
            .into(),
        differences: "The built-in materials approximate the measurements that the thesis had.".into(),
        findings: vec![
            format!(
                "The highest rank correlation is {:.2}, by this reading: {}.",
                best.0, best.1
            ),
            format!(
                "In the thesis nickel takes 7.2 times the memory of yellow paint. At each reading's best tolerance nickel keeps at most {} \
                 times the points of yellow paint.",
                write_ratio(largest_ratio)
            ),
        ],
        tables: vec![table],
        pictures: Vec::new(),
    }
}

/// How many times the points of yellow paint nickel keeps.
fn nickel_over_paint(
    subjects: &[Subject],
    counts: &[PointCounts],
    reading: usize,
    tolerance: usize,
) -> Option<f64> {
    let [nickel, paint] = ["nickel", "yellow-paint"].map(|name| {
        let index = subjects.iter().position(|subject| subject.name == name)?;
        Some(counts[index].0[reading][tolerance] as f64)
    });
    Some(nickel? / paint?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_across_a_chord_are_shorter_than_along_it() {
        // A step of height 1 between cells 4 and 5 of 10.
        let step: Vec<f64> = (0..=10).map(|i| f64::from(u8::from(i > 4))).collect();
        let vertical = simplify(&step, 0.4, Measure::Vertical);
        assert_eq!(vertical, [0, 4, 5, 10]);
        // In the unit square the chord has the slope 1, and cell 5, which is 0.5 above it, is 0.35 away from it.
        assert_eq!(simplify(&step, 0.4, Measure::Normalised), [0, 10]);
        // In cells its slope is 0.1.
        assert_eq!(simplify(&step, 0.4, Measure::Perpendicular), vertical);
        assert_eq!(simplify(&[0.0, 0.5, 1.0], 1e-9, Measure::Vertical), [0, 2]);
    }

    #[test]
    fn rows_apart_keep_more_points_than_intervals() {
        let cells = vec![vec![1.0, 2.0, 4.0, 1.0]; 8];
        let reading = Reading {
            measure: Measure::Vertical,
            conditional: Conditional::Interval,
            level: Level::Probability,
        };
        // The marginal is a straight line: two points, and one conditional of four cells.
        assert_eq!(count_points(&cells, reading, 1e-6), 2 + 5);
        let rows = Reading {
            conditional: Conditional::Row,
            ..reading
        };
        assert_eq!(count_points(&cells, rows, 1e-6), 2 + 8 * 5);
    }
}
