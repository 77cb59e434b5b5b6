//! What accuracy costs in time: every sampler and technique against samples, seconds and bytes.
//!
//! ```text
//! PointPlan → references, curve → reach → verdict        a lit point
//! PicturePlan → reference, picture                       spheres
//! knobs → setting                                        each sampler's own settings
//! ```
//!
//! Every measurement is a plain value that can be written and read again, so that a run that was stopped goes on where it
//! stopped.

mod candidates;
mod counted;
mod light;
mod picture;
mod point;
mod proof;
mod setting;
mod target;
mod tie;
mod tune;
mod verdict;

pub use candidates::{Competitor, MATERIALS, competitors, picture_competitors, supported};
pub use counted::{CountedCost, cost_notes, counted_cost};
pub use light::LightTables;
pub use picture::{
    PICTURE_SAMPLES, PicturePlan, PictureReference, PictureResult, SceneKind, picture_errors,
    picture_reference, pictures,
};
pub use point::{
    Curve, ErrorPoint, PointPlan, Reference, THESIS_SAMPLES, curve, measure_costs, references,
};
pub use proof::Proof;
pub use setting::{Knob, RMSE_SAMPLES, Setting, knobs, setting};
pub use target::{Reach, SHARED_BY, TARGETS, reach, samples_to_reach};
pub use tie::{Contender, TIE, Winner, best};
pub use tune::{MOST_SAMPLES, Tried, Tuning, Wish, tunable, tune};
pub(crate) use verdict::write_factor;
pub use verdict::{Verdict, verdict};

use serde::{Deserialize, Serialize};

use merlkit::material::merl::LookupRule;
use merlkit::sampler::SamplerSpec;

/// Version of [`Comparison`]'s shape.
pub const SCHEMA: u32 = 4;

/// What a run compares, and how: two runs of equal plans may share their measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComparisonPlan {
    /// [`SCHEMA`] of the program that made it.
    pub schema: u32,
    /// Whether this is the quick run.
    pub quick: bool,
    /// The samplers asked for; if none are, all that are worth a comparison.
    pub samplers: Vec<SamplerSpec>,
    /// Lookup rule of every table.
    pub lookup: LookupRule,
    /// What lights the point.
    pub sky: String,
    /// The lit point.
    pub point: PointPlan,
    /// The pictures.
    pub picture: PicturePlan,
}

/// Everything that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What was asked for.
    pub plan: ComparisonPlan,
    /// Threads that built samplers and rendered.
    pub threads: usize,
    /// The lit point, by material.
    pub materials: Vec<MaterialComparison>,
    /// The pictures, by scene and material.
    pub pictures: Vec<PictureComparison>,
    /// Each sampler's own settings, by material.
    pub settings: Vec<SettingsComparison>,
    /// What materials and samplers look like.
    pub charts: Vec<MaterialCharts>,
}

/// Charts of one material and of samplers built for it, each a whole SVG picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MaterialCharts {
    /// Its name.
    pub material: String,
    /// Polar angle of `wo` on the discs and beside the samplers' densities, degrees.
    pub theta_o_deg: f64,
    /// The lobe at several angles, in polar coordinates.
    pub lobe: String,
    /// By sampler, the ideal density and the sampler's in the same coordinates.
    pub densities: Vec<String>,
    /// By sampler, the disc with directions it draws, and its leaves where it has some.
    pub discs: Vec<String>,
}

/// One material at the lit point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaterialComparison {
    /// Its name.
    pub material: String,
    /// What the estimates are held against.
    pub references: Vec<Reference>,
    /// Every competitor's errors.
    pub curves: Vec<Curve>,
    /// Who reaches 1 % first.
    pub verdict: Option<Verdict>,
    /// What to know before trusting a measured time.
    pub notes: Vec<String>,
}

/// One scene in one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureComparison {
    /// Which scene.
    pub scene: SceneKind,
    /// The sphere's material; of a scene with several, all of them.
    pub material: String,
    /// What the pictures are held against.
    pub reference: PictureReference,
    /// Every competitor's pictures.
    pub results: Vec<PictureResult>,
}

/// The samplers' settings for one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingsComparison {
    /// Its name.
    pub material: String,
    /// Every setting tried.
    pub settings: Vec<Setting>,
}
