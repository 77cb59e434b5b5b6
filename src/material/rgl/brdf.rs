//! The reflectance that a `.bsdf` file holds (Dupuy & Jakob 2018), evaluated as Mitsuba 3 evaluates it.

use fearless_simd::{Level, dispatch};
use glam::Vec3;

use super::coordinates::{
    FoldedView, LANES, angles_to_points, lane_angles, polar_angles, square_point,
};
use super::file::BsdfFile;
use super::warp::{SliceBlend, SliceGrid, SquareWarp};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{Symmetry, unit_upper};
use crate::lanes::{Columns, UnitDirections};

/// A `.bsdf` file ready to be evaluated and, as a [`crate::direction_sampler::DirectionSampler`], to be sampled by the density
/// that it holds. `wo`, the given direction, is what the file calls incident.
///
/// With m the half vector, u_m = (√(2θm/π), φm/2π + ½), φm counted from `wo` in an isotropic file, and s the point that the
/// file's warp takes to u_m: f_r·cosθᵢ = colour(s)·ndf(u_m)/(4 sigma(u_wo)), and the density of draws is
/// luminance(s)·warp(u_m)/J, J = max(2π²·u_m.x·sinθm, 10⁻⁶)·4(wo·m). Tables are linear between their nodes, in `wo` too.
/// Spectra become linear sRGB under the illuminant D65. Channels below 0, which measured spectra and their interpolation may
/// have, are 0.
///
/// The example of [`BsdfFile`](crate::material::rgl::BsdfFile) tabulates a material and evaluates the result.
#[derive(Debug)]
pub struct RglBrdf {
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    /// `ndf` and `sigma`; absent where the file's values need no factor.
    area: Option<[SliceGrid<1>; 2]>,
    pub(super) warp: SquareWarp,
    pub(super) luminance: SquareWarp,
    colour: SliceGrid<3>,
    symmetry: Symmetry,
}

/// The part of a look-up that depends on `wo` alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct GivenView {
    /// `wo` among the azimuths that the file tabulates.
    pub folded: FoldedView,
    /// The azimuth that those of half vectors are counted from, radians.
    pub origin: f64,
    /// Where its tables are.
    pub tables: GivenTables,
}

/// What the values along a `wo` are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct GivenTables {
    /// The tabulated slices about `wo`.
    pub blend: SliceBlend,
    /// 1/(4 sigma(u_wo)); 1 where the file's values need no factor.
    scale: f64,
}

impl RglBrdf {
    /// Normalises the tables of a file.
    pub fn new(file: BsdfFile) -> Self {
        debug_assert!(
            file.theta_i.is_sorted_by(|a, b| a < b) && file.phi_i.is_sorted_by(|a, b| a < b)
        );
        Self {
            symmetry: file.symmetry(),
            area: file
                .jacobian
                .then(|| [SliceGrid::new(&file.ndf), SliceGrid::new(&file.sigma)]),
            warp: SquareWarp::new(&file.vndf),
            luminance: SquareWarp::new(&file.luminance),
            colour: SliceGrid::new(&file.colour.to_rgb()),
            theta_i: file.theta_i.into_iter().map(f64::from).collect(),
            phi_i: file.phi_i.into_iter().map(f64::from).collect(),
        }
    }

    /// Bytes of all tables in memory, those that only draws need among them.
    pub fn table_bytes(&self) -> usize {
        let mut bytes = self.warp.bytes() + self.luminance.bytes() + self.colour.bytes();
        for grid in self.area.iter().flatten() {
            bytes += grid.bytes();
        }
        bytes
    }

    /// Everything that depends on `wo` alone; `None` unless it is above the horizon.
    #[inline]
    pub(super) fn view(&self, wo: Vec3) -> Option<GivenView> {
        let folded = FoldedView::new(unit_upper(wo)?, self.symmetry);
        let angles = polar_angles(folded.wo.to_array());
        Some(GivenView {
            folded,
            origin: self.azimuth_origin(angles[1]),
            tables: self.view_tables(angles),
        })
    }

    /// The tables for a folded `wo` of such angles.
    #[inline(always)]
    fn view_tables(&self, [theta, phi]: [f64; 2]) -> GivenTables {
        let scale = match &self.area {
            Some([_, sigma]) => {
                // sigma, the projected area of the microfacets that wo sees, depends on wo alone.
                let [sigma] = sigma.interpolate(square_point([theta, phi]), &SliceBlend::ONLY);
                1.0 / (4.0 * sigma)
            }
            None => 1.0,
        };
        GivenTables {
            blend: SliceBlend::between(phi, theta, &self.phi_i, &self.theta_i),
            scale,
        }
    }

    /// The azimuth that those of half vectors are counted from, radians, for `wo` at azimuth `phi`: an isotropic file counts
    /// from `wo`.
    #[inline(always)]
    fn azimuth_origin(&self, phi: f64) -> f64 {
        match self.symmetry {
            Symmetry::Isotropic => phi,
            _ => 0.0,
        }
    }

    /// s: the point of the square that the file's warp takes to `u_m`.
    #[inline(always)]
    fn unwarped(&self, tables: &GivenTables, u_m: [f64; 2]) -> [f64; 2] {
        self.warp.invert(u_m, &tables.blend).0
    }

    /// f_r·cosθᵢ where the half vector lies at `u_m` on its square, which the warp takes `s` to.
    #[inline(always)]
    fn value_cos(&self, tables: &GivenTables, u_m: [f64; 2], s: [f64; 2]) -> Rgb {
        // The factor ndf(u_m)/(4 sigma(u_wo)).
        let scale = match &self.area {
            Some([ndf, _]) => ndf.interpolate(u_m, &SliceBlend::ONLY)[0] * tables.scale,
            None => 1.0,
        };
        // f_r·cosθᵢ = colour(s)·scale; interpolation of measured spectra may fall below 0.
        let colour = self.colour.interpolate(s, &tables.blend);
        let mut rgb = Rgb::ZERO;
        for channel in 0..3 {
            rgb[channel] = (colour[channel] * scale).max(0.0) as f32;
        }
        if rgb.is_finite() { rgb } else { Rgb::ZERO }
    }

    /// Values of a block of lanes whose half vectors lie at `points`, by the tables of each lane. Tables are larger than the
    /// nearest caches: short loops, one for each table, wait for many lanes' values at once.
    #[inline(always)]
    fn look_up<'a>(
        &self,
        tables: impl Fn(usize) -> &'a GivenTables,
        points: &Columns<f64, 2, LANES>,
        out: &mut [Rgb],
    ) {
        let count = out.len().min(LANES);
        let mut unwarped = Columns::<f64, 2, LANES>::splat([0.0; 2]);
        for lane in 0..count {
            unwarped.set(lane, self.unwarped(tables(lane), points.get(lane)));
        }
        for (lane, out) in out.iter_mut().enumerate().take(count) {
            *out = self.value_cos(tables(lane), points.get(lane), unwarped.get(lane));
        }
    }

    /// Any number of lanes about one `wo`.
    #[inline(always)]
    fn blocks_about(&self, view: &GivenView, wi: &[Vec3], out: &mut [Rgb]) {
        for (wi, out) in wi.chunks(LANES).zip(out.chunks_mut(LANES)) {
            self.block_about(view, wi, out);
        }
    }

    /// Any number of lanes, each with a `wo` of its own.
    #[inline(always)]
    fn blocks_of_pairs(&self, wo: &[Vec3], wi: &[Vec3], out: &mut [Rgb]) {
        let blocks = wi.chunks(LANES).zip(out.chunks_mut(LANES));
        for (wo, (wi, out)) in wo.chunks(LANES).zip(blocks) {
            self.block_of_pairs(wo, wi, out);
        }
    }

    /// A block of at most [`LANES`] lanes about one `wo`.
    #[inline(always)]
    fn block_about(&self, view: &GivenView, wi: &[Vec3], out: &mut [Rgb]) {
        let units = UnitDirections::<LANES>::load(wi);
        let mut halves = Columns::splat([0.0; 3]);
        for lane in 0..LANES {
            halves.set(lane, view.folded.half_vector(units.get(lane)).to_array());
        }
        let origins = Columns::splat([view.origin]);
        let mut points = Columns::splat([0.0; 2]);
        lane_angles(&halves, wi.len(), &mut points);
        angles_to_points(&mut points, &origins, wi.len());
        self.look_up(|_| &view.tables, &points, out);
        for (lane, out) in out.iter_mut().enumerate() {
            if !units.is_upper(lane) {
                *out = Rgb::ZERO;
            }
        }
    }

    /// A block of at most [`LANES`] lanes, each with a `wo` of its own.
    #[inline(always)]
    fn block_of_pairs(&self, wo: &[Vec3], wi: &[Vec3], out: &mut [Rgb]) {
        let (views, units) = (
            UnitDirections::<LANES>::load(wo),
            UnitDirections::<LANES>::load(wi),
        );
        // Folded wo and half vectors, then their angles in columns.
        let mut given = Columns::splat([0.0; 3]);
        let mut halves = Columns::splat([0.0; 3]);
        for lane in 0..LANES {
            let folded = FoldedView::new(views.get(lane), self.symmetry);
            given.set(lane, folded.wo.to_array());
            halves.set(lane, folded.half_vector(units.get(lane)).to_array());
        }
        let mut angles = Columns::splat([0.0; 2]);
        lane_angles(&given, wi.len(), &mut angles);
        let mut origins = Columns::splat([0.0]);
        for lane in 0..LANES {
            origins.set(lane, [self.azimuth_origin(angles.get(lane)[1])]);
        }
        let mut points = Columns::splat([0.0; 2]);
        lane_angles(&halves, wi.len(), &mut points);
        angles_to_points(&mut points, &origins, wi.len());
        // The tables about each wo.
        let mut tables = [GivenTables::NONE; LANES];
        for (lane, tables) in tables.iter_mut().enumerate().take(wi.len()) {
            *tables = self.view_tables(angles.get(lane));
        }
        self.look_up(|lane| &tables[lane], &points, out);
        for (lane, out) in out.iter_mut().enumerate() {
            if !views.is_upper(lane) || !units.is_upper(lane) {
                *out = Rgb::ZERO;
            }
        }
    }
}

impl GivenTables {
    /// The first slice as it is.
    const NONE: Self = Self {
        blend: SliceBlend::ONLY,
        scale: 1.0,
    };
}

/// f_r of f_r·cosθᵢ. At grazing `wi` the quotient may leave the range of f32.
#[inline(always)]
fn without_cosine(value: Rgb, wi: Vec3) -> Rgb {
    let f = unit_upper(wi).map_or(Rgb::ZERO, |unit| value / unit.z);
    if f.is_finite() { f } else { Rgb::ZERO }
}

impl Brdf for RglBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        without_cosine(self.eval_cos(wo, wi), wi)
    }

    fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (Some(view), Some(wi)) = (self.view(wo), unit_upper(wi)) else {
            return Rgb::ZERO;
        };
        let [theta_m, phi_m] = polar_angles(view.folded.half_vector(wi).to_array());
        let u_m = square_point([theta_m, phi_m - view.origin]);
        self.value_cos(&view.tables, u_m, self.unwarped(&view.tables, u_m))
    }

    #[track_caller]
    fn eval_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        self.eval_cos_batch(wo, wi, out);
        for (out, &wi) in out.iter_mut().zip(wi) {
            *out = without_cosine(*out, wi);
        }
    }

    #[track_caller]
    fn eval_cos_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        match wo {
            Wo::One(wo) => match self.view(wo) {
                Some(view) => dispatch!(Level::new(), _ => self.blocks_about(&view, wi, out)),
                None => out.fill(Rgb::ZERO),
            },
            Wo::Each(wo) => dispatch!(Level::new(), _ => self.blocks_of_pairs(wo, wi, out)),
        }
    }

    fn is_isotropic(&self) -> bool {
        self.symmetry == Symmetry::Isotropic
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}
