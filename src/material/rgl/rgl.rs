//! Measured materials of the RGL kind: values and density of a `.bsdf` file (Dupuy & Jakob 2018), as Mitsuba 3 has them.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};

use super::file::BsdfFile;
use super::warp::{Blend, Grid, Warp};
use crate::color::Rgb;
use crate::geometry::{Symmetry, reflect_about, spherical, to_spherical, unit_upper};

/// A `.bsdf` file ready to be evaluated. `wo`, the given direction, is what the file calls incident.
///
/// With m the half vector, u_m = (√(2θm/π), φm/2π + ½), φm counted from `wo` in an isotropic file, and s the point that the
/// file's warp takes to u_m: f_r·cosθᵢ = colour(s)·ndf(u_m)/(4 sigma(u_wo)), and the density of draws is
/// luminance(s)·warp(u_m)/J, J = max(2π²·u_m.x·sinθm, 10⁻⁶)·4(wo·m). Tables are linear between their nodes, in `wo` too.
/// Spectra become linear sRGB under the illuminant D65. Channels below 0, which measured spectra and their interpolation may
/// have, are 0.
#[derive(Debug)]
pub struct RglBrdf {
    theta_i: Vec<f32>,
    phi_i: Vec<f32>,
    /// Nothing is multiplied where it is missing.
    area: Option<[Grid; 2]>,
    warp: Warp,
    luminance: Warp,
    colour: Grid,
    symmetry: Symmetry,
}

/// Where a pair of directions stands in the file.
struct Place {
    blend: Blend,
    wo: [f64; 2],
    m: [f64; 2],
    jacobian: f64,
}

impl RglBrdf {
    /// Normalises the tables.
    pub fn new(file: BsdfFile) -> Self {
        let symmetry = symmetry(&file);
        Self {
            area: file
                .jacobian
                .then(|| [Grid::new(file.ndf, 1), Grid::new(file.sigma, 1)]),
            warp: Warp::new(file.vndf),
            luminance: Warp::new(file.luminance),
            colour: Grid::new(file.colour.to_rgb(), 3),
            symmetry,
            theta_i: file.theta_i,
            phi_i: file.phi_i,
        }
    }

    /// Whether turning both directions about the normal leaves values as they are.
    pub fn is_isotropic(&self) -> bool {
        self.symmetry == Symmetry::Isotropic
    }

    /// What turns and mirrors of both directions leave values as they are; the file tabulates the azimuths of its span.
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// f_r·cosθᵢ in sr⁻¹; 0 for what is no direction above the horizon.
    pub fn value_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let Some(place) = self.place(wo, wi) else {
            return Rgb::ZERO;
        };
        let (s, _) = self.warp.invert(place.m, &place.blend);
        let scale = self.area.as_ref().map_or(1.0, |[ndf, sigma]| {
            ndf.at(place.m, 0, &Blend::ONLY) / (4.0 * sigma.at(place.wo, 0, &Blend::ONLY))
        });
        let channel = |c: usize| (self.colour.at(s, c, &place.blend) * scale).max(0.0) as f32;
        let rgb = Rgb::new(channel(0), channel(1), channel(2));
        if rgb.is_finite() { rgb } else { Rgb::ZERO }
    }

    /// f_r in sr⁻¹; 0 for what is no direction above the horizon.
    pub fn value(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let Some(unit) = unit_upper(wi) else {
            return Rgb::ZERO;
        };
        let f = self.value_cos(wo, unit) / unit.z;
        if f.is_finite() { f } else { Rgb::ZERO }
    }

    /// Density of [`Self::draw`] per solid angle of `wi`, sr⁻¹. Draws below the horizon make it integrate to less than 1.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(place) = self.place(wo, wi) else {
            return 0.0;
        };
        let (s, stretch) = self.warp.invert(place.m, &place.blend);
        (self.luminance.density(s, &place.blend) * stretch / place.jacobian) as f32
    }

    /// The direction that a point of the unit square is mapped to; `None` below the horizon.
    pub fn draw(&self, wo: Vec3, u: [f64; 2]) -> Option<Vec3> {
        let turned = self.turned(unit_upper(wo)?);
        let (theta, phi) = to_spherical(turned.wo);
        let blend = Blend::about(phi, theta, &self.phi_i, &self.theta_i);
        let u_m = self.warp.sample(self.luminance.sample(u, &blend), &blend);
        let from = if self.is_isotropic() { phi } else { 0.0 };
        let m = spherical(
            u_m[0] * u_m[0] * FRAC_PI_2,
            (2.0 * u_m[1] - 1.0) * PI + from,
        );
        unit_upper((reflect_about(turned.wo, m) * turned.signs).as_vec3())
    }

    /// Bytes of the tables that [`Self::draw`] and [`Self::density`] use.
    pub fn draw_bytes(&self) -> usize {
        self.warp.bytes() + self.luminance.bytes()
    }

    /// Bytes of all tables.
    pub fn table_bytes(&self) -> usize {
        let area = self.area.iter().flatten().map(Grid::bytes).sum::<usize>();
        self.draw_bytes() + self.colour.bytes() + area
    }

    fn place(&self, wo: Vec3, wi: Vec3) -> Option<Place> {
        let (wo, wi) = (unit_upper(wo)?, unit_upper(wi)?.as_dvec3());
        let turned = self.turned(wo);
        let m = (turned.wo + wi * turned.signs).normalize();
        let ((theta, phi), (theta_m, phi_m)) = (to_spherical(turned.wo), to_spherical(m));
        let from = if self.is_isotropic() { phi } else { 0.0 };
        let u_m = [root(theta_m), share_of_turn(phi_m - from)];
        Some(Place {
            blend: Blend::about(phi, theta, &self.phi_i, &self.theta_i),
            wo: [root(theta), share_of_turn(phi)],
            m: u_m,
            jacobian: jacobian(u_m[0], theta_m.sin(), turned.wo.dot(m)),
        })
    }

    /// `wo` where azimuths are tabulated, and the signs by which `wi` goes along.
    fn turned(&self, wo: Vec3) -> Turned {
        let signs = self.symmetry.signs(wo).as_dvec3();
        Turned {
            wo: wo.as_dvec3() * signs,
            signs,
        }
    }
}

struct Turned {
    wo: DVec3,
    signs: DVec3,
}

/// Solid angle of `wi` to a unit of area on the square of half vectors.
fn jacobian(x: f64, sin_theta_m: f64, cos_d: f64) -> f64 {
    (TAU * PI * x * sin_theta_m).max(1e-6) * 4.0 * cos_d
}

fn root(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

fn share_of_turn(phi: f64) -> f64 {
    let y = 0.5 * FRAC_1_PI * phi + 0.5;
    y - y.floor()
}

fn symmetry(file: &BsdfFile) -> Symmetry {
    let span = match file.phi_i.as_slice() {
        [first, .., last] if !file.is_isotropic() => f64::from(last - first),
        _ => return Symmetry::Isotropic,
    };
    match (TAU / span).round() as u32 {
        0 | 1 => Symmetry::Whole,
        4 => Symmetry::Quarter,
        _ => Symmetry::Half,
    }
}
