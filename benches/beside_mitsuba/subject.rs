//! What is rendered: a few scenes, and the files that Mitsuba needs for them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use merlkit::brdf::Brdf;
use merlkit::files::Overwrite;
use merlkit::image::{Image, write_exr};
use merlkit::light::{EnvironmentSource, LightSpec, SkySampling, studio};
use merlkit::material::merl::{LookupRule, MerlBrdf, decode_embedded};
use merlkit::material::rgl::{BsdfSize, tabulate};
use merlkit::render::{Ray, SceneSpec};
use serde_json::{Value, json};

/// Of the table, and of what the `.bsdf` file is made of.
const LOOKUP: LookupRule = LookupRule::Linear;
/// Pixels a side.
pub const SIDE: usize = 512;
pub const SKY: [usize; 2] = [512, 256];
const BSDF_SIZE: &str = "6MB";

/// Spheres in a row under the studio.
pub struct Subject {
    pub name: &'static str,
    materials: &'static [&'static str],
    /// Reflectance of a diffuse ground, if there is one.
    ground: Option<f32>,
}

pub const SUBJECTS: [Subject; 4] = [
    Subject {
        name: "nickel",
        materials: &["nickel"],
        ground: None,
    },
    Subject {
        name: "rough metal",
        materials: &["alum-bronze"],
        ground: None,
    },
    Subject {
        name: "diffuse",
        materials: &["teflon"],
        ground: None,
    },
    Subject {
        name: "three spheres on a ground",
        materials: &["nickel", "red-plastic", "teflon"],
        ground: Some(0.35),
    },
];

impl Subject {
    /// As it is described in the output.
    pub fn description(&self) -> String {
        format!("{} ({})", self.name, self.materials.join(", "))
    }

    pub fn spec(&self, sky: &Path) -> SceneSpec {
        let light = LightSpec::Environment(EnvironmentSource::File {
            path: sky.to_owned(),
            clamp: None,
        });
        let names: Vec<String> = self.materials.iter().map(|m| (*m).to_owned()).collect();
        SceneSpec {
            lights: vec![light],
            depth: 1,
            floor: self.ground,
            ..SceneSpec::row(&names, 1.0)
        }
    }

    /// The BRDF of the material of this number.
    pub fn brdf(&self, material: usize) -> MerlBrdf {
        let table = decode_embedded(self.materials[material]).expect("an embedded material");
        MerlBrdf::new(Arc::new(table), LOOKUP)
    }

    /// Pixels whose four corners all show something, and the same.
    pub fn mask(&self, sky: &Path) -> Vec<bool> {
        let spec = self.spec(sky);
        let mut seen = Vec::new();
        for i in 0..(SIDE + 1) * (SIDE + 1) {
            let corner = DVec2::new((i % (SIDE + 1)) as f64, (i / (SIDE + 1)) as f64);
            seen.push(object(&spec, &spec.camera.ray(corner / SIDE as f64, 1.0)));
        }
        let mut mask = Vec::new();
        for i in 0..SIDE * SIDE {
            let corner = i % SIDE + (i / SIDE) * (SIDE + 1);
            let first = seen[corner];
            let others = [corner + 1, corner + SIDE + 1, corner + SIDE + 2];
            mask.push(first.is_some() && others.iter().all(|&c| seen[c] == first));
        }
        mask
    }
}

/// The object that a ray meets first: the number of a sphere, or of the ground after them.
fn object(spec: &SceneSpec, ray: &Ray) -> Option<usize> {
    let mut nearest: Option<(f64, usize)> = None;
    for (i, sphere) in spec.spheres.iter().enumerate() {
        if let Some(distance) = sphere.shape.enter(ray)
            && nearest.is_none_or(|n| distance < n.0)
        {
            nearest = Some((distance, i));
        }
    }
    let below = spec.floor.is_some() && ray.direction.y < 0.0;
    let ground = below.then_some(spec.spheres.len());
    nearest.map(|n| n.1).or(ground)
}

/// Files of a scene, and what Mitsuba needs to know of it.
pub struct Files {
    pub folder: tempfile::TempDir,
    pub sky: PathBuf,
    pub scene: PathBuf,
}

impl Files {
    pub fn new(subject: &Subject) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let [sky, scene] = ["sky.exr", "scene.json"].map(|name| folder.path().join(name));
        write_exr(&sky, &sky_map(), Overwrite::Refuse).expect("a sky");
        let spec = subject.spec(&sky);
        let mut balls = Vec::new();
        for sphere in &spec.spheres {
            let mut ball = material_files(subject, sphere.material, folder.path());
            ball["centre"] = json!(sphere.shape.centre.to_array());
            ball["radius"] = json!(sphere.shape.radius);
            balls.push(ball);
        }
        let camera = spec.camera;
        let described = json!({
            "side": SIDE,
            "sky": sky,
            "camera": {
                "eye": camera.eye.to_array(),
                "target": camera.target.to_array(),
                "degrees": camera.vertical_angle.to_degrees(),
            },
            "balls": balls,
            "ground": subject.ground,
        });
        std::fs::write(&scene, described.to_string()).expect("a scene");
        Self { folder, sky, scene }
    }
}

/// Writes a material's `.bsdf` file and its table, and returns where they are.
fn material_files(subject: &Subject, material: usize, folder: &Path) -> Value {
    let brdf = subject.brdf(material);
    let bsdf = folder.join(format!("{material}.bsdf"));
    let table = folder.join(format!("{material}.table"));
    let size = BsdfSize::ALL.into_iter().find(|s| s.name == BSDF_SIZE);
    let file = tabulate(
        |wo, wi| brdf.eval(wo, wi),
        size.expect("a size"),
        subject.materials[material].into(),
    );
    file.write(&bsdf, Overwrite::Refuse).expect("a .bsdf file");
    std::fs::write(&table, cells(&brdf)).expect("a table");
    json!({"bsdf": bsdf, "table": table})
}

/// f32 by θh, θd, φd and channel.
fn cells(brdf: &MerlBrdf) -> Vec<u8> {
    let table = brdf.table();
    let mut bytes = Vec::new();
    for (h, d, p) in (0..90 * 90 * 180).map(|i| (i / (90 * 180), i / 180 % 90, i % 180)) {
        let cell = table.rgb(h, d, p);
        cell.to_array()
            .iter()
            .for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    bytes
}

/// The studio by pixels: the middle of the map is −z, its right half +x.
fn sky_map() -> Image {
    let sky = studio(SkySampling::Uniform);
    let [width, height] = SKY;
    let share = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    Image::from_fn(width, height, |x, y| {
        let (theta, phi) = (
            share(y, height) * std::f64::consts::PI,
            (share(x, width) - 0.5) * std::f64::consts::TAU,
        );
        sky.radiance(DVec3::new(
            theta.sin() * phi.sin(),
            theta.cos(),
            -theta.sin() * phi.cos(),
        ))
    })
    .expect("a map")
}
