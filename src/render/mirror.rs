//! Mirror directions: what a surface whose BRDF has a delta part reflects as a mirror.

use glam::{DVec3, Vec3};

use super::bundle::{Run, Scratch, Vertex};
use super::follow::add_found;
use super::rays::{NewRay, Rays};
use super::tracer::Tracer;
use crate::points::PointId;

impl Tracer<'_> {
    /// Adds the light that vertices of a surface reflect as mirrors, and keeps the paths that go on from there.
    ///
    /// Neither a light nor the BRDF's sampler chooses the mirror direction, so everything it finds counts in full: T·F·L, with F
    /// for [`crate::Brdf::mirror`]. A path that meets such a surface goes on twice; roulette keeps their number in bounds.
    pub(super) fn add_mirrors(
        &self,
        run: Run<'_, '_>,
        scratch: &mut Scratch,
        radiance: &mut [DVec3],
        ids: &[PointId],
        paths: &mut Rays,
    ) {
        if !self.mirrors {
            return;
        }
        let found = &mut scratch.found;
        found.clear();
        for vertex in run.vertices {
            if let Some(ray) = mirror_ray(vertex) {
                found.push(ray);
            }
        }
        if found.is_empty() {
            return;
        }
        self.find_next_hits(found);
        // Add what lights with an extent emit along the mirror directions.
        self.sum_emitted(found, &mut scratch.emitted, |_, _| 1.0);
        add_found(found, &scratch.emitted.sums, radiance);
        // Let roulette decide which paths go on.
        if self.interreflection && run.bounce + 1 < self.scene.depth {
            self.keep_survivors(found, run.bounce, ids, paths);
        }
    }
}

/// The ray along the mirror direction of a vertex, T ← T·F; `None` where nothing is reflected there.
fn mirror_ray(vertex: &Vertex<'_>) -> Option<NewRay> {
    let mirror = vertex.surface.brdf.mirror(vertex.wo)?.as_dvec3();
    let throughput = vertex.throughput * mirror;
    if throughput == DVec3::ZERO || !throughput.is_finite() {
        return None;
    }
    let wi = Vec3::new(-vertex.wo.x, -vertex.wo.y, vertex.wo.z);
    Some(NewRay {
        owner: vertex.lane,
        from: vertex.position,
        along: vertex.frame.to_world(wi).as_dvec3().try_normalize()?,
        weight: throughput,
        // Neither technique draws it by a density.
        pdf: 0.0,
        leaving: vertex.object,
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::Result;
    use crate::material::{LookupRule, Material};
    use crate::points::PointSet;
    use crate::render::{
        Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render,
    };
    use crate::sampler::Cosine;

    /// One sphere of a formula under a light; `mirrors` are those that the plan is told of.
    fn build(formula: &str, light: &str, mirrors: Vec<usize>) -> Result<Scene> {
        let row = SceneSpec::row(&[formula.to_owned()], 1.5);
        let spec = SceneSpec {
            mirrors,
            lights: vec![row.light(light).unwrap()],
            floor: None,
            ..row
        };
        let loaded = Material::resolve(formula).unwrap();
        let loaded = loaded.load(LookupRule::Floor).unwrap();
        Scene::build(&spec, PlanRequest::AsNeeded, |_, _| {
            Ok(Surface {
                brdf: loaded.brdf().clone(),
                sampler: Some(std::sync::Arc::new(Cosine)),
            })
        })
    }

    fn picture(formula: &str, light: &str) -> Film {
        let scene = build(formula, light, vec![0]).unwrap();
        let settings = RenderSettings {
            width: 24,
            height: 16,
            seed: 3,
            points: PointSet::Sobol,
            budget: Budget::Even(256),
        };
        render(&scene, &settings, &|_| {}).unwrap().film
    }

    /// Its light would be missing.
    #[test]
    fn a_mirror_that_the_plan_was_not_told_of_is_refused() {
        let refused = build("specular:ks=0.54", "uniform:1", Vec::new()).err();
        assert!(refused.unwrap().to_string().contains("mirror"));
        assert!(build("diffuse:kd=0.5", "uniform:1", Vec::new()).is_ok());
    }

    /// A mirror of reflectance 0.54 before a sky of radiance 1 shows 0.54, and a coat over a white base nearly all of it.
    #[test]
    fn mirrors_show_a_uniform_sky() {
        for (formula, radiance, tolerance) in [
            ("specular:ks=0.54", 0.54, 1e-5),
            ("coupled:Rm=1,Ro=0.05", 0.998, 0.04),
        ] {
            let centre = picture(formula, "uniform:1").mean(12, 8);
            let error = (centre - DVec3::splat(radiance)).abs().max_element();
            assert!(error < tolerance, "{formula}: {centre}");
        }
    }
}
