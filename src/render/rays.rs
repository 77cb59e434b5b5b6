//! Rays in columns, and what they meet.

use glam::DVec3;

/// What is called the object of a ray that meets none.
pub(super) const NOTHING: u32 = u32::MAX;

/// Rays of paths or of drawn directions, and what they meet, in columns of one length. Those of what they meet are filled by
/// [`super::scene::Scene::find_hits`].
#[derive(Default)]
pub(super) struct Rays {
    /// Whose each is: of a path its position in the bundle, of a drawn direction that of its vertex in the run.
    pub(super) owners: Vec<u32>,
    pub(super) from: Vec<DVec3>,
    /// Unit directions.
    pub(super) along: Vec<DVec3>,
    /// Of a path its throughput, of a drawn direction f_r·cos/pdf.
    pub(super) weights: Vec<DVec3>,
    /// The density that each direction was drawn with; of no meaning for camera rays and mirror directions.
    pub(super) pdfs: Vec<f64>,
    /// The objects that the rays start on, or [`NOTHING`].
    pub(super) leaving: Vec<u32>,
    /// Distances from which on they meet an object, while it is intersected.
    pub(super) near: Vec<f64>,
    /// Distances to what they had met before that.
    pub(super) before: Vec<f64>,
    /// Distances to what they meet, or infinity.
    pub(super) reach: Vec<f64>,
    /// The objects that they meet, or [`NOTHING`].
    pub(super) objects: Vec<u32>,
    /// Normals there; of no meaning without an object.
    pub(super) normals: Vec<DVec3>,
}

/// A ray to be added to [`Rays`].
#[derive(Clone, Copy)]
pub(super) struct NewRay {
    pub(super) owner: u32,
    pub(super) from: DVec3,
    pub(super) along: DVec3,
    pub(super) weight: DVec3,
    pub(super) pdf: f64,
    pub(super) leaving: u32,
}

impl Rays {
    pub(super) fn len(&self) -> usize {
        self.owners.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.owners.is_empty()
    }

    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        let Self {
            owners,
            from,
            along,
            weights,
            pdfs,
            leaving,
            near: _,
            before: _,
            reach,
            objects,
            normals,
        } = self;
        owners.clear();
        from.clear();
        along.clear();
        weights.clear();
        pdfs.clear();
        leaving.clear();
        reach.clear();
        objects.clear();
        normals.clear();
    }

    /// Adds a ray that has met nothing so far.
    #[inline(always)]
    pub(super) fn push(&mut self, ray: NewRay) {
        self.owners.push(ray.owner);
        self.from.push(ray.from);
        self.along.push(ray.along);
        self.weights.push(ray.weight);
        self.pdfs.push(ray.pdf);
        self.leaving.push(ray.leaving);
    }

    /// Makes `count` camera rays out of one point, each of the path in its position, whose directions are still to be filled in.
    pub(super) fn begin(&mut self, count: usize, eye: DVec3) {
        self.owners.clear();
        self.owners.extend(0..count as u32);
        refill(&mut self.from, count, eye);
        refill(&mut self.along, count, DVec3::ZERO);
        refill(&mut self.weights, count, DVec3::ONE);
        refill(&mut self.pdfs, count, 0.0);
        refill(&mut self.leaving, count, NOTHING);
    }

    /// Forgets what the rays meet.
    pub(super) fn forget_hits(&mut self) {
        let count = self.len();
        refill(&mut self.reach, count, f64::INFINITY);
        refill(&mut self.objects, count, NOTHING);
        refill(&mut self.normals, count, DVec3::ZERO);
    }

    /// Keeps the rays along which there is light, in their order, and forgets what they meet.
    pub(super) fn keep_lit(&mut self, light: &[DVec3]) {
        let mut kept = 0;
        for (k, light) in light.iter().enumerate() {
            if *light == DVec3::ZERO {
                continue;
            }
            self.owners[kept] = self.owners[k];
            self.from[kept] = self.from[k];
            self.along[kept] = self.along[k];
            self.weights[kept] = self.weights[k];
            self.pdfs[kept] = self.pdfs[k];
            self.leaving[kept] = self.leaving[k];
            kept += 1;
        }
        self.owners.truncate(kept);
        self.from.truncate(kept);
        self.along.truncate(kept);
        self.weights.truncate(kept);
        self.pdfs.truncate(kept);
        self.leaving.truncate(kept);
        self.forget_hits();
    }

    /// A ray, with what it carries.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> NewRay {
        NewRay {
            owner: self.owners[k],
            from: self.from[k],
            along: self.along[k],
            weight: self.weights[k],
            pdf: self.pdfs[k],
            leaving: self.leaving[k],
        }
    }

    /// Adds a ray of others, with what it carries and meets.
    pub(super) fn push_from(&mut self, others: &Self, k: usize, weight: DVec3) {
        self.push(NewRay {
            weight,
            ..others.get(k)
        });
        self.reach.push(others.reach[k]);
        self.objects.push(others.objects[k]);
        self.normals.push(others.normals[k]);
    }
}

/// Makes an array of `count` elements that are all `value`.
pub(super) fn refill<T: Clone>(array: &mut Vec<T>, count: usize, value: T) {
    array.clear();
    array.resize(count, value);
}
