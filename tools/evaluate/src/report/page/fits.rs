//! A gallery of fits: the material's sphere, those of the fits, and their differences.

use super::html::{paragraph, subheading, table};
use super::pictures::image;
use super::{Section, whole_page};
use crate::measure::fit::{FitPictures, FitPlan, MaterialFit};
use crate::plot::escape;
use crate::report::Provenance;
use crate::report::fit::{fit_matrix, fit_ranking, fit_text};

const TITLE: &str = "Models fitted to materials";

/// One self-contained HTML page, which is well-formed XML as well, without scripts or addresses of other files.
pub fn fit_page(
    fits: &[MaterialFit],
    pictures: &[FitPictures],
    plan: &FitPlan,
    provenance: &Provenance,
) -> String {
    let mut gallery = paragraph(
        "Each sphere is lit by two directional lights and drawn to the same exposure. Below each fit is its absolute difference \
         from the material, four times as bright. Captions give the error and the root mean square difference of the spheres \
         in 8-bit levels.",
    );
    for (fit, pictures) in fits.iter().zip(pictures) {
        gallery += &material(fit, pictures);
    }
    let errors = table("Error of each model", &fit_matrix(fits));
    let ranking = table("Models by their errors", &fit_ranking(fits));
    let sections: Vec<Section> = [
        Section::new("spheres", "Spheres", gallery),
        Section::new("errors", "Errors", errors + &ranking),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut head = paragraph(&fit_text(plan));
    for line in provenance.lines() {
        head += &paragraph(&line);
    }
    whole_page(TITLE, &head, &sections)
}

fn material(fit: &MaterialFit, pictures: &FitPictures) -> String {
    let mut figures = format!(
        "<figure>{}<figcaption><b>measured</b></figcaption></figure>\n",
        image(&pictures.measured, &format!("{}, measured", fit.material))
    );
    for (model, [fitted, difference]) in fit.fits.iter().zip(&pictures.fitted) {
        let title = format!("{}, {}", fit.material, model.model);
        figures += &format!(
            "<figure>{}{}<figcaption><b>{}</b> {:.4}, {:.1} levels</figcaption></figure>\n",
            image(fitted, &title),
            image(difference, &format!("{title}: difference")),
            escape(&model.model),
            model.error,
            model.sphere_levels
        );
    }
    subheading(&fit.material) + "<div class=\"pictures\">\n" + &figures + "</div>\n"
}
