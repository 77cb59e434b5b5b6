//! A material as a MERL table of four bytes a cell, and as the file that programs load at run time.

use std::sync::Arc;

use merlkit::export::Export;
use merlkit::material::merl::{BinPoint, CellFormat, RoundingError, THETA_D_BINS, THETA_H_BINS};
use merlkit::material::merl::{MerlTable, tabulate_brdf};
use merlkit::material::{Loaded, LookupRule};
use merlkit::sampler::HalfVectorSettings;
use serde_json::json;

use crate::answer::{Answer, ArrayAnswer};
use crate::query::Query;
use crate::refusal::Refusal;
use crate::session::Session;

/// The words of `--table rgb9e5`, and how far they are from the values.
pub(crate) fn table(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (registered, loaded) = session.load(query.material()?)?;
    let facts = &registered.facts;
    facts.require_isotropic(&registered.name, "a MERL table")?;
    let measured = loaded.table().map(|measured| measured.table());
    let compact = shared_exponent_table(&loaded, measured)?;
    let Some((words, unit)) = compact.shared_exponent_words() else {
        return Err(Refusal::new(500, "the table has no words; report this"));
    };
    let errors = compact.rounding_errors().map(RoundingError::worst);
    let errors = errors.unwrap_or_default();
    let rule = loaded.rule().unwrap_or(LookupRule::Floor);
    let mut answer = ArrayAnswer::new(json!({
        "unit": unit,
        "error": errors.greatest,
        "median": errors.median,
        "permille": errors.permille,
        "zeroed": errors.zeroed,
        "resampled": measured.is_none(),
        "rule": rule.name(),
    }));
    let shape = [THETA_H_BINS, THETA_D_BINS, compact.phi_d_bins()];
    answer.push_u32("table", &shape, words);
    Ok(answer.finish())
}

/// The material's table in cells of four bytes; what is no table is resampled at the bins' centres.
fn shared_exponent_table(
    loaded: &Loaded,
    measured: Option<&Arc<MerlTable>>,
) -> Result<MerlTable, Refusal> {
    let table = match measured {
        Some(table) => MerlTable::clone(table),
        None => tabulate_brdf(&**loaded.brdf(), BinPoint::Centre)?,
    };
    Ok(table.with_cell_format(CellFormat::Rgb9e5)?)
}

/// The bytes of the file that `merlkit export --format runtime` writes.
pub(crate) fn runtime(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (registered, loaded) = session.load(query.material()?)?;
    let settings = HalfVectorSettings::default();
    let export = Export::new(&registered.material, &loaded, settings)?;
    Ok(Answer::file(export.runtime_bytes()?))
}
