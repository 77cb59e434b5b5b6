//! Tables of costs against a size, with the exponent of each column.

use std::cell::RefCell;
use std::hint::black_box;

use merlkit_evaluate::measure::cost::{CallCost, TimedBatch, time_round};

use crate::fit::Exponent;

/// Work that is timed as a whole.
struct Work<'a>(RefCell<Box<dyn FnMut() + 'a>>);

impl TimedBatch for Work<'_> {
    fn run(&self, _: u64) -> usize {
        self.0.borrow_mut()();
        1
    }
}

/// Works of several sizes that are timed in turn.
#[derive(Default)]
pub struct Works<'a>(Vec<Work<'a>>);

impl<'a> Works<'a> {
    pub fn add<T>(&mut self, mut work: impl FnMut() -> T + 'a) {
        self.0.push(Work(RefCell::new(Box::new(move || {
            black_box(work());
        }))));
    }

    /// CPU seconds of each by this thread: the lower quartile of the rounds. A first round with cold caches is above it.
    pub fn seconds(&self, rounds: u64) -> Vec<f64> {
        let works: Vec<&dyn TimedBatch> = self.0.iter().map(|w| w as &dyn TimedBatch).collect();
        let mut columns = vec![Vec::new(); works.len()];
        for round in 0..rounds {
            for (column, ns) in columns.iter_mut().zip(time_round(&works, round)) {
                column.extend(ns);
            }
        }
        let costs = columns.into_iter().map(CallCost::from_rounds);
        costs.map(|cost| cost.ns * 1e-9).collect()
    }
}

/// What is printed of a value.
#[derive(Clone, Copy)]
pub enum Unit {
    Seconds,
    /// Seconds that are shown as nanoseconds.
    Nanoseconds,
    /// In thousands of bytes.
    Kilobytes,
}

impl Unit {
    fn name(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Nanoseconds => "ns",
            Self::Kilobytes => "KB",
        }
    }

    fn cell(self, value: f64) -> String {
        let value = match self {
            Self::Seconds => value,
            Self::Nanoseconds => value * 1e9,
            Self::Kilobytes => value / 1e3,
        };
        // Three digits.
        let digits = (2 - value.log10().floor() as i32).max(0) as usize;
        format!("{value:.digits$}")
    }
}

/// A column against the sizes.
pub struct Column {
    pub name: &'static str,
    pub unit: Unit,
    pub values: Vec<f64>,
}

/// Prints rows of sizes and costs, and the exponents below. `sizes` are the numbers behind the labels of the rows.
pub fn print_table(size: &str, labels: &[String], sizes: &[f64], columns: &[Column]) {
    let mut head = format!("\n| {size} |");
    let mut rule = "|---|".to_owned();
    for column in columns {
        head += &format!(" {}, {} |", column.name, column.unit.name());
        rule += "---|";
    }
    println!("{head}\n{rule}");
    for (row, label) in labels.iter().enumerate() {
        let mut line = format!("| {label} |");
        for column in columns {
            line += &format!(" {} |", column.unit.cell(column.values[row]));
        }
        println!("{line}");
    }
    let mut line = "| exponent |".to_owned();
    for column in columns {
        let points: Vec<(f64, f64)> = sizes
            .iter()
            .copied()
            .zip(column.values.iter().copied())
            .collect();
        line += &format!(" {} |", Exponent::fit(&points).cell());
    }
    println!("{line}");
}
