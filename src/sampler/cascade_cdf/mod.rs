//! Cascaded CDFs of the half vector (Lawrence, Rusinkiewicz, Ramamoorthi 2005; thesis 5.6): a marginal over θh and
//! conditionals over φh for each of a few angles of `wo`, inverted by binary search, stored whole or compressed.
//!
//! Half vectors that reflect `wo` below the horizon make a draw fail; only cells that the horizon crosses hold any.

mod axis;
mod build;
mod codec;
mod fields;
mod plot_data;
mod settings;
mod tables;

pub use axis::ThetaSpacing;
pub use plot_data::CdfCurve;
pub use settings::CascadeCdfSettings;

pub(super) use axis::ThetaAxis;
pub(super) use build::{contribution, masses};

use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::azimuth_knots::{check_azimuths, check_stored_azimuths};
use super::direction_knots::{DirectionKnots, DirectionNeighbours};
use super::knots::split_unit;
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs, Settings};
use crate::Result;
use crate::brdf::Brdf;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::distribution::Segment;
use crate::geometry::{Symmetry, approx, cosine_hemisphere, is_upper, reflect_about, unit_upper};
use crate::material::{Loaded, MaterialFacts};
use tables::Tables;

/// Marginal and conditional CDFs over the half vector.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct CascadeCdf {
    settings: CascadeCdfSettings,
    knots: DirectionKnots,
    axis: ThetaAxis,
    tables: Tables,
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
    fn from_parts(
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
    fn draw(&self, k: usize, u: DVec2) -> DVec2 {
        // First θh from the marginal curve, then φh from the conditional curve of its piece.
        let row = self.tables.marginal.find(k, u.x);
        let conditional = self.tables.first[k] as usize + row.index;
        let column = self.tables.conditional.find(conditional, u.y);
        DVec2::new(position_in(&row, u.x), position_in(&column, u.y))
    }

    /// Density of table `k` per unit of the square (θh, φh), each axis scaled to 0..1.
    #[inline]
    fn square_density(&self, k: usize, at: DVec2) -> f64 {
        let piece = self.tables.marginal.find_segment(k, at.x);
        let within = self
            .tables
            .conditional
            .find_segment(self.tables.first[k] as usize + piece.index, at.y);
        // p(a, b) = dF(a)/da · dF(b | a)/db, the slopes of both pieces. Grid units are cells, and the square has sides 1.
        let cells = (self.settings.theta_h * self.settings.phi_h) as f64;
        // One division for both densities: it is what takes time here.
        (piece.c1 - piece.c0) * (within.c1 - within.c0) * cells
            / ((piece.x1 - piece.x0) * (within.x1 - within.x0))
    }

    /// Density of table `k` per solid angle; that of the cosine for a void table.
    #[inline(always)]
    fn knot_density(&self, k: usize, at: DVec2, to_solid_angle: f64, cosine: f64) -> f64 {
        if self.tables.marginal.is_void(k) {
            cosine
        } else {
            self.square_density(k, at) * to_solid_angle
        }
    }

    /// Density of the tables of one azimuth, whose direction in the plane is `axis`, at a half vector along `sum`.
    #[inline(always)]
    fn azimuth_density(
        &self,
        near: &DirectionNeighbours,
        azimuth: usize,
        point: &HalfVectorPoint,
        cosine: f64,
    ) -> f64 {
        // φh of the half vector against the azimuth of the table, as a coordinate in [0, 1].
        let sum = point.sum;
        let angle = match near.axes[azimuth] {
            DVec2::ZERO => approx::atan2(sum.y, sum.x),
            axis => approx::atan2(axis.perp_dot(sum.truncate()), axis.dot(sum.truncate())),
        };
        let turn = angle * (1.0 / TAU);
        let b = if turn < 0.0 { turn + 1.0 } else { turn };
        debug_assert!((0.0..=1.0).contains(&point.a) && (0.0..=1.0).contains(&b));
        let at = DVec2::new(
            point.a * self.settings.theta_h as f64,
            b * self.settings.phi_h as f64,
        );
        // The knots' densities by their weights; a knot without weight is not looked up.
        let (start, polar) = (near.starts[azimuth], near.polar);
        let first = if polar.share < 1.0 {
            (1.0 - polar.share)
                * self.knot_density(start + polar.first, at, point.to_solid_angle, cosine)
        } else {
            0.0
        };
        let second = if polar.share > 0.0 {
            polar.share * self.knot_density(start + polar.second, at, point.to_solid_angle, cosine)
        } else {
            0.0
        };
        first + second
    }

    /// Density of `wi`, among the azimuths that have tables as the `wo` of `near` is.
    fn density(&self, near: &DirectionNeighbours, wi: DVec3) -> f32 {
        // Step 1: θh of the half vector as a coordinate in [0, 1].
        let sum = near.wo.as_dvec3() + wi;
        let rho = (sum.x * sum.x + sum.y * sum.y).sqrt();
        let a = self.axis.coordinate(approx::atan2(rho, sum.z));
        // dσ(h) = 2π sinθh (dθh/da) da db, and dσ(wi) = 4 (wo·h) dσ(h) with wo·h = |wo + wi|/2.
        let length = sum.length();
        let point = HalfVectorPoint {
            sum,
            a,
            to_solid_angle: 1.0 / (TAU * self.axis.solid_angle(a, rho / length) * 2.0 * length),
        };
        // Step 2: the densities of the tables of both azimuths by their weights.
        let cosine = wi.z * FRAC_1_PI;
        let mut tables = 0.0;
        for (azimuth, weight) in [1.0 - near.weight, near.weight].into_iter().enumerate() {
            if weight > 0.0 {
                tables += weight * self.azimuth_density(near, azimuth, &point, cosine);
            }
        }
        let floor = self.settings.floor;
        ((1.0 - floor) * tables + floor * cosine).min(f64::from(f32::MAX)) as f32
    }

    /// Half vector at grid coordinates `at` of a table whose azimuth has the direction `axis` in the plane.
    #[inline]
    fn half_vector(&self, axis: DVec2, at: DVec2) -> DVec3 {
        // θh and φh from the coordinates, then the turn by the azimuth of the table, from which φh counts.
        let theta = self.axis.theta(at.x / self.settings.theta_h as f64);
        let (sin, cos) = approx::sin_cos_turns(theta * (1.0 / TAU));
        let (s, c) = approx::sin_cos_turns(at.y / self.settings.phi_h as f64);
        let turn = axis.try_normalize().unwrap_or(DVec2::X);
        (turn.rotate(DVec2::new(c, s)) * sin).extend(cos)
    }
}

/// A half vector, as far as it is the same for all tables.
struct HalfVectorPoint {
    /// wo + wi.
    sum: DVec3,
    /// Coordinate of θh.
    a: f64,
    /// What a density over the square is multiplied by.
    to_solid_angle: f64,
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
fn position_in(piece: &Segment, u: f64) -> f64 {
    piece.x0 + ((u - piece.c0) / (piece.c1 - piece.c0)).clamp(0.0, 1.0) * (piece.x1 - piece.x0)
}

impl Method for CascadeCdf {
    const NAME: &'static str = "cascade-cdf";
    const SUMMARY: &'static str =
        "a marginal and conditional CDFs over the half vector, compressed or whole";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = CascadeCdfSettings;

    fn check_facts(settings: &CascadeCdfSettings, facts: &MaterialFacts) -> Result<()> {
        check_azimuths(settings.azimuths, facts.symmetry)
    }

    fn build(material: &Loaded, settings: &CascadeCdfSettings) -> Result<Self> {
        Self::build(&**material.brdf(), *settings)
    }

    fn settings(&self) -> CascadeCdfSettings {
        *self.settings()
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        codec::write(&self.tables, out);
        Ok(())
    }

    fn agree(asked: &CascadeCdfSettings, used: &CascadeCdfSettings) -> bool {
        let azimuths = asked.azimuths.or(used.azimuths);
        CascadeCdfSettings { azimuths, ..*asked } == *used
    }

    fn read(tensors: &Tensors, settings: CascadeCdfSettings, material: &Loaded) -> Result<Self> {
        let symmetry = material.symmetry();
        check_stored_azimuths(settings.azimuths, symmetry, tensors)?;
        Self::from_parts(settings, symmetry, codec::read(tensors, &settings)?)
    }
}

impl DirectionSampler for CascadeCdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        let near = self.knots.neighbours(wo);
        let (ignore_tables, x) = split_unit(f64::from(u.x), self.settings.floor);
        let (is_first, left) = split_unit(x, 1.0 - near.weight);
        let azimuth = usize::from(!is_first);
        let (is_first, y) = split_unit(f64::from(u.y), 1.0 - near.polar.share);
        let polar = if is_first {
            near.polar.first
        } else {
            near.polar.second
        };
        let k = near.starts[azimuth] + polar;
        let wi = if ignore_tables {
            cosine_hemisphere(DVec2::new(x, f64::from(u.y))).as_vec3()
        } else if self.tables.marginal.is_void(k) {
            cosine_hemisphere(DVec2::new(left, y)).as_vec3()
        } else {
            let h = self.half_vector(near.axes[azimuth], self.draw(k, DVec2::new(left, y)));
            reflect_about(near.wo.as_dvec3(), h).as_vec3()
        };
        if !is_upper(wi) {
            return None;
        }
        let pdf = self.density(&near, wi.as_dvec3());
        let wi = wi * near.signs;
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        let near = self.knots.neighbours(wo);
        self.density(&near, (wi * near.signs).as_dvec3())
    }

    fn bytes(&self) -> usize {
        self.tables.marginal.bytes()
            + self.tables.conditional.bytes()
            + size_of_val(self.tables.first.as_slice())
    }
}
