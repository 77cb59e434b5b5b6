use glam::*;
use merlkit::brdf::*;
use merlkit::geom::*;
use merlkit::merl::*;
use merlkit::points::*;
use merlkit::sampler::*;
use std::sync::Arc;
fn main() {
    let b = Arc::new(Measured::new(Arc::new(decode_embedded("nickel").unwrap()), LookupRule::Floor));
    let n = 200_000;
    let us: Vec<Vec2> = (0..n).map(|i| PointSet::Random.point(1, i as u64, 0)).collect();
    let wo = spherical(45.2f64.to_radians(), 0.3).as_vec3();
    let which = std::env::args().nth(1).unwrap();
    let s: Box<dyn DirectionSampler> = if which == "disc" {
        Box::new(AdaptiveDisc::build(b.clone(), AdaptiveDiscSettings::default()).unwrap())
    } else {
        Box::new(CascadeCdf::build(&*b, CascadeCdfSettings::default()).unwrap())
    };
    let mut acc = 0.;
    for _ in 0..40 {
        for &u in &us {
            acc += s.sample(wo, u).map_or(0., |s| s.pdf);
        }
    }
    println!("{acc}");
}
