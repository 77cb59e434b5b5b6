//! Which sampler, with which settings: what a command line asks for and what a file records.

use std::fmt;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{
    AdaptiveDisc, AdaptiveDiscSettings, ByAzimuth, ByAzimuthSettings, CascadeCdf,
    CascadeCdfSettings, Construction, Cosine, DirectionSample, DirectionSampler, Factored,
    FactoredSettings, HalfVectorSettings, HalfVectorTable, LeafChoice, Lobe, LobeKind,
    LobeSettings, TableChoice, ThetaSpacing,
};
use crate::batch::Wo;
use crate::brdf::Importance;
use crate::direction_sampler::draw_stratified;
use crate::material::Loaded;
use crate::material::merl::MerlBrdf;
use crate::{Error, Result};

/// A sampler that can be built for measured materials: the last two for anisotropic ones alone, which of the others have
/// [`Self::Cosine`] and, as [`Self::ByAzimuth`], [`Self::HalfVector`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "sampler", rename_all = "kebab-case")]
pub enum SamplerSpec {
    /// Uniform on the disc.
    Cosine,
    /// Quadtrees on the disc.
    AdaptiveDisc(AdaptiveDiscSettings),
    /// CDFs of the half vector.
    CascadeCdf(CascadeCdfSettings),
    /// Tables over the half-vector square: the default.
    HalfVector(HalfVectorSettings),
    /// An analytic lobe and a share of cosine.
    Lobe(LobeSettings),
    /// Factors of one angle each.
    Factored(FactoredSettings),
    /// A half-vector table for each of a few azimuths of `wo`.
    ByAzimuth(ByAzimuthSettings),
    /// The density that a `.bsdf` file itself holds.
    File,
}

impl SamplerSpec {
    /// What the tables are compared with besides [`Self::Cosine`], each with the settings that suit the material best.
    pub fn baselines() -> [Self; 8] {
        let [a, b, c, d, e, f] = LobeKind::ALL.map(|kind| Self::Lobe(LobeSettings::fitted(kind)));
        let factored = Self::Factored(FactoredSettings::default());
        [
            a,
            b,
            c,
            d,
            e,
            f,
            factored,
            Self::AdaptiveDisc(AdaptiveDiscSettings::rejection()),
        ]
    }

    /// The method's name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cosine => "cosine",
            Self::AdaptiveDisc(s) if s.depth == 0 => "disc-rejection",
            Self::AdaptiveDisc(_) => "adaptive-disc",
            Self::CascadeCdf(_) => "cascade-cdf",
            Self::HalfVector(_) | Self::ByAzimuth(_) => "half-vector",
            Self::Lobe(s) => s.kind.name(),
            Self::Factored(_) => "factored",
            Self::File => "file",
        }
    }

    /// The name with the settings that tell variants apart, for tables: "cascade-cdf 16×1024×512 ±0.001, nearest".
    pub fn label(&self) -> String {
        let (mut label, published, notes) = match self {
            Self::Cosine | Self::File => return self.name().into(),
            Self::AdaptiveDisc(s) => (
                disc_label(s),
                *s == AdaptiveDiscSettings::as_published(),
                disc_notes(s),
            ),
            Self::CascadeCdf(s) => {
                let published = [true, false]
                    .map(CascadeCdfSettings::as_published)
                    .contains(s);
                (cascade_label(s), published, cascade_notes(s))
            }
            Self::HalfVector(s) => (half_vector_label(s), false, luminance_note(s.importance)),
            Self::Lobe(s) => (self.name().into(), false, luminance_note(s.importance)),
            Self::Factored(s) => (
                format!("factored, {} tables", s.tables),
                false,
                luminance_note(s.importance),
            ),
            Self::ByAzimuth(s) => (
                by_azimuth_label(s),
                false,
                luminance_note(s.table.importance),
            ),
        };
        let notes = if published {
            vec!["as published".into()]
        } else {
            notes
        };
        for note in notes {
            label = format!("{label}, {note}");
        }
        label
    }

    /// Whether such a sampler can be built for an anisotropic material, or for another.
    ///
    /// # Errors
    /// [`Error::Argument`] if not.
    pub fn serve(&self, anisotropic: bool) -> Result<()> {
        match self {
            Self::Cosine | Self::HalfVector(_) => Ok(()),
            Self::ByAzimuth(_) | Self::File if anisotropic => Ok(()),
            Self::ByAzimuth(_) | Self::File => Err(self.refused_by_tables()),
            Self::AdaptiveDisc(_) | Self::CascadeCdf(_) | Self::Lobe(_) | Self::Factored(_)
                if anisotropic =>
            {
                Err(self.refused_by_files())
            }
            Self::AdaptiveDisc(_) | Self::CascadeCdf(_) | Self::Lobe(_) | Self::Factored(_) => {
                Ok(())
            }
        }
    }

    fn refused_by_tables(&self) -> Error {
        let (what, fix) = match self {
            Self::ByAzimuth(_) => (
                "tables by azimuth are",
                "leave the azimuths out: one table serves all of them",
            ),
            _ => ("the sampler file is", "choose another, as half-vector"),
        };
        Error::argument(
            format!("{what} for anisotropic .bsdf files, and this material is isotropic"),
            fix,
        )
    }

    fn refused_by_files(&self) -> Error {
        let what = format!(
            "{} is for isotropic materials, and this one is anisotropic",
            self.name()
        );
        Error::argument(what, "choose the sampler half-vector, file or cosine")
    }

    /// Builds the sampler on the threads of the current pool.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains, and for samplers of anisotropic materials alone.
    pub fn build(&self, brdf: &Arc<MerlBrdf>) -> Result<Sampler> {
        Ok(match self {
            Self::Cosine => Sampler::Cosine(Cosine),
            Self::AdaptiveDisc(settings) => {
                Sampler::AdaptiveDisc(AdaptiveDisc::build(brdf.clone(), *settings)?)
            }
            Self::CascadeCdf(settings) => {
                Sampler::CascadeCdf(CascadeCdf::build(&**brdf, *settings)?)
            }
            Self::HalfVector(settings) => {
                Sampler::HalfVector(HalfVectorTable::build(&**brdf, *settings)?)
            }
            Self::Lobe(settings) => Sampler::Lobe(Lobe::build(&**brdf, *settings)?),
            Self::Factored(settings) => Sampler::Factored(Factored::build(&**brdf, *settings)?),
            Self::ByAzimuth(settings) => Sampler::ByAzimuth(ByAzimuth::build(&**brdf, *settings)?),
            Self::File => return Err(self.refused_by_tables()),
        })
    }

    /// Builds the sampler for any material.
    ///
    /// # Errors
    /// As [`Self::build`]; [`Error::Argument`] for a sampler that an anisotropic material can't have.
    pub fn build_for(&self, material: &Loaded) -> Result<Sampler> {
        if let Some(measured) = material.table() {
            return self.build(measured);
        }
        let brdf = &**material.brdf();
        Ok(match self {
            Self::Cosine => Sampler::Cosine(Cosine),
            Self::HalfVector(table) => {
                Sampler::ByAzimuth(ByAzimuth::build(brdf, ByAzimuthSettings::of(*table))?)
            }
            Self::ByAzimuth(settings) => Sampler::ByAzimuth(ByAzimuth::build(brdf, *settings)?),
            Self::File => match material.own_sampler() {
                Some(own) => Sampler::File(own.clone()),
                None => return Err(self.refused_by_tables()),
            },
            Self::AdaptiveDisc(_) | Self::CascadeCdf(_) | Self::Lobe(_) | Self::Factored(_) => {
                return Err(self.refused_by_files());
            }
        })
    }
}

fn disc_label(s: &AdaptiveDiscSettings) -> String {
    let name = SamplerSpec::AdaptiveDisc(*s).name();
    match s.construction {
        Construction::Refined => format!("{name}, {} trees", s.tables),
        Construction::Grid(side) => format!("{name}, {} trees from {side}² pixels", s.tables),
    }
}

fn cascade_label(s: &CascadeCdfSettings) -> String {
    let cells = format!("cascade-cdf {}×{}×{}", s.tables, s.theta_h, s.phi_h);
    s.tolerance
        .map_or_else(|| format!("{cells} whole"), |t| format!("{cells} ±{t}"))
}

fn half_vector_label(s: &HalfVectorSettings) -> String {
    if let Some((size, _)) = HalfVectorSettings::PRESETS
        .iter()
        .find(|p| p.1 == s.with_mean())
    {
        return format!("half-vector {size}");
    }
    let folded = if s.fold { " folded" } else { "" };
    format!("half-vector {}×{}×{}{folded}", s.tables, s.rows, s.segments)
}

fn by_azimuth_label(s: &ByAzimuthSettings) -> String {
    let same =
        |p: &&(&str, HalfVectorSettings)| ByAzimuthSettings::of(p.1).table == s.table.with_mean();
    let table = HalfVectorSettings::PRESETS
        .iter()
        .find(same)
        .map_or(s.table, |p| p.1);
    format!("{} at {} azimuths", half_vector_label(&table), s.azimuths)
}

fn luminance_note(importance: Importance) -> Vec<String> {
    (importance != Importance::default())
        .then(|| "luminance".to_owned())
        .into_iter()
        .collect()
}

/// The settings that differ from the default and do not stand in the label.
fn disc_notes(s: &AdaptiveDiscSettings) -> Vec<String> {
    let d = AdaptiveDiscSettings::default();
    let mut notes = common_notes(s.choice, s.floor, s.importance);
    let leaves = if s.leaves == LeafChoice::Warp {
        "rejection-free"
    } else {
        "leaves by integral"
    };
    notes.extend((s.leaves != d.leaves).then(|| leaves.to_owned()));
    notes.extend((s.carry != d.carry).then(|| "directions kept".to_owned()));
    notes.extend((s.n_max != d.n_max).then(|| format!("n_max {}", s.n_max)));
    notes.extend((s.depth != d.depth && s.depth > 0).then(|| format!("depth {}", s.depth)));
    notes.extend((s.waste != d.waste).then(|| format!("waste {}", s.waste)));
    notes
}

fn cascade_notes(s: &CascadeCdfSettings) -> Vec<String> {
    let mut notes = common_notes(s.choice, s.floor, s.importance);
    notes.extend((s.spacing != ThetaSpacing::default()).then(|| "uniform θh".to_owned()));
    notes
}

fn common_notes(choice: TableChoice, floor: f64, importance: Importance) -> Vec<String> {
    let mut notes = Vec::new();
    notes.extend((choice != TableChoice::default()).then(|| "nearest".to_owned()));
    notes
        .extend((floor != AdaptiveDiscSettings::default().floor).then(|| format!("floor {floor}")));
    notes.extend(luminance_note(importance));
    notes
}

/// A sampler of any of the kinds here.
#[derive(Clone)]
pub enum Sampler {
    /// Uniform on the disc.
    Cosine(Cosine),
    /// Quadtrees on the disc.
    AdaptiveDisc(AdaptiveDisc),
    /// CDFs of the half vector.
    CascadeCdf(CascadeCdf),
    /// Tables over the half-vector square.
    HalfVector(HalfVectorTable),
    /// An analytic lobe and a share of cosine.
    Lobe(Lobe),
    /// Factors of one angle each.
    Factored(Factored),
    /// A half-vector table for each of a few azimuths of `wo`.
    ByAzimuth(ByAzimuth),
    /// The density that a `.bsdf` file itself holds.
    File(Arc<dyn DirectionSampler>),
}

impl Sampler {
    /// What it was built from, with what was fitted.
    pub fn spec(&self) -> SamplerSpec {
        match self {
            Self::Cosine(_) => SamplerSpec::Cosine,
            Self::AdaptiveDisc(s) => SamplerSpec::AdaptiveDisc(*s.settings()),
            Self::CascadeCdf(s) => SamplerSpec::CascadeCdf(*s.settings()),
            Self::HalfVector(s) => SamplerSpec::HalfVector(*s.settings()),
            Self::Lobe(s) => SamplerSpec::Lobe(*s.settings()),
            Self::Factored(s) => SamplerSpec::Factored(*s.settings()),
            Self::ByAzimuth(s) => SamplerSpec::ByAzimuth(*s.settings()),
            Self::File(_) => SamplerSpec::File,
        }
    }

    /// Draws `count` directions for one `wo` that are spread together as well as the method can: by
    /// [`AdaptiveDisc::draw_stratified`] for the disc, by [`draw_stratified`] for the others.
    pub fn draw_stratified(
        &self,
        wo: Vec3,
        count: usize,
        seed: u64,
    ) -> Vec<Option<DirectionSample>> {
        match self {
            Self::AdaptiveDisc(disc) => disc.draw_stratified(wo, count, seed),
            _ => draw_stratified(self, wo, count, seed),
        }
    }

    /// The sampler behind the common interface.
    pub fn as_dyn(&self) -> &dyn DirectionSampler {
        match self {
            Self::Cosine(s) => s,
            Self::AdaptiveDisc(s) => s,
            Self::CascadeCdf(s) => s,
            Self::HalfVector(s) => s,
            Self::Lobe(s) => s,
            Self::Factored(s) => s,
            Self::ByAzimuth(s) => s,
            Self::File(s) => &**s,
        }
    }
}

impl DirectionSampler for Sampler {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        self.as_dyn().sample(wo, u)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.as_dyn().pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        self.as_dyn().bytes()
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        self.as_dyn().sample_batch(wo, u, out);
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        self.as_dyn().pdf_batch(wo, wi, out);
    }
}

impl fmt::Debug for Sampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Sampler").field(&self.spec()).finish()
    }
}
