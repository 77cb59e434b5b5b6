//! `merlkit info`

use std::path::Path;
use std::process::ExitCode;

use merlkit::Error;
use merlkit::image::Image;
use merlkit::material::{LookupRule, Material, Origin};
use merlkit::sampler::store::{Record, SamplerFile, looks_like_sampler_file};
use merlkit_evaluate::measure::cloud::PointCloud;
use merlkit_evaluate::measure::facts;
use merlkit_evaluate::report::{Info, Sheet, write_json};
use serde::Serialize;

use crate::batch::{self, Unreadable};
use crate::failure::Outcome;
use crate::output;
use crate::output::Destination;
use crate::progress::Progress;
use crate::provenance;
use crate::{args, table};

/// Print facts about a material: directional albedo, symmetry, size in bytes and, for a table, gaps and range
///
/// For a sampler file, prints the sampler, its settings and its material; for a picture (.exr, .png), what its header says of where it
/// comes from; for a FIT file (.fit), how many values it has, and their ranges.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit info nickel chrome.binary\n  merlkit info brdfs --json facts.json --csv albedos.csv"
)]
pub struct Args {
    /// MERL binaries, .bsdf files, sampler files, pictures or folders of these, names of built-in materials, or formulas
    #[arg(required = true, value_name = "MATERIAL|SAMPLERFILE")]
    sources: Vec<String>,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// Also write JSON to FILE; with -, write JSON to standard output instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Also write the directional albedos as CSV, one line per material and angle, to FILE; with -, write CSV to standard output
    /// instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    csv: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let (mut subjects, mut unreadable) = (Vec::new(), Unreadable::default());
    for source in batch::expand_folders(&args.sources)? {
        match Subject::resolve(&source, &args.tables)? {
            Ok(subject) => subjects.push(subject),
            Err(reason) => unreadable.push(reason),
        }
    }
    let overwrite = output::overwrite(args.force);
    output::refuse_same(args.json.as_ref(), args.csv.as_ref())?;
    for destination in args.json.iter().chain(&args.csv) {
        destination.check(overwrite)?;
    }
    let progress = Progress::new("measuring", subjects.len());
    let (mut results, mut materials) = (Vec::new(), Vec::new());
    for subject in subjects {
        if let Subject::Material(material) = &subject {
            materials.push(material.clone());
        }
        let info = subject.describe(args.lookup)?;
        if ![&args.json, &args.csv].contains(&&Some(Destination::Stdout)) {
            output::stdout(|out| writeln!(out, "{}", table::render(&info.sheet())))?;
        }
        results.push(info);
        progress.advance();
    }
    if let Some(destination) = &args.json {
        let provenance = provenance::record(None, &materials)?;
        destination.write(overwrite, |out| {
            write_json(out, "info", &provenance, &results)
        })?;
    }
    if let Some(destination) = &args.csv {
        let materials = results.iter().filter_map(Description::material);
        destination.write(overwrite, |out| Info::albedo_csv(materials).write_csv(out))?;
    }
    unreadable.end(results.len(), ExitCode::SUCCESS)
}

/// What an argument names.
enum Subject {
    Material(Material),
    Sampler(SamplerDescription),
    Picture(PictureDescription),
    Cloud(CloudDescription),
}

impl Subject {
    /// Fails for an argument that names nothing; holds the reason where it names a file that can't be read.
    fn resolve(argument: &str, tables: &args::TableOptions) -> Result<Result<Self, Error>, Error> {
        let path = Path::new(argument);
        if path.is_file() && looks_like_sampler_file(path) {
            return Ok(SamplerDescription::read(path).map(Self::Sampler));
        }
        let extension = path.extension().unwrap_or_default();
        if path.is_file() && (extension == "exr" || extension == "png") {
            return Ok(PictureDescription::read(path).map(Self::Picture));
        }
        if path.is_file() && extension.eq_ignore_ascii_case("fit") {
            return Ok(CloudDescription::read(path).map(Self::Cloud));
        }
        let material = tables.resolve(argument)?;
        Ok(match material.facts() {
            Ok(_) => Ok(Self::Material(material)),
            Err(reason) => Err(reason),
        })
    }

    fn describe(self, lookup: LookupRule) -> Result<Description, Error> {
        match self {
            Self::Material(material) => {
                Ok(Description::Material(Box::new(measure(&material, lookup)?)))
            }
            Self::Sampler(sampler) => Ok(Description::Sampler(sampler)),
            Self::Picture(picture) => Ok(Description::Picture(picture)),
            Self::Cloud(cloud) => Ok(Description::Cloud(cloud)),
        }
    }
}

/// What is printed of an argument.
#[derive(Serialize)]
#[serde(untagged)]
enum Description {
    Material(Box<Info>),
    Sampler(SamplerDescription),
    Picture(PictureDescription),
    Cloud(CloudDescription),
}

impl Description {
    /// The facts, if it is of a material.
    fn material(&self) -> Option<&Info> {
        match self {
            Self::Material(info) => Some(info),
            _ => None,
        }
    }

    fn sheet(&self) -> Sheet {
        match self {
            Self::Material(info) => info.sheet(),
            Self::Sampler(sampler) => sampler.sheet(),
            Self::Picture(picture) => picture.sheet(),
            Self::Cloud(cloud) => cloud.sheet(),
        }
    }
}

/// A sampler file and what it says of itself.
#[derive(Serialize)]
struct SamplerDescription {
    sampler_file: String,
    file_bytes: u64,
    #[serde(flatten)]
    record: Record,
}

impl SamplerDescription {
    fn read(path: &Path) -> Result<Self, Error> {
        let file_bytes = path
            .metadata()
            .map_err(|e| Error::io(path, "read", e))?
            .len();
        let record = SamplerFile::open(path)?.record().clone();
        Ok(Self {
            sampler_file: path.display().to_string(),
            file_bytes,
            record,
        })
    }

    fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&["sampler file", &self.sampler_file]);
        let source = self.record.path.as_deref().unwrap_or("built in");
        let lookup = self.record.lookup.map_or("none", LookupRule::name);
        let invalid = match self.record.channels_apart {
            true => "channel",
            false => "cell",
        };
        for (name, value) in [
            ("sampler", self.record.spec.to_string()),
            ("material", format!("{} ({source})", self.record.material)),
            ("lookup", lookup.to_owned()),
            ("invalid", invalid.to_owned()),
            ("table", self.record.cell_format.name().to_owned()),
            ("bytes", self.file_bytes.to_string()),
            ("layout version", self.record.version.to_string()),
            ("SHA-256 of the material", self.record.source_sha256.clone()),
        ] {
            sheet.push(vec![name.to_owned(), value]);
        }
        sheet
    }
}

/// A FIT file and what is in it.
#[derive(Serialize)]
struct CloudDescription {
    cloud: String,
    brdf: String,
    /// As the file has them.
    viewer: [f64; 2],
    points: usize,
    /// Least and greatest polar angle of the directions, degrees.
    theta_degrees: Option<[f64; 2]>,
    /// Least and greatest value, sr⁻¹.
    values: Option<[f64; 2]>,
}

impl CloudDescription {
    fn read(path: &Path) -> Result<Self, Error> {
        let cloud = PointCloud::open(path)?;
        Ok(Self {
            cloud: path.display().to_string(),
            points: cloud.values.len(),
            theta_degrees: cloud.theta_range(),
            values: cloud.value_range(),
            brdf: cloud.brdf,
            viewer: cloud.viewer,
        })
    }

    fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&["cloud", &self.cloud]);
        let [theta, phi] = self.viewer;
        // Up to π/2 the polar angle may be in either unit.
        let reading = match theta > std::f64::consts::FRAC_PI_2 {
            true => "degrees".to_owned(),
            false => format!("degrees, or θ in radians: {:.4}°", theta.to_degrees()),
        };
        let shown = self.theta_degrees.unwrap_or_default();
        let [low, high] = self.values.unwrap_or_default();
        for (name, value) in [
            ("BRDF", self.brdf.clone()),
            ("viewer", format!("({theta}, {phi}) in {reading}")),
            ("directions", self.points.to_string()),
            (
                "polar angles",
                format!("{:.4}° to {:.4}°", shown[0], shown[1]),
            ),
            ("values", format!("{low:.6e} to {high:.6e} sr⁻¹")),
        ] {
            sheet.push(vec![name.into(), value]);
        }
        sheet
    }
}

/// A picture and what its header says of it.
#[derive(Serialize)]
struct PictureDescription {
    picture: String,
    /// Lines of the header's comment.
    recorded: Vec<String>,
}

impl PictureDescription {
    fn read(path: &Path) -> Result<Self, Error> {
        let comment = Image::read_comment(path)?.unwrap_or_default();
        Ok(Self {
            picture: path.display().to_string(),
            recorded: comment.lines().map(str::to_owned).collect(),
        })
    }

    fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&["picture", &self.picture]);
        for line in &self.recorded {
            let (name, value) = line.split_once(": ").unwrap_or(("written by", line));
            sheet.push(vec![name.into(), value.into()]);
        }
        if self.recorded.is_empty() {
            sheet.push(vec![
                "written by".into(),
                "not recorded in its header".into(),
            ]);
        }
        sheet
    }
}

fn measure(material: &Material, lookup: LookupRule) -> Result<Info, Error> {
    let source = match material.origin() {
        Origin::File(path) => path.display().to_string(),
        Origin::Embedded(_) => "built in".into(),
        Origin::Formula(text) => text.clone(),
    };
    let loaded = args::load(material, lookup)?;
    Ok(Info {
        material: material.name().into(),
        source,
        read: loaded.file_access().map(Into::into),
        facts: facts(&loaded),
    })
}
