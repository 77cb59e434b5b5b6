//! Render one sphere of a measured material under the built-in studio, to an OpenEXR file in the temporary folder.
//!
//! `cargo run --release --example render_a_sphere`

use std::path::{Path, PathBuf};

use merlkit::files::Overwrite;
use merlkit::image::write_exr;
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit::{LookupRule, Material, SamplerSpec};

/// Renders `material` into `folder`.
pub fn picture(material: &str, folder: &Path) -> merlkit::Result<PathBuf> {
    let (width, height) = (96, 96);
    let settings = RenderSettings {
        width,
        height,
        seed: 0,
        points: PointSet::Lattice,
        budget: Budget::Even(16),
    };

    // Describe the scene. Nothing is loaded yet.
    let mut spec = SceneSpec::row(&[material.to_owned()], width as f64 / height as f64);
    spec.lights = vec![spec.light("environment")?];

    // The scene plans which effects it calls for, and asks for what these need: a sampler only where directions are drawn.
    let sampler: SamplerSpec = "half-vector:64KB".parse()?;
    let scene = Scene::build(&spec, PlanRequest::AsNeeded, |index, directions| {
        let loaded = Material::resolve(&spec.materials[index])?.load(LookupRule::Floor)?;
        let sampler = if directions {
            Some(sampler.build(&loaded)?.shared())
        } else {
            None
        };
        Ok(Surface {
            brdf: loaded.brdf().clone(),
            sampler,
        })
    })?;

    let rendered = render(&scene, &settings, &|_pixels| {})?;
    let path = folder.join("sphere.exr");
    write_exr(&path, &rendered.film.to_image()?, Overwrite::Replace)?;
    Ok(path)
}

pub fn main() -> merlkit::Result<()> {
    let path = picture("blue-metallic-paint", &std::env::temp_dir())?;
    println!("{}", path.display());
    Ok(())
}
