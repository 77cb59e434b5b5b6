//! What an experiment comes to: tables of the thesis's figures next to ours, small pictures, and what they say.

use serde::{Deserialize, Serialize};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ResultCell {
    /// A number in the unit of its column.
    Number(f64),
    /// Words.
    Words(String),
    /// Nothing was printed or measured.
    Missing,
}

impl From<f64> for ResultCell {
    fn from(value: f64) -> Self {
        if value.is_finite() {
            Self::Number(value)
        } else {
            Self::Missing
        }
    }
}

impl From<usize> for ResultCell {
    fn from(value: usize) -> Self {
        Self::Number(value as f64)
    }
}

impl From<Option<f64>> for ResultCell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::from)
    }
}

impl From<&str> for ResultCell {
    fn from(words: &str) -> Self {
        Self::Words(words.to_owned())
    }
}

impl From<String> for ResultCell {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

/// A table of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultTable {
    /// What it shows, and what differs from the thesis.
    pub caption: String,
    /// Names of the columns, with units; the thesis's begin with "thesis".
    pub heading: Vec<String>,
    /// The cells, as many in each row as in the heading.
    pub rows: Vec<Vec<ResultCell>>,
}

impl ResultTable {
    /// A table without rows.
    pub(super) fn new(caption: impl Into<String>, heading: &[&str]) -> Self {
        Self {
            caption: caption.into(),
            heading: heading.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub(super) fn push(&mut self, row: Vec<ResultCell>) {
        debug_assert_eq!(row.len(), self.heading.len(), "{row:?}");
        self.rows.push(row);
    }

    /// Adds the arithmetic means of all columns whose cells are numbers.
    pub(super) fn push_mean(&mut self) {
        let mut means = vec![ResultCell::from(format!("mean of {}", self.rows.len()))];
        for column in 1..self.heading.len() {
            let mut numbers = Vec::new();
            for row in &self.rows {
                if let ResultCell::Number(number) = row[column] {
                    numbers.push(number);
                }
            }
            let is_whole = numbers.len() == self.rows.len();
            means.push(match is_whole {
                true => ResultCell::from(mean(&numbers)),
                false => ResultCell::Missing,
            });
        }
        self.rows.push(means);
    }
}

/// A small picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thumbnail {
    /// What it shows.
    pub caption: String,
    /// PNG as base64.
    pub png: String,
}

/// An experiment's results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exhibit {
    /// Its name on the command line.
    pub name: String,
    /// What it repeats.
    pub title: String,
    /// How ours was measured.
    pub method: String,
    /// What differs from the thesis.
    pub differences: String,
    /// What agrees with the thesis and what does not, from the figures of this run.
    pub findings: Vec<String>,
    /// The figures.
    pub tables: Vec<ResultTable>,
    /// Small pictures.
    pub pictures: Vec<Thumbnail>,
}

/// Arithmetic mean; not a number of none.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The numbers' ranks from 1 on; equal numbers have the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut ranks = Vec::with_capacity(values.len());
    for value in values {
        let below = values.iter().filter(|other| *other < value).count();
        let equal = values.iter().filter(|other| *other == value).count();
        ranks.push(below as f64 + (equal as f64 + 1.0) / 2.0);
    }
    ranks
}

/// Spearman's rank correlation: the correlation of the ranks. `None` where one side is all equal.
pub(super) fn rank_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let (a, b) = (ranks(a), ranks(b));
    let (mean_a, mean_b) = (mean(&a), mean(&b));
    let (mut both, mut square_a, mut square_b) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(&b) {
        both += (x - mean_a) * (y - mean_b);
        square_a += (x - mean_a).powi(2);
        square_b += (y - mean_b).powi(2);
    }
    let correlation = both / (square_a * square_b).sqrt();
    correlation.is_finite().then_some(correlation)
}

/// Names in the order of their numbers, the smallest first.
pub(super) fn write_order(named: &[(&str, f64)]) -> String {
    let mut sorted = named.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let names: Vec<&str> = sorted.iter().map(|one| one.0).collect();
    names.join(" < ")
}

/// A ratio for a sentence.
pub(super) fn write_ratio(ratio: f64) -> String {
    match ratio {
        r if r >= 100.0 => format!("{r:.0}"),
        r if r >= 10.0 => format!("{r:.1}"),
        r => format!("{r:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_correlate_with_orders_alone() {
        let rising = [1.0, 2.0, 30.0, 31.0];
        assert_eq!(rank_correlation(&rising, &[0.1, 0.2, 0.3, 9.0]), Some(1.0));
        assert_eq!(rank_correlation(&rising, &[4.0, 3.0, 2.0, 1.0]), Some(-1.0));
        assert_eq!(rank_correlation(&rising, &[1.0; 4]), None);
        // 1, 2.5, 2.5, 4 against 1, 2, 3, 4: 4.5/√(5·4.5).
        let tied = rank_correlation(&rising, &[1.0, 2.0, 2.0, 3.0]).unwrap();
        assert!((tied - 4.5 / (5.0f64 * 4.5).sqrt()).abs() < 1e-12, "{tied}");
        assert_eq!(write_order(&[("b", 2.0), ("a", 1.0)]), "a < b");
    }

    #[test]
    fn means_are_of_columns_of_numbers() {
        let mut table = ResultTable::new("", &["a", "b", "c"]);
        table.push(vec!["x".into(), 1.0.into(), f64::NAN.into()]);
        table.push(vec!["y".into(), 3.0.into(), 2.0.into()]);
        table.push_mean();
        let expected = vec![
            ResultCell::from("mean of 2"),
            ResultCell::Number(2.0),
            ResultCell::Missing,
        ];
        assert_eq!(table.rows[2], expected);
    }
}
