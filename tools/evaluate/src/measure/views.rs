//! What a material and a sampler look like: the numbers behind pictures.
//!
//! Lobes and densities lie in the plane of incidence, over signed polar angles of `wi` in degrees: `wo` stands at −θ, its
//! mirror direction at θ.

use std::sync::Arc;

use glam::{DVec2, Vec3};

use super::{albedo_by_degree, directional_albedo};
use merlkit::brdf::Brdf;
use merlkit::color;
use merlkit::direction_sampler::{DirectionSampler, draw_stratified};
use merlkit::geometry::merl_axes::theta_h_degrees;
use merlkit::geometry::spherical;
use merlkit::material::merl::{THETA_D_BINS, THETA_H_BINS};
use merlkit::material::{LookupRule, MerlBrdf, MerlTable};
use merlkit::sampler::{AdaptiveDisc, Cosine, Sampler};

/// A curve over the angle in the plane of incidence: (degrees, value).
pub type PlottedCurve = Vec<(f64, f64)>;

/// A number that represents red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlottedChannel {
    /// Their mean.
    #[default]
    Mean,
    /// Their luminance, of linear sRGB.
    Luminance,
    /// Red alone.
    Red,
    /// Green alone.
    Green,
    /// Blue alone.
    Blue,
}

impl PlottedChannel {
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Luminance => "luminance",
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }

    /// What it is, for a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Mean => "the mean of red, green and blue",
            Self::Luminance => "the luminance",
            Self::Red => "the red channel",
            Self::Green => "the green channel",
            Self::Blue => "the blue channel",
        }
    }

    /// The number of a colour.
    pub fn reduce(self, rgb: color::Rgb) -> f32 {
        match self {
            Self::Mean => color::mean(rgb),
            Self::Luminance => color::luminance(rgb),
            Self::Red => rgb.x,
            Self::Green => rgb.y,
            Self::Blue => rgb.z,
        }
    }
}

/// Which number of a BRDF's value a curve shows: f_r·cosθᵢ, the mean of the channels, by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlottedValue {
    /// The channel.
    pub channel: PlottedChannel,
    /// Whether f_r is shown without the cosine.
    pub without_cosine: bool,
}

impl PlottedValue {
    /// The value as axes name it.
    pub fn symbol(self) -> &'static str {
        if self.without_cosine {
            "f"
        } else {
            "f·cos θi"
        }
    }

    /// The number of one pair of directions.
    pub fn evaluate(self, brdf: &dyn Brdf, wo: Vec3, wi: Vec3) -> f32 {
        self.channel.reduce(if self.without_cosine {
            brdf.eval(wo, wi)
        } else {
            brdf.eval_cos(wo, wi)
        })
    }
}

/// `value` in sr⁻¹ over the polar angle of `wi`, for `wo` at `theta_o` degrees, 0 to below 90.
pub fn lobe(brdf: &dyn Brdf, theta_o: f64, value: PlottedValue) -> PlottedCurve {
    over_plane(theta_o, |wo, wi| value.evaluate(brdf, wo, wi))
}

/// [`lobe`] of the mean over the albedo at `theta_o`: the density that a sampler should have, sr⁻¹. Empty for a black material.
pub fn ideal_density(brdf: &dyn Brdf, theta_o: f64) -> PlottedCurve {
    // An anisotropic material's albedo depends on the azimuth, and wo is drawn on the left.
    let side = if brdf.is_isotropic() { 1.0 } else { -1.0 };
    let albedo = directional_albedo(brdf, side * theta_o.to_radians());
    let albedo = f64::from(color::mean(albedo));
    if albedo <= 0.0 {
        return Vec::new();
    }
    lobe(brdf, theta_o, PlottedValue::default())
        .into_iter()
        .map(|(angle, f)| (angle, f / albedo))
        .collect()
}

/// Density of a sampler in sr⁻¹ over the polar angle of `wi`, for `wo` at `theta_o` degrees, 0 to below 90.
pub fn density(sampler: &dyn DirectionSampler, theta_o: f64) -> PlottedCurve {
    over_plane(theta_o, |wo, wi| sampler.pdf(wo, wi))
}

fn over_plane(theta_o: f64, value: impl Fn(Vec3, Vec3) -> f32) -> PlottedCurve {
    let wo = spherical(-theta_o.to_radians(), 0.0).as_vec3();
    let at = |angle: f64| {
        (
            angle,
            f64::from(value(wo, spherical(angle.to_radians(), 0.0).as_vec3())),
        )
    };
    angles(theta_o).into_iter().map(at).collect()
}

/// Every half degree, and, where MERL's bins of θh are finer, three angles in each of them around the mirror direction.
fn angles(theta_o: f64) -> Vec<f64> {
    let even = (-179..=179).map(|i| f64::from(i) * 0.5);
    // wi turns by twice as much as the half vector.
    let steps =
        (0..=3 * 40).map(|i| 2.0 * theta_h_degrees(f64::from(i) / (3.0 * THETA_H_BINS as f64)));
    let near = steps.flat_map(|step| [theta_o - step, theta_o + step]);
    let mut all: Vec<f64> = even.chain(near).filter(|a| a.abs() < 90.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Values of a table at φd = `phi_d` degrees, 0 to 179: f_r in sr⁻¹, mean of the channels, NaN where invalid;
/// `[theta_d, theta_h]`, θd from 89° down.
pub fn slice(table: &MerlTable, phi_d: usize) -> Vec<f64> {
    let mut values = Vec::with_capacity(THETA_H_BINS * THETA_D_BINS);
    for (theta_h, theta_d) in slice_bins() {
        let rgb = table.rgb(theta_h, theta_d, phi_d);
        values.push(match table.is_valid(theta_h, theta_d, phi_d) {
            true => f64::from(color::mean(rgb)),
            false => f64::NAN,
        });
    }
    values
}

/// The same in colour: linear RGB of f_r in sr⁻¹, 0 where invalid.
pub fn slice_rgb(table: &MerlTable, phi_d: usize) -> Vec<color::Rgb> {
    slice_bins()
        .map(|(theta_h, theta_d)| table.rgb(theta_h, theta_d, phi_d))
        .collect()
}

/// (θh, θd) of a slice, from the top left.
fn slice_bins() -> impl Iterator<Item = (usize, usize)> {
    (0..THETA_D_BINS)
        .rev()
        .flat_map(|theta_d| (0..THETA_H_BINS).map(move |theta_h| (theta_h, theta_d)))
}

/// Directional albedo of a channel at 0°, 1° … 89°, of `wo` at azimuth 0.
pub fn albedo_curve(brdf: &dyn Brdf, channel: PlottedChannel) -> PlottedCurve {
    let mut curve = PlottedCurve::new();
    for (degree, albedo) in albedo_by_degree(brdf).into_iter().enumerate() {
        curve.push((degree as f64, f64::from(channel.reduce(albedo.value))));
    }
    curve
}

/// [`albedo_curve`] of a table by each lookup rule, in the order of [`LookupRule::ALL`].
pub fn albedo_by_rule(table: &Arc<MerlTable>, channel: PlottedChannel) -> [PlottedCurve; 3] {
    LookupRule::ALL.map(|rule| albedo_curve(&MerlBrdf::new(table.clone(), rule), channel))
}

/// `wo` of a picture of the disc: at `theta_o` degrees on the left, as in the plane of incidence.
fn disc_wo(theta_o: f64) -> Vec3 {
    spherical(-theta_o.to_radians(), 0.0).as_vec3()
}

/// `count` draws of a seed, spread together as well as the sampler can, by the cosine if there is none, for `wo` at `theta_o`
/// degrees: their feet on the unit disc, `wo` at x < 0, and how many of the draws failed.
pub fn sampled_directions(
    sampler: Option<&Sampler>,
    theta_o: f64,
    count: usize,
    seed: u64,
) -> (Vec<DVec2>, usize) {
    let wo = disc_wo(theta_o);
    let draws = match sampler {
        Some(sampler) => sampler.draw_stratified(wo, count, seed),
        None => draw_stratified(&Cosine, wo, count, seed),
    };
    let feet: Vec<DVec2> = draws
        .iter()
        .flatten()
        .map(|d| d.wi.truncate().as_dvec2())
        .collect();
    let failed = count - feet.len();
    (feet, failed)
}

/// Outlines of the leaves, and of squares beside them, of the tree nearest to `theta_o` degrees, those inside or across the
/// rim; `wo` at x < 0. And the tree's own angle in degrees.
pub fn leaf_outlines(sampler: &AdaptiveDisc, theta_o: f64) -> (Vec<Vec<DVec2>>, f64) {
    let tree = sampler.subdivision(theta_o.to_radians());
    let outlines = tree
        .cells
        .iter()
        .map(|c| tree.outline(c).into_iter().map(|p| -p).collect());
    (outlines.collect(), tree.theta_o.to_degrees())
}
