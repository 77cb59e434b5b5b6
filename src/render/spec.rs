//! What a picture shows, before anything is loaded.

use std::sync::Arc;

use glam::DVec3;

use super::camera::Camera;
use super::shape::{Floor, Shape, Sphere};
use crate::Result;
use crate::distribution::Heuristic;
use crate::light::{LightSpec, Placement};

/// A scene described: names and numbers only.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug)]
pub struct SceneSpec {
    /// Names of materials that objects may use.
    pub materials: Vec<String>,
    /// Positions of those that reflect the mirror direction as well, as [`crate::material::MaterialFacts::has_mirror`].
    pub mirrors: Vec<usize>,
    /// The spheres.
    pub spheres: Vec<SphereSpec>,
    /// Objects of other shapes.
    pub objects: Vec<ObjectSpec>,
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
    /// Directions that the BRDF's sampler draws at each vertex together, from 1 to [`Self::MOST_DIRECTIONS`], where directions find
    /// lights ([`Strategy::Mis`] and [`Strategy::Brdf`]). All look for lights, and the path goes on along one of them.
    pub directions: u32,
    /// Angle by which all lights but those of objects are turned about the axis x = z = 0, radians, counter-clockwise as seen from
    /// above.
    pub light_turn: f64,
    /// Whether the picture leaves out what is seen past the objects and says how much of each pixel they cover
    /// ([`crate::image::Image::alpha`]).
    pub transparent: bool,
    /// The most that a path may carry in a channel: one that carries more is scaled down to it, which makes the picture darker.
    /// `None`: no limit.
    pub clamp: Option<f64>,
}

/// A sphere and its material.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereSpec {
    /// Its shape.
    pub shape: Sphere,
    /// Position in [`SceneSpec::materials`].
    pub material: usize,
}

/// An object of any shape and its material.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug)]
pub struct ObjectSpec {
    /// Its shape.
    pub shape: Arc<dyn Shape>,
    /// Position in [`SceneSpec::materials`].
    pub material: usize,
}

/// How light from lights with an extent is found.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
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

/// Distance between neighbouring centres of a row of unit spheres.
const SPACING: f64 = 2.25;

/// Half the width of a row of `count` unit spheres.
fn half_row(count: usize) -> f64 {
    count.saturating_sub(1) as f64 * SPACING * 0.5 + 1.0
}

impl SceneSpec {
    /// The most of [`Self::directions`].
    pub const MOST_DIRECTIONS: u32 = 1 << 16;

    /// A row of unit spheres along x that rest on y = 0, one for each entry of `materials`, framed for a picture of
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
            mirrors: Vec::new(),
            spheres,
            objects: Vec::new(),
            floor: None,
            lights: Vec::new(),
            camera: frame_row(half, aspect),
            depth: 8,
            strategy: Strategy::default(),
            directions: 1,
            light_turn: 0.0,
            transparent: false,
            clamp: None,
        }
    }

    /// The light that a word names, see [`LightSpec::from_name`], placed to light the row.
    ///
    /// # Errors
    /// As [`LightSpec::from_name`].
    pub fn light(&self, name: &str) -> Result<LightSpec> {
        LightSpec::from_name(name, &self.placement())
    }

    /// The middle of the row, and a place to the upper left in front of it, the farther away the wider the row is.
    pub fn placement(&self) -> Placement {
        let reach = half_row(self.spheres.len()) + 2.5;
        Placement {
            subject: DVec3::Y,
            key: DVec3::Y + DVec3::new(-0.45, 0.75, 0.8) * reach,
        }
    }

    /// The shapes of all objects, in the order in which the scene holds them.
    pub(super) fn shapes(&self) -> Vec<&dyn Shape> {
        let mut shapes: Vec<&dyn Shape> = Vec::new();
        for sphere in &self.spheres {
            shapes.push(&sphere.shape);
        }
        for object in &self.objects {
            shapes.push(&*object.shape);
        }
        if self.floor.is_some() {
            shapes.push(&Floor);
        }
        shapes
    }

    /// Whether an object is made of a material.
    pub(super) fn uses_material(&self, material: usize) -> bool {
        self.spheres.iter().any(|s| s.material == material)
            || self.objects.iter().any(|o| o.material == material)
    }
}

/// A view from slightly above, far enough for the row to fill the picture with a margin.
fn frame_row(half_width: f64, aspect: f64) -> Camera {
    let vertical_angle = 24f64.to_radians();
    let half = (vertical_angle * 0.5).tan();
    let (margin, target) = (1.12, DVec3::new(0.0, 0.95, 0.0));
    // At the distance d the picture is 2·d·tan(angle/2) high. The spheres' height or the row's width decides, as
    // one of them needs more distance. The 1 in the end is the radius, by which spheres are nearer than their centres.
    let distance = (margin * 1.1 / half).max(margin * half_width / (half * aspect)) + 1.0;
    let towards = DVec3::new(0.0, 0.22, 1.0).normalize();
    Camera {
        eye: target + towards * distance,
        target,
        vertical_angle,
    }
}
