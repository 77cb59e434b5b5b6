//! A formula fitted to a material.

use merlkit_evaluate::measure::fit::{DEFAULT_FIT_MODELS, FitModel, FitPlan, fit_models};

use crate::answer::Answer;
use crate::query::{Query, shorten};
use crate::refusal::Refusal;
use crate::session::Session;

/// What may be fitted in addition to the models of `merlkit fit`: two lobes.
const TWO_LOBES: &str = "ggx+ggx";

/// The models that the page offers.
pub(crate) fn offered_models() -> Vec<&'static str> {
    let mut models = DEFAULT_FIT_MODELS.to_vec();
    models.push(TWO_LOBES);
    models
}

/// Fits one of the offered models as `merlkit fit` does; the answer's member `material` is the result as a MATERIAL.
pub(crate) fn fit(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let name = query.text("model");
    if !offered_models().contains(&name) {
        return Err(Refusal::bad(format!(
            "no model \"{}\" is fitted here; choose {}",
            shorten(name),
            offered_models().join(", ")
        )));
    }
    let (registered, loaded) = session.load(query.material()?)?;
    let models = [FitModel::parse(name)?];
    let plan = FitPlan::default();
    let fitted = fit_models(&registered.name, &**loaded.brdf(), &models, &plan)?;
    match fitted.fits.first() {
        Some(fit) => Answer::json(fit),
        None => Err(Refusal::new(500, "nothing was fitted; report this")),
    }
}
