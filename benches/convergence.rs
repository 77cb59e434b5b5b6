//! How fast each sampler's estimate of a lit point converges under Owen-scrambled Sobol points: errors and slopes, not times.
//!
//! One point under two broad lamps and a gradient, eight materials, `wo` at 45°. `cargo bench --bench convergence`.

use std::sync::Arc;

use glam::Vec3;
use merlkit::brdf::Importance;
use merlkit::geometry::{POINTS_PER_BIN, spherical};
use merlkit::material::Loaded;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, CosineSettings, HalfVectorSettings, LeafChoice,
    SamplerSpec,
};
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

fn samplers() -> [(&'static str, SamplerSpec); 5] {
    let warp = AdaptiveDiscSettings {
        leaves: LeafChoice::Warp,
        ..Default::default()
    };
    [
        (
            "half-vector 64KB",
            SamplerSpec::new(HalfVectorSettings::default()),
        ),
        (
            "cascade-cdf",
            SamplerSpec::new(CascadeCdfSettings::default()),
        ),
        ("disc, rejection-free", SamplerSpec::new(warp)),
        (
            "adaptive-disc",
            SamplerSpec::new(AdaptiveDiscSettings::default()),
        ),
        ("cosine", SamplerSpec::new(CosineSettings {})),
    ]
}

/// Errors of every material.
fn errors(spec: &SamplerSpec, brdfs: &[Arc<MerlBrdf>]) -> Vec<Vec<ErrorAt>> {
    let wo = spherical(45f64.to_radians(), 0.8).as_vec3();
    let runs = Runs {
        points: PointSet::Sobol,
        seeds: 200,
        first_seed: 1,
    };
    let of = |brdf: &Arc<MerlBrdf>| {
        let sampler = spec
            .build(&Loaded::from_table(brdf.clone()))
            .expect("a sampler");
        let point = LitPoint {
            brdf: &**brdf,
            importance: Importance::Mean,
            light: Incident::Function(&radiance),
            wo,
        };
        point.errors(&*sampler, point.reference(POINTS_PER_BIN), &SAMPLES, runs)
    };
    brdfs.iter().map(of).collect()
}

fn main() {
    let measured = |name: &&str| {
        Arc::new(MerlBrdf::new(
            Arc::new(decode_embedded(name).expect("an embedded material")),
            LookupRule::Floor,
        ))
    };
    let brdfs: Vec<Arc<MerlBrdf>> = MATERIALS.iter().map(measured).collect();
    println!(
        "relative RMSE over 200 seeds, geometric mean of {} materials, and slopes",
        MATERIALS.len()
    );
    for (name, spec) in samplers() {
        let errors = errors(&spec, &brdfs);
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
            "{name:22} {}  slope {mean_slope:.2} ({})",
            row.join(" "),
            each.join(" ")
        );
    }
}
