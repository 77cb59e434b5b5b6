//! A brushed metal, as a formula and as the anisotropic `.bsdf` file that a measurement would become.
#![allow(dead_code)] // each test file uses its own part

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::{Rgb, luminance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{Symmetry, spherical, unit_upper};
use merlkit::material::rgl::{BsdfFile, Colour, RglBrdf, Tensor};

/// GGX of two roughnesses (Walter et al. 2007; Heitz 2014) over a little Lambert.
#[derive(Clone, Copy)]
pub struct Brushed {
    /// Roughness along x and y, before it is turned.
    pub alpha: [f64; 2],
    /// Turns the streaks against the surface's x, radians.
    pub turned: f64,
}

impl Brushed {
    pub const STRONG: Self = Self {
        alpha: [0.06, 0.4],
        turned: 0.0,
    };

    fn local(&self, w: DVec3) -> DVec3 {
        let (sin, cos) = self.turned.sin_cos();
        DVec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z)
    }

    /// Density of half vectors.
    fn distribution(&self, m: DVec3) -> f64 {
        let m = self.local(m);
        let [a, b] = self.alpha;
        FRAC_1_PI / (a * b * ((m.x / a).powi(2) + (m.y / b).powi(2) + m.z * m.z).powi(2))
    }

    fn lambda(&self, w: DVec3) -> f64 {
        let l = self.local(w);
        let slope2 = ((self.alpha[0] * l.x).powi(2) + (self.alpha[1] * l.y).powi(2)) / (l.z * l.z);
        0.5 * ((1.0 + slope2).sqrt() - 1.0)
    }

    fn value(&self, wo: DVec3, wi: DVec3) -> Rgb {
        let m = (wo + wi).normalize();
        let shadow = 1.0 / (1.0 + self.lambda(wo) + self.lambda(wi));
        let metal = self.distribution(m) * shadow / (4.0 * wo.z * wi.z);
        let tint = DVec3::new(0.9, 0.75, 0.55);
        let fresnel = tint + (1.0 - tint) * (1.0 - wo.dot(m)).max(0.0).powi(5);
        (fresnel * metal + 0.05 * FRAC_1_PI).as_vec3()
    }
}

impl Brdf for Brushed {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let pair = unit_upper(wo).zip(unit_upper(wi));
        pair.map_or(Rgb::ZERO, |(wo, wi)| {
            self.value(wo.as_dvec3(), wi.as_dvec3())
        })
    }

    fn is_isotropic(&self) -> bool {
        false
    }
}

/// How finely a file resolves `wo`, half vectors and the square of values.
#[derive(Clone, Copy)]
pub struct Resolution {
    pub azimuths: usize,
    pub angles: usize,
    /// Rows and columns of half vectors.
    pub half_vectors: [usize; 2],
    pub side: usize,
}

impl Resolution {
    pub const FINE: Self = Self {
        azimuths: 9,
        angles: 10,
        half_vectors: [128, 64],
        side: 32,
    };
    pub const COARSE: Self = Self {
        azimuths: 5,
        angles: 6,
        half_vectors: [48, 32],
        side: 16,
    };
}

/// Half vector at a point of the square.
fn half_vector(x: f64, y: f64) -> DVec3 {
    spherical(x * x * FRAC_PI_2, (2.0 * y - 1.0) * PI)
}

/// Values at all nodes of `[rows, columns]` over the square.
fn grid(rows: usize, columns: usize, value: impl Fn(f64, f64) -> f64) -> Tensor {
    let share = |k: usize, n: usize| k as f64 / (n - 1) as f64;
    let at = |k: usize| value(share(k % columns, columns), share(k / columns, rows)) as f32;
    Tensor {
        shape: vec![rows, columns],
        values: (0..rows * columns).map(at).collect(),
    }
}

/// The file that Dupuy & Jakob's construction makes of a metal of that symmetry: half vectors are drawn by the visible ones of
/// its distribution, and values are what is left.
pub fn bsdf_of(metal: &Brushed, symmetry: Symmetry, resolution: Resolution) -> BsdfFile {
    let Resolution {
        azimuths,
        angles,
        half_vectors: [rows, columns],
        side,
    } = resolution;
    let along = |k: usize, n: usize| k as f64 / (n - 1) as f64;
    let phi_i: Vec<f64> = (0..azimuths)
        .map(|k| Symmetry::START + symmetry.span() * along(k, azimuths))
        .collect();
    let theta_i: Vec<f64> = (0..angles)
        .map(|k| (88.0 * along(k, angles)).to_radians())
        .collect();
    let slices: Vec<DVec3> = phi_i
        .iter()
        .flat_map(|&phi| theta_i.iter().map(move |&theta| spherical(theta, phi)))
        .collect();
    let visible = |wo: &DVec3| {
        let density = |x: f64, y: f64| {
            let m = half_vector(x, y);
            (metal.distribution(m) + 0.02) * wo.dot(m).max(1e-3) * x * m.x.hypot(m.y)
        };
        grid(rows, columns, density).values
    };
    let shape = |rest: &[usize]| [&[azimuths, angles], rest].concat();
    let mut file = BsdfFile {
        notes: Vec::new(),
        description: "brushed metal".into(),
        theta_i: theta_i.iter().map(|&t| t as f32).collect(),
        phi_i: phi_i.iter().map(|&p| p as f32).collect(),
        jacobian: true,
        ndf: grid(rows, columns, |x, y| {
            metal.distribution(half_vector(x, y)) + 0.02
        }),
        sigma: grid(rows, columns, |x, y| {
            let w = half_vector(x.min(0.999), y);
            w.z * (1.0 + metal.lambda(w))
        }),
        vndf: Tensor {
            shape: shape(&[rows, columns]),
            values: slices.iter().flat_map(visible).collect(),
        },
        luminance: Tensor::filled(&shape(&[side, side]), 1.0),
        colour: Colour::Rgb(Tensor::filled(&shape(&[3, side, side]), 1.0)),
    };
    fill(&mut file, metal, symmetry, side);
    file
}

/// What a file of ones maps each node of the square to tells the values and densities there.
fn fill(file: &mut BsdfFile, metal: &Brushed, symmetry: Symmetry, side: usize) {
    let ones = RglBrdf::new(file.clone());
    assert_eq!(ones.symmetry(), symmetry);
    let share = |k: usize| k as f64 / (side - 1) as f64;
    let cells = side * side;
    let (mut rgb, mut densities) = (Vec::new(), Vec::new());
    for (&phi, &theta) in file
        .phi_i
        .iter()
        .flat_map(|p| file.theta_i.iter().map(move |t| (p, t)))
    {
        // Within the azimuths that are tabulated, whatever rounding does.
        let end = Symmetry::START + symmetry.span();
        let phi = f64::from(phi).clamp(Symmetry::START + 1e-5, end - 1e-5);
        let wo = spherical(f64::from(theta).max(1e-3), phi).as_vec3();
        let node = |k: usize| {
            let wi = ones.map_square(wo, DVec2::new(share(k % side), share(k / side)))?;
            let (scale, density) = (ones.eval_cos(wo, wi).x, ones.pdf(wo, wi));
            let value = metal.eval_cos(wo, wi);
            (scale > 0.0 && density > 0.0).then(|| (value / scale, luminance(value) / density))
        };
        let nodes: Vec<(Rgb, f32)> = (0..cells)
            .map(|k| node(k).unwrap_or((Rgb::ZERO, 0.0)))
            .collect();
        let mean = nodes.iter().map(|n| n.1).sum::<f32>() / cells as f32;
        (0..3).for_each(|c| rgb.extend(nodes.iter().map(|n| n.0[c])));
        densities.extend(nodes.iter().map(|n| n.1.max(1e-4 * mean)));
    }
    file.luminance.values = densities;
    let shape = [&file.luminance.shape[..2], &[3, side, side]].concat();
    file.colour = Colour::Rgb(Tensor { shape, values: rgb });
}

/// Directions about the azimuths that tables and symmetries end at, and between them.
pub fn directions() -> Vec<Vec3> {
    let angles = [0.0, 1e-6, 12.0, 47.0, 80.0, 89.0];
    let azimuths = [
        0.0,
        0.3,
        FRAC_PI_2,
        2.0,
        PI,
        -0.7,
        -FRAC_PI_2,
        -2.6,
        TAU - 1e-7,
    ];
    let at =
        |k: usize, phi: &f64| spherical(f64::to_radians(angles[k % angles.len()]), *phi).as_vec3();
    let twice = azimuths.iter().chain(&azimuths).enumerate();
    twice
        .map(|(k, phi)| at(k + k / azimuths.len(), phi))
        .collect()
}
