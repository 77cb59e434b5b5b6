//! Meshes that emit light.

use std::collections::HashSet;
use std::fmt;

use glam::{DVec2, DVec3};
use merlkit::color::Rgb;
use merlkit::light::{Emission, Light, LightSample};
use merlkit::render::{Ray, Shape};
use merlkit::{Error, Result};

use crate::mesh::{Shading, Sides, TriangleMesh};
use crate::mesh_data::MeshData;

/// How much nearer than its light a luminous object may be met, in units of the distance: light and object are one surface, whose
/// distance each computes with roundings of its own.
const CLEARANCE: f64 = 1e-6;

/// The nearest light, in units of the largest coordinate of the point that it shines on, and of the mesh: the point may lie on the mesh,
/// where a direction that rounding turns below the surface would find what it leaves. The renderer has the same limits for
/// objects.
const LEAST_DISTANCE: f64 = 1e-6;
const LEAST_DISTANCE_OF_EXTENT: f64 = 1e-8;

/// The light of a mesh that emits equal radiance from every point, in all directions from which the mesh is seen.
///
/// The mesh is to be an object of the scene as well, which hides the light of its far side.
pub(crate) struct MeshLight {
    /// With flat shading, world space.
    mesh: TriangleMesh,
    sides: Sides,
    /// In the order of `sums`.
    triangles: Vec<[DVec3; 3]>,
    /// The area of the triangles up to and with each of them.
    sums: Vec<f64>,
    radiance: Rgb,
    /// Its largest coordinate.
    extent: f64,
}

impl MeshLight {
    /// The light of the triangles of a mesh in world space. Triangles that are there twice count once.
    ///
    /// # Errors
    /// Those of [`TriangleMesh::build`]; [`Error::Argument`] for radiance that is negative or not finite.
    pub(crate) fn build(data: &MeshData, sides: Sides, radiance: Rgb) -> Result<Self> {
        if !(radiance.is_finite() && radiance.min_element() >= 0.0) {
            let what = format!("an emission of {radiance}");
            return Err(Error::argument(what, "give finite channels ≥ 0"));
        }
        let mesh = TriangleMesh::build(data, sides, Shading::Flat)?;
        // Step 1: the triangles, each once.
        let mut known = HashSet::new();
        let mut triangles = Vec::new();
        for &face in &data.faces {
            let corners = data.corners(face);
            if known.insert(sorted_bits(corners)) {
                triangles.push(corners);
            }
        }
        // Step 2: sums of their areas, |(b − a) × (c − a)|/2.
        let mut sums = Vec::with_capacity(triangles.len());
        let mut sum = 0.0;
        for corners in &triangles {
            sum += 0.5 * facing(*corners).length();
            sums.push(sum);
        }
        let [low, high] = mesh.bounds();
        Ok(Self {
            extent: low.abs().max(high.abs()).max_element(),
            mesh,
            sides,
            triangles,
            sums,
            radiance,
        })
    }

    /// Area of all triangles.
    fn area(&self) -> f64 {
        self.sums.last().copied().unwrap_or_default()
    }

    /// Below this distance from a point nothing counts.
    fn least_distance(&self, from: DVec3) -> f64 {
        let least = LEAST_DISTANCE * from.abs().max_element();
        least.max(LEAST_DISTANCE_OF_EXTENT * self.extent)
    }

    /// A point uniform in area, and the unit normal of its triangle; `None` on one of no area.
    fn choose_point(&self, u: DVec2) -> Option<[DVec3; 2]> {
        // Step 1: the triangle whose part of [0, area) holds u.x·area.
        let x = u.x * self.area();
        let last = self.triangles.len().checked_sub(1)?;
        let k = self.sums.partition_point(|sum| *sum <= x).min(last);
        let before = if k == 0 { 0.0 } else { self.sums[k - 1] };
        // Step 2: a point uniform in it. With r where x is within the part, s = √r has the density 2s of strips parallel to bc.
        let r = ((x - before) / (self.sums[k] - before)).clamp(0.0, 1.0);
        let s = r.sqrt();
        let [a, b, c] = self.triangles[k];
        let point = (1.0 - s) * a + s * ((1.0 - u.y) * b + u.y * c);
        Some([point, facing([a, b, c]).try_normalize()?])
    }

    /// Density per solid angle of points uniform in area, where a ray of length d meets a surface with this normal: d²/(A·cos). `None`
    /// along the surface, and from a side that is dark.
    fn pdf(&self, direction: DVec3, normal: DVec3, distance: f64) -> Option<f64> {
        let cos = -normal.dot(direction);
        let cos = match self.sides {
            Sides::Both => cos.abs(),
            Sides::Outer => cos,
        };
        let pdf = distance * distance / (self.area() * cos);
        (pdf > 0.0 && pdf.is_finite()).then_some(pdf)
    }
}

/// The mesh by a number that follows from its coordinates, and what it emits.
impl fmt::Debug for MeshLight {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("MeshLight")
            .field("mesh", &self.mesh)
            .field("radiance", &self.radiance)
            .finish_non_exhaustive()
    }
}

/// Along the normal, with twice the area for its length.
fn facing([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The same for a triangle in whatever order its corners are.
fn sorted_bits(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    let mut bits = corners.map(|corner| corner.to_array().map(f64::to_bits));
    bits.sort_unstable();
    bits
}

impl Light for MeshLight {
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        let [point, normal] = self.choose_point(u)?;
        let (wi, distance) = ((point - from).try_normalize()?, point.distance(from));
        if distance <= self.least_distance(from) {
            return None;
        }
        Some(LightSample {
            wi,
            // The object is not to hide its own light.
            distance: distance * (1.0 - CLEARANCE),
            radiance: self.radiance,
            pdf: self.pdf(wi, normal, distance)?,
        })
    }

    /// The nearest point of the mesh emits. What is farther along the ray is hidden by it.
    ///
    /// A direction is sampled through its nearest point with the density of that point. Through a farther one it is sampled as well,
    /// but the object then hides the light, so that for what is seen the density is that of the nearest point alone.
    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        let ray = Ray {
            origin: from,
            direction,
        };
        let least = self.least_distance(from);
        let hit = self.mesh.intersect(&ray, least, f64::INFINITY)?;
        // The object itself is met at this distance, but for rounding.
        if hit.distance * (1.0 - CLEARANCE) >= reach {
            return None;
        }
        Some(Emission {
            radiance: self.radiance,
            pdf: self.pdf(direction, hit.normal, hit.distance)?,
        })
    }

    fn hull(&self) -> Vec<DVec3> {
        self.mesh.extremes().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displace_sphere;
    use merlkit::points::PointSet;

    /// Seen from here the lamps are large, and some of their triangles face away.
    const FROM: DVec3 = DVec3::new(0.3, 2.0, 0.4);

    /// Two triangles of different sizes, in two planes.
    fn open_lamp(sides: Sides) -> MeshLight {
        let data = MeshData {
            vertices: vec![
                DVec3::ZERO,
                DVec3::new(2.0, 0.1, 0.0),
                DVec3::new(0.2, 0.0, 1.0),
                DVec3::new(-0.5, 0.4, 0.1),
            ],
            normals: Vec::new(),
            // The last one is the first again, and counts once.
            faces: vec![[0, 1, 2], [0, 2, 3], [2, 0, 1]],
        };
        MeshLight::build(&data, sides, Rgb::ONE).unwrap()
    }

    fn closed_lamp() -> MeshLight {
        let data = displace_sphere(1.0, 0.3, 6, 5).unwrap();
        MeshLight::build(&data, Sides::Both, Rgb::ONE).unwrap()
    }

    /// χ² of the points in each triangle against areas, over the degrees of freedom.
    fn chi_square(light: &MeshLight, expected: &[f64]) -> f64 {
        let draws = 100_000;
        let mut counts = vec![0.0; light.triangles.len()];
        for i in 0..draws {
            let u = PointSet::Random.point(1, i, 0).as_dvec2();
            let [point, _] = light.choose_point(u).unwrap();
            // The triangle whose plane and edges the point is nearest to.
            let distances = light.triangles.iter().map(|t| distance_to(*t, point));
            let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            counts[nearest.unwrap().0] += 1.0;
        }
        let sum: f64 = expected.iter().sum();
        let mut chi_square = 0.0;
        for (count, area) in counts.iter().zip(expected) {
            let mean = draws as f64 * area / sum;
            chi_square += (count - mean).powi(2) / mean;
        }
        chi_square / (counts.len() - 1) as f64
    }

    /// How much larger the three triangles with a point are than the one without: 0 for a point in it.
    fn distance_to([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
        let parts = [[a, b, point], [b, c, point], [c, a, point]].map(|t| facing(t).length());
        parts.iter().sum::<f64>() / facing([a, b, c]).length() - 1.0
    }

    /// With 287 degrees of freedom 1.3 is exceeded once in 2000 runs; areas that are 10 % wrong in half of the triangles are far beyond it.
    #[test]
    fn triangles_are_chosen_by_their_areas() {
        let light = closed_lamp();
        let mut areas: Vec<f64> = light
            .triangles
            .iter()
            .map(|t| facing(*t).length())
            .collect();
        assert_eq!(areas.len(), 288);
        let found = chi_square(&light, &areas);
        assert!(found < 1.3, "{found}");
        for area in areas.iter_mut().step_by(2) {
            *area *= 1.1;
        }
        let wrong = chi_square(&light, &areas);
        assert!(wrong > 1.6, "{wrong}");
        assert_eq!(open_lamp(Sides::Both).triangles.len(), 2);
    }

    /// What is sampled and seen is emitted along the ray with the same density, and up to the light only.
    #[test]
    fn what_is_sampled_is_emitted_with_the_same_density() {
        for light in [open_lamp(Sides::Both), closed_lamp()] {
            let (mut seen, mut hidden) = (0, 0);
            for i in 0..4000 {
                let u = PointSet::Random.point(2, i, 0).as_dvec2();
                let s = light.sample(FROM, u).unwrap();
                let emission = light.emitted_along(FROM, s.wi, f64::INFINITY).unwrap();
                let ray = Ray {
                    origin: FROM,
                    direction: s.wi,
                };
                if light.mesh.blocks(&ray, 0.0, s.distance) {
                    hidden += 1;
                    continue;
                }
                seen += 1;
                assert!((emission.pdf / s.pdf - 1.0).abs() < 1e-9);
                // The object is met at the light's distance, which is behind that of the sample.
                let near = s.distance * (1.0 - 1e-9);
                assert!(light.emitted_along(FROM, s.wi, near).is_none());
                assert!(light.emitted_along(FROM, -s.wi, f64::INFINITY).is_none());
            }
            assert!(seen > 1000, "{seen} {hidden}");
            // Half of a closed lamp is behind the other half.
            assert_eq!(hidden > 1000, light.triangles.len() > 2, "{hidden}");
        }
    }

    /// The cosine of a ray with the surface that it meets.
    fn cosine(light: &MeshLight, ray: &Ray) -> f64 {
        let hit = light.mesh.intersect(ray, 0.0, f64::INFINITY).unwrap();
        hit.normal.dot(ray.direction).abs()
    }

    /// ∫ pdf·cos dω over what is seen is the mean cosine of samples that are seen, of others 0. Without the cosine, which bounds it, the
    /// integral by uniform directions would have no variance, since d²/(A·cos) has none.
    #[test]
    fn densities_integrate_to_what_samples_see() {
        let light = closed_lamp();
        let draws = 400_000;
        // Sums and sums of squares, by uniform directions and by samples.
        let (mut uniform, mut sampled) = ([0.0; 2], [0.0; 2]);
        for i in 0..draws {
            let u = PointSet::Random.point(3, i, 0).as_dvec2();
            // Uniform over the sphere, of the density 1/4π.
            let z = 1.0 - 2.0 * u.x;
            let (sin, cos) = (std::f64::consts::TAU * u.y).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let mut ray = Ray {
                origin: FROM,
                direction: DVec3::new(r * cos, r * sin, z),
            };
            if let Some(emission) = light.emitted_along(FROM, ray.direction, f64::INFINITY) {
                let value = emission.pdf * cosine(&light, &ray) * 2.0 * std::f64::consts::TAU;
                uniform = [uniform[0] + value, uniform[1] + value * value];
            }
            let s = light.sample(FROM, u).unwrap();
            ray.direction = s.wi;
            if !light.mesh.blocks(&ray, 0.0, s.distance) {
                let value = cosine(&light, &ray);
                sampled = [sampled[0] + value, sampled[1] + value * value];
            }
        }
        let n = draws as f64;
        let [integral, seen] = [uniform, sampled].map(|sums| sums[0] / n);
        let [a, b] = [uniform, sampled].map(|sums| (sums[1] / n - (sums[0] / n).powi(2)) / n);
        let error = (a + b).sqrt();
        let z = (integral - seen) / error;
        assert!(z.abs() < 4.0, "{integral} {seen}: {z} standard errors");
        // A density that is wrong by a twentieth would be seen.
        assert!(error < 0.01 * seen, "{error} {seen}");
    }

    #[test]
    fn one_side_is_dark_where_the_mesh_is_seen_from_outside() {
        let lamp = open_lamp(Sides::Outer);
        // Corners are counter-clockwise as seen from below.
        let (mut above, mut below) = (0, 0);
        for i in 0..1000 {
            let u = PointSet::Random.point(4, i, 0).as_dvec2();
            above += usize::from(lamp.sample(FROM, u).is_some());
            below += usize::from(lamp.sample(-FROM, u).is_some());
        }
        assert_eq!((above, below), (0, 1000));
        let up = lamp.emitted_along(DVec3::new(0.4, -1.0, 0.3), DVec3::Y, f64::INFINITY);
        let down = lamp.emitted_along(DVec3::new(0.4, 1.0, 0.3), DVec3::NEG_Y, f64::INFINITY);
        assert!(up.is_some() && down.is_none());
    }

    /// A point of the lamp itself sees other parts of it, and not what it lies on.
    #[test]
    fn a_point_of_the_lamp_does_not_find_itself() {
        let light = open_lamp(Sides::Both);
        for i in 0..1000 {
            let u = PointSet::Random.point(5, i, 0).as_dvec2();
            let [point, normal] = light.choose_point(u).unwrap();
            for away in [normal, -normal] {
                let along = (away + DVec3::new(1e-3, 2e-3, 0.0)).normalize();
                assert!(light.emitted_along(point, along, 0.1).is_none());
            }
        }
        let bad = Rgb::new(1.0, -1.0, 1.0);
        let data = displace_sphere(1.0, 0.0, 2, 0).unwrap();
        assert!(MeshLight::build(&data, Sides::Both, bad).is_err());
    }
}
