//! The readings of a table between its samples.

/// What a table says between its samples. The rule changes the albedo of metals by up to a quarter, so reports name it.
///
/// The example of [`Material`](crate::material::Material) goes from an argument to a loaded material.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum LookupRule {
    /// The value of the bin that holds the angles, as the original MERL reader.
    #[default]
    Floor,
    /// Trilinear, values at the lower edges of their bins.
    Linear,
    /// Trilinear, values at the centres of their bins.
    Centred,
}

impl LookupRule {
    /// All rules, in the order of their documentation.
    pub const ALL: [Self; 3] = [Self::Floor, Self::Linear, Self::Centred];

    /// The rule's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Floor => "floor",
            Self::Linear => "linear",
            Self::Centred => "centred",
        }
    }
}
