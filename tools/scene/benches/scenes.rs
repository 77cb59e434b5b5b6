//! What plans save, how fast meshes are loaded, and rays per second on a mesh of 100,352 triangles, here and in Mitsuba 3.
//!
//! `cargo bench -p merlkit-scene --bench scenes`. Mitsuba wants a `python3` that has it (`MERLKIT_PYTHON` names another program),
//! and is left out without.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use merlkit::material::{LookupRule, Material};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Effect, EffectPlan, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render,
};
use merlkit::sampler::Cosine;
use merlkit_scene::{
    MeshData, Shading, Sides, TriangleMesh, displace_sphere, read_mesh, read_scene,
};

/// Pictures of each kind, in turn; the fastest of a kind counts.
const REPEATS: usize = 5;

fn main() {
    let folder = std::env::temp_dir().join(format!("merlkit-scenes-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    measure_plans();
    measure_loading(&folder);
    measure_rays(&folder);
    fs::remove_dir_all(&folder).expect("the folder");
}

fn build(spec: &SceneSpec, request: PlanRequest) -> Scene {
    let scene = Scene::build(spec, request, |i, _| {
        let material = Material::resolve(&spec.materials[i])?.load(LookupRule::Floor)?;
        Ok(Surface {
            brdf: material.brdf().clone(),
            sampler: Some(Arc::new(Cosine)),
        })
    });
    scene.expect("a scene")
}

/// Seconds of one thread.
fn draw(scene: &Scene, [width, height]: [usize; 2], paths: u64) -> f64 {
    let settings = RenderSettings {
        width,
        height,
        seed: 1,
        points: PointSet::Lattice,
        budget: Budget::Even(paths),
    };
    let threads = cpu_seconds();
    render(scene, &settings, &|_| {}).expect("a picture");
    cpu_seconds() - threads
}

/// Processor time of this process, which other programs on a busy machine do not lengthen as they do the time of day.
fn cpu_seconds() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").expect("Linux");
    // Fields 14 and 15 are times in user and system mode, in hundredths of a second; the name before them may hold blanks.
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let fields: Vec<&str> = after_name.split_whitespace().collect();
    let ticks = |i: usize| fields[i].parse::<f64>().expect("a number");
    (ticks(11) + ticks(12)) / 100.0
}

fn measure_plans() {
    println!("scene, effects on, processor seconds as planned, with everything, ratio");
    for name in ["jar", "room", "sphere", "spheres"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let described = read_scene(&path.join(name).with_extension("toml")).expect("a scene");
        let size = described.size.expect("a size");
        let spec = described.build().expect("a scene").spec;
        let plan = EffectPlan::for_scene(&spec, PlanRequest::AsNeeded);
        let on = Effect::ALL.iter().filter(|e| plan.is_on(**e)).count();
        let scenes = [PlanRequest::AsNeeded, PlanRequest::Everything].map(|r| build(&spec, r));
        let mut least = [f64::INFINITY; 2];
        for _ in 0..REPEATS {
            for (scene, least) in scenes.iter().zip(&mut least) {
                *least = least.min(draw(scene, size, 32));
            }
        }
        let [planned, all] = least;
        println!(
            "{name}, {on} of {}, {planned:.2}, {all:.2}, {:.2}",
            Effect::ALL.len(),
            all / planned
        );
    }
}

fn write_obj(path: &Path, data: &MeshData) {
    let mut out = std::io::BufWriter::new(fs::File::create(path).expect("a file"));
    for v in &data.vertices {
        writeln!(out, "v {:.7} {:.7} {:.7}", v.x, v.y, v.z).expect("written");
    }
    for [a, b, c] in &data.faces {
        writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1).expect("written");
    }
}

fn write_ply(path: &Path, data: &MeshData) {
    let mut out = std::io::BufWriter::new(fs::File::create(path).expect("a file"));
    let (vertices, faces) = (data.vertices.len(), data.faces.len());
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .expect("written");
    for v in &data.vertices {
        for x in v.to_array() {
            out.write_all(&(x as f32).to_le_bytes()).expect("written");
        }
    }
    for face in &data.faces {
        out.write_all(&[3]).expect("written");
        for corner in face {
            out.write_all(&corner.to_le_bytes()).expect("written");
        }
    }
}

fn measure_loading(folder: &Path) {
    let data = displace_sphere(1.0, 0.2, 112, 1).expect("a mesh");
    write_obj(&folder.join("mesh.obj"), &data);
    write_ply(&folder.join("mesh.ply"), &data);
    println!(
        "file of {} triangles, seconds to read, to build, processor seconds of both",
        data.faces.len()
    );
    for name in ["mesh.obj", "mesh.ply"] {
        let mut least = [f64::INFINITY; 3];
        for _ in 0..REPEATS {
            let (start, cpu) = (Instant::now(), cpu_seconds());
            let data = read_mesh(&folder.join(name)).expect("a mesh");
            let read = start.elapsed().as_secs_f64();
            TriangleMesh::build(&data, Sides::Both, Shading::Flat).expect("a mesh");
            let both = start.elapsed().as_secs_f64();
            let times = [read, both - read, cpu_seconds() - cpu];
            for (least, time) in least.iter_mut().zip(times) {
                *least = least.min(time);
            }
        }
        println!("{name}, {:.2}, {:.2}, {:.2}", least[0], least[1], least[2]);
    }
}

const SCENE: &str = r#"
[camera]
eye = [0, 0.8, 5]
look_at = [0, 0, 0]
fov = 30
[[material]]
name = "grey"
brdf = "lambert:reflectance=0.5"
[[object]]
shape = "mesh"
file = "mesh.ply"
material = "grey"
[[light]]
kind = "area"
corner = [-2, 4, 1]
edge_u = [2, 0, 0]
edge_v = [0, 0, 2]
radiance = 6
"#;

const MITSUBA: &str = r#"
import sys, time, mitsuba as mi
mi.set_variant("scalar_rgb")
path, side, spp, repeats = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
T = mi.ScalarTransform4f
scene = mi.load_dict({
    "type": "scene", "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 1, "hide_emitters": False},
    "sensor": {"type": "perspective", "fov": 30, "fov_axis": "y",
               "to_world": T().look_at(origin=[0, 0.8, 5], target=[0, 0, 0], up=[0, 1, 0]),
               "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}},
               "sampler": {"type": "independent", "sample_count": spp}},
    "mesh": {"type": "ply", "filename": path, "face_normals": True,
             "bsdf": {"type": "twosided", "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}}},
    "lamp": {"type": "rectangle", "to_world": T().translate([-1, 4, 2]) @ T().rotate([1, 0, 0], 90),
             "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 6}}},
})
import numpy
best = None
for seed in range(repeats):
    start = time.process_time()
    image = mi.render(scene, seed=seed, spp=spp)
    seconds = time.process_time() - start
    best = seconds if best is None else min(best, seconds)
print(best, float(numpy.array(image).mean()))
"#;

/// Processor seconds of the same picture, direct light only: camera rays, and at each hit a ray to the lamp and one that the
/// BRDF draws.
fn measure_rays(folder: &Path) {
    const SIDE: usize = 256;
    const PATHS: u64 = 16;
    fs::write(folder.join("scene.toml"), SCENE).expect("written");
    let mut described = read_scene(&folder.join("scene.toml")).expect("a scene");
    described.bounces = Some(1);
    let mut spec = described.build().expect("a scene").spec;
    spec.depth = 1;
    let scene = build(&spec, PlanRequest::AsNeeded);
    let mut ours = f64::INFINITY;
    for _ in 0..REPEATS {
        ours = ours.min(draw(&scene, [SIDE, SIDE], PATHS));
    }
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        seed: 1,
        points: PointSet::Random,
        budget: Budget::Even(PATHS),
    };
    let film = render(&scene, &settings, &|_| {}).expect("a picture").film;
    let mut mean = 0.0;
    for i in 0..SIDE * SIDE {
        mean += film.mean(i % SIDE, i / SIDE).element_sum() / (3 * SIDE * SIDE) as f64;
    }
    let paths = (SIDE * SIDE) as f64 * PATHS as f64;
    println!("renderer, processor seconds, million paths per second, mean radiance");
    println!("merlkit, {ours:.2}, {:.3}, {mean:.5}", paths / ours / 1e6);
    fs::write(folder.join("mesh.py"), MITSUBA).expect("written");
    let python = std::env::var("MERLKIT_PYTHON").unwrap_or_else(|_| "python3".into());
    let output = Command::new(python)
        .arg(folder.join("mesh.py"))
        .arg(folder.join("mesh.ply"))
        .args([SIDE, PATHS as usize, REPEATS].map(|n| n.to_string()))
        .output();
    let words = output.map(|out| String::from_utf8_lossy(&out.stdout).into_owned());
    let words = words.unwrap_or_default();
    let numbers: Vec<f64> = words
        .split_whitespace()
        .filter_map(|n| n.parse().ok())
        .collect();
    match numbers[..] {
        [theirs, mean] => println!(
            "Mitsuba scalar_rgb, {theirs:.2}, {:.3}, {mean:.5}\nratio, {:.2}",
            paths / theirs / 1e6,
            theirs / ours
        ),
        _ => println!("no Mitsuba"),
    }
}
