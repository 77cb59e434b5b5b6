//! Boxes in boxes over triangles, so that a ray is tested against few of them.
//!
//! The boxes are in f32, and the triangles in f64. A ray must never miss a box whose triangle it meets. For this reason boxes
//! are taken relative to the middle of the mesh and in units of its size, rays start near the mesh, and every box is widened by
//! more than all roundings on the way together.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use merlkit::render::Ray;
use merlkit::{Error, Result};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BoxRay, RayHit};
use obvhs::{Boundable, BvhBuildParams};

/// Half the size of the mesh in the units of the boxes. Traversal ignores boxes that end within 10⁻⁴ of the origin, which is
/// nothing compared with this.
const HALF_SIZE: f64 = 16384.0;

/// By how much boxes are widened, in units of [`HALF_SIZE`]. Roundings of f32 to origins, directions and slabs of a ray that is at
/// most four units long amount to 40·2⁻²⁴ = 2.4·10⁻⁶ at most.
const MARGIN: f64 = 4e-6;

/// Levels of boxes for which traversal has room.
const MOST_LEVELS: u32 = 30;

/// Boxes over the triangles of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    boxes: CwBvh,
    middle: DVec3,
    /// Radius of a sphere around the middle that holds all triangles.
    radius: f64,
    /// Units of the boxes in one unit of the mesh.
    scale: f64,
}

/// The box of a triangle, widened.
struct TriangleBox(Aabb);

impl Boundable for TriangleBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A ray in the units of the boxes, and where its origin is on the given one.
struct ClippedRay {
    ray: BoxRay,
    start: f64,
}

impl Hierarchy {
    /// Builds boxes over triangles, of which there is at least one, and puts the triangles into the order of the boxes: `order[k]`
    /// is the position among the given ones of the triangle that [`Self::find_first`] calls `k`.
    ///
    /// # Errors
    /// [`Error::Argument`] for triangles nested so deeply that traversal has no room for it.
    pub(crate) fn build(triangles: &[[DVec3; 3]]) -> Result<(Self, Vec<u32>)> {
        // Step 1: the middle of all corners, and the largest half side about it.
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for corner in triangles.iter().flatten() {
            low = low.min(*corner);
            high = high.max(*corner);
        }
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        let scale = HALF_SIZE / half.max_element();
        // Step 2: boxes in these units, widened.
        let mut boxes = Vec::with_capacity(triangles.len());
        let margin = Vec3A::splat((MARGIN * HALF_SIZE) as f32);
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| ((corner - middle) * scale).as_vec3a());
            boxes.push(TriangleBox(Aabb::new(
                a.min(b).min(c) - margin,
                a.max(b).max(c) + margin,
            )));
        }
        // Step 3: boxes over boxes.
        let params = BvhBuildParams::fast_build();
        let boxes = build_cwbvh(&boxes, params, &mut Duration::default());
        if count_levels(&boxes) > MOST_LEVELS {
            return Err(Error::argument(
                "the triangles of a mesh are nested too deeply",
                "cut it into meshes of similar triangles",
            ));
        }
        let order = boxes.primitive_indices.clone();
        let hierarchy = Self {
            boxes,
            middle,
            radius: half.length() * (1.0 + MARGIN),
            scale,
        };
        Ok((hierarchy, order))
    }

    /// The part of a ray that is inside the sphere around the mesh, between `near` and `far`, in the units of the boxes.
    #[inline(always)]
    fn clip(&self, ray: &Ray, near: f64, far: f64) -> Option<ClippedRay> {
        // Step 1: where the line enters and leaves the sphere, along ∓ h with h² = r² − |perpendicular|².
        let to_middle = self.middle - ray.origin;
        let along = to_middle.dot(ray.direction);
        let perpendicular = to_middle - along * ray.direction;
        // What is far away is rounded by as much as its distance.
        let radius = self.radius + 1e-14 * to_middle.length();
        let half2 = radius * radius - perpendicular.length_squared();
        if half2 < 0.0 {
            return None;
        }
        let half = half2.sqrt();
        let margin = MARGIN * self.radius;
        let start = (along - half).max(near) - margin;
        let end = (along + half).min(far) + margin;
        if start > end {
            return None;
        }
        // Step 2: the origin moves to the start, near the mesh, where f32 is fine enough.
        let origin = (ray.point_at(start) - self.middle) * self.scale;
        let length = (end - start) * self.scale;
        let ray = BoxRay::new(
            origin.as_vec3a(),
            ray.direction.as_vec3a(),
            0.0,
            round_up(length),
        );
        Some(ClippedRay { ray, start })
    }

    /// Gives `meet` the triangles whose boxes the ray meets between `near` and `far`. It returns the distance at which the ray meets
    /// the triangle, infinite if it does not; boxes that begin beyond the least of these are left out.
    #[inline(always)]
    pub(crate) fn find_first(
        &self,
        ray: &Ray,
        near: f64,
        far: f64,
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let Some(ClippedRay { ray, start }) = self.clip(ray, near, far) else {
            return;
        };
        let mut hit = RayHit::none();
        self.boxes.ray_traverse(ray, &mut hit, |_, k| {
            let distance = (meet(k) - start) * self.scale;
            round_up(distance)
        });
    }

    /// Whether `meets` says yes for a triangle whose box the ray meets between `near` and `far`.
    #[inline(always)]
    pub(crate) fn find_any(
        &self,
        ray: &Ray,
        near: f64,
        far: f64,
        mut meets: impl FnMut(usize) -> bool,
    ) -> bool {
        let Some(ClippedRay { ray, .. }) = self.clip(ray, near, far) else {
            return false;
        };
        let missed = self.boxes.ray_traverse_miss(ray, |_, k| match meets(k) {
            true => -1.0,
            false => f32::INFINITY,
        });
        !missed
    }
}

/// A distance in the units of the boxes, made longer by what boxes are widened by.
#[inline(always)]
fn round_up(distance: f64) -> f32 {
    (distance + MARGIN * HALF_SIZE) as f32
}

/// How many levels of boxes there are.
fn count_levels(boxes: &CwBvh) -> u32 {
    let mut levels = 0;
    let mut open = vec![(0u32, 1u32)];
    while let Some((node, level)) = open.pop() {
        let Some(node) = boxes.nodes.get(node as usize) else {
            continue;
        };
        levels = levels.max(level);
        // A bit of the mask for each child that is a box of boxes; these lie one after another.
        for child in 0..node.imask.count_ones() {
            open.push((node.child_base_idx + child, level + 1));
        }
    }
    levels
}
