//! Scene 3: a large mesh.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use merlkit::Result;
use merlkit::render::{Camera, ObjectSpec, Shape};
use merlkit_scene::{Instance, Quad, Shading, Sides, TriangleMesh, displace_sphere};

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

/// A displaced sphere on a floor before a wall.
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
    let steps = if plan.quick { 24 } else { 120 };
    let data = displace_sphere(0.8, 0.2, steps, 7)?;
    let mesh: Arc<dyn Shape> = Arc::new(TriangleMesh::build(&data, Sides::Both, Shading::Flat)?);
    let lifted = Instance::new(mesh, DAffine3::from_translation(DVec3::new(0.0, 1.0, 0.0)))?;
    let shapes: [Arc<dyn Shape>; 3] = [Arc::new(floor), Arc::new(wall), Arc::new(lifted)];
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
    let pieces = [("displaced sphere", piece)];
    findings.push(describe_references(&pieces));
    Ok(describe_scene_3(
        most,
        findings,
        vec![table],
        thumbnails(&pieces, &["displaced sphere"]),
    ))
}

/// What scene 3 is, with its results.
fn describe_scene_3(
    most: u64,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    Exhibit {
        name: "scene-3".into(),
        title: "Scene 3: a large mesh on a floor before a wall".into(),
        method: format!(
            "A displaced sphere of Lafortune's BRDF (n 46), a floor of Oren and Nayar's and a wall of Strauss's, under a square light with one bounce, {most} \
             samples."
        ),
        differences: format!(
            "{UNKNOWN_FILES} Its mesh is a scanned dragon of 200,000 faces. The parameters of the wall and the diffuse part of the dragon are not printed."
        ),
        findings,
        tables,
        pictures,
    }
}
