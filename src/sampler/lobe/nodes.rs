//! How even the weights of a density are on a material, by quadrature.

use glam::Vec3;
use rayon::prelude::*;

use crate::brdf::{Brdf, Importance};
use crate::geometry::{Quadrature, Symmetry, spherical};

/// Polar angles of `wo` that are fitted to, degrees.
const ANGLES_DEG: [f64; 6] = [5.0, 20.0, 35.0, 50.0, 65.0, 80.0];
/// Points in each of the quadrature's bins: E\[w²\] to some percent, which is finer than a lobe fits.
const POINTS: usize = 34;

/// Azimuths of `wo` that are fitted to of an anisotropic material, as fractions of those that represent all others.
const AZIMUTHS: [f64; 3] = [0.1, 0.45, 0.8];

/// Polar angle and azimuth of each `wo` that is fitted to, radians.
fn view_angles(symmetry: Symmetry) -> Vec<[f64; 2]> {
    let mut angles = Vec::new();
    for theta in ANGLES_DEG.map(f64::to_radians) {
        if symmetry == Symmetry::Isotropic {
            angles.push([theta, 0.0]);
            continue;
        }
        for fraction in AZIMUTHS {
            angles.push([theta, Symmetry::START + fraction * symmetry.span()]);
        }
    }
    angles
}

/// f_r·cosθ of a material at the nodes of a quadrature, for each of a few `wo`.
pub(in crate::sampler) struct Nodes(Vec<LobeView>);

struct LobeView {
    wo: Vec3,
    /// ∫ f cosθ, > 0.
    albedo: f64,
    /// Direction and (f cosθ)² dσ, where it is positive.
    nodes: Vec<(Vec3, f64)>,
}

impl LobeView {
    fn tabulate([theta, azimuth]: [f64; 2], brdf: &dyn Brdf, importance: Importance) -> Self {
        let wo = spherical(theta, azimuth).as_vec3();
        let mut albedo = 0.0;
        let mut nodes = Vec::new();
        Quadrature::new(wo, POINTS).for_each(|wi, d_sigma| {
            let f_cos = f64::from(importance.reduce(brdf.eval_cos(wo, wi)));
            // E[w] = ∫ f cosθ dσ, and E[w²] = ∫ (f cosθ)²/pdf dσ, of which all but pdf is stored.
            albedo += f_cos * d_sigma;
            if f_cos > 0.0 {
                nodes.push((wi, f_cos * f_cos * d_sigma));
            }
        });
        Self { wo, albedo, nodes }
    }

    /// ln(E\[w²\]/E\[w\]²) of draws with density `pdf`: E\[w²\] = ∫ (f cosθ)²/pdf dσ, and E\[w\] is the albedo.
    fn unevenness(&self, pdf: &impl Fn(Vec3, Vec3) -> f64) -> f64 {
        let mut sum = 0.0;
        for &(wi, value) in &self.nodes {
            sum += value / pdf(self.wo, wi);
        }
        let ratio: f64 = sum / (self.albedo * self.albedo);
        ratio.ln().min(f64::from(f32::MAX))
    }
}

impl Nodes {
    /// The material's values, without the angles at which it is black.
    pub fn tabulate(brdf: &dyn Brdf, importance: Importance) -> Self {
        let angles = view_angles(brdf.symmetry());
        let mut views: Vec<LobeView> = angles
            .par_iter()
            .map(|&angles| LobeView::tabulate(angles, brdf, importance))
            .collect();
        views.retain(|view| view.albedo > 0.0);
        Self(views)
    }

    /// Whether the material is black at all angles.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Mean over the angles of ln(E\[w²\]/E\[w\]²) of draws with density `pdf(wo, wi)`; 0 for a black material.
    pub fn unevenness(&self, pdf: impl Fn(Vec3, Vec3) -> f64 + Sync) -> f64 {
        let views = self.0.par_iter();
        let each: Vec<f64> = views.map(|view| view.unevenness(&pdf)).collect();
        // Summed in the order of the angles, for the same bits with any number of threads.
        each.iter().sum::<f64>() / each.len().max(1) as f64
    }
}
