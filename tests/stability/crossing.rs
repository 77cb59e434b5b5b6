//! Every hard case against every sampler, lookup rule and light.

use merlkit::material::merl::HardCase;
use merlkit_evaluate::measure::hard::{
    HardCheck, HardModel, HardOutcome, Thoroughness, check_hard, check_hard_models,
};
use std::sync::LazyLock;

/// One crossing for all tests: with every rule if `STABILITY_FULL` is set.
pub static CROSSING: LazyLock<Vec<HardOutcome>> = LazyLock::new(|| {
    let full = std::env::var_os("STABILITY_FULL").is_some();
    let thoroughness = if full {
        Thoroughness::Full
    } else {
        Thoroughness::Quick
    };
    check_hard(&HardCase::ALL, thoroughness, 1, &|| {}).unwrap()
});

#[test]
fn hard_cases_keep_every_promise() {
    let failures: Vec<String> = CROSSING
        .iter()
        .filter(|o| !o.pass)
        .map(|o| {
            format!(
                "{} {:?} {} {:?}: {:.3e} > {:.3e} of {}; {}",
                o.case,
                o.lookup,
                o.sampler,
                o.check,
                o.value,
                o.bound.unwrap_or(0.0),
                o.count,
                o.note
            )
        })
        .collect();
    assert!(
        failures.is_empty(),
        "{} failures:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

/// Formulas without bounds, with needles and with zeros to divide by.
#[test]
fn hard_models_keep_every_promise() {
    let outcomes = check_hard_models(&HardModel::ALL, Thoroughness::Quick, 1, &|| {}).unwrap();
    for model in HardModel::ALL {
        assert!(outcomes.iter().any(|o| o.case == model.name));
    }
    let failures: Vec<&HardOutcome> = outcomes.iter().filter(|o| !o.pass).collect();
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn every_case_and_check_took_part() {
    for case in HardCase::ALL {
        assert!(
            CROSSING.iter().any(|o| o.case == case.name),
            "{}",
            case.name
        );
    }
    for check in HardCheck::ALL {
        assert!(
            CROSSING.iter().any(|o| o.check == check && o.count > 0),
            "{check:?}"
        );
    }
}
