//! The surface of a lobe over the hemisphere of `wi`: a mesh that is fine where the lobe is narrow.
//!
//! Vertices lie on spokes that leave the mirror direction and end at the horizon, and on rings about it. `wo` is at x < 0, as in
//! [`super::views`].

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::views::PlottedValue;
use merlkit::brdf::Brdf;
use merlkit::geometry::spherical;

/// A direction and the value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeVertex {
    /// The direction.
    pub wi: Vec3,
    /// The value, sr⁻¹.
    pub value: f64,
}

/// The vertices of a lobe: the mirror direction, then ring after ring away from it, the last one at the horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeMesh {
    /// One, and `spokes` for each ring.
    pub vertices: Vec<LobeVertex>,
    /// Vertices of a ring.
    pub spokes: usize,
}

/// How many vertices a mesh has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshSize {
    /// Rings about the mirror direction.
    pub rings: usize,
    /// Vertices of each.
    pub spokes: usize,
}

/// Places on a spoke among which those of the rings are chosen, and spokes that are looked at for the choice.
const CANDIDATES: usize = 600;
const PROBES: usize = 24;
/// The last ring is so near to the horizon, as a fraction of the spoke: at the horizon itself a BRDF may be 0.
const LAST: f64 = 1.0 - 1e-5;

/// The directions around the mirror direction of a `wo`.
struct MirrorFrame {
    /// Sine and cosine of the polar angle.
    sin: f64,
    cos: f64,
}

impl MirrorFrame {
    fn new(theta_o: f64) -> Self {
        let (sin, cos) = theta_o.to_radians().sin_cos();
        Self { sin, cos }
    }

    /// The direction at a fraction of the way from the mirror direction to the horizon, along the spoke at azimuth `beta`.
    fn direction(&self, fraction: f64, beta: f64) -> Vec3 {
        let (sin_beta, cos_beta) = beta.sin_cos();
        // Along the spoke wi_z = cosθ·cosα − sinθ·cosβ·sinα, which is 0 where tan α = cosθ/(sinθ·cosβ).
        let horizon = self.cos.atan2(self.sin * cos_beta);
        let (sin, cos) = (fraction * LAST * horizon).sin_cos();
        let mirror = DVec3::new(self.sin, 0.0, self.cos);
        let outwards = DVec3::new(self.cos * cos_beta, sin_beta, -self.sin * cos_beta);
        (mirror * cos + outwards * sin).as_vec3().normalize()
    }
}

/// The mesh of `value` for `wo` at `theta_o` degrees, 0 to below 90.
///
/// The rings are placed so that all bands between them are as wide on the drawn surface: each spans the same part of the length
/// of the lobe's outline, whose radius is `radius` of a value and of the greatest value. A highlight a tenth of a degree wide has
/// as many rings as its height asks for, because the candidates lie as the cubes of even steps.
///
/// `size` has at least one ring and three spokes.
pub fn lobe_mesh(
    brdf: &dyn Brdf,
    theta_o: f64,
    value: PlottedValue,
    size: MeshSize,
    radius: &dyn Fn(f64, f64) -> f64,
) -> LobeMesh {
    let frame = MirrorFrame::new(theta_o);
    let wo = spherical(-theta_o.to_radians(), 0.0).as_vec3();
    let fractions = ring_fractions(brdf, wo, &frame, value, size.rings.max(1), radius);
    let spokes = size.spokes.max(3);
    let mut vertices = vec![vertex(brdf, wo, frame.direction(0.0, 0.0), value)];
    for fraction in fractions {
        for spoke in 0..spokes {
            let beta = TAU * spoke as f64 / spokes as f64;
            vertices.push(vertex(brdf, wo, frame.direction(fraction, beta), value));
        }
    }
    LobeMesh { vertices, spokes }
}

fn vertex(brdf: &dyn Brdf, wo: Vec3, wi: Vec3, value: PlottedValue) -> LobeVertex {
    let value = f64::from(value.evaluate(brdf, wo, wi));
    LobeVertex { wi, value }
}

/// Where the rings are, as fractions of the spokes; the last is 1.
fn ring_fractions(
    brdf: &dyn Brdf,
    wo: Vec3,
    frame: &MirrorFrame,
    value: PlottedValue,
    rings: usize,
    radius: &dyn Fn(f64, f64) -> f64,
) -> Vec<f64> {
    // Cubes of even steps: the first lies a few billionths of the way from the mirror direction.
    let mut places = Vec::new();
    for i in 0..=CANDIDATES {
        places.push((i as f64 / CANDIDATES as f64).powi(3));
    }
    let mut spokes = Vec::new();
    for probe in 0..PROBES {
        let beta = TAU * probe as f64 / PROBES as f64;
        let along = places
            .iter()
            .map(|&f| vertex(brdf, wo, frame.direction(f, beta), value));
        spokes.push(along.collect::<Vec<_>>());
    }
    let values = spokes.iter().flatten().map(|v| v.value);
    let greatest = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
    // Length of the outline up to each place, by the spoke on which a step is longest: s = Σ max |p(k + 1) − p(k)|.
    let mut lengths = vec![0.0];
    for step in 0..CANDIDATES {
        let mut longest = 0f64;
        for spoke in &spokes {
            let ends = [spoke[step], spoke[step + 1]];
            let [from, to] = ends.map(|v| v.wi.as_dvec3() * radius(v.value, greatest));
            longest = longest.max((to - from).length());
        }
        // A black lobe has rings as well.
        lengths.push(lengths[step] + longest + 1e-9);
    }
    even_places(&places, &lengths, rings)
}

/// The places at which the length reaches each of `count` even parts of the whole.
fn even_places(places: &[f64], lengths: &[f64], count: usize) -> Vec<f64> {
    let last = lengths.len() - 1;
    let mut chosen = Vec::with_capacity(count);
    for part in 1..count {
        let wanted = lengths[last] * part as f64 / count as f64;
        let next = lengths.partition_point(|&l| l < wanted).clamp(1, last);
        let (from, to) = (lengths[next - 1], lengths[next]);
        let t = (wanted - from) / (to - from);
        chosen.push(places[next - 1] + t * (places[next] - places[next - 1]));
    }
    chosen.push(1.0);
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::material::{LookupRule, Material};

    const SIZE: MeshSize = MeshSize {
        rings: 40,
        spokes: 24,
    };

    fn linear(value: f64, greatest: f64) -> f64 {
        value / greatest
    }

    fn mesh(material: &str, theta_o: f64) -> LobeMesh {
        let material = Material::resolve(material).unwrap();
        let loaded = material.load(LookupRule::Floor).unwrap();
        let value = PlottedValue::default();
        lobe_mesh(&**loaded.brdf(), theta_o, value, SIZE, &linear)
    }

    #[test]
    fn the_mesh_covers_the_hemisphere_up_to_the_horizon() {
        for theta_o in [0.0, 40.0, 89.0] {
            let mesh = mesh("lambert:reflectance=0.5", theta_o);
            assert_eq!(mesh.vertices.len(), 1 + SIZE.rings * SIZE.spokes);
            let (sin, cos) = theta_o.to_radians().sin_cos();
            let mirror = DVec3::new(sin, 0.0, cos);
            assert!((mesh.vertices[0].wi.as_dvec3() - mirror).length() < 1e-6);
            assert!(mesh.vertices.iter().all(|v| v.wi.z > 0.0));
            let last = &mesh.vertices[mesh.vertices.len() - SIZE.spokes..];
            assert!(last.iter().all(|v| v.wi.z < 1e-4), "{theta_o}");
        }
    }

    #[test]
    fn a_narrow_highlight_has_rings_on_its_flanks() {
        // Half of the peak is reached where tan θh = α·√(√2 − 1), a twentieth of a degree; wi turns by twice as much.
        let mesh = mesh("ggx:ax=0.001,ay=0.001", 30.0);
        let peak = mesh.vertices[0].value;
        let ring = |r: usize| mesh.vertices[1 + r * mesh.spokes].value / peak;
        let flank = (0..SIZE.rings).filter(|&r| (0.05..0.95).contains(&ring(r)));
        assert!(flank.count() >= 15);
        assert!(mesh.vertices.iter().all(|v| v.value <= peak * 1.0001));
    }
}
