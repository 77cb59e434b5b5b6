//! `merlkit samplers`

use std::process::ExitCode;

use merlkit::Error;
use merlkit::sampler::{Needs, PresetFacts, SamplerSpec, SettingFacts};
use merlkit_evaluate::report::{Sheet, write_json};
use serde::Serialize;

use crate::failure::Outcome;
use crate::output;
use crate::output::Destination;
use crate::provenance::record_command;
use crate::table;

/// List the samplers, or the settings of one sampler
///
/// A sampler is written NAME or NAME:SETTING,SETTING…. A preset, if any, comes first; keywords and KEY=VALUE follow in any
/// order. Omitted settings are taken from the preset, or else have their default.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit samplers                  # all of them\n  merlkit samplers adaptive-disc    # its settings, their domains and defaults"
)]
pub struct Args {
    /// The sampler whose settings are listed [default: list all samplers]
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
        Some(name) => vec![Description::new(&name.parse()?)?],
        None => {
            let all = SamplerSpec::methods();
            all.iter()
                .map(Description::new)
                .collect::<Result<Vec<_>, _>>()?
        }
    };
    if let Some(destination) = &args.json {
        destination.write(output::overwrite(args.force), |out| {
            write_json(out, "samplers", &record_command(), &chosen)
        })?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = match (&args.name, &chosen[..]) {
        (Some(_), [one]) => one.text(),
        _ => list(&chosen),
    };
    output::stdout(|out| write!(out, "{}", table::wrap(&text)))?;
    Ok(ExitCode::SUCCESS)
}

/// A sampler as it is listed.
#[derive(Serialize)]
struct Description {
    name: &'static str,
    summary: &'static str,
    needs: Needs,
    /// Its text with default settings.
    default: SamplerSpec,
    example: SamplerSpec,
    settings: Vec<SettingFacts>,
    presets: Vec<PresetFacts>,
}

impl Description {
    fn new(spec: &SamplerSpec) -> Result<Self, Error> {
        let default: SamplerSpec = spec.name().parse()?;
        Ok(Self {
            name: spec.name(),
            summary: spec.summary(),
            needs: spec.needs(),
            example: example(&default)?,
            settings: default.setting_facts(),
            presets: default.preset_facts(),
            default,
        })
    }

    /// Its settings and presets, for people.
    fn text(&self) -> String {
        let mut text = format!(
            "{}: {}\n\nNeeds {}. Default: {}.\n",
            self.name, self.summary, self.needs, self.default
        );
        if self.settings.is_empty() {
            return text + "No settings.\n";
        }
        let mut settings = Sheet::new(&["setting", "values", "default", "meaning"]);
        for setting in &self.settings {
            let row = [
                &setting.key.to_owned(),
                &setting.domain,
                &setting.default,
                &setting.meaning.to_owned(),
            ];
            settings.push(row.map(String::clone).to_vec());
        }
        text += &format!("\n{}", table::render(&settings));
        let alone: Vec<&str> = self
            .settings
            .iter()
            .flat_map(|s| s.standing_alone.iter().copied())
            .collect();
        if !alone.is_empty() {
            text += &format!(
                "\nValues that may be given without their key: {}.\n",
                alone.join(", ")
            );
        }
        if !self.presets.is_empty() {
            let mut presets = Sheet::new(&["preset", "meaning"]);
            for preset in &self.presets {
                presets.push(vec![preset.name.to_owned(), preset.meaning.clone()]);
            }
            text += &format!("\n{}", table::render(&presets));
        }
        text + &format!("\nExample: --sampler {}\n", self.example)
    }
}

/// All samplers, a line each.
fn list(all: &[Description]) -> String {
    let mut sheet = Sheet::new(&["sampler", "description", "needs", "default"]);
    for one in all {
        sheet.push(vec![
            one.name.to_owned(),
            one.summary.to_owned(),
            one.needs.to_string(),
            one.default.to_string(),
        ]);
    }
    format!(
        "{}\n`merlkit samplers NAME` lists the settings of a sampler. Example: --sampler {}\n",
        table::render(&sheet),
        all.first().map_or("", |one| one.name).to_owned() + ":64KB,rows=50"
    )
}

/// The sampler with a few settings: its first preset, if it has one, and another number of tables, if it has any.
fn example(default: &SamplerSpec) -> Result<SamplerSpec, Error> {
    let presets = default.preset_facts();
    let mut settings: Vec<String> = Vec::new();
    settings.extend(presets.first().map(|preset| preset.name.to_owned()));
    if default.setting("tables").is_some() {
        settings.push("tables=24".to_owned());
    }
    match &settings[..] {
        [] => Ok(default.clone()),
        _ => format!("{}:{}", default.name(), settings.join(",")).parse(),
    }
}
