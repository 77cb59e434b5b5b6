//! Which sampler, with which settings: the options of every command that builds one.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use merlkit::Error;
use merlkit::brdf::Importance;
use merlkit::material::Material;
use merlkit::sampler::{
    AdaptiveDiscSettings, ByAzimuthSettings, Carry, CascadeCdfSettings, Construction,
    FactoredSettings, HalfVectorSettings, LeafChoice, LobeSettings, SamplerSpec, TableChoice,
    ThetaSpacing,
};

use crate::args;

/// Settings of samplers; those that are left out keep the method's own default.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Sampler")]
pub struct SamplerArgs {
    /// adaptive-disc, cascade-cdf: use the settings of the 2008 thesis instead of ours as defaults
    #[arg(long)]
    as_published: bool,
    /// Tables over the polar angle of wo, 1 to 4096, of half-vector 1 to 1024 [default: half-vector by its table size,
    /// adaptive-disc and disc-rejection 20, cascade-cdf 16, factored 32; as published 60, 32]
    #[arg(long, value_name = "N")]
    tables: Option<usize>,
    /// adaptive-disc, cascade-cdf, disc-rejection: what serves a wo between two tables [default: mixture; as published nearest]
    #[arg(long, value_name = "HOW", value_parser = args::named(&[("nearest", TableChoice::Nearest), ("mixture", TableChoice::Mixture)]))]
    choice: Option<TableChoice>,
    /// adaptive-disc, cascade-cdf, disc-rejection: share of draws that follow the cosine, so that no direction is left out, 0 to 1
    /// [default: 0.001; as published 0]
    #[arg(long, value_name = "SHARE")]
    floor: Option<f64>,
    /// Scalar that draws are proportional to [default: mean (of red, green, blue)]
    #[arg(long, value_name = "SCALAR", value_parser = args::named(&[("mean", Importance::Mean), ("luminance", Importance::Luminance)]))]
    importance: Option<Importance>,
    /// adaptive-disc: mean number of trials allowed in a leaf, above 1 [default: 2]
    #[arg(long, value_name = "TRIALS")]
    n_max: Option<f64>,
    /// adaptive-disc: subdivisions down to the smallest leaf, 0 to 14 [default: 14; as published 10]
    #[arg(long, value_name = "LEVELS")]
    depth: Option<u32>,
    /// adaptive-disc: don't split a leaf that wastes less than this share of the tree; with --rejection-free, that adds less
    /// than a hundredth of it to the weights' variance [default: 0.001; as published 0]
    #[arg(long, value_name = "SHARE")]
    waste: Option<f64>,
    /// adaptive-disc: build from an image of PIXELS a side, 8 to 4096, whose maxima are no bounds [default: refine where
    /// needed; as published 800]
    #[arg(long, value_name = "PIXELS")]
    grid: Option<u32>,
    /// adaptive-disc: draw leaves by bound × area, which is exact, or by integral [default: envelope; as published integral]
    #[arg(long, value_name = "BY", value_parser = args::named(&[("envelope", LeafChoice::Envelope), ("integral", LeafChoice::Integral)]))]
    leaves: Option<LeafChoice>,
    /// adaptive-disc: a warp down the quadtree, whose every draw counts and which keeps points well spread, with a density
    /// that is constant in each leaf [default: draws are accepted under bounds, in proportion to the BRDF]
    #[arg(long, conflicts_with_all = ["leaves", "grid"])]
    rejection_free: bool,
    /// adaptive-disc: what keeps its place when a tree serves a wo beside its own [default: half-vector; as published direction]
    #[arg(long, value_name = "WHAT", value_parser = args::named(&[("half-vector", Carry::HalfVector), ("direction", Carry::Direction)]))]
    carry: Option<Carry>,
    /// cascade-cdf: cells over θh and φh before compression [default: 1024x512; 256x32 with --uncompressed]
    #[arg(long, value_name = "THETAxPHI", value_parser = args::size)]
    resolution: Option<(usize, usize)>,
    /// cascade-cdf: largest error of a compressed CDF, in probability [default: 0.001]
    #[arg(long, value_name = "ERROR", conflicts_with = "uncompressed")]
    tolerance: Option<f64>,
    /// cascade-cdf: store every knot
    #[arg(long)]
    uncompressed: bool,
    /// cascade-cdf: spacing of cells over θh, by its root as MERL's bins or uniform [default: merl; as published uniform]
    #[arg(long, value_name = "SPACING", value_parser = args::named(&[("merl", ThetaSpacing::Merl), ("uniform", ThetaSpacing::Uniform)]))]
    spacing: Option<ThetaSpacing>,
    /// half-vector: settings that fill this many bytes [default: 64KB]
    #[arg(long, value_name = "BYTES", ignore_case = true, value_parser = preset())]
    table_size: Option<HalfVectorSettings>,
    /// half-vector: azimuths of wo that have such a table, of anisotropic materials, 2 to 256 [default: 8]
    #[arg(long, value_name = "N")]
    azimuths: Option<usize>,
    /// half-vector: rows over θh, 2 to 79 [default: by table size]
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// half-vector: segments over the azimuth, 1 to 256 [default: by table size]
    #[arg(long, value_name = "N")]
    segments: Option<usize>,
    /// half-vector: let one side of the plane of incidence stand for both [default: by table size]
    #[arg(long, conflicts_with = "no_fold")]
    fold: bool,
    /// half-vector: tell the two sides of the plane of incidence apart [default: by table size]
    #[arg(long)]
    no_fold: bool,
}

/// Parses the name of one of [`HalfVectorSettings::PRESETS`].
pub fn preset() -> impl TypedValueParser<Value = HalfVectorSettings> {
    PossibleValuesParser::new(HalfVectorSettings::PRESETS.map(|p| p.0))
        .map(|name| preset_called(&name))
}

/// The preset of that name in any case, or the default.
fn preset_called(name: &str) -> HalfVectorSettings {
    let same = |p: &&(&str, HalfVectorSettings)| p.0.eq_ignore_ascii_case(name);
    HalfVectorSettings::PRESETS
        .iter()
        .find(same)
        .map_or_else(HalfVectorSettings::default, |p| p.1)
}

/// Names of the samplers that are compared unless others are named, the default first.
pub const SAMPLERS: [&str; 4] = [DEFAULT, "adaptive-disc", "cascade-cdf", "cosine"];
/// Names of the other samplers, which are built only when named: those of [`SamplerSpec::baselines`].
pub const BASELINES: [&str; 8] = [
    "cosine-lobe",
    "cosine-lobe-sphere",
    "blinn",
    "ward",
    "ashikhmin-shirley",
    "ggx",
    "factored",
    "disc-rejection",
];

/// Name of the sampler that an anisotropic .bsdf file itself is.
const FILE: &str = "file";

/// Parses the name of any sampler.
pub fn any_name() -> PossibleValuesParser {
    PossibleValuesParser::new(SAMPLERS.into_iter().chain(BASELINES))
}

/// Parses the name of any sampler, those of anisotropic materials alone among them.
pub fn any_name_or_file() -> PossibleValuesParser {
    PossibleValuesParser::new(SAMPLERS.into_iter().chain(BASELINES).chain([FILE]))
}

/// Parses the name of any sampler that has something to store.
pub fn storable_name() -> PossibleValuesParser {
    PossibleValuesParser::new(
        SAMPLERS
            .into_iter()
            .chain(BASELINES)
            .filter(|&n| n != "cosine"),
    )
}

/// The sampler of a command that is told none.
pub const DEFAULT: &str = "half-vector";
/// Sizes of the half-vector table that are compared with the other samplers.
pub const COMPARED: [&str; 3] = ["2KB", "64KB", "1MB"];

impl SamplerArgs {
    /// The sampler called `name`, one of [`SAMPLERS`] or [`BASELINES`], with these settings.
    ///
    /// # Errors
    /// [`Error::Argument`] for a setting that the sampler does not have.
    pub fn spec(&self, name: &str) -> Result<SamplerSpec, Error> {
        self.refuse_foreign(&[name])?;
        Ok(self.lenient(name))
    }

    /// The sampler called `name` with those of these settings that it has.
    fn lenient(&self, name: &str) -> SamplerSpec {
        match name {
            "adaptive-disc" => SamplerSpec::AdaptiveDisc(self.disc()),
            "cascade-cdf" => SamplerSpec::CascadeCdf(self.cascade()),
            "half-vector" => match self.azimuths {
                Some(azimuths) => {
                    let settings = ByAzimuthSettings::of(self.half_vector());
                    SamplerSpec::ByAzimuth(ByAzimuthSettings {
                        azimuths,
                        ..settings
                    })
                }
                None => SamplerSpec::HalfVector(self.half_vector()),
            },
            FILE => SamplerSpec::File,
            _ => self.baseline(name),
        }
    }

    /// The baseline called `name`, or else cosine.
    fn baseline(&self, name: &str) -> SamplerSpec {
        let baseline = SamplerSpec::baselines()
            .into_iter()
            .find(|s| s.name() == name);
        match baseline.unwrap_or(SamplerSpec::Cosine) {
            SamplerSpec::AdaptiveDisc(d) => SamplerSpec::AdaptiveDisc(AdaptiveDiscSettings {
                tables: self.tables.unwrap_or(d.tables),
                choice: self.choice.unwrap_or(d.choice),
                floor: self.floor.unwrap_or(d.floor),
                importance: self.importance.unwrap_or(d.importance),
                ..d
            }),
            SamplerSpec::Lobe(l) => SamplerSpec::Lobe(LobeSettings {
                importance: self.importance.unwrap_or(l.importance),
                ..l
            }),
            SamplerSpec::Factored(f) => SamplerSpec::Factored(FactoredSettings {
                tables: self.tables.unwrap_or(f.tables),
                importance: self.importance.unwrap_or(f.importance),
                ..f
            }),
            other => other,
        }
    }

    /// Every setting given must belong to one of the samplers called `names`.
    fn refuse_foreign(&self, names: &[&str]) -> Result<(), Error> {
        let unless = |names_it: bool, option: Option<&'static str>| option.filter(|_| !names_it);
        let (disc, cdf) = (
            names.contains(&"adaptive-disc"),
            names.contains(&"cascade-cdf"),
        );
        let square = names.contains(&"half-vector");
        let rejection = names.contains(&"disc-rejection");
        let tables = disc || cdf || square || rejection || names.contains(&"factored");
        let fitted = names.iter().any(|name| BASELINES.contains(name));
        let foreign = unless(disc, self.disc_only())
            .or(unless(cdf, self.cdf_only()))
            .or(unless(square, self.square_only()))
            .or(unless(
                disc || cdf,
                given(&[(self.as_published, "--as-published")]),
            ))
            .or(unless(disc || cdf || rejection, self.thesis_only()))
            .or(unless(
                tables,
                given(&[(self.tables.is_some(), "--tables")]),
            ))
            .or(unless(
                tables || fitted,
                given(&[(self.importance.is_some(), "--importance")]),
            ));
        match foreign {
            Some(option) => Err(Error::argument(
                format!("{option} is no setting of {}", names.join(" or ")),
                "leave it out, or choose another --sampler",
            )),
            None => Ok(()),
        }
    }

    /// The samplers called `names`, or all of them: the half-vector table in each of `sizes` unless told which, cosine, the
    /// adaptive disc, and the cascade CDF whole and compressed.
    ///
    /// # Errors
    /// As [`Self::spec`].
    pub fn specs(&self, names: &[String], sizes: &[&str]) -> Result<Vec<SamplerSpec>, Error> {
        if !names.is_empty() {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            self.refuse_foreign(&names)?;
            return Ok(names.iter().map(|n| self.lenient(n)).collect());
        }
        let whole = Self {
            uncompressed: true,
            ..self.clone()
        };
        let mut specs = self.half_vectors(sizes);
        specs.extend([
            SamplerSpec::Cosine,
            self.lenient("adaptive-disc"),
            whole.lenient("cascade-cdf"),
        ]);
        if !self.uncompressed {
            specs.push(self.lenient("cascade-cdf"));
        }
        Ok(specs)
    }

    /// As [`Self::specs`]; where none are named, all that the material supports, among them the density that its own file holds.
    ///
    /// # Errors
    /// As [`Self::spec`].
    pub fn specs_of(
        &self,
        material: &Material,
        names: &[String],
        sizes: &[&str],
    ) -> Result<Vec<SamplerSpec>, Error> {
        let facts = material.facts()?;
        if names.is_empty() && !facts.is_isotropic() {
            self.refuse_foreign(&[DEFAULT])?;
        }
        let mut specs = self.specs(names, sizes)?;
        if names.is_empty() {
            specs.push(SamplerSpec::File);
            specs.retain(|spec| {
                matches!(spec, SamplerSpec::ByAzimuth(_)) || spec.check_supports(&facts).is_ok()
            });
        }
        specs.iter().try_for_each(|s| s.check_supports(&facts))?;
        Ok(specs)
    }

    /// The half-vector table in the size given, or else in each of `sizes`; those that come out the same once.
    fn half_vectors(&self, sizes: &[&str]) -> Vec<SamplerSpec> {
        if self.table_size.is_some() {
            return vec![self.lenient("half-vector")];
        }
        let of_size = |size: &&str| {
            Self {
                table_size: Some(preset_called(size)),
                ..self.clone()
            }
            .lenient("half-vector")
        };
        let mut specs: Vec<SamplerSpec> = sizes.iter().map(of_size).collect();
        specs.dedup();
        specs
    }

    /// The first setting given, by its option.
    pub fn first_given(&self) -> Option<&'static str> {
        self.disc_only()
            .or(self.cdf_only())
            .or(self.square_only())
            .or(given(&[
                (self.as_published, "--as-published"),
                (self.tables.is_some(), "--tables"),
                (self.importance.is_some(), "--importance"),
            ]))
            .or(self.thesis_only())
    }

    fn disc(&self) -> AdaptiveDiscSettings {
        let d = match self.as_published {
            true => AdaptiveDiscSettings::as_published(),
            false => AdaptiveDiscSettings::default(),
        };
        AdaptiveDiscSettings {
            tables: self.tables.unwrap_or(d.tables),
            n_max: self.n_max.unwrap_or(d.n_max),
            depth: self.depth.unwrap_or(d.depth),
            waste: self.waste.unwrap_or(d.waste),
            construction: match self.grid {
                Some(side) => Construction::Grid(side),
                None if self.rejection_free => Construction::Refined,
                None => d.construction,
            },
            leaves: if self.rejection_free {
                LeafChoice::Warp
            } else {
                self.leaves.unwrap_or(d.leaves)
            },
            choice: self.choice.unwrap_or(d.choice),
            carry: self.carry.unwrap_or(d.carry),
            floor: self.floor.unwrap_or(d.floor),
            importance: self.importance.unwrap_or(d.importance),
        }
    }

    fn cascade(&self) -> CascadeCdfSettings {
        let d = match (self.as_published, self.uncompressed) {
            (true, uncompressed) => CascadeCdfSettings::as_published(!uncompressed),
            (false, true) => CascadeCdfSettings::uniform(),
            (false, false) => CascadeCdfSettings::default(),
        };
        let (theta_h, phi_h) = self.resolution.unwrap_or((d.theta_h, d.phi_h));
        CascadeCdfSettings {
            tables: self.tables.unwrap_or(d.tables),
            theta_h,
            phi_h,
            spacing: self.spacing.unwrap_or(d.spacing),
            tolerance: self.tolerance.or(d.tolerance),
            choice: self.choice.unwrap_or(d.choice),
            floor: self.floor.unwrap_or(d.floor),
            importance: self.importance.unwrap_or(d.importance),
        }
    }

    fn half_vector(&self) -> HalfVectorSettings {
        let d = self.table_size.unwrap_or_default();
        HalfVectorSettings {
            tables: self.tables.unwrap_or(d.tables),
            rows: self.rows.unwrap_or(d.rows),
            segments: self.segments.unwrap_or(d.segments),
            fold: self.fold || (d.fold && !self.no_fold),
            importance: self.importance.unwrap_or(d.importance),
        }
    }

    /// The first option given that only the adaptive disc has.
    fn disc_only(&self) -> Option<&'static str> {
        given(&[
            (self.n_max.is_some(), "--n-max"),
            (self.depth.is_some(), "--depth"),
            (self.waste.is_some(), "--waste"),
            (self.grid.is_some(), "--grid"),
            (self.leaves.is_some(), "--leaves"),
            (self.rejection_free, "--rejection-free"),
            (self.carry.is_some(), "--carry"),
        ])
    }

    /// The first option given that only the cascade CDF has.
    fn cdf_only(&self) -> Option<&'static str> {
        given(&[
            (self.resolution.is_some(), "--resolution"),
            (self.tolerance.is_some(), "--tolerance"),
            (self.uncompressed, "--uncompressed"),
            (self.spacing.is_some(), "--spacing"),
        ])
    }

    /// The first option given that only the half-vector table has.
    fn square_only(&self) -> Option<&'static str> {
        given(&[
            (self.table_size.is_some(), "--table-size"),
            (self.azimuths.is_some(), "--azimuths"),
            (self.rows.is_some(), "--rows"),
            (self.segments.is_some(), "--segments"),
            (self.fold, "--fold"),
            (self.no_fold, "--no-fold"),
        ])
    }

    /// The first option given that only the thesis's two samplers have.
    fn thesis_only(&self) -> Option<&'static str> {
        given(&[
            (self.choice.is_some(), "--choice"),
            (self.floor.is_some(), "--floor"),
        ])
    }
}

fn given(options: &[(bool, &'static str)]) -> Option<&'static str> {
    options.iter().find(|o| o.0).map(|o| o.1)
}
