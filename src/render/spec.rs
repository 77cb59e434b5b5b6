//! What a picture shows, before anything is loaded.

use std::path::PathBuf;

use glam::DVec3;

use super::{Camera, Sphere};
use crate::color::Rgb;
use crate::distribution::Heuristic;
use crate::light::{Area, Directional, Point};

/// A scene described: names and numbers only.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// Names of materials that spheres may use.
    pub materials: Vec<String>,
    /// The spheres.
    pub spheres: Vec<SphereSpec>,
    /// Reflectance of a Lambertian floor at y = 0, or no floor.
    pub floor: Option<f32>,
    /// The lights.
    pub lights: Vec<LightSpec>,
    /// The view.
    pub camera: Camera,
    /// Surfaces a path may meet after the eye, ≥ 1; 1 is direct light only.
    pub depth: u32,
    /// How light from lights with an extent is found.
    pub strategy: Strategy,
}

/// A sphere and its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereSpec {
    /// Its shape.
    pub shape: Sphere,
    /// Position in [`SceneSpec::materials`].
    pub material: usize,
}

/// A light, not loaded.
#[derive(Clone, Debug, PartialEq)]
pub enum LightSpec {
    /// A point.
    Point(Point),
    /// Parallel light.
    Directional(Directional),
    /// A luminous rectangle.
    Area(Area),
    /// Light from all around.
    Environment(EnvironmentSource),
}

/// Where an environment's radiance comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// The built-in studio.
    Studio,
    /// Equal radiance from everywhere.
    Uniform(Rgb),
    /// An equirectangular OpenEXR file.
    File(PathBuf),
}

/// How light from lights with an extent is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// By one direction towards each light and one from the BRDF's sampler, weighted (Veach and Guibas 1995).
    Mis(Heuristic),
    /// By choosing a direction towards each light.
    Light,
    /// By choosing a direction from the BRDF's sampler.
    Brdf,
    /// By choosing several directions from the BRDF's sampler and keeping one of them in proportion to what it would reflect
    /// if nothing were in the way (resampled importance sampling, Talbot et al. 2005). Only that one is traced.
    Ris {
        /// Directions to keep one of, ≥ 1; 1 is [`Self::Brdf`].
        candidates: u32,
    },
}

impl Default for Strategy {
    fn default() -> Self {
        Self::Mis(Heuristic::default())
    }
}

impl Strategy {
    /// Candidates where none are asked for.
    pub const CANDIDATES: u32 = 8;

    /// How two techniques are weighted, should a plan hold both.
    pub(super) fn heuristic(self) -> Heuristic {
        match self {
            Self::Mis(heuristic) => heuristic,
            Self::Light | Self::Brdf | Self::Ris { .. } => Heuristic::default(),
        }
    }

    /// Candidates, should a plan resample.
    pub(super) fn candidates(self) -> u32 {
        match self {
            Self::Ris { candidates } => candidates,
            Self::Mis(_) | Self::Light | Self::Brdf => Self::CANDIDATES,
        }
    }
}

impl LightSpec {
    /// Whether it is a point or parallel: no direction drawn by chance can hit it.
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Directional(_))
    }

    /// Whether its description alone says that it gives no light.
    pub fn is_dark(&self) -> bool {
        let radiance = match self {
            Self::Point(light) => light.intensity,
            Self::Directional(light) => light.irradiance,
            Self::Area(light) => light.radiance,
            Self::Environment(EnvironmentSource::Uniform(radiance)) => *radiance,
            Self::Environment(EnvironmentSource::Studio | EnvironmentSource::File(_)) => {
                return false;
            }
        };
        radiance == Rgb::ZERO
    }

    /// What kind of light it is, in a word or two.
    pub fn kind(&self) -> String {
        match self {
            Self::Point(_) => "point".into(),
            Self::Directional(_) => "directional".into(),
            Self::Area(_) => "area".into(),
            Self::Environment(EnvironmentSource::Studio) => "environment (built-in studio)".into(),
            Self::Environment(EnvironmentSource::Uniform(_)) => "environment (uniform)".into(),
            Self::Environment(EnvironmentSource::File(path)) => {
                format!("environment {}", path.display())
            }
        }
    }
}

/// Distance between neighbouring centres of a row of unit spheres.
const SPACING: f64 = 2.25;

/// Half the width of a row of `count` unit spheres.
fn half_row(count: usize) -> f64 {
    count.saturating_sub(1) as f64 * SPACING * 0.5 + 1.0
}

impl SceneSpec {
    /// A row of unit spheres along x that stand on y = 0, one for each entry of `materials`, framed for a picture of
    /// `aspect` = width over height. Equal names are one material. No light and no floor yet.
    pub fn row(materials: &[String], aspect: f64) -> Self {
        let mut names: Vec<String> = Vec::new();
        let half = half_row(materials.len());
        let spheres = materials.iter().enumerate().map(|(i, name)| {
            let material = names.iter().position(|n| n == name).unwrap_or_else(|| {
                names.push(name.clone());
                names.len() - 1
            });
            let centre = DVec3::new(i as f64 * SPACING + 1.0 - half, 1.0, 0.0);
            SphereSpec {
                shape: Sphere {
                    centre,
                    radius: 1.0,
                },
                material,
            }
        });
        let spheres = spheres.collect();
        Self {
            materials: names,
            spheres,
            floor: None,
            lights: Vec::new(),
            camera: frame_row(half, aspect),
            depth: 8,
            strategy: Strategy::default(),
        }
    }

    /// A point light to the upper left in front of the row; a surface that faces it from the middle of the row gets an
    /// irradiance of 2π.
    pub fn row_point(&self) -> LightSpec {
        let position = self.row_key();
        let distance2 = position.distance_squared(DVec3::Y);
        let intensity = Rgb::splat((std::f64::consts::TAU * distance2) as f32);
        LightSpec::Point(Point {
            position,
            intensity,
        })
    }

    /// Parallel light from the upper left, in front; irradiance π.
    pub fn row_directional(&self) -> LightSpec {
        let towards = DVec3::new(-0.5, 1.0, 0.8).normalize();
        LightSpec::Directional(Directional {
            towards,
            irradiance: Rgb::splat(std::f32::consts::PI),
        })
    }

    /// A rectangle to the upper left in front of the row, about as wide as it, turned towards its middle; irradiance there
    /// is about 2π.
    pub fn row_area(&self) -> LightSpec {
        let centre = self.row_key();
        let back = (centre - DVec3::Y).normalize();
        let across = DVec3::Y.cross(back).normalize_or(DVec3::X);
        let size = 0.5 * centre.distance(DVec3::Y);
        let (edge_u, edge_v) = (across * size, back.cross(across) * -size);
        let radiance = Rgb::splat((std::f64::consts::TAU / 0.25) as f32);
        LightSpec::Area(Area {
            corner: centre - 0.5 * (edge_u + edge_v),
            edge_u,
            edge_v,
            radiance,
        })
    }

    fn row_key(&self) -> DVec3 {
        let reach = half_row(self.spheres.len()) + 2.5;
        DVec3::Y + DVec3::new(-0.45, 0.75, 0.8) * reach
    }
}

/// A view from slightly above, far enough for the row to fill the picture with a margin.
fn frame_row(half_width: f64, aspect: f64) -> Camera {
    let vertical_angle = 24f64.to_radians();
    let half = (vertical_angle * 0.5).tan();
    let (margin, target) = (1.12, DVec3::new(0.0, 0.95, 0.0));
    let distance = (margin * 1.1 / half).max(margin * half_width / (half * aspect)) + 1.0;
    let towards = DVec3::new(0.0, 0.22, 1.0).normalize();
    Camera {
        eye: target + towards * distance,
        target,
        vertical_angle,
    }
}
