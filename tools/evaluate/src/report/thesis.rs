//! Figures of the 2008 thesis for a material, to compare with ours.

use serde::Serialize;

use crate::thesis::published::{
    TABLE_5_9 as UNIFORM_MEMORY, TABLE_5_10 as COMPRESSED_MEMORY, TABLE_6_23 as PRECOMPUTE,
    TABLE_6_24 as SAMPLING,
};

/// Bytes of the thesis's KB.
pub(super) const THESIS_KB: f64 = 1024.0;

/// What the thesis gives for one method and material. Its machine was an AMD Opteron of 2007.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThesisFigures {
    /// The thesis's name for the method, and the tables that have its figures.
    pub method: String,
    /// Memory, KB.
    pub memory_kb: Option<f64>,
    /// Precompute time, s.
    pub precompute_s: Option<f64>,
    /// Time spent on drawing for its picture of 450 × 200 pixels at 25 samples, s.
    pub sampling_s: Option<f64>,
}

/// The thesis's figures for a material by its embedded name; empty where it has none.
pub fn thesis_figures(material: &str) -> Vec<ThesisFigures> {
    let CostRows {
        compressed,
        precompute,
        sampling,
    } = cost_rows(material);
    let named = |(method, words): (&str, &str)| {
        let &(_, (kb, seconds)) = precompute.iter().find(|p| p.0 == method)?;
        Some(ThesisFigures {
            method: format!("thesis (6.23, 6.24): {words}"),
            memory_kb: Some(kb),
            precompute_s: Some(seconds),
            sampling_s: sampling.iter().find(|s| s.0 == method).map(|s| s.1),
        })
    };
    let methods = [
        ("adaptive disc", "adaptive disc, 60 quadtrees"),
        ("uniform CDF", "uniform CDF"),
        ("compressed CDF", "compressed CDF"),
    ];
    let alone = compressed.map(|(kb, seconds)| ThesisFigures {
        method: "thesis (5.10): compressed CDF".into(),
        memory_kb: Some(kb),
        precompute_s: Some(seconds),
        sampling_s: None,
    });
    methods.into_iter().filter_map(named).chain(alone).collect()
}

/// The thesis's memory of uniform CDFs, the same for every material: (cells over θh, cells over φh, KB).
pub fn thesis_uniform_memory() -> Vec<(u32, u32, f64)> {
    UNIFORM_MEMORY
        .lines()
        .skip(1)
        .filter_map(memory_row)
        .collect()
}

fn memory_row(line: &str) -> Option<(u32, u32, f64)> {
    let cells: Vec<&str> = line.split(',').collect();
    Some((
        cells.first()?.parse().ok()?,
        cells.get(1)?.parse().ok()?,
        cells.get(2)?.parse().ok()?,
    ))
}

/// What the thesis's tables of costs have for a material: by method, memory in KB and seconds.
#[derive(Default)]
pub(super) struct CostRows {
    /// 5.10: (KB, seconds) of compressing.
    pub compressed: Option<(f64, f64)>,
    /// 6.23: (KB, seconds) of precomputing.
    pub precompute: Vec<(&'static str, (f64, f64))>,
    /// 6.24: seconds of drawing.
    pub sampling: Vec<(&'static str, f64)>,
}

pub(super) fn cost_rows(material: &str) -> CostRows {
    let methods = ["uniform CDF", "compressed CDF", "adaptive disc"];
    let compressed = row(COMPRESSED_MEMORY, material).and_then(|r| Some((*r.get(2)?, *r.first()?)));
    let precompute = row(PRECOMPUTE, material).unwrap_or_default();
    let mut costs = Vec::new();
    for (i, method) in methods.into_iter().enumerate() {
        // The seconds of all methods come first, then their KB.
        if let (Some(&seconds), Some(&kb)) = (precompute.get(i), precompute.get(3 + i)) {
            costs.push((method, (kb, seconds)));
        }
    }
    let sampling = row(SAMPLING, material).unwrap_or_default();
    CostRows {
        compressed,
        precompute: costs,
        sampling: ["uniform"]
            .into_iter()
            .chain(methods)
            .zip(sampling)
            .collect(),
    }
}

/// Tables 6.14 and 6.22 by number of samples: each sampler's name and error in percent.
pub(super) fn errors_by_samples(table: &'static str) -> Vec<(u64, Vec<(&'static str, f64)>)> {
    let heading = table.lines().next().unwrap_or_default();
    let samples = heading
        .split(',')
        .skip(1)
        .filter_map(|n| n.strip_prefix('n')?.parse().ok());
    let mut columns = Vec::new();
    for (i, samples) in samples.enumerate() {
        columns.push((samples, error_column(table, i)));
    }
    columns
}

/// Each sampler's name and its number in column `i`, from 0.
fn error_column(table: &'static str, i: usize) -> Vec<(&'static str, f64)> {
    let mut errors = Vec::new();
    for (name, numbers) in table.lines().skip(1).filter_map(|l| l.split_once(',')) {
        let number = numbers.split(',').nth(i).and_then(|n| n.parse().ok());
        errors.extend(number.map(|n| (name, n)));
    }
    errors
}

/// The numbers of a material's row, without its name.
fn row(table: &str, material: &str) -> Option<Vec<f64>> {
    table.lines().skip(1).find_map(|line| {
        let (name, numbers) = line.split_once(',')?;
        (name == material).then(|| numbers.split(',').filter_map(|x| x.parse().ok()).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::published::{TABLE_6_14 as SCENE_2, TABLE_6_22 as SCENE_6};

    #[test]
    fn figures_are_those_printed_in_the_thesis() {
        let nickel = thesis_figures("nickel");
        assert_eq!(nickel.len(), 4);
        assert_eq!(
            (
                nickel[0].memory_kb,
                nickel[0].precompute_s,
                nickel[0].sampling_s
            ),
            (Some(846.15), Some(71.36), Some(12.31))
        );
        assert_eq!(
            (
                nickel[1].memory_kb,
                nickel[1].precompute_s,
                nickel[1].sampling_s
            ),
            (Some(33792.0), Some(30.13), Some(1.87))
        );
        assert_eq!(
            (
                nickel[2].memory_kb,
                nickel[2].precompute_s,
                nickel[2].sampling_s
            ),
            (Some(2057.51), Some(2576.81), Some(1.13))
        );
        assert_eq!(
            (nickel[3].memory_kb, nickel[3].precompute_s),
            (Some(1023.62), Some(567.49))
        );
        assert!(thesis_figures("chrome").is_empty());
        assert_eq!(thesis_uniform_memory()[1], (100, 32, 82500.0));
        let rows = cost_rows("nickel");
        assert_eq!(rows.compressed, Some((1023.62, 567.49)));
        assert_eq!(rows.precompute[2], ("adaptive disc", (846.15, 71.36)));
        assert_eq!(
            rows.sampling[..2],
            [("uniform", 0.37), ("uniform CDF", 1.87)]
        );
        let errors = errors_by_samples(SCENE_6);
        assert_eq!(
            (errors.len(), errors[0].0, errors[0].1[3]),
            (7, 25, ("adaptive_disc", 6.70))
        );
        assert_eq!(errors_by_samples(SCENE_2)[8].0, 1_000_000);
    }
}
