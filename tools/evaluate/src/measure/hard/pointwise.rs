//! Single values and single draws: what one counterexample refutes.

use glam::{Vec2, Vec3};

use super::{HardCheck, HardOutcome, HardSampler, HardSubject};
use super::{hard_directions, hard_partners, hard_points, wrong_points};
use crate::measure::chi_square::is_direction;
use crate::measure::probe::AGREEMENT;
use merlkit::Wo;
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSample;
use merlkit::geometry::is_upper;
use merlkit::sampler::Sampler;

/// Largest relative difference between f_r and f_r with the directions exchanged.
const RECIPROCITY: f64 = 1e-4;

/// Values of formulas, sr⁻¹, below which no digit is promised.
const NEGLIGIBLE: f32 = 1e-12;

/// What went wrong, how often, and the first instance.
#[derive(Default)]
struct Tally {
    count: u64,
    violations: u64,
    first: String,
}

impl Tally {
    fn check(&mut self, right: bool, describe: impl FnOnce() -> String) {
        self.count += 1;
        if !right {
            if self.violations == 0 {
                self.first = describe();
            }
            self.violations += 1;
        }
    }

    fn outcome(
        self,
        subject: &HardSubject,
        sampler: &'static str,
        check: HardCheck,
    ) -> HardOutcome {
        subject.outcome(
            sampler,
            check,
            self.violations as f64,
            Some(0.0),
            self.count,
            self.first,
        )
    }
}

/// The largest of some differences and where it was.
#[derive(Default)]
struct Worst {
    count: u64,
    value: f64,
    place: String,
}

impl Worst {
    fn add(&mut self, a: f64, b: f64, describe: impl FnOnce() -> String) {
        self.count += 1;
        let difference = if a == b {
            0.0
        } else {
            (a - b).abs() / a.abs().max(b.abs())
        };
        // A NaN is the largest difference.
        if difference.is_nan() || difference > self.value {
            (self.value, self.place) = (
                if difference.is_nan() {
                    f64::INFINITY
                } else {
                    difference
                },
                describe(),
            );
        }
    }
}

/// [`HardCheck::Values`] and, where the material is reciprocal, [`HardCheck::Reciprocity`].
pub(super) fn values(subject: &HardSubject) -> Vec<HardOutcome> {
    let (mut tally, mut exchanged) = (Tally::default(), Worst::default());
    for direction in hard_directions() {
        let wo = direction.w;
        let partners = hard_partners(wo);
        let mut batch = vec![Rgb::NAN; partners.len()];
        subject
            .brdf()
            .eval_batch(Wo::One(wo), &partners, &mut batch);
        for (&wi, &in_batch) in partners.iter().zip(&batch) {
            let (f, f_cos) = (subject.brdf().eval(wo, wi), subject.brdf().eval_cos(wo, wi));
            let valid = is_upper(wo) && is_upper(wi);
            let right =
                is_value(f) && is_value(f_cos) && f == in_batch && (valid || f == Rgb::ZERO);
            tally.check(right, || {
                format!(
                    "{} {wo:?}, {wi:?}: f {f}, in a batch {in_batch}, f cos {f_cos}",
                    direction.about
                )
            });
            let other = subject.brdf().eval(wi, wo);
            // A formula may come to nothing one way and to next to nothing the other.
            if subject.lookup.is_none() && f.x.max(other.x) < NEGLIGIBLE {
                continue;
            }
            exchanged.add(f.x.into(), other.x.into(), || {
                format!("{wo:?}, {wi:?}: {f}, {other}")
            });
        }
    }
    let mut out = vec![tally.outcome(subject, "", HardCheck::Values)];
    if subject.is_reciprocal {
        let Worst {
            count,
            value,
            place,
        } = exchanged;
        out.push(subject.outcome(
            "",
            HardCheck::Reciprocity,
            value,
            Some(RECIPROCITY),
            count,
            place,
        ));
    }
    out
}

/// Finite and not negative in every channel.
fn is_value(f: Rgb) -> bool {
    f.is_finite() && f.min_element() >= 0.0
}

/// [`HardCheck::Draws`] and [`HardCheck::Agreement`].
pub(super) fn draws(
    subject: &HardSubject,
    hard: &HardSampler,
    sampler: &Sampler,
) -> Vec<HardOutcome> {
    let mut probe = HardProbe {
        subject,
        sampler,
        tally: Tally::default(),
        agreement: Worst::default(),
    };
    let points = hard_points();
    for direction in hard_directions() {
        probe.direction(&direction.about, direction.w, &points);
    }
    let HardProbe {
        tally, agreement, ..
    } = probe;
    let Worst {
        count,
        value,
        place,
    } = agreement;
    vec![
        tally.outcome(subject, hard.name, HardCheck::Draws),
        subject.outcome(
            hard.name,
            HardCheck::Agreement,
            value,
            Some(AGREEMENT),
            count,
            place,
        ),
    ]
}

struct HardProbe<'a> {
    subject: &'a HardSubject,
    sampler: &'a Sampler,
    tally: Tally,
    agreement: Worst,
}

impl HardProbe<'_> {
    fn direction(&mut self, about: &str, wo: Vec3, points: &[Vec2]) {
        for &u in points.iter().chain(&wrong_points()) {
            self.draw(about, wo, u, self.sampler.sample(wo, u));
        }
        for count in [0, 1, 7] {
            let many = self.sampler.draw_stratified(wo, count, self.subject.seed);
            self.tally.check(many.len() == count, || {
                format!("{} draws of {count}", many.len())
            });
            many.into_iter()
                .for_each(|draw| self.draw(about, wo, Vec2::ZERO, draw));
        }
        for wi in hard_partners(wo) {
            let pdf = self.sampler.pdf(wo, wi);
            let right = if is_upper(wo) && is_upper(wi) {
                pdf >= 0.0 && pdf.is_finite()
            } else {
                pdf == 0.0
            };
            self.tally
                .check(right, || format!("{about} {wo:?}: pdf {pdf} of {wi:?}"));
        }
    }

    fn draw(&mut self, about: &str, wo: Vec3, u: Vec2, draw: Option<DirectionSample>) {
        let Some(DirectionSample { wi, pdf }) = draw else {
            self.tally.count += 1;
            return;
        };
        let weight = self.subject.brdf().eval_cos(wo, wi).as_dvec3() / f64::from(pdf);
        let right = is_upper(wo)
            && is_direction(wi)
            && (pdf > 0.0 && pdf.is_finite())
            && (weight.is_finite() && weight.min_element() >= 0.0);
        self.tally.check(right, || {
            format!("{about} {wo:?}, u {u}: wi {wi:?}, pdf {pdf}, weight {weight}")
        });
        let other = f64::from(self.sampler.pdf(wo, wi));
        self.agreement.add(f64::from(pdf), other, || {
            format!("{about} {wo:?}, u {u}: {pdf} and {other} at {wi:?}")
        });
    }
}
