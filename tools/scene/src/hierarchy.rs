//! Boxes in boxes over triangles, so that a ray is tested against few of them.
//!
//! The boxes are in f32, and the triangles in f64. A ray must never miss a box whose triangle it meets. For this reason boxes
//! are taken relative to the middle of the mesh and in units of its size, rays start near the mesh, and every box is widened by
//! more than all roundings on the way together.
//!
//! Which boxes are put into one is decided by the crate obvhs, whose compressed boxes serve graphics processors. A processor with
//! vectors of eight numbers is slowed down by unpacking them, so that boxes are kept as they are here, eight side by side.

use std::time::Duration;

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::{DVec3, Vec3A};
use merlkit::render::Ray;
use merlkit::{Error, Result};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::{Boundable, BvhBuildParams};

/// Half the size of the mesh in the units of the boxes.
const HALF_SIZE: f64 = 16384.0;

/// By how much boxes are widened, in units of [`HALF_SIZE`]. Roundings of f32 to origins, directions and slabs of a ray that is at
/// most four units long amount to 40·2⁻²⁴ = 2.4·10⁻⁶ at most.
const MARGIN: f64 = 4e-6;

/// Levels of boxes for which a walk has room.
const MOST_LEVELS: usize = 30;

/// Components of directions are taken for at least this: in the units of the boxes, no ray moves by one along such an axis.
const LEAST_COMPONENT: f32 = 1e-20;

/// Boxes over the triangles of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    /// The root comes first, and children behind their parents.
    nodes: Vec<Node>,
    middle: DVec3,
    /// Radius of a sphere around the middle that holds all triangles.
    radius: f64,
    /// Units of the boxes in one unit of the mesh.
    scale: f64,
}

/// Up to eight boxes with the same parent.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Node {
    /// Lower x, y and z of the eight boxes, then upper ones. Where there is no box, the lower ones are infinite and the upper ones −∞.
    planes: [[f32; 8]; 6],
    /// Of a box of boxes its node, of a box of triangles the first of them.
    contents: [u32; 8],
    /// How many triangles are in each box; 0 in boxes of boxes.
    counts: [u8; 8],
    /// A bit for each box of boxes.
    inner: u8,
}

/// The box of a triangle, widened.
struct TriangleBox(Aabb);

impl Boundable for TriangleBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A ray in the units of the boxes.
struct BoxRay {
    origin: [f32; 3],
    /// Reciprocals of its direction.
    inverse: [f32; 3],
    /// Which of a box's planes it meets first, of those across x, y and z.
    first: [usize; 3],
    /// In which order it meets the boxes of a node: that at `place ^ octant` for each place, from the last to the first.
    octant: usize,
    /// Where it ends.
    most: f32,
    /// Distance along the given ray to its origin.
    start: f64,
}

/// `ORDER[octant][bits]` moves the bit at each `slot` to `slot ^ octant`.
static ORDER: [[u8; 256]; 8] = order_bits();

impl Hierarchy {
    /// Builds boxes over triangles, of which there is at least one, and puts the triangles into the order of the boxes: `order[k]`
    /// is the position among the given ones of the triangle that [`Self::find_first`] calls `k`.
    ///
    /// # Errors
    /// [`Error::Argument`] for triangles nested so deeply that a walk has no room for it.
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
        let params = BvhBuildParams::medium_build();
        let tree = build_cwbvh(&boxes, params, &mut Duration::default());
        if count_levels(&tree) > MOST_LEVELS {
            return Err(Error::argument(
                "the triangles of a mesh are nested too deeply",
                "cut it into meshes of similar triangles",
            ));
        }
        let hierarchy = Self {
            nodes: unpack(&tree, &boxes),
            middle,
            radius: half.length() * (1.0 + MARGIN),
            scale,
        };
        Ok((hierarchy, tree.primitive_indices))
    }

    /// The part of a ray that is inside the sphere around the mesh, between `near` and `far`, in the units of the boxes.
    #[inline(always)]
    fn clip(&self, ray: &Ray, near: f64, far: f64) -> Option<BoxRay> {
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
        let direction = ray.direction.as_vec3().to_array();
        let mut inverse = [0.0; 3];
        let mut first = [0; 3];
        let mut octant = 0;
        for axis in 0..3 {
            let component = direction[axis];
            inverse[axis] = component
                .abs()
                .max(LEAST_COMPONENT)
                .recip()
                .copysign(component);
            // Lower planes come first in the direction of the axis, upper ones, which are behind those, against it.
            let backwards = component.is_sign_negative();
            first[axis] = axis + 3 * usize::from(backwards);
            octant = 2 * octant + usize::from(!backwards);
        }
        Some(BoxRay {
            origin: origin.as_vec3().to_array(),
            inverse,
            first,
            octant,
            most: round_up((end - start) * self.scale),
            start,
        })
    }

    /// Gives `meet` the triangles whose boxes the ray meets between `near` and `far`. It returns the distance at which the ray meets
    /// the triangle, infinite if it does not; boxes that begin beyond the least of these are left out.
    #[inline(always)]
    pub(crate) fn find_first<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        near: f64,
        far: f64,
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let Some(mut ray) = self.clip(ray, near, far) else {
            return;
        };
        self.walk(
            simd,
            &mut ray,
            #[inline(always)]
            |ray, k| {
                let distance = round_up((meet(k) - ray.start) * self.scale);
                if distance < ray.most {
                    ray.most = distance;
                }
                true
            },
        );
    }

    /// Whether `meets` says yes for a triangle whose box the ray meets between `near` and `far`.
    #[inline(always)]
    pub(crate) fn find_any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        near: f64,
        far: f64,
        mut meets: impl FnMut(usize) -> bool,
    ) -> bool {
        let Some(mut ray) = self.clip(ray, near, far) else {
            return false;
        };
        !self.walk(
            simd,
            &mut ray,
            #[inline(always)]
            |_, k| !meets(k),
        )
    }

    /// Gives `visit` the triangles whose boxes the ray meets before its end, which may be moved meanwhile, roughly from near to
    /// far, until it says no. Whether it never did.
    #[inline(always)]
    fn walk<S: Simd>(
        &self,
        simd: S,
        ray: &mut BoxRay,
        mut visit: impl FnMut(&mut BoxRay, usize) -> bool,
    ) -> bool {
        let order = &ORDER[ray.octant];
        // Nodes with boxes that are still to be entered, and these.
        let mut waiting = [(0u32, 0u8); MOST_LEVELS];
        let mut count = 0;
        let mut place = 0u32;
        loop {
            // Step 1: the boxes of this node that the ray meets.
            let node = &self.nodes[place as usize];
            let met = node.find_met(simd, ray);
            // Step 2: their triangles.
            let mut leaves = met & !node.inner;
            while leaves != 0 {
                let child = leaves.trailing_zeros() as usize;
                leaves &= leaves - 1;
                let first = node.contents[child] as usize;
                for k in first..first + usize::from(node.counts[child]) {
                    if !visit(ray, k) {
                        return false;
                    }
                }
            }
            // Step 3: the nearest of their boxes of boxes, or of those that wait.
            let mut inner = order[usize::from(met & node.inner)];
            if inner == 0 {
                if count == 0 {
                    return true;
                }
                count -= 1;
                (place, inner) = waiting[count];
            }
            let nearest = inner.ilog2();
            inner ^= 1 << nearest;
            if inner != 0 {
                waiting[count] = (place, inner);
                count += 1;
            }
            place = self.nodes[place as usize].contents[nearest as usize ^ ray.octant];
        }
    }
}

impl Node {
    /// A node without boxes.
    const EMPTY: Self = {
        let (low, high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Self {
            planes: [low, low, low, high, high, high],
            contents: [0; 8],
            counts: [0; 8],
            inner: 0,
        }
    };

    /// A bit for each box that the ray meets.
    #[inline(always)]
    fn find_met<S: Simd>(&self, simd: S, ray: &BoxRay) -> u8 {
        // A ray meets the plane at p at the distance t = (p − o)/d, and is inside a box from the last of the planes that it meets
        // first to the first of the others.
        let mut enter = f32x8::splat(simd, 0.0);
        let mut leave = f32x8::splat(simd, ray.most);
        for axis in 0..3 {
            let first = ray.first[axis];
            let last = 2 * axis + 3 - first;
            let origin = f32x8::splat(simd, ray.origin[axis]);
            let inverse = f32x8::splat(simd, ray.inverse[axis]);
            let first = f32x8::from_slice(simd, &self.planes[first]);
            let last = f32x8::from_slice(simd, &self.planes[last]);
            enter = ((first - origin) * inverse).max(enter);
            leave = ((last - origin) * inverse).min(leave);
        }
        let met: mask32x8<S> = enter.simd_le(leave);
        met.to_bitmask() as u8
    }
}

/// The nodes of a tree without compression, with the boxes of its triangles.
fn unpack(tree: &CwBvh, boxes: &[TriangleBox]) -> Vec<Node> {
    let mut nodes = vec![Node::EMPTY; tree.nodes.len()];
    let mut bounds = vec![Aabb::empty(); tree.nodes.len()];
    // Children come behind their parents, and their boxes are known before those of their parents.
    for (i, packed) in tree.nodes.iter().enumerate().rev() {
        for slot in 0..8 {
            if packed.is_child_empty(slot) {
                continue;
            }
            let node = &mut nodes[i];
            let mut bound = Aabb::empty();
            if packed.is_leaf(slot) {
                let (first, count) = packed.child_primitives(slot);
                for k in first..first + count {
                    let triangle = tree.primitive_indices[k as usize];
                    bound = bound.union(&boxes[triangle as usize].0);
                }
                node.contents[slot] = first;
                node.counts[slot] = count as u8;
            } else {
                let child = packed.child_node_index(slot);
                assert!(child as usize > i, "children come behind their parents");
                bound = bounds[child as usize];
                node.contents[slot] = child;
                node.inner |= 1 << slot;
            }
            for axis in 0..3 {
                node.planes[axis][slot] = bound.min[axis];
                node.planes[3 + axis][slot] = bound.max[axis];
            }
            bounds[i] = bounds[i].union(&bound);
        }
    }
    nodes
}

const fn order_bits() -> [[u8; 256]; 8] {
    let mut order = [[0; 256]; 8];
    let mut i = 0;
    while i < 8 * 256 * 8 {
        let (octant, bits, slot) = (i / 2048, i / 8 % 256, i % 8);
        if bits >> slot & 1 == 1 {
            order[octant][bits] |= 1 << (slot ^ octant);
        }
        i += 1;
    }
    order
}

/// A distance in the units of the boxes, made longer by what boxes are widened by.
#[inline(always)]
fn round_up(distance: f64) -> f32 {
    (distance + MARGIN * HALF_SIZE) as f32
}

/// How many levels of boxes there are.
fn count_levels(tree: &CwBvh) -> usize {
    let mut levels = 0;
    let mut open = vec![(0u32, 1)];
    while let Some((node, level)) = open.pop() {
        let Some(node) = tree.nodes.get(node as usize) else {
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
