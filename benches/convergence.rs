//! How fast each sampler's estimate of a lit point converges under Owen-scrambled Sobol points: errors and slopes, not times.
//!
//! One point under two broad lamps and a gradient, eight materials, `wo` at 45°. `cargo bench --bench convergence`.

use glam::Vec3;
use merlkit::brdf::Importance;
use merlkit::geometry::{POINTS_PER_BIN, spherical};
use merlkit::points::PointSet;
use merlkit::{Loaded, LookupRule, Material, SamplerSpec};
use merlkit_evaluate::measure::compare::MATERIALS;
use merlkit_evaluate::measure::convergence::{ErrorAt, Incident, LitPoint, Runs, slope};

const SAMPLES: [usize; 7] = [16, 32, 64, 128, 256, 512, 1024];

/// Radiance from a direction: lobes 30° and 15° wide over a gradient, all smooth.
fn radiance(wi: Vec3) -> f64 {
    let lobe = |towards: Vec3, n: i32| f64::from(wi.dot(towards.normalize()).max(0.0)).powi(n);
    0.2 + 0.3 * f64::from(wi.z)
        + 4.0 * lobe(Vec3::new(0.5, 0.3, 0.8), 8)
        + 2.0 * lobe(Vec3::new(-0.8, 0.2, 0.4), 30)
}

/// The samplers that are compared, as the command line names them.
const SAMPLERS: [&str; 5] = [
    "half-vector:64KB",
    "cascade-cdf",
    "adaptive-disc:rejection-free",
    "adaptive-disc",
    "cosine",
];

/// Errors of every material.
fn errors(spec: &SamplerSpec, materials: &[Loaded]) -> Vec<Vec<ErrorAt>> {
    let wo = spherical(45f64.to_radians(), 0.8).as_vec3();
    let runs = Runs {
        points: PointSet::Sobol,
        seeds: 200,
        first_seed: 1,
    };
    let mut errors = Vec::with_capacity(materials.len());
    for material in materials {
        let sampler = spec.build(material).expect("a sampler");
        let point = LitPoint {
            brdf: &**material.brdf(),
            importance: Importance::Mean,
            light: Incident::Function(&radiance),
            wo,
        };
        let reference = point.reference(POINTS_PER_BIN);
        errors.push(point.errors(sampler.as_dyn(), reference, &SAMPLES, runs));
    }
    errors
}

fn main() {
    let mut materials = Vec::new();
    for name in MATERIALS {
        let material = Material::resolve(name).expect("an embedded material");
        materials.push(material.load(LookupRule::Floor).expect("its table"));
    }
    println!(
        "relative RMSE over 200 seeds, geometric mean of {} materials, and slopes",
        MATERIALS.len()
    );
    for name in SAMPLERS {
        let spec = name.parse().expect("a sampler's text");
        let errors = errors(&spec, &materials);
        let mean = |i: usize| {
            (errors.iter().map(|e| e[i].rmse.ln()).sum::<f64>() / errors.len() as f64).exp()
        };
        let row: Vec<String> = (0..SAMPLES.len())
            .map(|i| format!("{:.4}", mean(i)))
            .collect();
        let slopes: Vec<f64> = errors.iter().map(|e| slope(e)).collect();
        let each: Vec<String> = slopes.iter().map(|s| format!("{s:.2}")).collect();
        let mean_slope = slopes.iter().sum::<f64>() / slopes.len() as f64;
        println!(
            "{name:28} {}  slope {mean_slope:.2} ({})",
            row.join(" "),
            each.join(" ")
        );
    }
}
