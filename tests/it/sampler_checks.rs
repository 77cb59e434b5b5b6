//! The checks pass right samplers and reject wrong ones, each for its own fault.

use crate::support::measured_under;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use merlkit::Wo;
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature};
use merlkit::geometry::{half_vector, is_upper, reflect_about, spherical, to_spherical};
use merlkit::material::merl::{Header, MerlTable};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::Stream;
use merlkit::sampler::Cosine;
use merlkit_evaluate::measure::accuracy::weight_spread;
use merlkit_evaluate::measure::check::{
    Check, CheckReport, CheckSettings, check_directions, check_sampler,
};
use merlkit_evaluate::measure::chi_square::{ChiSquareTest, ChiSquareVerdict};

/// f_r = 0.5/π in every bin.
fn lambert() -> MerlBrdf {
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| [0.5 * FRAC_1_PI; 3]);
    MerlBrdf::new(Arc::new(table), LookupRule::Floor)
}

fn settings(calls: usize) -> CheckSettings {
    CheckSettings {
        calls,
        ..CheckSettings::default()
    }
}

fn directions(angles: &[f64]) -> Vec<Vec3> {
    angles
        .iter()
        .map(|a| spherical(a.to_radians(), 0.8).as_vec3())
        .collect()
}

fn failed(report: &CheckReport, check: Check) -> usize {
    report.failures().filter(|o| o.check == check).count()
}

/// Half cosine, half a lobe (n+1)/2π·cosⁿθh of half vectors, some of which reflect `wo` below the horizon: those draws fail.
#[derive(Clone, Copy)]
struct Lobe {
    drawn: f64,
    claimed: f64,
    scale: f32,
}

impl Lobe {
    fn right(exponent: f64) -> Self {
        Self {
            drawn: exponent,
            claimed: exponent,
            scale: 1.0,
        }
    }
}

impl DirectionSampler for Lobe {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        if !is_upper(wo) {
            return None;
        }
        let wi = if u.x < 0.5 {
            Cosine.sample(wo, Vec2::new(2.0 * u.x, u.y))?.wi
        } else {
            let x = 2.0 - 2.0 * f64::from(u.x);
            let theta = x.powf(1.0 / (self.drawn + 1.0)).acos();
            reflect_about(
                wo.as_dvec3().normalize(),
                spherical(theta, TAU * f64::from(u.y)),
            )
            .as_vec3()
        };
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !is_upper(wo) || !is_upper(wi) {
            return 0.0;
        }
        let (o, i) = (wo.as_dvec3().normalize(), wi.as_dvec3().normalize());
        let Some(h) = half_vector(o, i) else {
            return 0.0;
        };
        let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
        let cos_n = (-0.5 * self.claimed * tan2.ln_1p()).exp();
        let lobe = (self.claimed + 1.0) / TAU * cos_n / (4.0 * o.dot(h));
        self.scale * (0.5 * i.z * FRAC_1_PI + 0.5 * lobe) as f32
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Cosine sampling and, with probability `drawn`, a spike: half vectors within 10⁻⁴ of one that is 20° off the normal.
#[derive(Clone, Copy)]
struct Spike {
    drawn: f64,
    claimed: f64,
}

impl Spike {
    const RADIUS: f64 = 1e-4;

    fn axis() -> DVec3 {
        spherical(0.35, 1.3)
    }
}

impl DirectionSampler for Spike {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let x = f64::from(u.x);
        let wi = if x < self.drawn {
            let (a, b) = Self::axis().any_orthonormal_pair();
            let radius = Self::RADIUS * (x / self.drawn).sqrt();
            let (sin, cos) = (TAU * f64::from(u.y)).sin_cos();
            let h = (Self::axis() + radius * (cos * a + sin * b)).normalize();
            reflect_about(wo.as_dvec3().normalize(), h).as_vec3()
        } else {
            let rest = (x - self.drawn) / (1.0 - self.drawn);
            Cosine.sample(wo, Vec2::new(rest as f32, u.y))?.wi
        };
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !is_upper(wo) || !is_upper(wi) {
            return 0.0;
        }
        let sum = wo.as_dvec3() + wi.as_dvec3();
        let is_within = sum.cross(Self::axis()).length() < Self::RADIUS * sum.length();
        let spike = if is_within {
            1.0 / (PI * Self::RADIUS * Self::RADIUS * 2.0 * sum.length())
        } else {
            0.0
        };
        let cosine = f64::from(wi.z) * FRAC_1_PI;
        ((1.0 - self.claimed) * cosine + self.claimed * spike) as f32
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Piecewise constant on a grid in √θh and the share of the azimuth, as fine tabulated samplers are: neighbouring cells differ
/// by factors, none of their edges is an edge of a bin of the test, and no draw fails. The first row is uniform in area, for the
/// density of √θh is unbounded at the mirror direction, beyond what f32 directions resolve.
struct Steps {
    rows: usize,
    columns: usize,
    /// Cumulative probability of the cells, row by row.
    cumulative: Vec<f64>,
}

impl Steps {
    fn new(rows: usize, columns: usize, seed: u64) -> Self {
        let mut stream = Stream::new(seed);
        // Uneven by up to e⁴, and falling with θh.
        let weights = (0..rows * columns)
            .map(|i| (4.0 * stream.next_f64() - 0.1 * (i / columns) as f64).exp());
        let mut cumulative = vec![0.0];
        for weight in weights {
            cumulative.push(cumulative[cumulative.len() - 1] + weight);
        }
        let total = cumulative[cumulative.len() - 1];
        cumulative.iter_mut().for_each(|c| *c /= total);
        Self {
            rows,
            columns,
            cumulative,
        }
    }

    /// The largest θh, and the largest azimuth of h at one θh, that reflect above the horizon.
    fn limits(theta_o: f64, theta_h: f64) -> (f64, f64) {
        let (far, near) = (
            (2.0 * theta_h + theta_o).cos(),
            (2.0 * theta_h - theta_o).cos(),
        );
        let phi_max = if far >= 0.0 {
            PI
        } else {
            2.0 * near.max(1e-16).sqrt().atan2((-far).sqrt())
        };
        (0.5 * (FRAC_PI_2 + theta_o), phi_max)
    }
}

impl DirectionSampler for Steps {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        if !is_upper(wo) {
            return None;
        }
        let (theta_o, phi_o) = to_spherical(wo.as_dvec3());
        let x = f64::from(u.x);
        let cell = self
            .cumulative
            .partition_point(|&c| c <= x)
            .clamp(1, self.rows * self.columns)
            - 1;
        let rest =
            (x - self.cumulative[cell]) / (self.cumulative[cell + 1] - self.cumulative[cell]);
        let (row, within) = ((cell / self.columns) as f64, f64::from(u.y));
        let a = if row == 0.0 {
            within.powf(0.25)
        } else {
            row + within
        } / self.rows as f64;
        let b = 2.0 * ((cell % self.columns) as f64 + rest) / self.columns as f64 - 1.0;
        let theta_h = a * a * Self::limits(theta_o, 0.1).0;
        let h = spherical(theta_h, phi_o + b * Self::limits(theta_o, theta_h).1);
        let wi = reflect_about(wo.as_dvec3().normalize(), h).as_vec3();
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !is_upper(wo) || !is_upper(wi) {
            return 0.0;
        }
        let (theta_o, phi_o) = to_spherical(wo.as_dvec3());
        let h = (wo.as_dvec3() + wi.as_dvec3()).normalize();
        let (theta_h, phi_h) = to_spherical(h);
        let theta_h = theta_h.max(1e-12);
        let (theta_max, phi_max) = Self::limits(theta_o, theta_h);
        let azimuth = (phi_h - phi_o + 3.0 * PI).rem_euclid(TAU) - PI;
        let (a, b) = (
            (theta_h / theta_max).sqrt(),
            0.5 + 0.5 * (azimuth / phi_max),
        );
        let row = ((a * self.rows as f64) as usize).min(self.rows - 1);
        let column = ((b * self.columns as f64) as usize).min(self.columns - 1);
        let cell = row * self.columns + column;
        let mass = self.cumulative[cell + 1] - self.cumulative[cell];
        let per_square = mass * (self.rows * self.columns) as f64;
        // θh = a²·θmax, or (rows·a)⁴ uniform in the first row; the azimuth runs over 2·φmax.
        let first_row = if row == 0 {
            4.0 * (self.rows as f64 * a).powi(3)
        } else {
            1.0
        };
        let per_half =
            per_square * first_row / (2.0 * a * theta_max * 2.0 * phi_max * theta_h.sin());
        (per_half / (4.0 * wo.as_dvec3().dot(h))) as f32
    }

    fn bytes(&self) -> usize {
        size_of_val(self.cumulative.as_slice())
    }
}

/// Cosine sampling with one deliberate fault.
#[derive(Clone, Copy)]
enum Faulty {
    /// The returned pdf is not that of `pdf`.
    Disagrees,
    /// Never draws, and says so, where wi.x > 0.9.
    Hole,
    /// Never draws there, but claims the density.
    HiddenHole,
    /// One draw in a thousand is not a number.
    Nan,
    /// Draws below the horizon.
    Below,
    /// Density 0 in a region that it does draw.
    Impossible,
    /// Batches that leave out a tenth of the unit square.
    Batch,
}

impl DirectionSampler for Faulty {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let mut draw = Cosine.sample(wo, u)?;
        match self {
            Self::Disagrees => draw.pdf *= 1.001,
            Self::Hole | Self::HiddenHole if draw.wi.x > 0.9 => return None,
            Self::Nan if u.x < 0.001 => draw.wi.x = f32::NAN,
            Self::Below if u.x < 0.001 => draw.wi.z = -draw.wi.z,
            _ => {}
        }
        Some(draw)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Hole | Self::Impossible if wi.x > 0.9 => 0.0,
            _ => Cosine.pdf(wo, wi),
        }
    }

    fn bytes(&self) -> usize {
        0
    }

    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        let kept = if matches!(self, Self::Batch) {
            0.9
        } else {
            1.0
        };
        for (lane, (out, u)) in out.iter_mut().zip(u).enumerate() {
            *out = self.sample(wo.lane(lane), Vec2::new(u.x, u.y * kept));
        }
    }
}

fn assert_pass(sampler: &dyn DirectionSampler, brdf: &dyn Brdf) {
    let report = check_sampler(sampler, brdf, &check_directions(), &settings(8));
    assert_eq!(report.outcomes.len(), 13 * 7);
    assert!(
        report.pass(),
        "{:#?}",
        report.failures().collect::<Vec<_>>()
    );
}

#[test]
fn cosine_passes_on_every_material() {
    for name in ["teflon", "nickel", "red-plastic"] {
        assert_pass(&Cosine, &measured_under(name, LookupRule::Floor));
    }
    assert_pass(&Cosine, &lambert());
}

#[test]
fn right_samplers_with_failed_draws_and_with_jumps_pass() {
    for brdf in [measured_under("nickel", LookupRule::Floor), lambert()] {
        assert_pass(&Lobe::right(200.0), &brdf);
        assert_pass(&Steps::new(40, 24, 9), &brdf);
    }
}

#[test]
fn other_lookup_rules_pass_too() {
    let settings = settings(2);
    for rule in [LookupRule::Linear, LookupRule::Centred] {
        let report = check_sampler(
            &Lobe::right(800.0),
            &measured_under("chrome", rule),
            &directions(&[14.5, 75.5]),
            &settings,
        );
        assert!(
            report.pass(),
            "{:#?}",
            report.failures().collect::<Vec<_>>()
        );
    }
}

#[test]
fn a_pdf_five_per_cent_high_is_rejected() {
    let wrong = Lobe {
        scale: 1.05,
        ..Lobe::right(50.0)
    };
    let wos = directions(&[0.0, 29.75, 60.0, 85.0]);
    let report = check_sampler(&wrong, &lambert(), &wos, &settings(1));
    for check in [
        Check::ChiSquare,
        Check::PdfIntegral,
        Check::Bias,
        Check::Furnace,
    ] {
        assert_eq!(failed(&report, check), wos.len(), "{check:?}: {report:#?}");
    }
    let chi_square = report
        .failures()
        .find(|o| o.check == Check::ChiSquare)
        .unwrap();
    assert!(chi_square.note.contains("worst cell"), "{chi_square:?}");
}

#[test]
fn an_exponent_fifteen_per_cent_off_is_rejected() {
    for exponent in [50.0, 5e3, 1e6] {
        let wrong = Lobe {
            claimed: 1.15 * exponent,
            ..Lobe::right(exponent)
        };
        for wo in directions(&[0.76, 45.0, 84.7]) {
            let result = ChiSquareTest {
                tests: 1000,
                ..ChiSquareTest::default()
            }
            .run(&wrong, wo);
            assert_eq!(
                result.verdict,
                ChiSquareVerdict::Unlikely,
                "{exponent} {wo}: {result:?}"
            );
            assert!(result.worst.iter().all(|c| c.term > 0.0) && !result.worst.is_empty());
        }
    }
}

/// No lattice of any affordable size meets the spike, 3·10⁻⁸ of half vectors: where draws fell shows where to look.
#[test]
fn a_narrow_spike_passes_where_it_is_right_and_is_rejected_where_it_is_wrong() {
    let wos = directions(&[14.5, 30.0]);
    let right = Spike {
        drawn: 0.01,
        claimed: 0.01,
    };
    let report = check_sampler(&right, &lambert(), &wos, &settings(1));
    assert_eq!(failed(&report, Check::ChiSquare), 0, "{report:#?}");
    assert_eq!(failed(&report, Check::PdfIntegral), 0, "{report:#?}");
    for claimed in [0.0, 0.006, 0.015] {
        let wrong = Spike {
            drawn: 0.01,
            claimed,
        };
        let report = check_sampler(&wrong, &lambert(), &wos, &settings(1));
        assert_eq!(
            failed(&report, Check::ChiSquare),
            2,
            "{claimed}: {report:#?}"
        );
    }
}

#[test]
fn an_honest_hole_fails_positivity_and_bias_but_not_chi_square() {
    let report = check_sampler(
        &Faulty::Hole,
        &lambert(),
        &directions(&[0.0, 60.25]),
        &settings(1),
    );
    assert_eq!(failed(&report, Check::Positivity), 2, "{report:#?}");
    assert_eq!(failed(&report, Check::Bias), 2, "{report:#?}");
    assert_eq!(failed(&report, Check::ChiSquare), 0, "{report:#?}");
    assert_eq!(failed(&report, Check::PdfIntegral), 0, "{report:#?}");
}

#[test]
fn a_hidden_hole_fails_chi_square_and_the_integral() {
    let report = check_sampler(
        &Faulty::HiddenHole,
        &lambert(),
        &directions(&[0.0, 60.25]),
        &settings(1),
    );
    assert_eq!(failed(&report, Check::Positivity), 0, "{report:#?}");
    assert_eq!(failed(&report, Check::ChiSquare), 2, "{report:#?}");
    assert_eq!(failed(&report, Check::PdfIntegral), 2, "{report:#?}");
}

#[test]
fn draws_that_are_no_directions_are_rejected() {
    for wrong in [Faulty::Nan, Faulty::Below] {
        let report = check_sampler(&wrong, &lambert(), &directions(&[30.0]), &settings(1));
        assert_eq!(failed(&report, Check::Validity), 1, "{report:#?}");
        assert_eq!(failed(&report, Check::ChiSquare), 1, "{report:#?}");
        assert!(
            report.outcomes.iter().all(|o| !o.value.is_nan()),
            "{report:#?}"
        );
    }
}

#[test]
fn draws_where_the_pdf_is_zero_are_rejected() {
    let wo = directions(&[30.0])[0];
    let result = ChiSquareTest::default().run(&Faulty::Impossible, wo);
    assert_eq!(result.verdict, ChiSquareVerdict::Impossible);
    assert!(result.impossible > 1000);
}

#[test]
fn a_returned_pdf_of_its_own_is_rejected() {
    let report = check_sampler(
        &Faulty::Disagrees,
        &lambert(),
        &directions(&[30.0]),
        &settings(1),
    );
    assert_eq!(failed(&report, Check::Agreement), 1, "{report:#?}");
}

#[test]
fn a_wrong_stratified_draw_is_rejected() {
    let brdf = measured_under("beige-fabric", LookupRule::Floor);
    // Turned so that the wedge which is never drawn holds the retro-reflection of the cloth.
    let wos = [45.0_f64, 60.25, 75.5].map(|a| spherical(a.to_radians(), -FRAC_PI_2).as_vec3());
    let report = check_sampler(&Faulty::Batch, &brdf, &wos, &settings(1));
    assert_eq!(failed(&report, Check::Furnace), wos.len(), "{report:#?}");
    // Single draws are right, and nothing else looks at batches.
    assert_eq!(report.failures().count(), wos.len(), "{report:#?}");
    assert!(check_sampler(&Cosine, &brdf, &wos, &settings(1)).pass());
}

#[test]
fn p_values_of_right_samplers_are_uniform() {
    let wo = directions(&[60.25])[0];
    let samplers: [&dyn DirectionSampler; 2] = [&Cosine, &Lobe::right(3000.0)];
    let p: Vec<f64> = (0..60)
        .map(|seed| {
            let test = ChiSquareTest {
                draws: 50_000,
                seed,
                ..ChiSquareTest::default()
            };
            test.run(samplers[seed as usize % 2], wo).p_value
        })
        .collect();
    let below = |x: f64| p.iter().filter(|&&p| p < x).count();
    // Binomial with 60 trials: each range holds with probability over 0.998.
    assert!(below(0.01) <= 4, "{p:?}");
    assert!((2..=24).contains(&below(0.2)), "{p:?}");
    assert!((17..=43).contains(&below(0.5)), "{p:?}");
}

#[test]
fn p_values_of_densities_with_jumps_are_uniform() {
    let p: Vec<f64> = (0..24)
        .map(|seed| {
            let wo = directions(&[0.76, 29.75, 60.25, 84.7])[seed as usize % 4];
            let test = ChiSquareTest {
                seed,
                ..ChiSquareTest::default()
            };
            test.run(&Steps::new(64, 32, seed), wo).p_value
        })
        .collect();
    let below = |x: f64| p.iter().filter(|&&p| p < x).count();
    // Binomial with 24 trials: each range holds with probability over 0.998.
    assert!(below(0.01) <= 3, "{p:?}");
    assert!(below(0.2) <= 13, "{p:?}");
    assert!((4..=20).contains(&below(0.5)), "{p:?}");
}

#[test]
fn reports_do_not_depend_on_threads() {
    let brdf = measured_under("red-plastic", LookupRule::Floor);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            check_sampler(
                &Lobe::right(100.0),
                &brdf,
                &directions(&[0.0, 45.0, 85.0]),
                &settings(1),
            )
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn spread_sees_holes_and_failed_draws() {
    let wo = directions(&[75.5])[0];
    let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
    let spread = |sampler: &dyn DirectionSampler| {
        weight_spread(sampler, &lambert(), &quadrature, Importance::Mean)
    };
    let hole = spread(&Faulty::Hole);
    assert!(
        hole.holes > 0.015 && (hole.holes + hole.pdf_integral - 1.0).abs() < 1e-4,
        "{hole:?}"
    );
    // The weight is 1/2 or, for a failed draw, 0: a coin of probability q has E[w²]/E[w]² = 1/q.
    let expected = (1.0 / hole.pdf_integral - 1.0).sqrt();
    assert!((hole.relstd - expected).abs() < 2e-3, "{hole:?}");
    let lobe = spread(&Lobe::right(20.0));
    assert!(lobe.pdf_integral < 0.95 && lobe.holes == 0.0, "{lobe:?}");
}

#[test]
fn an_invalid_direction_passes_as_nothing() {
    let report = check_sampler(&Cosine, &lambert(), &[-Vec3::Z], &settings(1));
    assert_eq!(failed(&report, Check::ChiSquare), 0, "{report:#?}");
    assert!(
        report
            .outcomes
            .iter()
            .all(|o| o.value.is_finite() && o.bound.is_finite()),
        "{report:#?}"
    );
    assert_eq!(lambert().eval(-Vec3::Z, Vec3::Z), Vec3::ZERO);
}
