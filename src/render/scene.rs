//! A scene: the plan of its effects, and what that calls for, loaded.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::camera::Camera;
use super::plan::{Effect, EffectPlan, PlanRequest};
use super::rays::Rays;
use super::shape::{Floor, Ray, Shape};
use super::spec::{SceneSpec, SphereSpec, Strategy};
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSampler;
use crate::geometry::Frame;
use crate::light::{Light, LightSpec, MapNotes, SkySampling, TurnedLight};
use crate::material::analytic::Lambert;
use crate::sampler::Cosine;
use crate::{Error, Result};

/// How an object reflects.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone)]
pub struct Surface {
    /// Its BRDF.
    pub brdf: Arc<dyn Brdf>,
    /// How directions are drawn; `None` where the plan draws none.
    pub sampler: Option<Arc<dyn DirectionSampler>>,
}

impl Surface {
    /// The local frame at a normal. An anisotropic surface lies as if turned on a lathe: its x runs horizontally, about +y.
    pub(super) fn frame(&self, normal: Vec3) -> Frame {
        if self.brdf.is_isotropic() {
            Frame::from_normal(normal)
        } else {
            Frame::around(normal, Vec3::Y)
        }
    }
}

/// A scene, ready to be rendered by the plan that it holds.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
pub struct Scene {
    pub(super) plan: EffectPlan,
    pub(super) camera: Camera,
    pub(super) depth: u32,
    pub(super) strategy: Strategy,
    pub(super) directions: u32,
    pub(super) transparent: bool,
    pub(super) clamp: f64,
    pub(super) lights: Vec<Arc<dyn Light>>,
    /// The same lights, with what they were loaded from.
    loaded: Vec<LoadedLight>,
    objects: Vec<Object>,
    surfaces: Vec<Option<Surface>>,
}

/// A light and the description that it was loaded from.
struct LoadedLight {
    spec: LightSpec,
    sampling: SkySampling,
    light: Arc<dyn Light>,
}

struct Object {
    shape: Arc<dyn Shape>,
    /// Asked of the shape once.
    is_convex: bool,
    /// The largest coordinate of its points; 0 where it is not known.
    extent: f64,
    /// Position in `surfaces`.
    surface: usize,
}

impl Object {
    fn new(shape: Arc<dyn Shape>, surface: usize) -> Self {
        let mut extent = 0f64;
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let ends = [shape.support(axis), shape.support(-axis)];
            for end in ends.into_iter().filter(|end| end.is_finite()) {
                extent = extent.max(end.abs());
            }
        }
        Self {
            is_convex: shape.is_convex(),
            extent,
            shape,
            surface,
        }
    }
}

/// How far a ray must have come from an object that is not convex before it can meet that object again, in units of its
/// origin's largest coordinate.
///
/// The origin lies on the surface but for rounding, and the direction, which passes through f32, may point below the tangent
/// plane by some 10⁻⁷: nearer hits are no other part of the surface.
const LEAST_RETURN: f64 = 1e-6;

/// The same in units of the object's largest coordinate. Near the origin of space coordinates are small, while what they were
/// computed from is not: rounding by 10⁻¹⁵ of it, at an angle of 10⁻⁷, is 10⁻⁸.
const LEAST_RETURN_OF_EXTENT: f64 = 1e-8;

impl Scene {
    /// Plans `spec`'s effects and loads what the plan calls for. `surface(i, directions)` gives material `i` of
    /// [`SceneSpec::materials`], with a sampler if `directions`; it is called once for each material that is used, in order.
    ///
    /// # Errors
    /// [`Error::Argument`] for a sphere without a radius or an object without a material, a floor, light or strategy outside
    /// its domain, a missing sampler, or a mirror that is not in [`SceneSpec::mirrors`]; what `surface` returns; what
    /// [`crate::light::LightSpec::load`] returns.
    pub fn build(
        spec: &SceneSpec,
        request: PlanRequest,
        surface: impl FnMut(usize, bool) -> Result<Surface>,
    ) -> Result<Self> {
        Self::build_with(&[], spec, request, surface)
    }

    /// [`Self::build`] of a scene that has lights in common with this one: they are not loaded again.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_next(
        &self,
        spec: &SceneSpec,
        request: PlanRequest,
        surface: impl FnMut(usize, bool) -> Result<Surface>,
    ) -> Result<Self> {
        Self::build_with(&self.loaded, spec, request, surface)
    }

    fn build_with(
        known: &[LoadedLight],
        spec: &SceneSpec,
        request: PlanRequest,
        surface: impl FnMut(usize, bool) -> Result<Surface>,
    ) -> Result<Self> {
        check(spec)?;
        let plan = EffectPlan::for_scene(spec, request);
        // Load lights first, so that a missing file is reported before the slow work.
        let loaded = load_lights(known, spec, &plan)?;
        let lights = turn_lights(&loaded, spec.light_turn);
        let mut surfaces = load_surfaces(spec, &plan, surface)?;
        check_mirrors(spec, &surfaces)?;
        let objects = collect_objects(spec, surfaces.len());
        surfaces.extend(spec.floor.map(|reflectance| Some(floor(reflectance))));
        Ok(Self {
            plan,
            camera: spec.camera,
            depth: spec.depth,
            strategy: spec.strategy,
            directions: spec.directions,
            transparent: spec.transparent,
            clamp: spec.clamp.unwrap_or(f64::INFINITY),
            lights,
            loaded,
            objects,
            surfaces,
        })
    }

    /// The plan that the scene was built by, and is rendered by.
    pub fn plan(&self) -> &EffectPlan {
        &self.plan
    }

    /// What was found and changed in the files of its lights.
    pub fn light_notes(&self) -> Vec<&MapNotes> {
        self.lights
            .iter()
            .filter_map(|light| light.notes())
            .collect()
    }

    /// Finds the first object that each ray meets. One that is convex is not met by a ray that leaves it.
    pub(super) fn find_hits(&self, rays: &mut Rays) {
        rays.forget_hits();
        for (object, candidate) in self.objects.iter().enumerate() {
            candidate.find_hits(object as u32, rays);
        }
    }

    /// Whether something is between `ray`'s origin on `leaving` and `distance`.
    pub(super) fn is_hidden(&self, ray: &Ray, leaving: u32, distance: f64) -> bool {
        for (object, candidate) in self.objects.iter().enumerate() {
            let Some(near) = candidate.least_distance(ray.origin, leaving == object as u32) else {
                continue;
            };
            if candidate.shape.blocks(ray, near, distance) {
                return true;
            }
        }
        false
    }

    /// The surface of an object; `None` if it was not loaded, because no light falls on it.
    pub(super) fn surface(&self, object: u32) -> Option<&Surface> {
        self.surfaces
            .get(self.objects[object as usize].surface)?
            .as_ref()
    }
}

impl Object {
    /// Finds where rays meet this object, the one of that number, nearer than what they have met so far.
    fn find_hits(&self, number: u32, rays: &mut Rays) {
        let Rays {
            from,
            along,
            leaving,
            near,
            before,
            reach,
            objects,
            normals,
            ..
        } = rays;
        near.clear();
        for k in 0..from.len() {
            // What a ray can't meet at all, it would meet beyond infinity.
            let least = self.least_distance(from[k], leaving[k] == number);
            near.push(least.unwrap_or(f64::INFINITY));
        }
        before.clone_from(reach);
        self.shape
            .intersect_batch(from, along, near, reach, normals);
        for k in 0..from.len() {
            if reach[k] < before[k] {
                objects[k] = number;
            }
        }
    }

    /// The distance beyond which a ray from `origin` can meet the object; `None` if it can't meet it at all.
    fn least_distance(&self, origin: DVec3, leaving: bool) -> Option<f64> {
        match (leaving, self.is_convex) {
            (false, _) => Some(0.0),
            // A ray never returns to the convex object that it leaves. To another it may, beyond the rounding of its origin.
            (true, true) => None,
            (true, false) => {
                let least = LEAST_RETURN * origin.abs().max_element();
                Some(least.max(LEAST_RETURN_OF_EXTENT * self.extent))
            }
        }
    }
}

/// The objects in the order of [`SceneSpec::shapes`]; the floor's surface has the position `floor`.
fn collect_objects(spec: &SceneSpec, floor: usize) -> Vec<Object> {
    let mut objects = Vec::new();
    for sphere in &spec.spheres {
        objects.push(Object::new(Arc::new(sphere.shape), sphere.material));
    }
    for other in &spec.objects {
        objects.push(Object::new(other.shape.clone(), other.material));
    }
    if spec.floor.is_some() {
        objects.push(Object::new(Arc::new(Floor), floor));
    }
    objects
}

/// Refuses a surface that reflects mirror directions and is not among those that the plan was told of: its light would be missing.
fn check_mirrors(spec: &SceneSpec, surfaces: &[Option<Surface>]) -> Result<()> {
    for (i, surface) in surfaces.iter().enumerate() {
        // A BRDF that has such a part has it at the normal, too.
        let reflects = |surface: &Surface| surface.brdf.mirror(Vec3::Z).is_some();
        if surface.as_ref().is_some_and(reflects) && !spec.mirrors.contains(&i) {
            return Err(Error::argument(
                format!("{} reflects mirror directions", spec.materials[i]),
                "add its position to the mirrors of the scene",
            ));
        }
    }
    Ok(())
}

fn floor(reflectance: f32) -> Surface {
    Surface {
        brdf: Arc::new(Lambert {
            reflectance: Rgb::splat(reflectance),
        }),
        sampler: Some(Arc::new(Cosine)),
    }
}

/// The surfaces of [`SceneSpec::materials`]; `None` for those that are not used.
fn load_surfaces(
    spec: &SceneSpec,
    plan: &EffectPlan,
    mut surface: impl FnMut(usize, bool) -> Result<Surface>,
) -> Result<Vec<Option<Surface>>> {
    let directions = plan.is_on(Effect::Directions);
    let mut surfaces = Vec::with_capacity(spec.materials.len());
    for (i, name) in spec.materials.iter().enumerate() {
        if !plan.materials().get(i).is_some_and(|material| material.on) {
            surfaces.push(None);
            continue;
        }
        let surface = surface(i, directions)?;
        if directions && surface.sampler.is_none() {
            let what = format!("material {name} has no sampler");
            return Err(Error::argument(what, "give one: the plan draws directions"));
        }
        surfaces.push(Some(surface));
    }
    Ok(surfaces)
}

/// Loads the lights that the plan calls for, but for those that are `known`.
fn load_lights(
    known: &[LoadedLight],
    spec: &SceneSpec,
    plan: &EffectPlan,
) -> Result<Vec<LoadedLight>> {
    let sampling = if plan.is_on(Effect::EnvironmentTables) {
        SkySampling::Importance
    } else {
        SkySampling::Uniform
    };
    let mut lights = Vec::new();
    for (spec, decision) in spec.lights.iter().zip(plan.lights()) {
        if !decision.on {
            continue;
        }
        let same = |light: &&LoadedLight| light.sampling == sampling && light.spec == *spec;
        let light = match known.iter().find(same) {
            Some(known) => known.light.clone(),
            None => Arc::from(spec.load(sampling)?),
        };
        lights.push(LoadedLight {
            spec: spec.clone(),
            sampling,
            light,
        });
    }
    Ok(lights)
}

/// The lights as the scene has them.
fn turn_lights(loaded: &[LoadedLight], angle: f64) -> Vec<Arc<dyn Light>> {
    let mut lights: Vec<Arc<dyn Light>> = Vec::with_capacity(loaded.len());
    for LoadedLight { spec, light, .. } in loaded {
        // What is not turned is not to pay for it, nor to be rounded. The light of an object stays on the object.
        let stays = angle == 0.0 || matches!(spec, LightSpec::Object(_));
        lights.push(match stays {
            true => light.clone(),
            false => Arc::new(TurnedLight::new(light.clone(), angle)),
        });
    }
    lights
}

fn check(spec: &SceneSpec) -> Result<()> {
    check_objects(spec)?;
    if spec.depth == 0 {
        return Err(Error::argument(
            "a depth of 0",
            "give a depth of at least 1",
        ));
    }
    if spec.floor.is_some_and(|r| !(0.0..=1.0).contains(&r)) {
        return Err(Error::argument(
            "the floor's reflectance is not in [0, 1]",
            "give 0.4, for example",
        ));
    }
    if spec.strategy.candidates() == 0 {
        return Err(Error::argument(
            "no candidates to resample",
            "give at least 1",
        ));
    }
    if !(1..=SceneSpec::MOST_DIRECTIONS).contains(&spec.directions) {
        let what = format!("{} directions at each vertex", spec.directions);
        let fix = format!("give from 1 to {}", SceneSpec::MOST_DIRECTIONS);
        return Err(Error::argument(what, fix));
    }
    if !spec.light_turn.is_finite() {
        let what = "lights that are turned by no finite angle";
        return Err(Error::argument(what, "give 0.0, for example"));
    }
    if spec.clamp.is_some_and(|most| most.is_nan() || most <= 0.0) {
        let what = "paths that may carry nothing";
        return Err(Error::argument(what, "give a limit above 0, or none"));
    }
    if let Some(i) = spec.lights.iter().position(|light| !light.is_valid()) {
        let what = format!(
            "light {i} ({}) has a value that is negative or not finite",
            spec.lights[i].describe()
        );
        return Err(Error::argument(
            what,
            "give finite positions and radiance ≥ 0",
        ));
    }
    Ok(())
}

fn is_valid(sphere: &SphereSpec, materials: usize) -> bool {
    let (centre, radius) = (sphere.shape.centre, sphere.shape.radius);
    centre.is_finite() && radius > 0.0 && radius.is_finite() && sphere.material < materials
}

fn check_objects(spec: &SceneSpec) -> Result<()> {
    let materials = spec.materials.len();
    if let Some(i) = spec.spheres.iter().position(|s| !is_valid(s, materials)) {
        let what = format!("sphere {i} has no finite centre, no radius or no material");
        return Err(Error::argument(
            what,
            "give a finite centre, a radius > 0 and the index of a material",
        ));
    }
    if let Some(i) = spec.objects.iter().position(|o| o.material >= materials) {
        return Err(Error::argument(
            format!("object {i} has no material"),
            "give the index of a material",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
