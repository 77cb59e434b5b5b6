//! The scenes that need other shapes than spheres: 1, 3, 4 and 6.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use merlkit::Result;
use merlkit::color::Rgb;
use merlkit::light::{Area, EnvironmentSource, LightSpec};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::render::{Camera, ObjectSpec, SceneSpec, Shape};
use merlkit::sampler::SamplerSpec;
use merlkit_scene::{
    Instance, Quad, Shading, Sides, TriangleMesh, jar_profile, revolve, smooth_profile,
};

use super::bench::ThesisBench;
use super::contenders::{CANDIDATES, Way};
use super::exhibit::{Exhibit, ResultTable, Thumbnail};
use super::plan::ThesisPlan;
use super::published::{PublishedTable, published_number};
use super::ranking::{compare_errors, describe_references};
use super::spheres::{REFERENCE, thumbnails};
use super::stage::{SceneSampler, StagePiece, ThesisScene};
use super::subjects::{Subject, models};

/// What is said of every scene with meshes.
pub(super) const UNKNOWN_FILES: &str = "The thesis's files are not available.";

/// A scene without objects, seen by a camera.
pub(super) fn empty_scene(names: &[String], camera: Camera, depth: u32) -> SceneSpec {
    let mut spec = SceneSpec::row(names, 1.0);
    spec.spheres.clear();
    spec.camera = camera;
    spec.depth = depth;
    spec
}

/// The models of a scene that renders each of them: all, or four in a quick run.
fn chosen_models(plan: &ThesisPlan) -> Vec<Subject> {
    let every = if plan.quick { 4 } else { 1 };
    models().into_iter().step_by(every).collect()
}

/// A corner, two edges, and the number of a colour.
type Wall = ([f64; 3], [f64; 3], [f64; 3], usize);

/// Corners and edges of the walls of Cornell's room, in millimetres, each with the number of its colour. Normals point inside.
const WALLS: [Wall; 5] = [
    // Floor, ceiling, back.
    ([0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [556.0, 0.0, 0.0], 1),
    ([0.0, 548.8, 0.0], [556.0, 0.0, 0.0], [0.0, 0.0, 559.2], 1),
    ([0.0, 0.0, 559.2], [0.0, 548.8, 0.0], [556.0, 0.0, 0.0], 1),
    // Left and right as the camera sees them.
    ([556.0, 0.0, 0.0], [0.0, 0.0, 559.2], [0.0, 548.8, 0.0], 0),
    ([0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 0.0, 559.2], 2),
];
/// Red, white and green.
const COLOURS: [&str; 3] = ["0.63/0.065/0.05", "0.725/0.71/0.68", "0.14/0.45/0.09"];

/// Cornell's room without blocks, of one BRDF in three colours.
fn room(subject: &Subject, plan: &ThesisPlan) -> Result<ThesisScene> {
    let mut materials = Vec::new();
    let mut names = Vec::new();
    for colour in COLOURS {
        materials.push(subject.coloured(colour).load()?);
        names.push(format!("{} {colour}", subject.name));
    }
    let camera = Camera {
        eye: DVec3::new(278.0, 273.0, -800.0),
        target: DVec3::new(278.0, 273.0, 0.0),
        vertical_angle: 39.3f64.to_radians(),
    };
    let mut spec = empty_scene(&names, camera, 2);
    for (corner, edge_u, edge_v, material) in WALLS {
        let [corner, edge_u, edge_v] = [corner, edge_u, edge_v].map(DVec3::from_array);
        spec.objects.push(ObjectSpec {
            shape: Arc::new(Quad::new(corner, edge_u, edge_v)?),
            material,
        });
    }
    spec.lights = vec![LightSpec::Area(Area {
        // A tenth of a millimetre below the ceiling.
        corner: DVec3::new(213.0, 548.7, 227.0),
        edge_u: DVec3::new(130.0, 0.0, 0.0),
        edge_v: DVec3::new(0.0, 0.0, 105.0),
        radiance: Rgb::new(17.0, 12.0, 4.0),
    })];
    Ok(ThesisScene {
        spec,
        size: [plan.side; 2],
        materials,
        reference: REFERENCE.parse()?,
    })
}

/// A contender for every material of a stage, which all have the same name in the thesis's tables.
fn contend(
    way: Way,
    candidates: Option<(u32, &'static str)>,
    subject: &str,
    materials: &[Loaded],
    plan: &ThesisPlan,
) -> Result<SceneSampler> {
    let mut specs = Vec::new();
    for material in materials {
        specs.push(way.spec(subject, material, plan)?);
    }
    Ok(SceneSampler {
        name: candidates.map_or(way.name(), |resampled| resampled.1),
        specs,
        candidates: candidates.map_or(1, |resampled| resampled.0),
        samples: plan.samples.clone(),
    })
}

/// Who draws in the room: the thesis's four.
const ROOM_WAYS: [Way; 4] = [
    Way::Uniform,
    Way::LobeSphere,
    Way::LobeHemisphere,
    Way::Disc,
];

/// Scene 1: tables 6.7 and 6.8.
pub(super) fn scene_1(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut pieces = Vec::new();
    for subject in chosen_models(&bench.plan) {
        let piece = bench.piece(&format!("scene-1/{}", subject.name), |plan| {
            let stage = room(&subject, plan)?;
            let mut contenders = Vec::new();
            for way in ROOM_WAYS {
                contenders.push(contend(way, None, subject.name, &stage.materials, plan)?);
            }
            stage.compare(&contenders, plan)
        })?;
        pieces.push((subject.name, piece));
    }
    let names = ROOM_WAYS.map(Way::name);
    let caption =
        "Table 6.8: mean relative error in percent, by samples per pixel, mean over the BRDFs";
    let (errors, mut findings) =
        compare_errors("6.8", caption, &names, &pieces, &bench.plan.samples);
    findings.push(
        "The thesis's errors of the room don't fall as 1/√N either: the disc's stay between 8.6 and 10 % from 100 to 2500 samples, \
         and one lobe's seconds are printed twice for 225 and 400."
            .into(),
    );
    findings.push(describe_references(&pieces));
    let times = room_times(&pieces, bench.plan.most_samples());
    let shown = thumbnails(&pieces, &[pieces.last().map_or("", |piece| piece.0)]);
    Ok(describe_scene_1(
        bench.plan.side,
        pieces.len(),
        findings,
        vec![errors, times],
        shown,
    ))
}

/// Table 6.7: seconds over those of uniform directions.
fn room_times(pieces: &[(&str, StagePiece)], most: u64) -> ResultTable {
    let mut times = ResultTable::new(
        "Table 6.7: seconds over those of uniform directions at the most samples; the thesis's of drawing, ours of drawing alone and of rendering",
        &[
            "sampler",
            "thesis, drawing",
            "ours, drawing",
            "ours, rendering",
        ],
    );
    let row = most.to_string();
    let mut sums = Vec::new();
    for name in ROOM_WAYS.map(Way::name) {
        let (mut draw, mut whole) = (0.0, 0.0);
        for (_, piece) in pieces {
            if let Some(result) = piece.find(name, most) {
                draw += result.draw_ns;
                whole += result.seconds.cpu;
            }
        }
        sums.push([draw, whole]);
        times.push(vec![
            name.into(),
            published_number("6.7", &row, name)
                .zip(published_number("6.7", &row, "uniform"))
                .map(|(one, base)| one / base)
                .into(),
            (draw / sums[0][0]).into(),
            (whole / sums[0][1]).into(),
        ]);
    }
    times
}

/// What scene 1 is, with its results.
fn describe_scene_1(
    side: usize,
    count: usize,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    Exhibit {
        name: "scene-1".into(),
        title: "Scene 1, tables 6.7 and 6.8: Cornell's room without blocks".into(),
        method: format!(
            "Five walls of one BRDF in three colours, light from a rectangle under the ceiling and from one bounce, {0} × {0} pixels, BRDF directions \
             alone, {1} of the 16 BRDFs.",
            side, count
        ),
        differences: "The thesis's room has 1000 triangles and the same walls; its depth of paths is not printed, and its resolution is 256 × 256. Colours and \
                      light are Cornell's. Its reference is the mean over all samplers."
            .into(),
        findings,
        tables,
        pictures,
    }
}

/// A jar that rests on y = 0, about 1 high.
fn jar(plan: &ThesisPlan) -> Result<Arc<dyn Shape>> {
    let points = if plan.quick { 24 } else { 48 };
    let profile = smooth_profile(&jar_profile(), points + 1);
    let data = revolve(&profile, points)?;
    Ok(Arc::new(TriangleMesh::build(
        &data,
        Sides::Both,
        Shading::Flat,
    )?))
}

/// The largest distance between the jars' axes and the height that the camera looks at.
const JAR_STEP: f64 = 1.1;

/// Jars side by side, each of its material, without lights.
fn jars(materials: Vec<Loaded>, size: [usize; 2], plan: &ThesisPlan) -> Result<ThesisScene> {
    let names: Vec<String> = materials.iter().map(|m| m.name().to_owned()).collect();
    let aspect = size[0] as f64 / size[1] as f64;
    let width = JAR_STEP * materials.len() as f64 + 0.3;
    let target = DVec3::new(0.0, 0.5, 0.0);
    let distance = 6.0;
    // The jars' width or their height of 1 fills the picture, with a margin.
    let height = (width / aspect).max(1.3);
    let camera = Camera {
        eye: target + DVec3::new(0.0, 0.25, 1.0).normalize() * distance,
        target,
        vertical_angle: 2.0 * (0.5 * height / distance).atan(),
    };
    let mut spec = empty_scene(&names, camera, 2);
    let shape = jar(plan)?;
    for material in 0..materials.len() {
        let x = (material as f64 - (materials.len() - 1) as f64 * 0.5) * JAR_STEP;
        let placed = Instance::new(
            shape.clone(),
            DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)),
        )?;
        spec.objects.push(ObjectSpec {
            shape: Arc::new(placed),
            material,
        });
    }
    Ok(ThesisScene {
        spec,
        size,
        materials,
        reference: REFERENCE.parse()?,
    })
}

/// The three jars' BRDFs, with the names of their factorisations.
const JARS: [(&str, &str); 3] = [
    (
        "beardmaxwell",
        "beardmaxwell:omega=1,tau=0,nreal=0.37,nimag=2.82,Rs=0.7,Rd=0.5,Rv=0.2",
    ),
    ("he", "he:sigma=0.5,tau=3,lambda=800"),
    ("blinn", "blinn:n=100,ks=1,kd=0.67"),
];
/// Who draws there.
pub(super) const JAR_WAYS: [Way; 4] = [Way::Uniform, Way::LobeSphere, Way::Factored, Way::Disc];

/// What the three jars come to.
fn jars_piece(bench: &mut ThesisBench) -> Result<StagePiece> {
    bench.piece("scene-4", |plan| {
        let materials = load_named(&JARS)?;
        let mut stage = jars(materials, [plan.side * 5 / 2, plan.side * 11 / 10], plan)?;
        stage.spec.lights = vec![stage.spec.light("area")?];
        let contenders = contend_named(&JARS, &stage.materials, plan)?;
        stage.compare(&contenders, plan)
    })
}

/// Materials of a scene by our texts.
pub(super) fn load_named(named: &[(&str, &str)]) -> Result<Vec<Loaded>> {
    let mut materials = Vec::new();
    for (_, text) in named {
        materials.push(Material::resolve(text)?.load(LookupRule::Floor)?);
    }
    Ok(materials)
}

/// The samplers of scenes 3 and 4, for materials with the thesis's names.
pub(super) fn contend_named(
    named: &[(&str, &str)],
    materials: &[Loaded],
    plan: &ThesisPlan,
) -> Result<Vec<SceneSampler>> {
    let mut contenders = Vec::new();
    for way in JAR_WAYS {
        let mut specs: Vec<SamplerSpec> = Vec::new();
        for ((name, _), material) in named.iter().zip(materials) {
            specs.push(way.spec(name, material, plan)?);
        }
        contenders.push(SceneSampler {
            name: way.name(),
            specs,
            candidates: 1,
            samples: plan.samples.clone(),
        });
    }
    Ok(contenders)
}

/// Scene 4: three jars.
pub(super) fn scene_4(bench: &mut ThesisBench) -> Result<Exhibit> {
    let piece = jars_piece(bench)?;
    let pieces = [("three jars", piece)];
    let names = JAR_WAYS.map(Way::name);
    let caption =
        "Mean relative error in percent by samples per pixel; the thesis's is its table 6.17";
    let (errors, mut findings) =
        compare_errors("6.17", caption, &names, &pieces, &bench.plan.samples);
    let mut text = ResultTable::new(
        "The thesis's text: 400 samples against 10,000; ours at the most samples",
        &[
            "sampler",
            "thesis, s",
            "thesis, error %",
            "ours, CPU s",
            "ours, error %",
        ],
    );
    for (name, row) in names.into_iter().zip([Some(0), Some(1), None, Some(2)]) {
        let printed = row.map_or([None; 2], |row| text_row("scene-4", row));
        let ours = pieces[0].1.find(name, bench.plan.most_samples());
        text.push(vec![
            name.into(),
            printed[0].into(),
            printed[1].into(),
            ours.map(|r| r.seconds.cpu).into(),
            ours.map(|r| 100.0 * r.error).into(),
        ]);
    }
    findings.push(
        "The thesis's factored BRDF stays at 35 to 39 % from 25 to 2500 samples: that is bias, not noise. Ours keeps 1 % of cosine draws, and its error \
         falls."
            .into(),
    );
    findings.push(describe_references(&pieces));
    Ok(describe_scene_4(
        findings,
        vec![errors, text],
        thumbnails(&pieces, &["three jars"]),
    ))
}

/// What scene 4 is, with its results.
fn describe_scene_4(
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    Exhibit {
        name: "scene-4".into(),
        title: "Scene 4, tables 6.15 to 6.17: three jars".into(),
        method: "Three jars of Beard and Maxwell's, He's and Blinn's BRDFs under a square light, with shadows and one bounce, BRDF directions alone."
            .into(),
        differences: format!(
            "{UNKNOWN_FILES} Ours is a jar of revolution, and its light is ours. The thesis's factorisations are those of its table 6.19 here. Its \
             table 6.17 is a mean over 16 BRDFs, and the text and the tables of this scene exchange the samplers' seconds."
        ),
        findings,
        tables,
        pictures,
    }
}

/// Seconds and percent of a place's row, counted from 0, in the figures of the text.
pub(super) fn text_row(place: &str, row: usize) -> [Option<f64>; 2] {
    let rows = PublishedTable::find("text").map_or_else(Vec::new, |t| t.rows());
    let found = rows.iter().filter(|cells| cells[0] == place).nth(row);
    found.map_or([None; 2], |cells| {
        [cells[3].parse().ok(), cells[4].parse().ok()]
    })
}

/// Who draws in scene 6: candidates of resampling, and the thesis's names.
const RESAMPLED: [(Way, Option<(u32, &str)>); 5] = [
    (Way::Uniform, Some((CANDIDATES, "uniform_ris"))),
    (Way::Factored, None),
    (Way::Factored, Some((CANDIDATES, "factored_ris"))),
    (Way::Disc, None),
    (Way::Disc, Some((CANDIDATES, "adaptive_disc_ris"))),
];

/// Scene 6: one jar under an environment.
pub(super) fn scene_6(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut pieces = Vec::new();
    for subject in chosen_models(&bench.plan) {
        let piece = bench.piece(&format!("scene-6/{}", subject.name), |plan| {
            let mut stage = jars(vec![subject.load()?], [plan.side; 2], plan)?;
            stage.spec.lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
            let mut contenders = Vec::new();
            for (way, candidates) in RESAMPLED {
                let materials = &stage.materials;
                contenders.push(contend(way, candidates, subject.name, materials, plan)?);
            }
            stage.compare(&contenders, plan)
        })?;
        pieces.push((subject.name, piece));
    }
    let names = [
        "uniform_ris",
        "factored",
        "factored_ris",
        "adaptive_disc",
        "adaptive_disc_ris",
    ];
    let caption =
        "Table 6.22: mean relative error in percent, by samples per pixel, mean over the BRDFs";
    let (errors, mut findings) =
        compare_errors("6.22", caption, &names, &pieces, &bench.plan.samples);
    findings.push(
        "The thesis's text says that RIS takes the disc's error from 4.74 to 2.32 %; its table has 4.72 and 3.90 % at 2500 samples, and larger errors with \
         RIS up to 400."
            .into(),
    );
    findings.push(describe_references(&pieces));
    Ok(Exhibit {
        name: "scene-6".into(),
        title: "Scene 6, tables 6.20 to 6.22: a jar under an environment, with resampling".into(),
        method: format!(
            "One jar in the built-in studio with shadows and one bounce, {0} × {0} pixels; RIS keeps one of {CANDIDATES} directions. {1} of the 16 \
             BRDFs.",
            bench.plan.side,
            pieces.len()
        ),
        differences: format!(
            "{UNKNOWN_FILES} Its environment is a photograph; ours is the built-in studio. It doesn't say how many candidates it resamples."
        ),
        findings,
        tables: vec![errors],
        pictures: thumbnails(&pieces, &[pieces.last().map_or("", |piece| piece.0)]),
    })
}
