//! What a bench found, as a table and as JSON.

use std::path::Path;
use std::process::Command;

use merlkit_evaluate::measure::cost::CallCost;
use serde::Serialize;

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// All groups, and what is needed to compare them with those of another day.
#[derive(Serialize)]
pub struct BenchResult {
    schema: u32,
    pub bench: String,
    machine: Machine,
    pub groups: Vec<GroupResult>,
}

/// Where and when, and of which code.
#[derive(Serialize)]
pub struct Machine {
    /// Day, in UTC.
    date: String,
    version: &'static str,
    /// The commit that is checked out, with `-dirty` if files differ from it.
    commit: Option<String>,
    /// What the kernel calls the processor.
    processor: String,
    /// Whether vector code for AVX2 is taken.
    avx2: bool,
    /// Processors that the process may use.
    processors: usize,
    /// The compiler on the path, which is the one that built this unless it was replaced since.
    rustc: Option<String>,
}

#[derive(Serialize)]
pub struct GroupResult {
    pub name: String,
    /// What a call is.
    pub call: &'static str,
    pub rounds: usize,
    pub lines: Vec<LineResult>,
}

#[derive(Serialize)]
pub struct LineResult {
    pub name: String,
    pub cost: CallCost,
    /// Of this line to the first of its group.
    pub to_first: Ratio,
    /// Of this build to another.
    pub to_other: Option<Ratio>,
}

/// Median of the ratios of all rounds, and where it lies with 95 %.
#[derive(Serialize)]
pub struct Ratio {
    median: f64,
    low: f64,
    high: f64,
}

impl Ratio {
    /// Ranks below the median are binomial: n/2 ± 1.96 √n/2 of n.
    pub fn from_rounds(mut ratios: Vec<f64>) -> Self {
        ratios.sort_by(f64::total_cmp);
        let (count, last) = (ratios.len() as f64, ratios.len().max(1) - 1);
        let reach = 1.96 * count.sqrt() / 2.0;
        let ranks = [count / 2.0, count / 2.0 - reach, count / 2.0 + reach];
        let [median, low, high] = ranks.map(|rank| {
            let rank = (rank.max(0.0) as usize).min(last);
            ratios.get(rank).copied().unwrap_or(0.0)
        });
        Self { median, low, high }
    }

    fn text(&self) -> String {
        format!("{:.3} [{:.3}, {:.3}]", self.median, self.low, self.high)
    }
}

impl BenchResult {
    pub fn new(bench: &str) -> Self {
        Self {
            schema: SCHEMA,
            bench: bench.to_owned(),
            machine: Machine::here(),
            groups: Vec::new(),
        }
    }

    /// Replaces the file.
    pub fn write(&self, path: &Path) {
        let text = serde_json::to_string_pretty(self).expect("JSON");
        std::fs::write(path, text + "\n").expect("a file for the result");
    }
}

impl Machine {
    fn here() -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            date: answer("date", &["-u", "+%F"]).unwrap_or_default(),
            version: env!("CARGO_PKG_VERSION"),
            commit: answer("git", &["describe", "--always", "--dirty"]),
            processor: processor(),
            avx2: has_avx2(),
            processors,
            rustc: answer("rustc", &["--version"]),
        }
    }
}

/// The first line that a program prints; `None` if it fails.
fn answer(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let line = text.lines().next()?.trim().to_owned();
    output.status.success().then_some(line)
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split_once(": "));
    name.map_or(std::env::consts::ARCH, |(_, name)| name)
        .to_owned()
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

impl GroupResult {
    pub fn print(&self) {
        let width = self.lines.iter().map(|l| l.name.chars().count()).max();
        let width = width.unwrap_or(0).max(20);
        let to_other = self.lines.iter().any(|line| line.to_other.is_some());
        let other = if to_other {
            "   to the other build"
        } else {
            ""
        };
        println!(
            "\n{}: a {}, {} rounds\n{:width$}  {:>8}  {:^19}   {:23}{other}",
            self.name, self.call, self.rounds, "", "time", "interval", "to the first"
        );
        for line in &self.lines {
            let CallCost { ns, low, high, .. } = line.cost;
            let interval = format!("{} – {}", duration(low), duration(high));
            let other = line.to_other.as_ref().map_or(String::new(), Ratio::text);
            println!(
                "{:width$}  {:>8}  {interval:^19}   {:23}   {other}",
                line.name,
                duration(ns),
                line.to_first.text()
            );
        }
    }
}

/// Three or four digits with their unit.
fn duration(ns: f64) -> String {
    let (value, unit) = match ns {
        ns if ns < 1e4 => (ns, "ns"),
        ns if ns < 1e7 => (ns / 1e3, "µs"),
        ns if ns < 1e10 => (ns / 1e6, "ms"),
        ns => (ns / 1e9, "s"),
    };
    let digits = if value < 100.0 { 1 } else { 0 };
    format!("{value:.digits$} {unit}")
}
