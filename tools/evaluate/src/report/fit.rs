//! Fits in words and tables.

use serde::Serialize;

use super::Sheet;
use crate::measure::fit::{
    FitPlan, HELD, LARGEST_ANGLE, MaterialFit, ModelFit, Pinned, PinnedParameter,
};

/// Everything about a run, for JSON.
#[derive(Debug, Serialize)]
pub struct FitDocument<'a> {
    /// What the fits have in common.
    pub plan: &'a FitPlan,
    /// One entry a material.
    pub materials: &'a [MaterialFit],
}

/// What the errors of a run are.
pub fn fit_text(plan: &FitPlan) -> String {
    format!(
        "Error: root mean square difference of {} ({}) over {} validation pairs, both angles at most {LARGEST_ANGLE}\u{b0}",
        plan.metric.formula(),
        plan.metric.name(),
        plan.validation_pairs
    )
}

/// The models of one material, the least error first.
pub fn fits_sheet(fit: &MaterialFit) -> Sheet {
    let mut sheet = Sheet::new(&["model", "error", "relative %", "sphere", "holds"]);
    for model in ranked(fit) {
        sheet.push(vec![
            model.model.clone(),
            format!("{:.4}", model.error),
            format!("{:.1}", 100.0 * model.relative_error),
            format!("{:.1}", model.sphere_levels),
            if model.holds { "yes" } else { "no" }.into(),
        ]);
    }
    sheet
}

/// Every fit of every material as a row, for other programs: errors with all their digits, and the fit as a MATERIAL.
pub fn fits_csv(fits: &[MaterialFit]) -> Sheet {
    let heading = [
        "material",
        "model",
        "error",
        "relative error",
        "sphere",
        "holds",
        "fit",
    ];
    let mut sheet = Sheet::new(&heading);
    for fit in fits {
        for model in ranked(fit) {
            sheet.push(vec![
                fit.material.clone(),
                model.model.clone(),
                model.error.to_string(),
                model.relative_error.to_string(),
                model.sphere_levels.to_string(),
                model.holds.to_string(),
                model.material.clone(),
            ]);
        }
    }
    sheet
}

/// The fits of a material, the least error first.
fn ranked(fit: &MaterialFit) -> Vec<&ModelFit> {
    let mut ranked: Vec<&ModelFit> = fit.fits.iter().collect();
    ranked.sort_by(|a, b| a.error.total_cmp(&b.error));
    ranked
}

/// The parameters of a fit, with the ranges that the data leave them.
pub fn parameters_sheet(fit: &ModelFit) -> Sheet {
    let mut sheet = Sheet::new(&["parameter", "value", "range", "pinned down"]);
    for parameter in &fit.parameters {
        let [low, high] = parameter.range;
        sheet.push(vec![
            parameter.name.clone(),
            show(parameter.value),
            format!("{} to {}", show(low), show(high)),
            pinned_words(parameter).into(),
        ]);
    }
    sheet
}

fn pinned_words(parameter: &PinnedParameter) -> &'static str {
    match parameter.pinned {
        Pinned::Down => "yes",
        Pinned::NotDown => "no: the range reaches the end of its domain",
        Pinned::AtTheEnd => "at the end of its domain",
    }
}

/// Four significant digits.
fn show(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let digits = (3.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0);
        format!("{value:.*}", digits as usize)
    } else {
        format!("{value:.2e}")
    }
}

/// What is to be said below the tables of one material: the best fit as a MATERIAL, and whether any model holds the material.
pub fn fit_summary(fit: &MaterialFit) -> String {
    let Some(best) = fit.best() else {
        return String::new();
    };
    let mut text = format!("Best model: {}\n  {}\n", best.model, best.material);
    if let Ok(Some(sampler)) = best.sampler() {
        text += &format!("Sampler with this lobe: {sampler}\n");
    }
    if let Some((_, error)) = best.metal_rough {
        text += &format!("As a metallic-roughness material: error {error:.4}\n");
    }
    if !best.holds {
        text += &format!(
            "No model holds {}: the least error is {:.1} % of the material's own root mean square, above {:.0} %\n",
            fit.material,
            100.0 * best.relative_error,
            100.0 * HELD
        );
    }
    text
}

/// The error of each model for each material, and the model of the least.
pub fn fit_matrix(fits: &[MaterialFit]) -> Sheet {
    let names = model_names(fits);
    let mut heading = vec!["material"];
    heading.extend(names.iter().copied());
    heading.push("best");
    let mut sheet = Sheet::new(&heading);
    for fit in fits {
        let mut row = vec![fit.material.clone()];
        row.extend(fit.fits.iter().map(|model| format!("{:.4}", model.error)));
        row.push(fit.best().map_or(String::new(), |best| best.model.clone()));
        sheet.push(row);
    }
    sheet
}

/// How the models compare over all materials: mean and median error, mean rank, how often each is best, how many materials it
/// holds, and the mean difference of spheres.
pub fn fit_ranking(fits: &[MaterialFit]) -> Sheet {
    let mut sheet = Sheet::new(&[
        "model",
        "mean error",
        "median error",
        "mean rank",
        "best for",
        "holds",
        "mean sphere",
    ]);
    let mut rows = Vec::new();
    for (i, name) in model_names(fits).iter().enumerate() {
        let mut errors: Vec<f64> = fits.iter().map(|fit| fit.fits[i].error).collect();
        errors.sort_by(f64::total_cmp);
        let mut ranks = 0;
        let (mut best, mut held, mut levels) = (0, 0, 0.0);
        for fit in fits {
            let rank = ranked(fit).iter().position(|model| model.model == **name);
            ranks += rank.unwrap_or(0) + 1;
            best += usize::from(rank == Some(0));
            held += usize::from(fit.fits[i].holds);
            levels += fit.fits[i].sphere_levels;
        }
        let count = fits.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let row = vec![
            (*name).to_owned(),
            format!("{mean:.4}"),
            format!("{:.4}", errors[errors.len() / 2]),
            format!("{:.2}", ranks as f64 / count),
            best.to_string(),
            held.to_string(),
            format!("{:.1}", levels / count),
        ];
        rows.push((mean, row));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, row) in rows {
        sheet.push(row);
    }
    sheet
}

/// The models of a run, which are the same for all materials.
fn model_names(fits: &[MaterialFit]) -> Vec<&str> {
    let first = fits.first().map_or(&[][..], |fit| fit.fits.as_slice());
    first.iter().map(|model| model.model.as_str()).collect()
}
