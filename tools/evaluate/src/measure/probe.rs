//! Checks of single draws and single values: what one counterexample refutes.

use glam::{DVec2, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

use super::chi_square::is_direction;
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{cosine_hemisphere, reflect_about, spherical};
use merlkit::points::{PointSet, Stream};

/// Largest relative difference allowed between the pdf of a draw and `pdf`.
pub(super) const AGREEMENT: f64 = 1e-4;

/// Draws that are looked at one by one, besides those at the corners of the unit square.
const DRAWS: u64 = 20_000;
/// Random directions at which the pdf is asked.
const DIRECTIONS: usize = 8_000;

/// Violations and the first of them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Violations {
    pub count: usize,
    first: Option<(Vec3, f32)>,
}

impl Violations {
    pub fn add(&mut self, wi: Vec3, pdf: f32) {
        self.count += 1;
        self.first.get_or_insert((wi, pdf));
    }

    /// "none", or the first violation.
    pub fn describe(&self) -> String {
        self.first.map_or_else(
            || "none".to_owned(),
            |(wi, pdf)| format!("first at wi = ({}, {}, {}), pdf {pdf}", wi.x, wi.y, wi.z),
        )
    }
}

/// What probing found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probe {
    /// Draws and values that break the contract of [`DirectionSampler`].
    pub invalid: Violations,
    /// Directions with f cosθ > 0 and pdf = 0.
    pub holes: Violations,
    /// Draws whose pdf differs from `pdf` by more than [`AGREEMENT`].
    pub differs: Violations,
    /// Largest relative difference met.
    pub disagreement: f64,
}

/// Probes `sampler` at `wo`.
pub(super) fn run(sampler: &dyn DirectionSampler, brdf: &dyn Brdf, wo: Vec3, seed: u64) -> Probe {
    let mut probe = Probe::default();
    let random = (0..DRAWS).map(|i| PointSet::Random.point(seed, i, 0));
    let (mut draws, mut wi) = (Vec::new(), Vec::new());
    for u in corners().chain(random) {
        if let Some(draw) = sampler.sample(wo, u) {
            draws.push(draw);
            wi.push(draw.wi);
        }
    }
    let mut values = vec![Rgb::ZERO; wi.len()];
    brdf.eval_cos_batch(Wo::One(wo), &wi, &mut values);
    for (draw, f_cos) in draws.into_iter().zip(values) {
        probe.draw(sampler, wo, draw, f_cos);
    }
    for wi in directions(wo, seed) {
        probe.value(sampler, brdf, wo, wi);
    }
    probe.outside(sampler, wo);
    probe
}

impl Probe {
    fn draw(
        &mut self,
        sampler: &dyn DirectionSampler,
        wo: Vec3,
        draw: DirectionSample,
        f_cos: Rgb,
    ) {
        let DirectionSample { wi, pdf } = draw;
        let weight = f_cos / pdf;
        if !(is_direction(wi) && pdf > 0.0 && pdf.is_finite() && weight.is_finite()) {
            self.invalid.add(wi, pdf);
            return;
        }
        let difference = f64::from((sampler.pdf(wo, wi) - pdf).abs() / pdf);
        // A NaN is no agreement.
        let difference = if difference.is_nan() {
            f64::INFINITY
        } else {
            difference
        };
        if difference > AGREEMENT {
            self.differs.add(wi, pdf);
        }
        self.disagreement = self.disagreement.max(difference);
    }

    fn value(&mut self, sampler: &dyn DirectionSampler, brdf: &dyn Brdf, wo: Vec3, wi: Vec3) {
        let pdf = sampler.pdf(wo, wi);
        if !(pdf >= 0.0 && pdf.is_finite()) {
            self.invalid.add(wi, pdf);
        } else if pdf == 0.0 && brdf.eval_cos(wo, wi).max_element() > 0.0 {
            self.holes.add(wi, pdf);
        }
    }

    /// Below the horizon, and for directions that are none, there are no draws and no density.
    fn outside(&mut self, sampler: &dyn DirectionSampler, wo: Vec3) {
        let none = [
            -Vec3::Z,
            Vec3::X,
            Vec3::new(0.6, 0.0, -0.8),
            Vec3::ZERO,
            Vec3::NAN,
            Vec3::INFINITY,
        ];
        for bad in none {
            for (wo, wi) in [(wo, bad), (bad, Vec3::Z)] {
                let pdf = sampler.pdf(wo, wi);
                if pdf != 0.0 {
                    self.invalid.add(wi, pdf);
                }
            }
            if let Some(draw) = sampler.sample(bad, Vec2::splat(0.5)) {
                self.invalid.add(draw.wi, draw.pdf);
            }
        }
    }
}

/// Points on the edges, in the corners and in the middle of the unit square, where maps tend to divide by zero.
fn corners() -> impl Iterator<Item = Vec2> {
    let ends = [
        0.0,
        1.0 / (1u32 << 24) as f32,
        0.25,
        0.5,
        0.75,
        1.0f32.next_down(),
    ];
    ends.into_iter()
        .flat_map(move |x| ends.into_iter().map(move |y| Vec2::new(x, y)))
}

/// Directions over the whole hemisphere, down to the horizon, and ever closer to the mirror direction.
fn directions(wo: Vec3, seed: u64) -> impl Iterator<Item = Vec3> {
    let mut stream = Stream::new(seed);
    let exact = wo.as_dvec3().normalize_or(glam::DVec3::Z);
    let near_mirror = move |s: f64, t: f64| {
        // Half vectors from a thousandth of a degree to 45° off the normal, evenly in the logarithm.
        let theta = (PI / 4.0) * (-10.0 * s).exp();
        reflect_about(exact, spherical(theta, t * TAU)).as_vec3()
    };
    let direction = move |i: usize| {
        let (s, t) = (stream.next_f64(), stream.next_f64());
        match i % 3 {
            0 => cosine_hemisphere(DVec2::new(s, t)).as_vec3(),
            1 => spherical((1.0 - s * s).clamp(-1.0, 1.0).acos(), t * TAU).as_vec3(),
            _ => near_mirror(s, t),
        }
    };
    (0..DIRECTIONS)
        .map(direction)
        .filter(|wi| is_direction(*wi))
}
