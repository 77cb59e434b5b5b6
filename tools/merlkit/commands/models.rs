//! `merlkit models`

use std::process::ExitCode;

use merlkit::brdf::Brdf;
use merlkit::geometry::{Quadrature, Symmetry, spherical};
use merlkit::material::analytic::ModelFacts;
use merlkit::material::{LookupRule, Material};
use merlkit::{Error, color};
use merlkit_evaluate::report::{Sheet, write_json};
use serde::Serialize;

use crate::failure::Outcome;
use crate::output;
use crate::output::Destination;
use crate::provenance::record_command;
use crate::table;

/// List the analytic models, or the parameters of one model with a drawing
///
/// A model is written NAME or NAME:KEY=VALUE,KEY=VALUE…, and is a MATERIAL of every command. Omitted parameters have their
/// defaults.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit models                        # all of them\n  merlkit models ward                   # its parameters, their domains and defaults\n  merlkit models ward:sx=0.1,sy=0.4     # what it is with these parameters"
)]
pub struct Args {
    /// The model whose parameters are listed, with or without values of them [default: list all models]
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Write JSON instead of text, to FILE or, without FILE, to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let chosen = match &args.name {
        Some(name) => vec![ModelFacts::parse(name)?],
        None => ModelFacts::all(),
    };
    if let Some(destination) = &args.json {
        let mut all = Vec::with_capacity(chosen.len());
        for facts in chosen {
            all.push(Measured::new(facts)?);
        }
        destination.write(output::overwrite(args.force), |out| {
            write_json(out, "models", &record_command(), &all)
        })?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = match (&args.name, &chosen[..]) {
        (Some(_), [one]) => describe(one)?,
        _ => list(&chosen),
    };
    output::stdout(|out| write!(out, "{}", table::wrap(&text)))?;
    Ok(ExitCode::SUCCESS)
}

/// Angles of the viewer at which the albedo is listed, in degrees.
const ANGLES: [f64; 4] = [1.0, 45.0, 75.0, 85.0];

/// Points a bin of the half vector's angle of these albedos.
const POINTS: usize = 55;

/// The viewer's angle of the drawing, in degrees.
const DRAWN_ANGLE: f64 = 45.0;

/// A model with its albedo.
#[derive(Serialize)]
struct Measured {
    #[serde(flatten)]
    facts: ModelFacts,
    /// Mean of the channels, mirror included, by angle of the viewer in degrees.
    albedo: Vec<(f64, f64)>,
}

impl Measured {
    fn new(facts: ModelFacts) -> Result<Self, Error> {
        let brdf = load(&facts)?;
        let mut albedo = Vec::with_capacity(ANGLES.len());
        for angle in ANGLES {
            albedo.push((angle, measure_albedo(&*brdf, angle)));
        }
        Ok(Self { facts, albedo })
    }
}

fn load(facts: &ModelFacts) -> Result<std::sync::Arc<dyn Brdf>, Error> {
    let loaded = Material::resolve(&facts.material)?.load(LookupRule::default())?;
    Ok(loaded.brdf().clone())
}

/// The mean of the channels' directional albedos, mirror included.
fn measure_albedo(brdf: &dyn Brdf, degrees: f64) -> f64 {
    let wo = spherical(degrees.to_radians(), 0.0).as_vec3();
    let mirror = color::mean(brdf.mirror(wo).unwrap_or_default());
    let lobe =
        Quadrature::new(wo, POINTS).integrate(|wi| f64::from(color::mean(brdf.eval_cos(wo, wi))));
    f64::from(mirror) + lobe
}

/// All models, a line each.
fn list(all: &[ModelFacts]) -> String {
    let mut sheet = Sheet::new(&["model", "description", "source", "parameters"]);
    for one in all {
        let mut keys = Vec::with_capacity(one.parameters.len());
        for parameter in &one.parameters {
            keys.push(parameter.key);
        }
        sheet.push(vec![
            one.name.to_owned(),
            one.summary.to_owned(),
            one.source.to_owned(),
            keys.join(" "),
        ]);
    }
    format!(
        "{}\n`merlkit models NAME` lists the parameters of a model. Example of a MATERIAL: ward:sx=0.2,sy=0.4,ks=0.5,kd=0.5\n",
        table::render(&sheet)
    )
}

/// One model: its parameters, what is known of it, and a drawing.
fn describe(facts: &ModelFacts) -> Result<String, Error> {
    let mut sheet = Sheet::new(&["parameter", "domain", "default", "meaning"]);
    for parameter in &facts.parameters {
        let mut key = parameter.key.to_owned();
        for alias in &parameter.aliases {
            key += &format!(", {alias}");
        }
        sheet.push(vec![
            key,
            parameter.domain.clone(),
            parameter.default.clone(),
            parameter.meaning.to_owned(),
        ]);
    }
    let measured = Measured::new(facts.clone())?;
    Ok(format!(
        "{}: {}\nSource: {}\n\n{}\n{}\n{}{}\nMATERIAL: {}\n",
        facts.name,
        facts.summary,
        facts.source,
        table::render(&sheet),
        describe_values(facts),
        describe_albedo(&measured),
        draw_lobe(&*load(facts)?),
        facts.material
    ))
}

/// Reciprocity, bounds, symmetry and delta part.
fn describe_values(facts: &ModelFacts) -> String {
    let reciprocal = if facts.reciprocal { "yes" } else { "no" };
    let bounded = if facts.bounded {
        "yes"
    } else {
        "no, it grows without bound towards the horizon"
    };
    let symmetry = match facts.symmetry {
        Symmetry::Isotropic => "isotropic",
        Symmetry::Quarter => "anisotropic, symmetric to the x and y axes",
        Symmetry::Half => "anisotropic, symmetric under half a turn",
        Symmetry::Whole => "anisotropic, without symmetry",
    };
    let mirror = if facts.has_mirror {
        "a mirror direction, which `render` shows and `eval` leaves out"
    } else {
        "none"
    };
    format!(
        "Reciprocal: {reciprocal}\nBounded: {bounded}\nSymmetry: {symmetry}\nDelta part: {mirror}"
    )
}

fn describe_albedo(measured: &Measured) -> String {
    let bound = match measured.facts.albedo_bound {
        Some(bound) => format!("at most {bound:.4}"),
        None => "no bound is known".to_owned(),
    };
    let mut values = Vec::with_capacity(ANGLES.len());
    for (angle, albedo) in &measured.albedo {
        values.push(format!("{albedo:.3} at {angle}°"));
    }
    format!("Albedo: {bound}; {}\n", values.join(", "))
}

/// Rows of the drawing; a character is half as wide as it is high.
const ROWS: usize = 14;
const COLUMNS: usize = 4 * ROWS + 1;

/// The polar lobe of √(f·cosθi) in the plane of incidence, `o` on the side of the viewer and `m` where a mirror reflects.
fn draw_lobe(brdf: &dyn Brdf) -> String {
    let wo = spherical(-DRAWN_ANGLE.to_radians(), 0.0).as_vec3();
    let mut largest = 0.0f32;
    for half_degree in -179..180 {
        let theta = (0.5 * f64::from(half_degree)).to_radians();
        largest = largest.max(radiance(brdf, wo, theta));
    }
    if largest == 0.0 {
        return "No values to draw.\n".to_owned();
    }
    // A character is filled where its middle lies within the lobe.
    let mut rows = vec![vec![' '; COLUMNS]; ROWS];
    for (row, characters) in rows.iter_mut().enumerate() {
        let y = (ROWS - row) as f64 - 0.5;
        for (column, character) in characters.iter_mut().enumerate() {
            let x = 0.5 * (column as f64 - (COLUMNS / 2) as f64);
            let length = (radiance(brdf, wo, x.atan2(y)) / largest).sqrt();
            if x.hypot(y) <= f64::from(length) * ROWS as f64 {
                *character = '*';
            }
        }
    }
    let mirror = brdf.mirror(wo).map(|_| ('m', DRAWN_ANGLE));
    for (letter, degrees) in [Some(('o', -DRAWN_ANGLE)), mirror].into_iter().flatten() {
        let end = spherical(degrees.to_radians(), 0.0) * (ROWS as f64 - 0.5);
        let row = (ROWS as f64 - end.z) as usize;
        rows[row][((COLUMNS / 2) as f64 + 2.0 * end.x).round() as usize] = letter;
    }
    let mut text = format!(
        "\nf·cosθ for a viewer (o) at {DRAWN_ANGLE}°; the length is its root, the longest is {largest:.3} sr⁻¹\n\n"
    );
    for row in rows {
        let line: String = row.into_iter().collect();
        text += &format!("{}\n", line.trim_end());
    }
    text + &"-".repeat(COLUMNS) + "\n"
}

/// f·cosθ in the plane of incidence, where `theta` is signed.
fn radiance(brdf: &dyn Brdf, wo: merlkit::glam::Vec3, theta: f64) -> f32 {
    color::mean(brdf.eval_cos(wo, spherical(theta, 0.0).as_vec3()))
}
