//! The reflectance that a `.bsdf` file holds (Dupuy & Jakob 2018), evaluated as Mitsuba 3 evaluates it.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use glam::{DVec3, Vec3};

use super::file::BsdfFile;
use super::warp::{SliceBlend, SliceGrid, SquareWarp};
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{Symmetry, to_spherical, unit_upper};

/// A `.bsdf` file ready to be evaluated and, as a [`crate::direction_sampler::DirectionSampler`], to be sampled by the density
/// that it holds. `wo`, the given direction, is what the file calls incident.
///
/// With m the half vector, u_m = (√(2θm/π), φm/2π + ½), φm counted from `wo` in an isotropic file, and s the point that the
/// file's warp takes to u_m: f_r·cosθᵢ = colour(s)·ndf(u_m)/(4 sigma(u_wo)), and the density of draws is
/// luminance(s)·warp(u_m)/J, J = max(2π²·u_m.x·sinθm, 10⁻⁶)·4(wo·m). Tables are linear between their nodes, in `wo` too.
/// Spectra become linear sRGB under the illuminant D65. Channels below 0, which measured spectra and their interpolation may
/// have, are 0.
#[derive(Debug)]
pub struct RglBrdf {
    pub(super) theta_i: Vec<f32>,
    pub(super) phi_i: Vec<f32>,
    /// `ndf` and `sigma`; absent where the file's values need no factor.
    area: Option<[SliceGrid; 2]>,
    pub(super) warp: SquareWarp,
    pub(super) luminance: SquareWarp,
    colour: SliceGrid,
    symmetry: Symmetry,
}

/// A pair of directions in the coordinates of the file's tables.
pub(super) struct FilePoint {
    /// The tabulated slices about `wo`.
    pub blend: SliceBlend,
    /// `wo` on the square of `sigma`.
    u_wo: [f64; 2],
    /// The half vector on its square.
    pub u_m: [f64; 2],
    /// Polar angle of the half vector, radians.
    pub theta_m: f64,
    /// Cosine of the angle between `wo` and the half vector.
    pub cos_d: f64,
}

/// `wo` among the azimuths that the file tabulates.
pub(super) struct FoldedView {
    /// The folded direction, unit length.
    pub wo: DVec3,
    /// Signs of x and y that fold `wo`; the same signs take every other direction along, and back.
    pub signs: DVec3,
}

impl RglBrdf {
    /// Normalises the tables of a file.
    pub fn new(file: BsdfFile) -> Self {
        let symmetry = file.symmetry();
        Self {
            area: file
                .jacobian
                .then(|| [SliceGrid::new(file.ndf, 1), SliceGrid::new(file.sigma, 1)]),
            warp: SquareWarp::new(file.vndf),
            luminance: SquareWarp::new(file.luminance),
            colour: SliceGrid::new(file.colour.to_rgb(), 3),
            symmetry,
            theta_i: file.theta_i,
            phi_i: file.phi_i,
        }
    }

    /// Bytes of all tables in memory, those that only draws need among them.
    pub fn table_bytes(&self) -> usize {
        let area = self
            .area
            .iter()
            .flatten()
            .map(SliceGrid::bytes)
            .sum::<usize>();
        self.warp.bytes() + self.luminance.bytes() + self.colour.bytes() + area
    }

    /// The coordinates of a pair; `None` unless both directions are above the horizon.
    pub(super) fn file_point(&self, wo: Vec3, wi: Vec3) -> Option<FilePoint> {
        let (wo, wi) = (unit_upper(wo)?, unit_upper(wi)?.as_dvec3());
        // Fold wo into the tabulated azimuths, and take wi along: the material's symmetry leaves f_r as it is.
        let view = self.fold(wo);
        // m = (wo + wi)/|wo + wi|.
        let m = (view.wo + wi * view.signs).normalize();
        let ((theta, phi), (theta_m, phi_m)) = (to_spherical(view.wo), to_spherical(m));
        // u_m = (√(2θm/π), φm/2π + ½); an isotropic file counts φm from wo.
        let u_m = [
            polar_coordinate(theta_m),
            turn_fraction(phi_m - self.azimuth_origin(phi)),
        ];
        Some(FilePoint {
            blend: SliceBlend::between(phi, theta, &self.phi_i, &self.theta_i),
            u_wo: [polar_coordinate(theta), turn_fraction(phi)],
            u_m,
            theta_m,
            cos_d: view.wo.dot(m),
        })
    }

    /// The azimuth that those of half vectors are counted from, radians, for `wo` at azimuth `phi`.
    pub(super) fn azimuth_origin(&self, phi: f64) -> f64 {
        if self.is_isotropic() { phi } else { 0.0 }
    }

    /// Folds a unit `wo` into the azimuths that are tabulated.
    pub(super) fn fold(&self, wo: Vec3) -> FoldedView {
        let signs = self.symmetry.signs(wo).as_dvec3();
        FoldedView {
            wo: wo.as_dvec3() * signs,
            signs,
        }
    }
}

impl Brdf for RglBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let Some(unit) = unit_upper(wi) else {
            return Rgb::ZERO;
        };
        // The file holds f_r·cosθᵢ. At grazing wi the quotient may leave the range of f32.
        let f = self.eval_cos(wo, unit) / unit.z;
        if f.is_finite() { f } else { Rgb::ZERO }
    }

    fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let Some(point) = self.file_point(wo, wi) else {
            return Rgb::ZERO;
        };
        // s: the point of the square that the file's warp takes to u_m.
        let (s, _) = self.warp.invert(point.u_m, &point.blend);
        // The factor ndf(u_m)/(4 sigma(u_wo)).
        let scale = match &self.area {
            Some([ndf, sigma]) => {
                let ndf = ndf.interpolate(point.u_m, 0, &SliceBlend::ONLY);
                let sigma = sigma.interpolate(point.u_wo, 0, &SliceBlend::ONLY);
                ndf / (4.0 * sigma)
            }
            None => 1.0,
        };
        // f_r·cosθᵢ = colour(s)·scale; interpolation of measured spectra may fall below 0.
        let mut rgb = Rgb::ZERO;
        for channel in 0..3 {
            let value = self.colour.interpolate(s, channel, &point.blend);
            rgb[channel] = (value * scale).max(0.0) as f32;
        }
        if rgb.is_finite() { rgb } else { Rgb::ZERO }
    }

    fn is_isotropic(&self) -> bool {
        self.symmetry == Symmetry::Isotropic
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}

/// √(2θ/π): where a polar angle lies along a square's x.
fn polar_coordinate(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

/// φ/2π + ½ modulo 1: where an azimuth lies along a square's y.
fn turn_fraction(phi: f64) -> f64 {
    let y = 0.5 * FRAC_1_PI * phi + 0.5;
    y - y.floor()
}
