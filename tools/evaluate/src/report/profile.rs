//! Samplers' figures, worded.

use serde::Serialize;

use super::Sheet;
use super::cost::{kilobytes, nanoseconds};
use super::digits::{rounded, with_sign};
use super::thesis::{THESIS_KB, ThesisFigures, thesis_figures, thesis_uniform_memory};
use crate::measure::cost::ROUNDS;
use crate::measure::profile::{MaterialFigures, SamplerFigures};
use merlkit::geometry::Symmetry;
use merlkit::material::LookupRule;
use merlkit::material::merl::RoundingError;

/// The figures of a material's samplers, and the thesis's for the same material.
#[derive(Clone, Debug, Serialize)]
pub struct SamplerReport {
    /// Measured in this run.
    #[serde(flatten)]
    pub measured: MaterialFigures,
    /// Printed in the thesis; not measured here.
    pub thesis: Vec<ThesisFigures>,
}

impl SamplerReport {
    /// Puts the thesis's figures beside the measured ones.
    pub fn new(measured: MaterialFigures) -> Self {
        let thesis = thesis_figures(&measured.material);
        Self { measured, thesis }
    }

    /// One line a sampler, in two tables: what it costs, with a line for each method of the thesis, and how accurate it is.
    pub fn sheets(&self) -> [Sheet; 2] {
        let mut cost = Sheet::new(&[
            &self.measured.material,
            "table KB",
            "file KB",
            "build s",
            "CPU s",
            "sample ns",
            "pdf ns",
        ]);
        let mut accuracy = Sheet::new(&[
            &self.measured.material,
            "relstd",
            "worst",
            "holes %",
            "bias %",
            "± %",
            "failed %",
        ]);
        for s in &self.measured.samplers {
            cost.push(cost_line(s));
            accuracy.push(accuracy_line(s));
        }
        for t in &self.thesis {
            cost.push(thesis_line(t));
        }
        [cost, accuracy]
    }

    /// One line an adaptive disc: its size, trials and time to build against n_max (the thesis's question of table 6.5). `None`
    /// without any.
    pub fn disc_sheet(&self) -> Option<Sheet> {
        let mut sheet = Sheet::new(&[
            "adaptive disc",
            "n_max",
            "table KB",
            "trials",
            "build s",
            "CPU s",
            "sample ns",
            "above bounds %",
        ]);
        for s in &self.measured.samplers {
            if let Some(disc) = &s.disc {
                sheet.push(vec![
                    s.spec.to_string(),
                    disc.n_max.to_string(),
                    kilobytes(s.table_bytes),
                    format!("{:.2}", disc.mean_trials),
                    format!("{:.3}", s.build.wall),
                    format!("{:.3}", s.build.cpu),
                    nanoseconds(&s.calls.sample_ns),
                    format!("{:.4}", 100.0 * disc.largest_excess),
                ]);
            }
        }
        (!sheet.rows.is_empty()).then_some(sheet)
    }

    /// How the material was read.
    pub fn reading(&self) -> String {
        let m = &self.measured;
        format!(
            "{}: {}{}; loaded (or decoded) in {:.0} ms, {:.1} MB.",
            m.material,
            m.reading,
            m.rounding_errors.map(rounding_text).unwrap_or_default(),
            1e3 * m.load.wall,
            m.material_bytes as f64 / 1e6,
        )
    }

    /// What the figures of the sheets are, and how they were come by: once for all materials of a report, which have the same
    /// settings. `None` without any.
    pub fn legend(reports: &[Self]) -> Option<String> {
        let first = &reports.first()?.measured;
        let is_turned = |r: &Self| r.measured.symmetry != Symmetry::Isotropic;
        let azimuths = if reports.iter().any(is_turned) {
            " of 7, each at four azimuths where the material is anisotropic"
        } else {
            " of 7"
        };
        let threads = first.samplers.first().map_or(0, |s| s.threads);
        Some(format!(
            "Samplers are built on {threads} threads. Draws and densities are timed on one thread by CPU time, with samplers \
             alternating: the lower quartile of {ROUNDS} rounds over 7 angles, with its 95 % confidence interval in brackets. \
             1 KB = 1000 bytes.\n\
             relstd: relative standard deviation of the sample weight (mean RGB), by quadrature, mean and worst angle{azimuths}. \
             holes: fraction of the albedo where the density is 0, worst angle. bias: bias of the albedo from {} draws, seed {}, \
             at the angle where it is the most standard errors (±) from 0. failed: fraction of draws that give no direction.",
            first.settings.draws, first.settings.seed,
        ))
    }

    /// The same figures as one wide table for machines: full precision, SI units, one row a sampler and angle, then the
    /// thesis's, whose KB are 1024 bytes.
    pub fn csv(reports: &[Self]) -> Sheet {
        let mut sheet = Sheet::new(&[
            "material",
            "lookup",
            "source",
            "sampler",
            "table_bytes",
            "file_bytes",
            "load_s",
            "build_wall_s",
            "build_cpu_s",
            "threads",
            "sample_ns",
            "sample_ns_low",
            "sample_ns_high",
            "pdf_ns",
            "pdf_ns_low",
            "pdf_ns_high",
            "failed",
            "theta_o_deg",
            "phi_o_deg",
            "relstd",
            "albedo",
            "holes",
            "pdf_integral",
            "bias",
            "bias_standard_error",
            "draws",
            "seed",
        ]);
        for report in reports {
            report.csv_rows(&mut sheet);
        }
        sheet
    }

    fn csv_rows(&self, sheet: &mut Sheet) {
        let m = &self.measured;
        for s in &m.samplers {
            for a in &s.angles {
                sheet.push(vec![
                    m.material.clone(),
                    m.lookup.map_or("", LookupRule::name).into(),
                    "measured".into(),
                    s.spec.to_string(),
                    s.table_bytes.to_string(),
                    s.file_bytes.map(|b| b.to_string()).unwrap_or_default(),
                    m.load.wall.to_string(),
                    s.build.wall.to_string(),
                    s.build.cpu.to_string(),
                    s.threads.to_string(),
                    s.calls.sample_ns.ns.to_string(),
                    s.calls.sample_ns.low.to_string(),
                    s.calls.sample_ns.high.to_string(),
                    s.calls.pdf_ns.ns.to_string(),
                    s.calls.pdf_ns.low.to_string(),
                    s.calls.pdf_ns.high.to_string(),
                    s.calls.failed.to_string(),
                    a.theta_o_deg.to_string(),
                    a.phi_o_deg.to_string(),
                    a.spread.relstd.to_string(),
                    a.spread.mean.to_string(),
                    a.spread.holes.to_string(),
                    a.spread.pdf_integral.to_string(),
                    a.bias.relative.to_string(),
                    a.bias.standard_error.to_string(),
                    m.settings.draws.to_string(),
                    m.settings.seed.to_string(),
                ]);
            }
        }
        for t in &self.thesis {
            let mut row = vec![String::new(); sheet.heading.len()];
            row[0] = m.material.clone();
            row[2] = "thesis".into();
            row[3] = t.method.clone();
            row[4] = number_or_empty(t.memory_kb.map(|kb| (kb * THESIS_KB).round()));
            row[7] = number_or_empty(t.precompute_s);
            sheet.push(row);
        }
    }
}

/// What compact cells cost in accuracy, in brackets.
fn rounding_text(channels: [RoundingError; 3]) -> String {
    let worst = RoundingError::worst(channels);
    format!(
        " (relative errors of its worst channel: {:.1e} in the median, above {:.1e} for one value in 1000, at most {:.1e}; {} values \
         became 0)",
        worst.median, worst.permille, worst.greatest, worst.zeroed
    )
}

fn number_or_empty(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| x.to_string())
}

/// What the thesis's lines are, once for a whole report.
pub fn thesis_legend() -> String {
    let sizes: Vec<String> = thesis_uniform_memory()
        .iter()
        .map(|(h, p, kb)| format!("{h} × {p} cells take {kb} KB"))
        .collect();
    format!(
        "Rows marked \"thesis\" are quoted from R. Montes's thesis (2008), which used an AMD Opteron; they were not measured here. \
         The thesis's KB of 1024 bytes are converted to KB of 1000 bytes in the table. In these rows, the sample column is \
         the total time for drawing the directions of one picture of 450 × 200 pixels at 25 samples per pixel. The \
         thesis's uniform CDFs, for any material (table 5.9), in KB of 1024 bytes: {}.",
        sizes.join(", ")
    )
}

fn cost_line(s: &SamplerFigures) -> Vec<String> {
    vec![
        s.spec.to_string(),
        kilobytes(s.table_bytes),
        s.file_bytes.map_or_else(|| "–".into(), kilobytes),
        format!("{:.3}", s.build.wall),
        format!("{:.3}", s.build.cpu),
        nanoseconds(&s.calls.sample_ns),
        nanoseconds(&s.calls.pdf_ns),
    ]
}

fn accuracy_line(s: &SamplerFigures) -> Vec<String> {
    let bias = s.worst_bias();
    let error = 100.0 * bias.standard_error;
    vec![
        s.spec.to_string(),
        figure(s.relstd()),
        figure(s.worst_relstd()),
        format!("{:.3}", 100.0 * s.worst_holes()),
        with_sign(100.0 * bias.relative, error),
        rounded(error, error),
        format!("{:.2}", 100.0 * s.calls.failed),
    ]
}

fn thesis_line(t: &ThesisFigures) -> Vec<String> {
    let number =
        |x: Option<f64>, unit: &str| x.map_or_else(|| "–".into(), |x| format!("{x}{unit}"));
    let mut line = vec!["–".to_owned(); 7];
    line[0] = t.method.clone();
    if let Some(kb) = t.memory_kb {
        line[1] = kilobytes((kb * THESIS_KB).round() as usize);
    }
    line[3] = number(t.precompute_s, "");
    line[5] = number(t.sampling_s, " s");
    line
}

/// Three significant digits or so.
fn figure(x: f64) -> String {
    if x < 10.0 {
        format!("{x:.3}")
    } else {
        format!("{x:.1}")
    }
}
