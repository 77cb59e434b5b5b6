//! A MERL table as a BRDF.

use std::sync::Arc;

use fearless_simd::{Level, dispatch};
use glam::Vec3;

use super::BinIndex;
use super::lookup::half_diff_tan2::HalfDiffTan2;
use super::lookup::trilinear::CellNeighbours;
use super::lookup::{LookupRule, batch};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{is_unit_upper, unit_upper};
use crate::material::merl::MerlTable;

/// A measured, isotropic BRDF: a table and its lookup rule.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Debug)]
pub struct MerlBrdf {
    table: Arc<MerlTable>,
    rule: LookupRule,
}

impl MerlBrdf {
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

    /// f_r of unit directions above the horizon.
    #[inline]
    fn value(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match self.rule {
            LookupRule::Floor => self.floor(wo, wi),
            LookupRule::Linear => self.trilinear(0.0, wo, wi),
            LookupRule::Centred => self.trilinear(0.5, wo, wi),
        }
    }

    /// f_r of any directions. Apart, so that the usual ones are used where they are: merged with renormalised ones, a call took
    /// 1.4 to 1.9 times as long (`cargo bench --bench lookup`).
    #[cold]
    fn value_of_others(&self, wo: Vec3, wi: Vec3) -> Rgb {
        unit_upper(wo)
            .zip(unit_upper(wi))
            .map_or(Rgb::ZERO, |(wo, wi)| self.value(wo, wi))
    }

    #[inline]
    fn floor(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match BinIndex::find(wo, wi, self.table.phi_d_bins()) {
            Some(b) => {
                let cell = self.table.index(b.theta_h, b.theta_d, b.phi_d);
                self.table.cell(cell).truncate()
            }
            None => Rgb::ZERO,
        }
    }

    fn trilinear(&self, offset: f64, wo: Vec3, wi: Vec3) -> Rgb {
        let bins = self.table.phi_d_bins();
        let tan2 = HalfDiffTan2::from_directions(wo, wi);
        match CellNeighbours::find(tan2, wi, bins, offset) {
            Some(neighbours) => neighbours.mean(&self.table),
            None => Rgb::ZERO,
        }
    }
}

impl Brdf for MerlBrdf {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if is_unit_upper(wo) & is_unit_upper(wi) {
            self.value(wo, wi)
        } else {
            self.value_of_others(wo, wi)
        }
    }

    #[track_caller]
    fn eval_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        batch::evaluate(&self.table, self.rule, wo, wi, out);
    }

    #[track_caller]
    fn eval_cos_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        self.eval_batch(wo, wi, out);
        dispatch!(Level::new(), _ => multiply_by_cosines(wi, out));
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}

/// f_r·cosθi from f_r; 0 unless `wi` is above the horizon.
#[inline(always)]
fn multiply_by_cosines(wi: &[Vec3], out: &mut [Rgb]) {
    for (out, &wi) in out.iter_mut().zip(wi) {
        if is_unit_upper(wi) {
            *out *= wi.z;
        } else {
            *out *= cosine_of_others(wi);
        }
    }
}

/// cosθi of a direction of any length; 0 below the horizon.
#[cold]
fn cosine_of_others(wi: Vec3) -> f32 {
    unit_upper(wi).map_or(0.0, |wi| wi.z)
}
