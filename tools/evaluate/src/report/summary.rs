//! Each sampler over all materials of a report.

use super::cost::nanoseconds;
use super::{SamplerReport, Sheet};
use crate::measure::profile::SamplerFigures;

/// One line a sampler: extremes of memory and time, geometric mean and worst of the spread, worst bias and losses.
///
/// Samplers are told apart by their labels, in the order of the first report.
pub fn summary(reports: &[SamplerReport]) -> Sheet {
    let heading = format!("{} materials", reports.len());
    let mut sheet = Sheet::new(&[
        &heading,
        "table KB",
        "build s",
        "sample ns",
        "relstd",
        "largest relstd",
        "worst angle",
        "holes %",
        "bias/±",
        "∫pdf − 1 %",
        "failed %",
    ]);
    let mut labels: Vec<String> = Vec::new();
    for s in reports.iter().flat_map(|r| &r.measured.samplers) {
        let label = s.spec.to_string();
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    for label in labels {
        let all: Vec<(&str, &SamplerFigures)> = reports
            .iter()
            .flat_map(|r| {
                r.measured
                    .samplers
                    .iter()
                    .map(|s| (r.measured.material.as_str(), s))
            })
            .filter(|(_, s)| s.spec.to_string() == label)
            .collect();
        sheet.push(line(label, &all));
    }
    sheet
}

fn kilobytes(figures: &SamplerFigures) -> f64 {
    figures.table_bytes as f64 / 1000.0
}

/// The largest distance of a pdf's integral from 1.
fn worst_integral(figures: &SamplerFigures) -> f64 {
    let mut worst = 0.0;
    for angle in &figures.angles {
        worst = f64::max(worst, (angle.spread.pdf_integral - 1.0).abs());
    }
    worst
}

fn line(label: String, all: &[(&str, &SamplerFigures)]) -> Vec<String> {
    let most =
        |of: &dyn Fn(&SamplerFigures) -> f64| all.iter().map(|(_, s)| of(s)).fold(0.0, f64::max);
    let least = all
        .iter()
        .map(|(_, s)| kilobytes(s))
        .fold(f64::INFINITY, f64::min);
    let worst = all
        .iter()
        .max_by(|a, b| a.1.relstd().total_cmp(&b.1.relstd()));
    let slowest = all
        .iter()
        .max_by(|a, b| a.1.calls.sample_ns.ns.total_cmp(&b.1.calls.sample_ns.ns));
    vec![
        label,
        write_range(least, most(&kilobytes)),
        format!("{:.3}", most(&|s| s.build.wall)),
        slowest.map_or_else(String::new, |(_, s)| nanoseconds(&s.calls.sample_ns)),
        format!("{:.3}", geometric_mean(all.iter().map(|(_, s)| s.relstd()))),
        worst.map_or_else(String::new, |(name, s)| {
            format!("{:.3} ({name})", s.relstd())
        }),
        format!("{:.3}", most(&SamplerFigures::worst_relstd)),
        format!("{:.3}", 100.0 * most(&SamplerFigures::worst_holes)),
        format!("{:.1}", most(&|s| s.worst_bias().in_standard_errors())),
        format!("{:.3}", 100.0 * most(&worst_integral)),
        format!("{:.2}", 100.0 * most(&|s| s.calls.failed)),
    ]
}

/// "44.7–123.7", or one number where both are the same.
fn write_range(least: f64, most: f64) -> String {
    let (least, most) = (format!("{least:.1}"), format!("{most:.1}"));
    if least == most {
        most
    } else {
        format!("{least}–{most}")
    }
}

/// 0 if a value is 0, or there are none.
fn geometric_mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len();
    let product: f64 = values.map(f64::ln).sum();
    if count > 0 {
        (product / count as f64).exp()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::geometric_mean;

    #[test]
    fn geometric_means() {
        assert!((geometric_mean([2.0, 8.0].into_iter()) - 4.0).abs() < 1e-12);
        assert_eq!(geometric_mean([0.0, 8.0].into_iter()), 0.0);
        assert_eq!(geometric_mean(Vec::new().into_iter()), 0.0);
    }
}
