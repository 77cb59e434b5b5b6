//! The scenes that are made of spheres: 2, 5 and 7.

use glam::DVec3;

use merlkit::Result;
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::render::{Camera, SceneSpec, Sphere, SphereSpec};
use merlkit::sampler::SamplerSpec;

use super::bench::{KB, ThesisBench, published_disc};
use super::contenders::{Way, disc};
use super::exhibit::{Exhibit, ResultCell, ResultTable, Thumbnail, mean, write_ratio};
use super::plan::ThesisPlan;
use super::published::published_number;
use super::ranking::{compare_errors, describe_levels, describe_references};
use super::stage::{SceneSampler, StagePiece, StageResult, ThesisScene};
use super::subjects::{Subject, measured, models};

/// The reference's sampler for analytic BRDFs: half of the draws follow the cosine, and directions towards the light do the rest.
pub(super) const REFERENCE: &str = "lobe:ggx,parameters=0.2/0.2/0.5";

/// One sphere under an area light, direct light only.
fn sphere_stage(subject: &Subject, plan: &ThesisPlan) -> Result<ThesisScene> {
    let mut spec = SceneSpec::row(&[subject.name.to_owned()], 1.0);
    spec.lights = vec![spec.light("area")?];
    spec.depth = 1;
    Ok(ThesisScene {
        spec,
        size: [plan.side; 2],
        materials: vec![subject.load()?],
        reference: REFERENCE.parse()?,
    })
}

/// Who draws in scene 2.
fn sphere_ways(plan: &ThesisPlan) -> Vec<Way> {
    let mut ways = vec![
        Way::Uniform,
        Way::LobeSphere,
        Way::LobeHemisphere,
        Way::Factored,
        Way::Disc,
    ];
    if !plan.quick {
        ways.extend([
            Way::LobeSphere30,
            Way::LobeHemisphere30,
            Way::DiscAsPublished,
        ]);
    }
    ways
}

/// Scene 2: tables 6.9 to 6.14.
pub(super) fn scene_2(bench: &mut ThesisBench) -> Result<Exhibit> {
    let mut pieces = Vec::new();
    for subject in models() {
        let piece = bench.piece(&format!("scene-2/{}", subject.name), |plan| {
            let stage = sphere_stage(&subject, plan)?;
            let mut contenders = Vec::new();
            for way in sphere_ways(plan) {
                contenders.push(way.contend(subject.name, &stage.materials[0], plan)?);
            }
            stage.compare(&contenders, plan)
        })?;
        pieces.push((subject.name, piece));
    }
    let names: Vec<&str> = sphere_ways(&bench.plan).iter().map(|w| w.name()).collect();
    let caption = "Mean relative error in percent over the 16 BRDFs, by samples per pixel; the thesis's is its table 6.14 (sphere 2, best parameters)";
    let (errors, mut findings) =
        compare_errors("6.14", caption, &names, &pieces, &bench.plan.samples);
    findings.push(describe_levels("6.12"));
    findings.push(describe_levels("6.14"));
    findings.push(describe_references(&pieces));
    let tables = vec![errors, disc_by_model(&pieces), draw_ratios(&pieces)];
    Ok(Exhibit {
        name: "scene-2".into(),
        title: "Scene 2, tables 6.9 to 6.14: a sphere under an area light".into(),
        method: format!(
            "A unit sphere under a square light, direct light only, {0} × {0} pixels, BRDF directions alone. Lobes are fitted to each BRDF \
             with a fraction of cosine, the factored BRDF has the numbers of table 6.19 and 1 % of cosine, and the disc is ours. \
             The reference is MIS with {1} samples of other random numbers.",
            bench.plan.side, bench.plan.reference_samples
        ),
        differences: "Place and size of the light, the view, and the resolution (256 × 256 there). The thesis's uniform directions are ours on the \
                      disc. Its reference is the mean over all samplers, biased ones included; ours is unbiased and says its own error."
            .into(),
        findings,
        tables,
        pictures: thumbnails(&pieces, &["ward", "phong", "he"]),
    })
}

/// Pictures of some materials: the reference and every contender's.
pub(super) fn thumbnails(pieces: &[(&str, StagePiece)], shown: &[&str]) -> Vec<Thumbnail> {
    let mut pictures = Vec::new();
    for (name, piece) in pieces.iter().filter(|piece| shown.contains(&piece.0)) {
        pictures.push(Thumbnail {
            caption: format!(
                "{name}: reference, own error {:.2} %",
                100.0 * piece.reference_error
            ),
            png: piece.reference_png.clone(),
        });
        for result in piece.results.iter().filter(|r| !r.png.is_empty()) {
            pictures.push(Thumbnail {
                caption: format!(
                    "{name}: {}, {} samples, error {:.1} %",
                    result.name,
                    result.samples,
                    100.0 * result.error
                ),
                png: result.png.clone(),
            });
        }
    }
    pictures
}

/// Table 6.10: the disc's error for each BRDF.
fn disc_by_model(pieces: &[(&str, StagePiece)]) -> ResultTable {
    let mut table = ResultTable::new(
        "Table 6.10: mean relative error of the disc in percent, for each BRDF",
        &[
            "BRDF",
            "thesis, 1",
            "ours, 1",
            "thesis, 25",
            "ours, 25",
            "thesis, 10⁶",
        ],
    );
    for (name, piece) in pieces {
        let mut row = vec![ResultCell::from(*name)];
        for (samples, column) in [(1, "n1"), (25, "n25")] {
            row.push(published_number("6.10", name, column).into());
            let ours = piece.find(Way::Disc.name(), samples);
            row.push(ours.map(|r| 100.0 * r.error).into());
        }
        row.push(published_number("6.10", name, "n1000000").into());
        table.push(row);
    }
    table.push_mean();
    table
}

/// Tables 6.11 and 6.13: what a draw costs over a uniform one.
fn draw_ratios(pieces: &[(&str, StagePiece)]) -> ResultTable {
    let mut table = ResultTable::new(
        "Table 6.13: time of drawing over that of uniform directions; the thesis's at 2500 samples, ours of a draw measured alone, mean over the BRDFs",
        &["sampler", "thesis, ratio", "ours, ratio", "ours, ns a draw"],
    );
    let printed_uniform = published_number("6.13", "uniform", "n2500");
    let uniform = mean_draw(pieces, Way::Uniform);
    for way in [
        Way::Uniform,
        Way::LobeSphere,
        Way::LobeHemisphere,
        Way::Factored,
        Way::Disc,
    ] {
        let ours = mean_draw(pieces, way);
        let ratio = published_number("6.13", way.name(), "n2500").zip(printed_uniform);
        table.push(vec![
            way.name().into(),
            ratio.map(|(one, base)| one / base).into(),
            (ours / uniform).into(),
            ours.into(),
        ]);
    }
    table
}

fn mean_draw(pieces: &[(&str, StagePiece)], way: Way) -> f64 {
    let mut costs = Vec::new();
    for (_, piece) in pieces {
        let result = piece.results.iter().find(|r| r.name == way.name());
        costs.extend(result.map(|r| r.draw_ns));
    }
    mean(&costs)
}

/// Exponents of scene 5.
const EXPONENTS: [u32; 6] = [10, 25, 50, 100, 150, 200];

/// Spheres of Lafortune's BRDF with rising exponents under an area light; `kp` is the diffuse part.
fn exponents_stage(kp: &str, light: &str, plan: &ThesisPlan) -> Result<ThesisScene> {
    let mut names = Vec::new();
    let mut materials = Vec::new();
    for exponent in EXPONENTS {
        let text = format!("lafortune:n={exponent},kp={kp},Cx=-1,Cy=-1,Cz=1");
        materials.push(Material::resolve(&text)?.load(LookupRule::Floor)?);
        names.push(text);
    }
    let mut spec = SceneSpec::row(&names, 6.0);
    spec.lights = vec![spec.light(light)?];
    spec.depth = 1;
    Ok(ThesisScene {
        spec,
        size: [6 * plan.side, plan.side],
        materials,
        reference: REFERENCE.parse()?,
    })
}

/// Samples of the disc and of uniform directions: the thesis's, or a quarter of them.
fn headline_samples(plan: &ThesisPlan) -> [u64; 2] {
    if plan.quick { [25, 625] } else { [100, 2500] }
}

/// Diffuse parts and lights of scene 5: the thesis names neither.
const HEADLINES: [(&str, &str); 3] = [("0", "area"), ("0", "studio"), ("0.96", "studio")];

/// What the spheres of scene 5 come to with a diffuse part, under a light.
fn exponents_piece(bench: &mut ThesisBench, [kp, light]: [&str; 2]) -> Result<StagePiece> {
    let [few, many] = headline_samples(&bench.plan);
    bench.piece(&format!("scene-5/{kp}/{light}"), |plan| {
        let stage = exponents_stage(kp, light, plan)?;
        let mut discs = Vec::new();
        for material in &stage.materials {
            discs.push(disc(material, plan)?);
        }
        let uniform = vec!["cosine".parse::<SamplerSpec>()?; discs.len()];
        let contenders = [
            contender(Way::Uniform.name(), uniform, vec![few, many]),
            contender(Way::Disc.name(), discs, vec![few]),
        ];
        stage.compare(&contenders, plan)
    })
}

/// Scene 5: a hundred samples of the disc against 2500 uniform ones.
pub(super) fn scene_5(bench: &mut ThesisBench) -> Result<Exhibit> {
    let samples = headline_samples(&bench.plan);
    let mut table = ResultTable::new(
        "Six spheres of Lafortune's BRDF, n = 10 to 200: the mean error counts each lit pixel by its own brightness, the root mean square \
         counts bright pixels most",
        &[
            "kp and light",
            "sampler",
            "samples",
            "thesis, s",
            "ours, CPU s",
            "ours, mean error %",
            "ours, root mean square %",
        ],
    );
    let mut findings = Vec::new();
    let mut pieces = Vec::new();
    for (kp, light) in HEADLINES {
        let piece = exponents_piece(bench, [kp, light])?;
        for result in &piece.results {
            table.push(vec![
                format!("{kp}, {light}").into(),
                result.name.as_str().into(),
                (result.samples as f64).into(),
                printed_seconds(result, samples, &bench.plan).into(),
                result.seconds.cpu.into(),
                (100.0 * result.error).into(),
                (100.0 * result.rms).into(),
            ]);
        }
        findings.extend(headline([kp, light], &piece, samples));
        pieces.push((light, piece));
    }
    findings.push("In the thesis 100 samples of the disc take 43.45 s and 2500 uniform ones 150.54 s, 3.5 times as long, for a picture that it calls worse. It prints no errors.".into());
    findings.push(describe_references(&pieces));
    Ok(describe_scene_5(
        &bench.plan,
        findings,
        vec![table],
        thumbnails(&pieces, &["area", "studio"]),
    ))
}

/// The thesis's seconds; a quick run has other numbers of samples.
fn printed_seconds(result: &StageResult, [few, _]: [u64; 2], plan: &ThesisPlan) -> Option<f64> {
    let seconds = match (result.name.as_str(), result.samples == few) {
        ("uniform", true) => 6.11,
        ("uniform", false) => 150.54,
        _ => 43.45,
    };
    (!plan.quick).then_some(seconds)
}

/// What scene 5 is, with its results.
fn describe_scene_5(
    plan: &ThesisPlan,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    let [few, many] = headline_samples(plan);
    Exhibit {
        name: "scene-5".into(),
        title: "Scene 5, figure 6.19: the disc at few samples against uniform directions at many".into(),
        method: format!(
            "Six unit spheres under a square light or in the studio, direct light only, {} × {} pixels, {few} samples of our disc and {many} of uniform directions; CPU \
             seconds of rendering.",
            6 * plan.side,
            plan.side
        ),
        differences: "The thesis doesn't describe its objects, its light or the diffuse part: both none (kp 0) and that of its table 6.18 (0.96) are tried. A \
                      quick run has a quarter of its samples, in the same ratio."
            .into(),
        findings,
        tables,
        pictures,
    }
}

fn contender(name: &'static str, specs: Vec<SamplerSpec>, samples: Vec<u64>) -> SceneSampler {
    SceneSampler {
        name,
        specs,
        candidates: 1,
        samples,
    }
}

/// The ratios of errors and of seconds.
fn headline([kp, light]: [&str; 2], piece: &StagePiece, [few, many]: [u64; 2]) -> Option<String> {
    let disc = piece.find(Way::Disc.name(), few)?;
    let uniform = piece.find(Way::Uniform.name(), many)?;
    Some(format!(
        "With kp {kp} and the light \"{light}\", {many} uniform samples have {} times the mean error and {} times the root mean square error of \
         {few} samples of the disc, in {} times its CPU seconds.",
        write_ratio(uniform.error / disc.error),
        write_ratio(uniform.rms / disc.rms),
        write_ratio(uniform.seconds.cpu / disc.seconds.cpu)
    ))
}

/// Spheres in a row of scene 7.
const ACROSS: usize = 6;

/// Eleven spheres of measured materials in two rows under the studio.
fn measured_stage(subjects: &[Subject], plan: &ThesisPlan) -> Result<ThesisScene> {
    let size = match plan.quick {
        true => [plan.side * 9 / 2, plan.side * 2],
        false => [450, 200],
    };
    let aspect = size[0] as f64 / size[1] as f64;
    let names: Vec<String> = subjects.iter().map(|s| s.name.to_owned()).collect();
    let mut spec = SceneSpec::row(&names, aspect);
    spec.spheres.clear();
    for material in 0..names.len() {
        let (column, row) = (material % ACROSS, material / ACROSS);
        let x = (column as f64 - (ACROSS - 1) as f64 * 0.5) * 2.25;
        spec.spheres.push(SphereSpec {
            shape: Sphere {
                centre: DVec3::new(x, 1.0 + 2.25 * (1 - row) as f64, 0.0),
                radius: 1.0,
            },
            material,
        });
    }
    // The two rows are 4.25 high, and the picture 5.4 at the spheres.
    let distance = 20.0;
    let target = DVec3::new(0.0, 2.125, 0.0);
    spec.camera = Camera {
        eye: target + DVec3::new(0.0, 0.0, distance),
        target,
        vertical_angle: 2.0 * (0.5 * 14.4 / aspect / distance).atan(),
    };
    spec.lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
    spec.depth = 1;
    let mut materials: Vec<Loaded> = Vec::new();
    for subject in subjects {
        materials.push(subject.load()?);
    }
    Ok(ThesisScene {
        spec,
        size,
        materials,
        reference: "half-vector".parse()?,
    })
}

/// Who draws in scene 7: names, and the columns of table 6.23 that they have.
const MEASURED_WAYS: [(&str, &str); 6] = [
    ("uniform", ""),
    ("uniform_cdf", "uniform_cdf"),
    ("compressed_cdf", "compressed_cdf"),
    ("adaptive_disc, as published", "adaptive_disc"),
    ("adaptive_disc", ""),
    ("half-vector", ""),
];

fn measured_specs(name: &str, materials: &[Loaded], plan: &ThesisPlan) -> Result<Vec<SamplerSpec>> {
    let ThesisPlan { tables, cells, .. } = plan;
    let mut specs = Vec::new();
    for material in materials {
        specs.push(match name {
            "uniform" => "cosine".parse()?,
            "uniform_cdf" => format!("cascade-cdf:published-uniform,tables={tables}").parse()?,
            "compressed_cdf" => format!(
                "cascade-cdf:published,tables={tables},cells={}x{}",
                cells[0], cells[1]
            )
            .parse()?,
            "half-vector" => "half-vector".parse()?,
            "adaptive_disc" => disc(material, plan)?,
            _ => published_disc([plan.trees, plan.image], material, "")?,
        });
    }
    Ok(specs)
}

/// Scene 7: measured materials.
pub(super) fn scene_7(bench: &mut ThesisBench) -> Result<Exhibit> {
    let subjects = measured("6.23");
    let piece = bench.piece("scene-7", |plan| {
        let stage = measured_stage(&subjects, plan)?;
        let mut contenders = Vec::new();
        for (name, _) in MEASURED_WAYS {
            let specs = measured_specs(name, &stage.materials, plan)?;
            contenders.push(contender(name, specs, vec![25]));
        }
        stage.compare(&contenders, plan)
    })?;
    let tables = vec![
        measured_table(&piece, subjects.len()),
        errors_by_sphere(&piece, &subjects),
    ];
    let mut findings = Vec::new();
    let mut results = piece.results.iter().collect::<Vec<_>>();
    results.sort_by(|a, b| a.error.total_cmp(&b.error));
    findings.extend(results.first().map(|best| {
        format!(
            "The least error at 25 samples has {} ({:.1} %). The thesis prints no errors for this scene.",
            best.name,
            100.0 * best.error
        )
    }));
    let pieces = [("11 materials", piece)];
    findings.push(describe_references(&pieces));
    let pictures = thumbnails(&pieces, &["11 materials"]);
    Ok(describe_scene_7(&bench.plan, findings, tables, pictures))
}

/// What each sampler of scene 7 costs a material, and its error.
fn measured_table(piece: &StagePiece, materials: usize) -> ResultTable {
    let mut table = ResultTable::new(
        "Eleven measured materials at 25 samples: KB (1024 bytes) and seconds a material; ours are CPU seconds",
        &[
            "sampler",
            "thesis, KB",
            "ours, KB",
            "thesis, build s",
            "ours, build s",
            "ours, render s",
            "ours, error %",
        ],
    );
    let count = materials as f64;
    for (name, column) in MEASURED_WAYS {
        let Some(result) = piece.find(name, 25) else {
            continue;
        };
        table.push(vec![
            name.into(),
            published_number("6.23", "average", &format!("{column}_kb")).into(),
            (result.bytes as f64 / KB / count).into(),
            published_number("6.23", "average", &format!("{column}_s")).into(),
            (result.build_seconds / count).into(),
            result.seconds.cpu.into(),
            (100.0 * result.error).into(),
        ]);
    }
    table
}

/// Errors of scene 7 for each material.
fn errors_by_sphere(piece: &StagePiece, subjects: &[Subject]) -> ResultTable {
    let mut heading = vec!["material"];
    for result in &piece.results {
        heading.push(&result.name);
    }
    let mut errors = ResultTable::new("Mean relative error in percent for each sphere", &heading);
    for (i, subject) in subjects.iter().enumerate() {
        let mut row = vec![ResultCell::from(subject.name)];
        for result in &piece.results {
            row.push(result.errors.get(i).map(|error| 100.0 * error).into());
        }
        errors.push(row);
    }
    errors
}

/// What scene 7 is, with its results.
fn describe_scene_7(
    plan: &ThesisPlan,
    findings: Vec<String>,
    tables: Vec<ResultTable>,
    pictures: Vec<Thumbnail>,
) -> Exhibit {
    Exhibit {
        name: "scene-7".into(),
        title: "Scene 7, figure 6.22: eleven measured materials".into(),
        method: format!(
            "Eleven unit spheres in the built-in studio, light from the environment alone, {} samples of the reference.",
            plan.reference_samples
        ),
        differences: "The thesis doesn't describe its scene. The built-in materials approximate the measurements that it had. Its KB and seconds are those \
                      of 512 tables or 60 trees."
            .into(),
        findings,
        tables,
        pictures,
    }
}
