//! A MERL table as a BRDF.

use std::sync::Arc;

use glam::Vec3;

use super::{BinIndex, Brdf, interpolate};
use crate::color::Rgb;
use crate::merl::MerlTable;

/// What a table says between its samples. The rule changes the albedo of metals by up to a quarter, so reports name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LookupRule {
    /// The value of the bin that holds the angles, as the original MERL reader.
    #[default]
    Floor,
    /// Trilinear, values standing at the lower edges of their bins.
    Linear,
    /// Trilinear, values standing at the centres of their bins.
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

/// A measured, isotropic BRDF: a table and its lookup rule.
#[derive(Clone, Debug)]
pub struct Measured {
    table: Arc<MerlTable>,
    rule: LookupRule,
}

impl Measured {
    /// Reads `table` by `rule`.
    pub fn new(table: Arc<MerlTable>, rule: LookupRule) -> Self {
        Self { table, rule }
    }

    /// The table behind it.
    pub fn table(&self) -> &Arc<MerlTable> {
        &self.table
    }

    /// The lookup rule.
    pub fn rule(&self) -> LookupRule {
        self.rule
    }
}

impl Brdf for Measured {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match self.rule {
            LookupRule::Floor => match BinIndex::of(wo, wi, self.table.phi_d_bins()) {
                Some(b) => self.table.cells()[self.table.index(b.theta_h, b.theta_d, b.phi_d)].truncate(),
                None => Rgb::ZERO,
            },
            LookupRule::Linear => interpolate::trilinear(&self.table, 0.0, wo, wi),
            LookupRule::Centred => interpolate::trilinear(&self.table, 0.5, wo, wi),
        }
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}
