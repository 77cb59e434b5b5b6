//! The list of materials, and what adds to it: formulas and files.

use std::sync::Arc;

use merlkit::SamplerSpec;
use merlkit::material::analytic::{ModelFacts, ParameterFacts};
use merlkit::material::{Material, Origin};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::environment::ENVIRONMENTS;
use crate::fit::offered_models;
use crate::query::Query;
use crate::refusal::Refusal;
use crate::registry::Registered;
use crate::session::Session;
use crate::upload::display_name;

/// Longer texts are no formulas that a page needs.
const LONGEST_FORMULA: usize = 2000;

/// Samplers that are offered in addition to each method with its usual settings.
const MORE_SAMPLERS: [&str; 2] = ["adaptive-disc:rejection-free", "lobe:ggx"];

/// What there is.
pub(crate) fn materials(session: &Session, _: &Query) -> Result<Answer, Refusal> {
    Answer::json(&describe_session(session, Value::Null)?)
}

/// The answer of `api/v1/materials`, whose member `stored` says what an exported page holds.
pub(crate) fn describe_session(session: &Session, stored: Value) -> Result<Value, Refusal> {
    let all = session.registry.all();
    let mut materials = Vec::with_capacity(all.len());
    for registered in &all {
        materials.push(describe_material(session, registered));
    }
    let mut formulas = Vec::new();
    for model in ModelFacts::all() {
        formulas.push(json!({
            "name": model.name,
            "summary": model.summary,
            "text": model.material,
        }));
    }
    Ok(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "materials": materials,
        "meshes": session.meshes.describe(),
        "samplers": describe_samplers(&all)?,
        "environments": ENVIRONMENTS,
        "models": offered_models(),
        "formulas": formulas,
        "stored": stored,
    }))
}

/// Every method, with the numbers of the materials that it supports.
fn describe_samplers(materials: &[Arc<Registered>]) -> Result<Vec<Value>, Refusal> {
    let mut specs = SamplerSpec::methods();
    specs.extend(SamplerSpec::parse_all(&MORE_SAMPLERS)?);
    let mut described = Vec::with_capacity(specs.len());
    for spec in specs {
        let mut supported = Vec::new();
        for registered in materials {
            if spec.check_supports(&registered.facts).is_ok() {
                supported.push(registered.id);
            }
        }
        described.push(json!({
            "text": spec.to_string(),
            "summary": spec.summary(),
            "materials": supported,
        }));
    }
    Ok(described)
}

/// The entry of a material.
fn describe_material(session: &Session, registered: &Registered) -> Value {
    let facts = &registered.facts;
    json!({
        "id": registered.id,
        "name": registered.name,
        "kind": registered.kind(),
        "isotropic": facts.is_isotropic(),
        "mirror": facts.has_mirror,
        "table": facts.has_table,
        "rule": facts.has_table.then(|| session.rule().name()),
        "notes": registered.notes.get().cloned().unwrap_or_default(),
        "text": registered.text(),
        "model": registered.model(),
        "parameters": describe_parameters(registered),
    })
}

/// The parameters of a formula; none of a sum of formulas and of other materials.
fn describe_parameters(registered: &Registered) -> Vec<Value> {
    let Origin::Formula(text) = registered.material.origin() else {
        return Vec::new();
    };
    let Ok(model) = ModelFacts::parse(text) else {
        return Vec::new();
    };
    model.parameters.iter().map(describe_parameter).collect()
}

/// A parameter with its domain as numbers, where it has one.
fn describe_parameter(parameter: &ParameterFacts) -> Value {
    let mut entry = json!({
        "name": parameter.key,
        "meaning": parameter.meaning,
        "kind": "choice",
        "default": parameter.default,
        "value": parameter.value,
    });
    match parameter.domain.strip_suffix(", or three as R/G/B") {
        Some(range) => {
            entry["kind"] = "colour".into();
            (entry["min"], entry["max"]) = read_range(range);
            entry["default"] = read_colour(&parameter.default);
            entry["value"] = read_colour(&parameter.value);
        }
        None if parameter.domain.contains(" to ") => {
            entry["kind"] = "number".into();
            (entry["min"], entry["max"]) = read_range(&parameter.domain);
            entry["default"] = read_number(&parameter.default);
            entry["value"] = read_number(&parameter.value);
        }
        None => {
            let choices: Vec<&str> = parameter.domain.split(" or ").collect();
            entry["choices"] = json!(choices);
        }
    }
    entry
}

/// "0 to 1" as two numbers.
fn read_range(text: &str) -> (Value, Value) {
    match text.split_once(" to ") {
        Some((low, high)) => (read_number(low), read_number(high)),
        None => (Value::Null, Value::Null),
    }
}

fn read_number(text: &str) -> Value {
    text.trim().parse::<f64>().map_or(Value::Null, Value::from)
}

/// "0.5" or "0.8/0.5/0.2" as three numbers.
fn read_colour(text: &str) -> Value {
    let numbers: Vec<Value> = text.split('/').map(read_number).collect();
    match numbers.as_slice() {
        [all] => json!([all, all, all]),
        _ => Value::Array(numbers),
    }
}

/// Registers the formula of a text, and describes it. The text is read as a formula alone: what is none, a path among others, is refused
/// before anything else is made of it.
pub(crate) fn formula(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let text = query.text("text");
    if text.len() > LONGEST_FORMULA {
        let length = text.len();
        let message = format!("the formula has {length} bytes; give at most {LONGEST_FORMULA}");
        return Err(Refusal::bad(message));
    }
    ModelFacts::brdf(text)?;
    let material = Material::resolve(text)?;
    let Origin::Formula(canonical) = material.origin() else {
        return Err(Refusal::bad("the text is no formula"));
    };
    let name = canonical.clone();
    let registered = session.registry.register(&name, material, false)?;
    Answer::json(&describe_material(session, &registered))
}

/// Registers the bytes of a file that is called `name`, and describes it.
pub(crate) fn upload(session: &Session, query: &Query, bytes: &[u8]) -> Result<Answer, Refusal> {
    let material = session.uploads.store(bytes)?;
    let name = display_name(query.text("name"));
    let registered = session.registry.register(&name, material, true)?;
    // What doesn't load is refused now rather than at its first use.
    session.load(registered.id)?;
    Answer::json(&describe_material(session, &registered))
}
