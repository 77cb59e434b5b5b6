//! Cascaded CDFs of the half vector (Lawrence, Rusinkiewicz, Ramamoorthi 2005; thesis 5.6): a marginal over θh and
//! conditionals over φh for each of a few angles of `wo`, inverted by binary search, stored whole or compressed.
//!
//! Half vectors that reflect `wo` below the horizon make a draw fail; only cells that the horizon crosses hold any.

mod axis;
mod build;
mod shown;

pub use axis::ThetaSpacing;
pub use shown::ShownCdf;

pub(super) use axis::ThetaAxis;
pub(super) use build::{contribution, masses};

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::knots::{Neighbours, TableChoice, ThetaKnots, split_unit};
use super::{DirectionSample, DirectionSampler};
use crate::brdf::{Brdf, Importance};
use crate::distribution::Curves;
use crate::geometry::{approx, cosine_hemisphere, is_upper, reflect_about, unit_upper};
use crate::{Error, Result};

/// Settings of [`CascadeCdf::build`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CascadeCdfSettings {
    /// Tables over the polar angle of `wo`, 1 to 4096.
    pub tables: usize,
    /// Cells over θh, 1 to 8192.
    pub theta_h: usize,
    /// Cells over φh, 1 to 8192.
    pub phi_h: usize,
    /// How cells are spaced over θh.
    pub spacing: ThetaSpacing,
    /// Largest error of a compressed curve, in probability; `None` stores every knot.
    pub tolerance: Option<f64>,
    /// What serves a `wo` between two tables.
    pub choice: TableChoice,
    /// Share of draws that ignore the tables and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
}

impl Default for CascadeCdfSettings {
    fn default() -> Self {
        Self {
            tables: 16,
            theta_h: 1024,
            phi_h: 512,
            spacing: ThetaSpacing::Merl,
            tolerance: Some(1e-3),
            choice: TableChoice::Mixture,
            floor: 1e-3,
            importance: Importance::Mean,
        }
    }
}

impl CascadeCdfSettings {
    /// Every knot of 256 × 32 cells a table.
    pub fn uniform() -> Self {
        Self {
            theta_h: 256,
            phi_h: 32,
            tolerance: None,
            ..Self::default()
        }
    }

    /// What the thesis used for its tables 6.23 and 6.24; `compressed` starts from 1024 × 512 cells.
    pub fn as_published(compressed: bool) -> Self {
        let published = Self {
            tables: 32,
            spacing: ThetaSpacing::Uniform,
            choice: TableChoice::Nearest,
            floor: 0.0,
            ..Self::default()
        };
        if compressed {
            published
        } else {
            Self {
                theta_h: 256,
                phi_h: 32,
                tolerance: None,
                ..published
            }
        }
    }

    fn check(&self) -> Result<()> {
        let refuse = |what: String, fix: &str| Err(Error::argument(what, fix));
        for (name, cells) in [("θh", self.theta_h), ("φh", self.phi_h)] {
            if !(1..=8192).contains(&cells) {
                return refuse(format!("{cells} cells over {name}"), "choose 1 to 8192");
            }
        }
        // Knots are numbered in 32 bits, and without compression there is one at every edge of a cell.
        let knots = self
            .tables
            .saturating_mul((self.theta_h + 1) * (self.phi_h + 2));
        if u32::try_from(knots).is_err() {
            return refuse(
                format!(
                    "{} tables of {} × {} cells",
                    self.tables, self.theta_h, self.phi_h
                ),
                "choose fewer: at most 4·10⁹ cells in all",
            );
        }
        if !(0.0..=1.0).contains(&self.floor) {
            return refuse(
                format!("floor is {}", self.floor),
                "choose a share between 0 and 1",
            );
        }
        if self.tolerance.is_some_and(|t| t.is_nan() || t < 0.0) {
            return refuse(
                "the tolerance is negative or not a number".into(),
                "choose 0 or more, such as 1e-3",
            );
        }
        Ok(())
    }
}

/// The tables of all knots.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tables {
    /// One curve over θh a knot.
    pub marginal: Curves,
    /// One curve over φh for each piece of each marginal, in order.
    pub conditional: Curves,
    /// First conditional of each knot.
    first: Vec<u32>,
}

impl Tables {
    pub fn new(marginal: Curves, conditional: Curves) -> Self {
        let first = (0..marginal.len())
            .scan(0, |next, k| {
                let first = *next;
                *next += marginal.segments(k) as u32;
                Some(first)
            })
            .collect();
        Self {
            marginal,
            conditional,
            first,
        }
    }
}

/// Marginal and conditional CDFs over the half vector.
#[derive(Clone, Debug)]
pub struct CascadeCdf {
    settings: CascadeCdfSettings,
    knots: ThetaKnots,
    axis: ThetaAxis,
    tables: Tables,
}

impl CascadeCdf {
    /// Tabulates `brdf` on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains.
    pub fn build(brdf: &dyn Brdf, settings: CascadeCdfSettings) -> Result<Self> {
        settings.check()?;
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        let axis = ThetaAxis::new(settings.spacing, settings.theta_h);
        let tables = build::tables(brdf, &settings, knots, axis);
        Ok(Self {
            settings,
            knots,
            axis,
            tables,
        })
    }

    /// Puts a sampler together from stored tables, which must have been validated.
    pub(super) fn from_parts(settings: CascadeCdfSettings, tables: Tables) -> Result<Self> {
        settings.check()?;
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        let axis = ThetaAxis::new(settings.spacing, settings.theta_h);
        Ok(Self {
            settings,
            knots,
            axis,
            tables,
        })
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &CascadeCdfSettings {
        &self.settings
    }

    pub(super) fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Grid coordinates (θh, φh) drawn from table `k`, which must not be void.
    #[inline]
    fn draw(&self, k: usize, u: DVec2) -> DVec2 {
        let invert = |curves: &Curves, curve: usize, u: f64| {
            let s = curves.find(curve, u);
            (
                s,
                s.x0 + ((u - s.c0) / (s.c1 - s.c0)).clamp(0.0, 1.0) * (s.x1 - s.x0),
            )
        };
        let (piece, x) = invert(&self.tables.marginal, k, u.x);
        let conditional = self.tables.first[k] as usize + piece.index;
        DVec2::new(x, invert(&self.tables.conditional, conditional, u.y).1)
    }

    /// Density of table `k` per unit of the square (θh, φh), each axis scaled to 0..1.
    #[inline]
    fn square_density(&self, k: usize, at: DVec2) -> f64 {
        let piece = self.tables.marginal.at(k, at.x);
        let within = self
            .tables
            .conditional
            .at(self.tables.first[k] as usize + piece.index, at.y);
        let cells = (self.settings.theta_h * self.settings.phi_h) as f64;
        // One division for both densities: it is what takes time here.
        (piece.c1 - piece.c0) * (within.c1 - within.c0) * cells
            / ((piece.x1 - piece.x0) * (within.x1 - within.x0))
    }

    fn density(&self, near: Neighbours, wo: DVec3, wi: DVec3) -> f32 {
        let sum = wo + wi;
        let rho = (sum.x * sum.x + sum.y * sum.y).sqrt();
        let a = self.axis.coordinate(approx::atan2(rho, sum.z));
        let azimuth = match wo.truncate() {
            DVec2::ZERO => approx::atan2(sum.y, sum.x),
            axis => approx::atan2(axis.perp_dot(sum.truncate()), axis.dot(sum.truncate())),
        };
        let turn = azimuth * (1.0 / TAU);
        let b = if turn < 0.0 { turn + 1.0 } else { turn };
        let at = DVec2::new(
            a * self.settings.theta_h as f64,
            b * self.settings.phi_h as f64,
        );
        // dσ(h) = 2π sinθh (dθh/da) da db, and dσ(wi) = 4 (wo·h) dσ(h) with wo·h = |wo + wi|/2.
        let length = sum.length();
        let to_solid_angle = 1.0 / (TAU * self.axis.solid_angle(a, rho / length) * 2.0 * length);
        let cosine = wi.z * FRAC_1_PI;
        let of = |k: usize| {
            if self.tables.marginal.is_void(k) {
                cosine
            } else {
                self.square_density(k, at) * to_solid_angle
            }
        };
        let first = if near.share < 1.0 {
            (1.0 - near.share) * of(near.first)
        } else {
            0.0
        };
        let tables = first
            + if near.share > 0.0 {
                near.share * of(near.second)
            } else {
                0.0
            };
        let floor = self.settings.floor;
        ((1.0 - floor) * tables + floor * cosine).min(f64::from(f32::MAX)) as f32
    }

    /// Half vector at grid coordinates `at`, in the frame of `wo`.
    #[inline]
    fn half_vector(&self, wo: Vec3, at: DVec2) -> DVec3 {
        let theta = self.axis.theta(at.x / self.settings.theta_h as f64);
        let (sin, cos) = approx::sin_cos_turns(theta * (1.0 / TAU));
        let (s, c) = approx::sin_cos_turns(at.y / self.settings.phi_h as f64);
        let turn = wo.truncate().as_dvec2().try_normalize().unwrap_or(DVec2::X);
        (turn.rotate(DVec2::new(c, s)) * sin).extend(cos)
    }
}

impl DirectionSampler for CascadeCdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        let near = self.knots.neighbours(wo);
        let (ignore_tables, x) = split_unit(f64::from(u.x), self.settings.floor);
        let (first, y) = split_unit(f64::from(u.y), 1.0 - near.share);
        let k = if first { near.first } else { near.second };
        let wi = if ignore_tables {
            cosine_hemisphere(DVec2::new(x, f64::from(u.y))).as_vec3()
        } else if self.tables.marginal.is_void(k) {
            cosine_hemisphere(DVec2::new(x, y)).as_vec3()
        } else {
            let h = self.half_vector(wo, self.draw(k, DVec2::new(x, y)));
            reflect_about(wo.as_dvec3(), h).as_vec3()
        };
        if !is_upper(wi) {
            return None;
        }
        let pdf = self.density(near, wo.as_dvec3(), wi.as_dvec3());
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        self.density(self.knots.neighbours(wo), wo.as_dvec3(), wi.as_dvec3())
    }

    fn bytes(&self) -> usize {
        self.tables.marginal.bytes()
            + self.tables.conditional.bytes()
            + size_of_val(self.tables.first.as_slice())
    }
}
