//! The tables, and a draw from one of them.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::axis::ThetaAxis;
use super::build;
use super::settings::CascadeCdfSettings;
use super::tables::Tables;
use crate::Result;
use crate::brdf::Brdf;
use crate::direction_sampler::DirectionSample;
use crate::distribution::Segment;
use crate::geometry::{Symmetry, approx};
use crate::sampler::Settings;
use crate::sampler::azimuth_knots::check_azimuths;
use crate::sampler::direction_knots::{DirectionKnots, DirectionNeighbours};
use crate::sampler::knots::split_unit;

/// Marginal and conditional CDFs over the half vector.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct CascadeCdf {
    pub(super) settings: CascadeCdfSettings,
    pub(super) knots: DirectionKnots,
    pub(super) axis: ThetaAxis,
    pub(super) tables: Tables,
}

impl CascadeCdf {
    /// Tabulates `brdf` on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains.
    pub fn build(brdf: &dyn Brdf, settings: CascadeCdfSettings) -> Result<Self> {
        settings.check()?;
        check_azimuths(settings.azimuths, brdf.symmetry())?;
        let knots = knots(&settings, brdf.symmetry())?;
        let settings = CascadeCdfSettings {
            azimuths: knots.azimuths.setting(),
            ..settings
        };
        let axis = ThetaAxis::new(settings.spacing, settings.theta_h);
        let tables = build::tables(brdf, &settings, knots, axis);
        Self::from_parts(settings, brdf.symmetry(), tables)
    }

    /// Puts a sampler together from tables, which must be validated if stored. The settings name the azimuths.
    pub(super) fn from_parts(
        settings: CascadeCdfSettings,
        symmetry: Symmetry,
        tables: Tables,
    ) -> Result<Self> {
        Ok(Self {
            knots: knots(&settings, symmetry)?,
            axis: ThetaAxis::new(settings.spacing, settings.theta_h),
            settings,
            tables,
        })
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &CascadeCdfSettings {
        &self.settings
    }

    /// Grid coordinates (θh, φh) drawn from table `k`, which must not be void.
    #[inline]
    pub(super) fn draw(&self, k: usize, u: DVec2) -> DVec2 {
        // First θh from the marginal curve, then φh from the conditional curve of its piece.
        let row = self.tables.marginal.find(k, u.x);
        let conditional = self.tables.find_conditional(k, &row);
        let column = self.tables.conditional.find(conditional, u.y);
        DVec2::new(position_in(&row, u.x), position_in(&column, u.y))
    }

    /// Half vector at grid coordinates `at` of a table whose azimuth has the direction `axis` in the plane.
    #[inline]
    pub(super) fn half_vector(&self, axis: DVec2, at: DVec2) -> DVec3 {
        // θh and φh from the coordinates, then the turn by the azimuth of the table, from which φh counts.
        let theta = self.axis.theta(at.x / self.settings.theta_h as f64);
        let (sin, cos) = approx::sin_cos_turns(theta * (1.0 / TAU));
        let (s, c) = approx::sin_cos_turns(at.y / self.settings.phi_h as f64);
        let turn = axis.try_normalize().unwrap_or(DVec2::X);
        (turn.rotate(DVec2::new(c, s)) * sin).extend(cos)
    }

    /// What a point of the unit square chooses at the `wo` of `near`.
    #[inline]
    pub(super) fn choose(&self, near: &DirectionNeighbours, u: Vec2) -> Chosen {
        let u = u.as_dvec2();
        let (ignore_tables, x) = split_unit(u.x, self.settings.floor);
        if ignore_tables {
            return Chosen::Cosine(DVec2::new(x, u.y));
        }
        let (is_first_azimuth, left) = split_unit(x, 1.0 - near.weight);
        let (is_first, y) = split_unit(u.y, 1.0 - near.polar.share);
        let azimuth = usize::from(!is_first_azimuth);
        let polar = if is_first {
            near.polar.first
        } else {
            near.polar.second
        };
        let (table, u) = (near.starts[azimuth] + polar, DVec2::new(left, y));
        if self.tables.marginal.is_void(table) {
            return Chosen::Cosine(u);
        }
        Chosen::Table { table, azimuth, u }
    }

    /// The sample of a direction that was drawn, among the azimuths that have tables.
    #[inline]
    pub(super) fn finish(
        &self,
        near: &DirectionNeighbours,
        wi: Vec3,
        pdf: f32,
    ) -> Option<DirectionSample> {
        let wi = wi * near.signs;
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }
}

/// What a draw is made from, and the point of the unit square that is left for it.
pub(super) enum Chosen {
    /// The cosine: of the floor, or of a table without mass.
    Cosine(DVec2),
    Table {
        table: usize,
        azimuth: usize,
        u: DVec2,
    },
}

/// The directions that have tables.
fn knots(settings: &CascadeCdfSettings, symmetry: Symmetry) -> Result<DirectionKnots> {
    DirectionKnots::new(
        settings.tables,
        settings.choice,
        symmetry,
        settings.azimuths,
    )
}

/// Where in its piece of a curve a probability is reached, in grid units: x0 + (u − c0)/(c1 − c0) · (x1 − x0).
#[inline(always)]
pub(super) fn position_in(piece: &Segment, u: f64) -> f64 {
    piece.x0 + ((u - piece.c0) / (piece.c1 - piece.c0)).clamp(0.0, 1.0) * (piece.x1 - piece.x0)
}
