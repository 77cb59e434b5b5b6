//! Triangle meshes, ready to be intersected.

use std::collections::HashSet;
use std::fmt;

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use merlkit::render::{Intersection, Ray, Shape};
use merlkit::{Error, Result};

use crate::convexity::{Form, find_form};
use crate::hierarchy::Hierarchy;
use crate::mesh_data::MeshData;
use crate::triangle::{ShearedRay, Triangle, TriangleHit};

/// From where the triangles of a mesh are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// From both sides, each of which reflects, such as the walls of a room.
    #[default]
    Both,
    /// From outside, where their corners appear counter-clockwise: a solid, whose inside nobody enters. Only such a mesh can be
    /// convex with a volume.
    Outer,
}

/// Which normals reflect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// Those of the triangles. The surface reflects what is in front of it, no more and no less.
    #[default]
    Flat,
    /// Those of the vertices, interpolated. A direction that is above the interpolated normal's plane and below the triangle's
    /// finds the mesh itself, so that no light leaks through, and the surface is darker where the two differ much.
    Smooth,
}

/// Vertices up to which they all count for [`Shape::support`]; of larger meshes the corners of their box do.
const MOST_EXTREMES: usize = 256;

/// An opaque surface of triangles.
///
/// See the crate's documentation for an example.
#[derive(Clone)]
pub struct TriangleMesh {
    /// In the order of the hierarchy.
    triangles: Vec<Triangle>,
    /// Normals of the triangles' corners; none with flat shading.
    normals: Vec<[DVec3; 3]>,
    hierarchy: Hierarchy,
    sides: Sides,
    form: Form,
    dropped: usize,
    /// Points whose convex hull holds the mesh.
    extremes: Vec<DVec3>,
}

impl TriangleMesh {
    /// Checks a mesh and makes it ready. Triangles of no area are dropped.
    ///
    /// # Errors
    /// As [`MeshData::check`], and [`Error::Argument`] for a mesh in which no triangle has an area.
    pub fn build(data: &MeshData, sides: Sides, shading: Shading) -> Result<Self> {
        data.check()?;
        let faces = data.faces_with_area();
        let dropped = data.faces.len() - faces.len();
        if faces.is_empty() {
            let what = format!(
                "a mesh of {} triangles, none of which has an area",
                data.faces.len()
            );
            return Err(Error::argument(what, "give triangles with three corners"));
        }
        let given: Vec<[DVec3; 3]> = faces.iter().map(|face| data.corners(*face)).collect();
        let form = find_form(&given);
        let (hierarchy, order) = Hierarchy::build(&given)?;
        let mut triangles = Vec::with_capacity(given.len());
        for k in &order {
            triangles.push(Triangle::new(given[*k as usize]));
        }
        let mut normals = Vec::new();
        if shading == Shading::Smooth {
            let of_vertices = data.vertex_normals();
            for k in &order {
                let face = faces[*k as usize];
                normals.push(face.map(|corner| of_vertices[corner as usize]));
            }
        }
        Ok(Self {
            triangles,
            normals,
            hierarchy,
            sides,
            form,
            dropped,
            extremes: find_extremes(&given),
        })
    }

    /// How many triangles it has.
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many triangles of no area were dropped.
    pub fn dropped_faces(&self) -> usize {
        self.dropped
    }

    /// Points whose convex hull holds the mesh.
    pub(crate) fn extremes(&self) -> &[DVec3] {
        &self.extremes
    }

    /// The least and the largest coordinates of its triangles.
    pub fn bounds(&self) -> [DVec3; 2] {
        bound(&self.extremes)
    }

    /// Where the ray meets a triangle that it sees, between `near` and `far`.
    #[inline(always)]
    fn meet(&self, ray: &ShearedRay, k: usize, near: f64, far: f64) -> Option<TriangleHit> {
        let hit = ray.meet(&self.triangles[k])?;
        let seen = self.sides == Sides::Both || hit.from_front;
        (seen && hit.distance > near && hit.distance < far).then_some(hit)
    }

    /// The normal that reflects where a ray meets a triangle: it points to where the ray comes from.
    #[inline(always)]
    fn normal(&self, k: usize, hit: &TriangleHit, direction: DVec3) -> DVec3 {
        let [a, b, c] = self.triangles[k].corners();
        let outward = (b - a).cross(c - a).normalize_or(-direction);
        let flat = if hit.from_front { outward } else { -outward };
        let Some([na, nb, nc]) = self.normals.get(k) else {
            return flat;
        };
        let mixed = hit.weights.x * *na + hit.weights.y * *nb + hit.weights.z * *nc;
        let Some(smooth) = mixed.try_normalize() else {
            return flat;
        };
        // Normals of a file may point inwards. On either side the one that is above the triangle counts.
        let smooth = if smooth.dot(flat) < 0.0 {
            -smooth
        } else {
            smooth
        };
        // Near the outline an interpolated normal can turn away from the ray, which nothing would be reflected to.
        match smooth.dot(direction) < 0.0 {
            true => smooth,
            false => flat,
        }
    }

    /// The nearest triangle that the ray meets.
    #[inline(always)]
    fn find_first<S: Simd>(&self, simd: S, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut first: Option<(usize, TriangleHit)> = None;
        self.hierarchy.find_first(
            simd,
            ray,
            near,
            far,
            #[inline(always)]
            |k| {
                let least = first.as_ref().map_or(far, |(_, hit)| hit.distance);
                match self.meet(&sheared, k, near, least) {
                    Some(hit) => {
                        first = Some((k, hit));
                        hit.distance
                    }
                    None => f64::INFINITY,
                }
            },
        );
        let (k, hit) = first?;
        Some(Intersection {
            distance: hit.distance,
            normal: self.normal(k, &hit, ray.direction),
        })
    }

    /// [`Self::find_first`] for each ray.
    #[inline(always)]
    fn find_each<S: Simd>(
        &self,
        simd: S,
        from: &[DVec3],
        along: &[DVec3],
        near: &[f64],
        reach: &mut [f64],
        normals: &mut [DVec3],
    ) {
        for (k, reach) in reach.iter_mut().enumerate() {
            let ray = Ray {
                origin: from[k],
                direction: along[k],
            };
            if let Some(met) = self.find_first(simd, &ray, near[k], *reach) {
                *reach = met.distance;
                normals[k] = met.normal;
            }
        }
    }

    /// Whether the ray meets any triangle.
    #[inline(always)]
    fn find_any<S: Simd>(&self, simd: S, ray: &Ray, near: f64, far: f64) -> bool {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        self.hierarchy.find_any(
            simd,
            ray,
            near,
            far,
            #[inline(always)]
            |k| self.meet(&sheared, k, near, far).is_some(),
        )
    }
}

// Compiled for each level of vector instructions; the machine's is chosen at run time.
impl Shape for TriangleMesh {
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        dispatch!(Level::new(), simd => self.find_first(simd, ray, near, far))
    }

    fn intersect_batch(
        &self,
        from: &[DVec3],
        along: &[DVec3],
        near: &[f64],
        reach: &mut [f64],
        normals: &mut [DVec3],
    ) {
        dispatch!(Level::new(), simd => self.find_each(simd, from, along, near, reach, normals));
    }

    fn blocks(&self, ray: &Ray, near: f64, far: f64) -> bool {
        dispatch!(Level::new(), simd => self.find_any(simd, ray, near, far))
    }

    fn is_convex(&self) -> bool {
        // Interpolated normals reflect into directions below the surface.
        let flat_shading = self.normals.is_empty();
        match self.form {
            Form::Flat(_) => flat_shading,
            Form::ConvexSolid => flat_shading && self.sides == Sides::Outer,
            Form::Other => false,
        }
    }

    fn support(&self, along: DVec3) -> f64 {
        let products = self.extremes.iter().map(|corner| along.dot(*corner));
        products.fold(f64::NEG_INFINITY, f64::max)
    }

    fn plane_normal(&self) -> Option<DVec3> {
        match self.form {
            Form::Flat(normal) => Some(normal),
            Form::ConvexSolid | Form::Other => None,
        }
    }
}

/// What it is, and a number that follows from all of its coordinates: a text that is short, and differs between meshes.
impl fmt::Debug for TriangleMesh {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        // h ← (h xor bits)·prime (Fowler, Noll and Vo).
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        let corners = self.triangles.iter().map(Triangle::corners);
        for point in corners.chain(self.normals.iter().copied()).flatten() {
            for coordinate in point.to_array() {
                hash = (hash ^ coordinate.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
                hash ^= hash >> 29;
            }
        }
        out.debug_struct("TriangleMesh")
            .field("faces", &self.triangles.len())
            .field("sides", &self.sides)
            .field("smooth", &!self.normals.is_empty())
            .field("hash", &format_args!("{hash:016x}"))
            .finish()
    }
}

fn bound(points: &[DVec3]) -> [DVec3; 2] {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for point in points {
        low = low.min(*point);
        high = high.max(*point);
    }
    [low, high]
}

/// All corners, or where they are many those of their box.
fn find_extremes(triangles: &[[DVec3; 3]]) -> Vec<DVec3> {
    let mut corners = triangles.concat();
    // Corners of neighbours are one point. Six triangles meet in most of them.
    if corners.len() <= 6 * MOST_EXTREMES {
        let mut known = HashSet::new();
        let mut different = corners.clone();
        different.retain(|corner| known.insert(corner.to_array().map(f64::to_bits)));
        if different.len() <= MOST_EXTREMES {
            return different;
        }
    }
    let ends = bound(&corners);
    corners.clear();
    for i in 0..8usize {
        corners.push(DVec3::new(
            ends[i & 1].x,
            ends[i >> 1 & 1].y,
            ends[i >> 2].z,
        ));
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{displace_sphere, jar_profile, revolve, smooth_profile};

    /// Numbers in [−1, 1) that look random.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }
    }

    fn bumps(centre: DVec3, scale: f64) -> MeshData {
        let mut data = displace_sphere(1.0, 0.3, 12, 3).unwrap();
        for vertex in &mut data.vertices {
            *vertex = centre + scale * *vertex;
        }
        data
    }

    fn flat_mesh(data: &MeshData) -> TriangleMesh {
        TriangleMesh::build(data, Sides::Both, Shading::Flat).unwrap()
    }

    /// The nearest of all triangles, without boxes.
    fn find_by_trying_all(mesh: &TriangleMesh, ray: &Ray) -> Option<f64> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let hits = (0..mesh.face_count()).filter_map(|k| {
            let hit = mesh.meet(&sheared, k, 0.0, f64::INFINITY)?;
            Some(hit.distance)
        });
        hits.reduce(f64::min)
    }

    /// Small, large, far off the origin of space, and seen from far away.
    #[test]
    fn boxes_leave_out_no_triangle() {
        let mut numbers = Numbers(1);
        for (centre, scale, distance) in [
            (DVec3::ZERO, 1.0, 3.0),
            (DVec3::new(3e5, -2e5, 1e4), 1e-3, 5e-3),
            (DVec3::new(1.0, 2.0, 3.0), 1e-6, 1e3),
            (DVec3::new(-400.0, 278.0, 0.0), 500.0, 2000.0),
        ] {
            let mesh = flat_mesh(&bumps(centre, scale));
            let mut met = 0;
            for _ in 0..400 {
                let origin = centre + distance * numbers.vector();
                let aim = centre + scale * numbers.vector();
                let direction = (aim - origin).normalize();
                let ray = Ray { origin, direction };
                let hit = mesh
                    .intersect(&ray, 0.0, f64::INFINITY)
                    .map(|hit| hit.distance);
                assert_eq!(hit, find_by_trying_all(&mesh, &ray));
                let far = hit.unwrap_or(f64::MAX) * (1.0 + 1e-12);
                assert_eq!(mesh.blocks(&ray, 0.0, far), hit.is_some());
                met += usize::from(hit.is_some());
            }
            assert!(met > 200, "{met}");
        }
    }

    /// Rays along the axes divide by 0.
    #[test]
    fn rays_along_the_axes_find_what_trying_all_finds() {
        let mesh = flat_mesh(&bumps(DVec3::ZERO, 1.0));
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z] {
            for shift in [DVec3::ZERO, DVec3::new(1e-9, 0.2, 0.1), DVec3::splat(0.25)] {
                let ray = Ray {
                    origin: shift - 4.0 * axis,
                    direction: axis,
                };
                let hit = mesh.intersect(&ray, 0.0, f64::INFINITY).unwrap();
                assert_eq!(Some(hit.distance), find_by_trying_all(&mesh, &ray));
            }
        }
    }

    /// A ray to a vertex or to a point of an edge meets the closed mesh: there is no slit between triangles.
    #[test]
    fn no_ray_slips_between_triangles() {
        let mut numbers = Numbers(2);
        for (centre, scale) in [(DVec3::ZERO, 1.0), (DVec3::new(278.0, -3e3, 0.7), 0.03)] {
            let data = bumps(centre, scale);
            let mesh = flat_mesh(&data);
            for face in &data.faces {
                let [a, b, _] = data.corners(*face);
                let part = 0.5 + 0.5 * numbers.next();
                // From inside, so that no other part of the mesh can take the place of what is missed.
                let origin = centre + 0.1 * scale * numbers.vector();
                for aim in [a, a.lerp(b, part), a.lerp(b, 0.5)] {
                    let direction = (aim - origin).normalize();
                    let hit = mesh.intersect(&Ray { origin, direction }, 0.0, f64::INFINITY);
                    let distance = hit.map(|hit| hit.distance).unwrap();
                    assert!((distance / aim.distance(origin) - 1.0).abs() < 1e-6);
                }
            }
        }
    }

    /// What the renderer does after a hit: the ray starts where the surface is but for rounding, in any direction above it, as
    /// f32 has it. Of a convex surface no such ray may come back.
    #[test]
    fn a_ray_does_not_meet_the_surface_that_it_leaves() {
        let mut numbers = Numbers(3);
        for (centre, scale) in [(DVec3::ZERO, 1.0), (DVec3::new(-4e4, 9e4, 10.0), 0.5)] {
            let mut data = displace_sphere(scale, 0.0, 8, 0).unwrap();
            for vertex in &mut data.vertices {
                *vertex += centre;
            }
            let mesh = flat_mesh(&data);
            let mut tried = 0;
            for _ in 0..3000 {
                let origin = centre + 3.0 * scale * numbers.vector().normalize();
                let aim = centre + 0.7 * scale * numbers.vector();
                let ray = Ray {
                    origin,
                    direction: (aim - origin).normalize(),
                };
                let Some(hit) = mesh.intersect(&ray, 0.0, f64::INFINITY) else {
                    continue;
                };
                let from = ray.point_at(hit.distance);
                let mut along = numbers.vector();
                // Mostly grazing.
                along -= hit.normal * along.dot(hit.normal) * (1.0 - 1e-6);
                along *= along.dot(hit.normal).signum();
                let direction = along.as_vec3().as_dvec3().normalize();
                // Rounding to f32 takes some of them below the surface, where they find its other side.
                if direction.dot(hit.normal) < 1e-8 {
                    continue;
                }
                tried += 1;
                let leaving = Ray {
                    origin: from,
                    direction,
                };
                let least = 1e-6 * from.abs().max_element();
                assert!(!mesh.blocks(&leaving, least, f64::INFINITY));
            }
            assert!(tried > 1000, "{tried}");
        }
    }

    #[test]
    fn triangles_of_no_area_are_dropped_and_counted() {
        let mut data = bumps(DVec3::ZERO, 1.0);
        let good = data.faces.len();
        data.faces.push([4, 4, 5]);
        data.vertices
            .extend([DVec3::X, 2.0 * DVec3::X, 3.0 * DVec3::X]);
        let last = data.vertices.len() as u32;
        data.faces.push([last - 3, last - 2, last - 1]);
        let mesh = flat_mesh(&data);
        assert_eq!((mesh.face_count(), mesh.dropped_faces()), (good, 2));
        data.faces.drain(..good);
        let refused = TriangleMesh::build(&data, Sides::Both, Shading::Flat);
        assert!(refused.unwrap_err().to_string().contains("area"));
    }

    #[test]
    fn a_room_is_seen_from_inside_and_a_solid_is_not() {
        let ball = displace_sphere(1.0, 0.0, 4, 0).unwrap();
        let ray = Ray {
            origin: DVec3::new(0.1, 0.2, 0.3),
            direction: DVec3::Z,
        };
        let hit = flat_mesh(&ball)
            .intersect(&ray, 0.0, f64::INFINITY)
            .unwrap();
        assert!(hit.normal.z < -0.5);
        let solid = TriangleMesh::build(&ball, Sides::Outer, Shading::Flat).unwrap();
        assert!(solid.intersect(&ray, 0.0, f64::INFINITY).is_none());
    }

    #[test]
    fn interpolated_normals_are_those_of_a_sphere_and_face_the_ray() {
        let mut numbers = Numbers(4);
        let ball = displace_sphere(1.0, 0.0, 16, 0).unwrap();
        let mesh = TriangleMesh::build(&ball, Sides::Both, Shading::Smooth).unwrap();
        assert!(!mesh.is_convex());
        for _ in 0..500 {
            let origin = 3.0 * numbers.vector().normalize();
            let direction = (0.9 * numbers.vector() - origin).normalize();
            let ray = Ray { origin, direction };
            let Some(hit) = mesh.intersect(&ray, 0.0, f64::INFINITY) else {
                continue;
            };
            assert!(hit.normal.dot(direction) < 0.0);
            let round = ray.point_at(hit.distance).normalize();
            assert!(hit.normal.dot(round) > 0.995);
        }
    }

    #[test]
    fn the_support_is_that_of_the_vertices_or_of_their_box() {
        let jar = revolve(&smooth_profile(&jar_profile(), 49), 48).unwrap();
        for data in [bumps(DVec3::ONE, 2.0), jar] {
            let mesh = flat_mesh(&data);
            for along in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.6, 0.0, -0.8)] {
                let products = data.vertices.iter().map(|v| v.dot(along));
                let most = products.fold(f64::NEG_INFINITY, f64::max);
                assert!(mesh.support(along) >= most);
            }
        }
    }
}
