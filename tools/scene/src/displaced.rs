//! A sphere with bumps: it takes the place of a scanned figure, with any number of triangles.

use std::collections::HashMap;

use glam::DVec3;
use merlkit::{Error, Result};

use crate::mesh_data::MeshData;

/// Steps along an edge of the octahedron, at most: 8 million triangles.
const MOST_STEPS: u32 = 1024;

/// Waves of each octave.
const WAVES: usize = 6;

/// Octaves of waves, each twice as fine as the last and half as high.
const OCTAVES: usize = 4;

/// A sphere about the origin whose radius goes up and down by at most `amplitude` of itself: an octahedron, each edge of which is
/// divided into `steps`, so that there are 8·steps² triangles. Equal seeds give equal bumps.
///
/// # Errors
/// [`Error::Argument`] for a radius that is not positive, an amplitude that is not in [0, 1), and steps out of 1 to 1024.
pub fn displace_sphere(radius: f64, amplitude: f64, steps: u32, seed: u64) -> Result<MeshData> {
    let is_usable = radius > 0.0
        && radius.is_finite()
        && (0.0..1.0).contains(&amplitude)
        && (1..=MOST_STEPS).contains(&steps);
    if !is_usable {
        return Err(Error::argument(
            format!("a sphere of radius {radius}, amplitude {amplitude} and {steps} steps"),
            format!("give a radius > 0, an amplitude in [0, 1) and 1 to {MOST_STEPS} steps"),
        ));
    }
    let mut sphere = Octahedron {
        steps: steps as i32,
        known: HashMap::new(),
        data: MeshData::default(),
    };
    sphere.add_faces();
    let waves = draw_waves(seed);
    for vertex in &mut sphere.data.vertices {
        *vertex *= radius * (1.0 + amplitude * height(&waves, *vertex));
    }
    Ok(sphere.data)
}

/// An octahedron with divided faces, blown up to a sphere.
struct Octahedron {
    steps: i32,
    known: HashMap<[i32; 3], u32>,
    data: MeshData,
}

impl Octahedron {
    /// The vertex at integer coordinates whose absolute values add up to `steps`.
    fn vertex(&mut self, at: [i32; 3]) -> u32 {
        let vertices = &mut self.data.vertices;
        *self.known.entry(at).or_insert_with(|| {
            let [x, y, z] = at.map(f64::from);
            vertices.push(DVec3::new(x, y, z).normalize());
            vertices.len() as u32 - 1
        })
    }

    fn add_faces(&mut self) {
        for octant in 0..8 {
            let sign = [octant & 1, octant >> 1 & 1, octant >> 2].map(|bit| 1 - 2 * bit);
            let mirrors = sign[0] * sign[1] * sign[2] < 0;
            for i in 0..self.steps {
                for j in 0..self.steps - i {
                    self.add_triangle([[i + 1, j], [i, j + 1], [i, j]], sign, mirrors);
                    if i + j + 1 < self.steps {
                        let upper = [[i + 1, j], [i + 1, j + 1], [i, j + 1]];
                        self.add_triangle(upper, sign, mirrors);
                    }
                }
            }
        }
    }

    /// A triangle of an octant, whose corners have the coordinates x and y; counter-clockwise as seen from outside.
    fn add_triangle(&mut self, corners: [[i32; 2]; 3], sign: [i32; 3], mirrors: bool) {
        let steps = self.steps;
        let mut face = corners
            .map(|[x, y]| self.vertex([sign[0] * x, sign[1] * y, sign[2] * (steps - x - y)]));
        if mirrors {
            face.swap(1, 2);
        }
        self.data.faces.push(face);
    }
}

/// A plane wave on the sphere.
struct Wave {
    along: DVec3,
    phase: f64,
    height: f64,
}

/// Waves in directions that the seed draws, whose heights add up to 1.
fn draw_waves(seed: u64) -> Vec<Wave> {
    let mut state = seed;
    let mut waves = Vec::with_capacity(OCTAVES * WAVES);
    let total = WAVES as f64 * (2.0 - 0.5f64.powi(OCTAVES as i32 - 1));
    for octave in 0..OCTAVES as i32 {
        for _ in 0..WAVES {
            let [x, y, z, phase] = [(); 4].map(|()| next_number(&mut state));
            let direction = DVec3::new(x, y, z).normalize_or(DVec3::Y);
            waves.push(Wave {
                along: direction * 3.0 * 2f64.powi(octave),
                phase: std::f64::consts::PI * phase,
                height: 0.5f64.powi(octave) / total,
            });
        }
    }
    waves
}

/// The next number in [−1, 1) of a generator of 64 bits (SplitMix, Steele et al. 2014).
fn next_number(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut bits = *state;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Σ height·sin(along·p + phase), in [−1, 1].
fn height(waves: &[Wave], p: DVec3) -> f64 {
    let mut sum = 0.0;
    for wave in waves {
        sum += wave.height * (wave.along.dot(p) + wave.phase).sin();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Shading, Sides, TriangleMesh};
    use merlkit::render::Shape;

    #[test]
    fn equal_seeds_give_equal_bumps_within_the_amplitude() {
        let bumps = displace_sphere(2.0, 0.2, 9, 7).unwrap();
        assert_eq!(bumps, displace_sphere(2.0, 0.2, 9, 7).unwrap());
        assert_ne!(bumps, displace_sphere(2.0, 0.2, 9, 8).unwrap());
        assert_eq!(bumps.faces.len(), 8 * 81);
        let radii = bumps.vertices.iter().map(|v| v.length());
        assert!(radii.clone().all(|r| (1.6..=2.4).contains(&r)));
        let (least, most) = radii.fold((9.0, 0.0), |(a, b), r| (f64::min(a, r), f64::max(b, r)));
        assert!(most - least > 0.2, "{least} {most}");
    }

    /// Without bumps it encloses a convex solid, which is proved from its faces: they are all there and point outwards.
    #[test]
    fn it_is_closed_and_seen_from_outside() {
        let round = displace_sphere(1.0, 0.0, 5, 0).unwrap();
        let mesh = TriangleMesh::build(&round, Sides::Outer, Shading::Flat).unwrap();
        assert!(mesh.is_convex());
        let both = TriangleMesh::build(&round, Sides::Both, Shading::Flat).unwrap();
        assert!(!both.is_convex());
        let bumps = displace_sphere(1.0, 0.3, 12, 1).unwrap();
        let mesh = TriangleMesh::build(&bumps, Sides::Outer, Shading::Flat).unwrap();
        assert!(!mesh.is_convex());
    }
}
