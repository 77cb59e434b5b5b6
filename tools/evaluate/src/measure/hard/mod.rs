//! Hard cases against everything: what `merlkit check --hard` runs, and the stability tests too.
//!
//! Every case of [`HardCase`] and every formula of [`HardModel`] is crossed with the lookup rules, the samplers of [`hard_samplers`], the directions of
//! [`hard_directions`] and [`hard_partners`], the numbers of [`hard_points`], and with the renderer. One outcome tells the
//! worst of all directions and numbers.

mod inputs;
mod integrals;
mod models;
mod picture;
mod pointwise;
mod samplers;

pub use inputs::{HardDirection, hard_directions, hard_partners, hard_points, wrong_points};
pub use models::HardModel;
use samplers::hard_model_samplers;
pub use samplers::{HardSampler, hard_samplers};

use std::sync::Arc;

use rayon::prelude::*;

use merlkit::Result;
use merlkit::brdf::Brdf;
use merlkit::material::analytic::ModelFacts;
use merlkit::material::merl::HardCase;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::material::{Loaded, Material};

/// What is promised for hard cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HardCheck {
    /// Values of the BRDF are finite and not negative, 0 where a direction is none, and the same one by one and in batches.
    /// Value: violations.
    Values,
    /// f_r is the same with the directions exchanged; tables of 180 bins of φd and reciprocal formulas only. Value: largest relative difference.
    Reciprocity,
    /// Draws are unit directions above the horizon with a finite, positive pdf and a finite weight; a pdf is finite and not
    /// negative; what is no direction above the horizon draws nothing and has pdf 0. Value: violations.
    Draws,
    /// The pdf of a draw is that of `pdf`. Value: largest relative difference.
    Agreement,
    /// ∫ pdf is one minus the rate of failed draws. Value: their difference.
    PdfIntegral,
    /// The mean weight of draws is the albedo, as far as the pdf reaches it. Value: relative deviation over what chance
    /// allows.
    Energy,
    /// Memory that the sampler holds, bytes.
    Memory,
    /// Pixels and standard errors under a point, an area and an environment light are finite and not negative. Value:
    /// violations.
    Picture,
}

impl HardCheck {
    /// All checks, in the order of tables.
    pub const ALL: [Self; 8] = [
        Self::Values,
        Self::Reciprocity,
        Self::Draws,
        Self::Agreement,
        Self::PdfIntegral,
        Self::Energy,
        Self::Memory,
        Self::Picture,
    ];
}

/// One check of a crossing.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct HardOutcome {
    /// Name of the hard case.
    pub case: &'static str,
    /// The lookup rule; `None` for a formula.
    pub lookup: Option<LookupRule>,
    /// The sampler; empty for checks of the BRDF alone.
    pub sampler: &'static str,
    /// What was checked.
    pub check: HardCheck,
    /// What was found at worst; see [`HardCheck`].
    pub value: f64,
    /// The largest value that passes; absent where nothing is promised.
    pub bound: Option<f64>,
    /// Whether the value keeps the bound.
    pub pass: bool,
    /// How many draws, values or pixels were looked at.
    pub count: u64,
    /// After a failure, where; empty otherwise.
    pub note: String,
}

/// How much is crossed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Thoroughness {
    /// One lookup rule for each pair of a case and a sampler and one of two directions for its integrals, in turn.
    Quick,
    /// Every lookup rule and five directions.
    Full,
}

impl Thoroughness {
    /// Polar angles of `wo` for integrals of a case, degrees.
    fn angles(self, case: usize) -> &'static [f64] {
        match self {
            Self::Quick if case.is_multiple_of(2) => &[30.0],
            Self::Quick => &[75.5],
            Self::Full => &[0.0, 30.0, 60.25, 85.0, 89.9],
        }
    }

    /// The same of a formula. Rounding of directions to f32 is no small part of a needle at grazing angles, so they are none of
    /// these.
    fn model_angles(self, model: usize) -> &'static [f64] {
        match self {
            Self::Quick => self.angles(model),
            Self::Full => &[0.0, 30.0, 60.25, 85.0],
        }
    }

    /// Whether a rule is taken for a case and a sampler, by their numbers.
    fn takes(self, rule: usize, case: usize, sampler: usize) -> bool {
        self == Self::Full || (case + sampler) % LookupRule::ALL.len() == rule
    }
}

/// Crosses the cases in parallel over samplers; the same outcomes for any number of threads. `progress` is called after
/// each case.
///
/// # Errors
/// Those of building samplers and scenes: none for the settings here.
pub fn check_hard(
    cases: &[HardCase],
    thoroughness: Thoroughness,
    seed: u64,
    progress: &dyn Fn(),
) -> Result<Vec<HardOutcome>> {
    let mut outcomes = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let table = Arc::new(case.table());
        for (rule, &lookup) in LookupRule::ALL.iter().enumerate() {
            let brdf = Arc::new(MerlBrdf::new(table.clone(), lookup));
            let subject = HardSubject {
                name: case.name,
                is_narrow: case.is_narrow,
                is_torn: case.is_torn,
                is_reciprocal: case.header().phi_d_bins == 180,
                lookup: Some(lookup),
                material: Loaded::from_table(brdf),
                thoroughness,
                angles: thoroughness.angles(number),
                seed,
            };
            let samplers = hard_samplers()?.into_iter().enumerate();
            let taken: Vec<HardSampler> = samplers
                .filter(|(k, _)| thoroughness.takes(rule, number, *k))
                .map(|(_, s)| s)
                .collect();
            outcomes.extend(subject.cross_all(&taken)?);
        }
        progress();
    }
    Ok(outcomes)
}

/// Crosses formulas as [`check_hard`] crosses tables, with fewer samplers.
///
/// # Errors
/// Those of building samplers and scenes: none for the settings here.
pub fn check_hard_models(
    models: &[HardModel],
    thoroughness: Thoroughness,
    seed: u64,
    progress: &dyn Fn(),
) -> Result<Vec<HardOutcome>> {
    let mut outcomes = Vec::new();
    for (number, model) in models.iter().enumerate() {
        let facts = ModelFacts::parse(model.text)?;
        let subject = HardSubject {
            name: model.name,
            is_narrow: false,
            is_torn: false,
            is_reciprocal: facts.reciprocal,
            lookup: None,
            material: Material::resolve(model.text)?.load(LookupRule::Floor)?,
            thoroughness,
            angles: thoroughness.model_angles(number),
            seed,
        };
        let mut taken = hard_model_samplers()?;
        if thoroughness == Thoroughness::Quick {
            taken = vec![taken.swap_remove(number % taken.len())];
        }
        outcomes.extend(subject.cross_all(&taken)?);
        progress();
    }
    Ok(outcomes)
}

/// Most bytes that a table of any sampler here may hold.
const BYTES_A_TABLE: f64 = (1 << 20) as f64;

/// A table looked up by a rule, or a formula.
struct HardSubject {
    name: &'static str,
    /// As [`HardCase::is_narrow`] and [`HardCase::is_torn`].
    is_narrow: bool,
    is_torn: bool,
    /// Whether exchanging the directions should change nothing.
    is_reciprocal: bool,
    lookup: Option<LookupRule>,
    material: Loaded,
    thoroughness: Thoroughness,
    angles: &'static [f64],
    seed: u64,
}

impl HardSubject {
    fn brdf(&self) -> &Arc<dyn Brdf> {
        self.material.brdf()
    }

    /// The values of the BRDF, then each sampler with every check, in parallel.
    fn cross_all(&self, samplers: &[HardSampler]) -> Result<Vec<HardOutcome>> {
        let mut outcomes = pointwise::values(self);
        let crossed: Result<Vec<Vec<HardOutcome>>> = samplers
            .par_iter()
            .map(|sampler| self.cross(sampler))
            .collect();
        outcomes.extend(crossed?.into_iter().flatten());
        Ok(outcomes)
    }

    fn cross(&self, hard: &HardSampler) -> Result<Vec<HardOutcome>> {
        let sampler = hard.spec.build(&self.material)?;
        let mut out = pointwise::draws(self, hard, &sampler);
        out.extend(integrals::integrals(self, hard, &*sampler));
        let bytes = sampler.bytes() as f64;
        let tables = samplers::count_tables(&sampler.fitted());
        let bound = Some(BYTES_A_TABLE * tables as f64);
        out.push(self.outcome(hard.name, HardCheck::Memory, bytes, bound, 1, String::new()));
        out.push(picture::picture(self, hard, &sampler)?);
        Ok(out)
    }

    fn outcome(
        &self,
        sampler: &'static str,
        check: HardCheck,
        value: f64,
        bound: Option<f64>,
        count: u64,
        note: String,
    ) -> HardOutcome {
        // A NaN keeps no bound.
        let pass = bound.is_none_or(|bound| value <= bound) && !value.is_nan();
        let note = if pass { String::new() } else { note };
        HardOutcome {
            case: self.name,
            lookup: self.lookup,
            sampler,
            check,
            value,
            bound,
            pass,
            count,
            note,
        }
    }
}
