//! Scene 3: a large mesh.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use merlkit::Result;
use merlkit::render::{Camera, ObjectSpec, Shape};
use merlkit_scene::{Instance, Quad, Shading, Sides, TriangleMesh, displace_sphere, read_mesh};

use super::bench::ThesisBench;
use super::contenders::Way;
use super::exhibit::{Exhibit, ResultCell, ResultTable, Thumbnail, write_ratio};
use super::gallery::{JAR_WAYS, UNKNOWN_FILES, contend_named, empty_scene, load_named, text_row};
use super::plan::ThesisPlan;
use super::ranking::describe_references;
use super::spheres::{REFERENCE, thumbnails};
use super::stage::{StagePiece, ThesisScene};

/// Floor, wall and object of scene 3.
const DRAGON: [(&str, &str); 3] = [
    ("oren", "oren:s=0.83,r=0.8"),
    ("strauss", "strauss:s=0.3,m=0.1,ks=0.2,kd=0.6"),
    ("lafortune", "lafortune:n=46,kp=0.5,Cx=-1,Cy=-1,Cz=1"),
];

/// The largest width, height and depth of a mesh that is put into the scene.
const ROOM: DVec3 = DVec3::new(2.6, 2.0, 2.0);
/// How far such a mesh is above the floor: faces in one plane with it would be seen by chance.
const LIFT: f64 = 1e-3;

/// The map that puts a mesh of these bounds onto the middle of the floor, as large as the room for it allows.
fn frame_mesh([low, high]: [DVec3; 2]) -> DAffine3 {
    // Step 1: one factor for all axes, s = min over the axes of room/extent. A flat mesh has an extent of 0, which limits nothing.
    let scale = (ROOM / (high - low)).min_element();
    // Step 2: the middle of its lower side goes to the floor, p → s·(p − foot) + lift.
    let middle = 0.5 * (low + high);
    let foot = DVec3::new(middle.x, low.y, middle.z);
    DAffine3::from_translation(DVec3::Y * LIFT)
        * DAffine3::from_scale(DVec3::splat(scale))
        * DAffine3::from_translation(-foot)
}

/// The mesh of the plan in its place: that of a file, or a displaced sphere.
fn place_mesh(plan: &ThesisPlan) -> Result<Instance> {
    let Some(file) = &plan.mesh else {
        let steps = if plan.quick { 24 } else { 120 };
        let data = displace_sphere(0.8, 0.2, steps, 7)?;
        let mesh = TriangleMesh::build(&data, Sides::Both, Shading::Flat)?;
        let lifted = DAffine3::from_translation(DVec3::new(0.0, 1.0, 0.0));
        return Instance::new(Arc::new(mesh), lifted);
    };
    let data = read_mesh(Path::new(&file.file))?;
    let mesh = TriangleMesh::build(&data, Sides::Both, Shading::Flat)?;
    let to_world = frame_mesh(mesh.bounds());
    Instance::new(Arc::new(mesh), to_world)
}

/// A mesh on a floor before a wall.
fn dragon(plan: &ThesisPlan) -> Result<ThesisScene> {
    let materials = load_named(&DRAGON)?;
    let names = DRAGON.map(|(name, _)| name.to_owned());
    let target = DVec3::new(0.0, 1.0, 0.0);
    let camera = Camera {
        eye: target + DVec3::new(0.0, 1.2, 6.0),
        target,
        vertical_angle: 32f64.to_radians(),
    };
    let mut spec = empty_scene(&names, camera, 2);
    let floor = Quad::new(
        DVec3::new(-4.0, 0.0, -2.0),
        DVec3::new(0.0, 0.0, 6.0),
        DVec3::new(8.0, 0.0, 0.0),
    )?;
    let wall = Quad::new(
        DVec3::new(-4.0, 0.0, -2.0),
        DVec3::new(8.0, 0.0, 0.0),
        DVec3::new(0.0, 5.0, 0.0),
    )?;
    let mesh = place_mesh(plan)?;
    let shapes: [Arc<dyn Shape>; 3] = [Arc::new(floor), Arc::new(wall), Arc::new(mesh)];
    for (material, shape) in shapes.into_iter().enumerate() {
        spec.objects.push(ObjectSpec { shape, material });
    }
    spec.lights = vec![spec.light("area")?];
    Ok(ThesisScene {
        spec,
        size: [plan.side; 2],
        materials,
        reference: REFERENCE.parse()?,
    })
}

/// Seconds of each sampler of scene 3.
fn seconds_table(piece: &StagePiece, most: u64) -> ResultTable {
    let mut table = ResultTable::new(
        "Seconds, and over those of uniform directions; ours at the most samples",
        &[
            "sampler",
            "thesis, s",
            "thesis, ratio",
            "ours, CPU s",
            "ours, ratio",
            "ours, error %",
        ],
    );
    let uniform = piece.find(Way::Uniform.name(), most).map(|r| r.seconds.cpu);
    let printed_uniform = text_row("scene-3", 0)[0];
    for (row, way) in JAR_WAYS.into_iter().enumerate() {
        let ours = piece.find(way.name(), most);
        let printed = text_row("scene-3", row)[0];
        let seconds = ours.map(|r| r.seconds.cpu);
        table.push(vec![
            ResultCell::from(way.name()),
            printed.into(),
            printed.zip(printed_uniform).map(|(a, b)| a / b).into(),
            seconds.into(),
            seconds.zip(uniform).map(|(a, b)| a / b).into(),
            ours.map(|r| 100.0 * r.error).into(),
        ]);
    }
    table
}

/// Scene 3: seconds of four samplers with a large mesh.
pub(super) fn scene_3(bench: &mut ThesisBench) -> Result<Exhibit> {
    let piece = bench.piece("scene-3", |plan| {
        let stage = dragon(plan)?;
        let contenders = contend_named(&DRAGON, &stage.materials, plan)?;
        stage.compare(&contenders, plan)
    })?;
    let most = bench.plan.most_samples();
    let table = seconds_table(&piece, most);
    let uniform = piece.find(Way::Uniform.name(), most).map(|r| r.seconds.cpu);
    let disc = piece.find(Way::Disc.name(), most).map(|r| r.seconds.cpu);
    let mut findings = Vec::new();
    findings.extend(disc.zip(uniform).map(|(disc, uniform)| {
        format!(
            "The disc's picture takes 4.37 times as long as that of uniform directions in the thesis, {} times here.",
            write_ratio(disc / uniform)
        )
    }));
    let name = match bench.plan.mesh {
        Some(_) => "mesh",
        None => "displaced sphere",
    };
    let pieces = [(name, piece)];
    findings.push(describe_references(&pieces));
    Ok(describe_scene_3(
        &bench.plan,
        findings,
        vec![table],
        thumbnails(&pieces, &[name]),
    ))
}

/// What the mesh of the plan is, as the beginning of a sentence.
fn describe_mesh(plan: &ThesisPlan) -> String {
    match &plan.mesh {
        None => "A displaced sphere".into(),
        Some(mesh) => format!(
            "The mesh {} ({} vertices, {} triangles, SHA-256 {}), scaled to fit into {} × {} × {},",
            mesh.file, mesh.vertices, mesh.faces, mesh.sha256, ROOM.x, ROOM.y, ROOM.z
        ),
    }
}

/// What scene 3 is, with its results.
fn describe_scene_3(
    plan: &ThesisPlan,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    let (subject, most) = (describe_mesh(plan), plan.most_samples());
    let mesh = match plan.mesh {
        Some(_) => {
            "Its mesh is a scanned dragon of 200,000 faces; ours is a file that was named with --mesh."
        }
        None => {
            "Its mesh is a scanned dragon of 200,000 faces; --mesh puts any other into its place."
        }
    };
    Exhibit {
        name: "scene-3".into(),
        title: "Scene 3: a large mesh on a floor before a wall".into(),
        method: format!(
            "{subject} of Lafortune's BRDF (n 46), a floor of Oren and Nayar's and a wall of Strauss's, under a square light with one bounce, {most} \
             samples."
        ),
        differences: format!(
            "{UNKNOWN_FILES} {mesh} The parameters of the wall and the diffuse part of the dragon are not printed."
        ),
        findings,
        tables,
        pictures,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tall, wide, flat, and far off the origin.
    #[test]
    fn meshes_are_framed_by_their_bounds() {
        for (low, high) in [
            (DVec3::ZERO, DVec3::new(1.0, 50.0, 2.0)),
            (DVec3::new(-3e3, 70.0, 4.0), DVec3::new(-2e3, 90.0, 5.0)),
            (DVec3::splat(-1e-4), DVec3::splat(1e-4)),
            (DVec3::new(0.0, 2.0, 0.0), DVec3::new(4.0, 2.0, 3.0)),
        ] {
            let framed = frame_mesh([low, high]);
            let (from, to) = (framed.transform_point3(low), framed.transform_point3(high));
            let extent = to - from;
            assert!((from.y - LIFT).abs() < 1e-9, "{from}");
            assert!((from + to).x.abs() < 1e-9 && (from + to).z.abs() < 1e-9);
            // It fills the room along one axis, and none is exceeded.
            let filled = (extent / ROOM).max_element();
            assert!((filled - 1.0).abs() < 1e-9, "{extent}");
        }
    }
}
