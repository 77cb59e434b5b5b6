//! A scene with what its plan calls for loaded.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::shape::enter_floor;
use super::{
    Camera, Effect, EffectPlan, EnvironmentSource, LightSpec, Ray, SceneSpec, Sphere, SphereSpec,
    Strategy,
};
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSampler;
use crate::geometry::Frame;
use crate::image::read_exr;
use crate::light::{Environment, Light, SkySampling, studio};
use crate::material::analytic::Lambert;
use crate::sampler::Cosine;
use crate::{Error, Result};

/// How an object reflects.
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
            Frame::about(normal)
        } else {
            Frame::around(normal, Vec3::Y)
        }
    }
}

/// A scene, ready to render by the plan it was built for.
pub struct Scene {
    pub(super) camera: Camera,
    pub(super) depth: u32,
    pub(super) strategy: Strategy,
    pub(super) lights: Vec<Box<dyn Light>>,
    objects: Vec<Object>,
    surfaces: Vec<Option<Surface>>,
}

struct Object {
    shape: Shape,
    /// Position in `surfaces`.
    surface: usize,
}

enum Shape {
    Sphere(Sphere),
    Floor,
}

/// Where a ray meets an object.
#[derive(Clone, Copy)]
pub(super) struct Hit {
    pub(super) object: usize,
    pub(super) at: DVec3,
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}

impl Scene {
    /// Loads what `plan` says `spec` uses. `surface(i, directions)` gives material `i` of [`SceneSpec::materials`], with a
    /// sampler if `directions`; it is called once for each material that is used, in order.
    ///
    /// # Errors
    /// [`Error::Argument`] for a sphere without a radius or a material, a floor, light or strategy outside its domain, or a missing
    /// sampler; what `surface` returns; what [`read_exr`] returns.
    pub fn build(
        spec: &SceneSpec,
        plan: &EffectPlan,
        surface: impl FnMut(usize, bool) -> Result<Surface>,
    ) -> Result<Self> {
        check(spec)?;
        // Lights first: a missing file should be told of before materials and samplers take their time.
        let lights = load_lights(spec, plan)?;
        let mut surfaces = load_surfaces(spec, plan, surface)?;
        let sphere = |s: &SphereSpec| Object {
            shape: Shape::Sphere(s.shape),
            surface: s.material,
        };
        let mut objects: Vec<Object> = spec.spheres.iter().map(sphere).collect();
        if let Some(reflectance) = spec.floor {
            objects.push(Object {
                shape: Shape::Floor,
                surface: surfaces.len(),
            });
            surfaces.push(Some(floor(reflectance)));
        }
        let SceneSpec {
            camera,
            depth,
            strategy,
            ..
        } = *spec;
        Ok(Self {
            camera,
            depth,
            strategy,
            lights,
            objects,
            surfaces,
        })
    }

    /// The first object that `ray` meets, except `leaving`: shapes are convex, so a ray that leaves one never meets it
    /// again, and no rounding can make it.
    pub(super) fn hit(&self, ray: &Ray, leaving: Option<usize>) -> Option<Hit> {
        let mut nearest: Option<(usize, f64)> = None;
        for (i, object) in self.objects.iter().enumerate() {
            if Some(i) == leaving {
                continue;
            }
            if let Some(d) = object
                .enter(ray)
                .filter(|d| nearest.is_none_or(|(_, best)| *d < best))
            {
                nearest = Some((i, d));
            }
        }
        nearest.map(|(object, distance)| self.meet(object, ray, distance))
    }

    /// Whether something stands between `ray`'s origin on `leaving` and `distance`.
    pub(super) fn is_hidden(&self, ray: &Ray, leaving: usize, distance: f64) -> bool {
        let blocks = |object: &Object| object.enter(ray).is_some_and(|d| d < distance);
        self.objects
            .iter()
            .enumerate()
            .any(|(i, object)| i != leaving && blocks(object))
    }

    /// The surface of an object; `None` if it was not loaded, because no light falls on it.
    pub(super) fn surface(&self, object: usize) -> Option<&Surface> {
        self.surfaces.get(self.objects[object].surface)?.as_ref()
    }

    fn meet(&self, object: usize, ray: &Ray, distance: f64) -> Hit {
        let at = ray.at(distance);
        let normal = match &self.objects[object].shape {
            Shape::Sphere(sphere) => sphere.normal(at),
            Shape::Floor => DVec3::Y,
        };
        Hit {
            object,
            at,
            normal,
            distance,
        }
    }
}

impl Object {
    fn enter(&self, ray: &Ray) -> Option<f64> {
        match &self.shape {
            Shape::Sphere(sphere) => sphere.enter(ray),
            Shape::Floor => enter_floor(ray),
        }
    }
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
    let load = |(i, name): (usize, &String)| {
        if !plan.materials().get(i).is_some_and(|material| material.on) {
            return Ok(None);
        }
        let surface = surface(i, directions)?;
        if directions && surface.sampler.is_none() {
            let what = format!("material {name} has no sampler");
            return Err(Error::argument(what, "give one: the plan draws directions"));
        }
        Ok(Some(surface))
    };
    spec.materials.iter().enumerate().map(load).collect()
}

fn load_lights(spec: &SceneSpec, plan: &EffectPlan) -> Result<Vec<Box<dyn Light>>> {
    let sampling = match plan.is_on(Effect::EnvironmentTables) {
        true => SkySampling::Importance,
        false => SkySampling::Uniform,
    };
    let used = spec
        .lights
        .iter()
        .zip(plan.lights())
        .filter(|(_, decision)| decision.on);
    used.map(|(light, _)| load(light, sampling)).collect()
}

fn load(light: &LightSpec, sampling: SkySampling) -> Result<Box<dyn Light>> {
    Ok(match light {
        LightSpec::Point(light) => Box::new(*light),
        LightSpec::Directional(light) => Box::new(*light),
        LightSpec::Area(light) => Box::new(*light),
        LightSpec::Environment(source) => Box::new(environment(source, sampling)?),
    })
}

fn environment(source: &EnvironmentSource, sampling: SkySampling) -> Result<Environment> {
    match source {
        EnvironmentSource::Studio => studio(sampling),
        EnvironmentSource::Uniform(radiance) => Environment::uniform(*radiance),
        EnvironmentSource::File(path) => {
            let map = read_exr(path)?;
            Environment::new(map.width(), map.height(), map.into_pixels(), sampling)
        }
    }
}

fn check(spec: &SceneSpec) -> Result<()> {
    let sphere_fits = |s: &SphereSpec| {
        s.shape.centre.is_finite()
            && s.shape.radius > 0.0
            && s.shape.radius.is_finite()
            && s.material < spec.materials.len()
    };
    if let Some(i) = spec.spheres.iter().position(|s| !sphere_fits(s)) {
        let what = format!("sphere {i} has no finite centre, no radius or no material");
        return Err(Error::argument(
            what,
            "give a finite centre, a radius > 0 and the index of a material",
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
    if let Some(i) = spec.lights.iter().position(|light| !light_fits(light)) {
        let what = format!(
            "light {i} ({}) has a value that is negative or not finite",
            spec.lights[i].kind()
        );
        return Err(Error::argument(
            what,
            "give finite positions and radiance ≥ 0",
        ));
    }
    Ok(())
}

fn light_fits(light: &LightSpec) -> bool {
    let emission = |c: Rgb| c.is_finite() && c.min_element() >= 0.0;
    match light {
        LightSpec::Point(l) => emission(l.intensity) && l.position.is_finite(),
        LightSpec::Directional(l) => emission(l.irradiance) && l.towards.is_finite(),
        LightSpec::Area(l) => {
            emission(l.radiance) && [l.corner, l.edge_u, l.edge_v].iter().all(|v| v.is_finite())
        }
        LightSpec::Environment(EnvironmentSource::Uniform(radiance)) => emission(*radiance),
        LightSpec::Environment(_) => true,
    }
}
