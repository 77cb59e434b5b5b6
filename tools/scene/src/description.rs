//! A scene as it is described: names, numbers and shapes, before materials and lights are loaded.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use merlkit::color::Rgb;
use merlkit::light::{LightSpec, Placement};
use merlkit::render::{Camera, ObjectSpec, SceneSpec, Shape, Sphere, SphereSpec};
use merlkit::{Error, Result};

use crate::background::Background;
use crate::formats::read_mesh;
use crate::instance::Instance;
use crate::luminous::MeshLight;
use crate::mesh::{Shading, Sides, TriangleMesh};
use crate::mesh_data::MeshData;
use crate::quad::Quad;
use crate::{displace_sphere, revolve};

/// A scene as a file describes it. Any format can be turned into it.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// Materials as the command takes them: names, formulas and files. Objects name them by position.
    pub materials: Vec<String>,
    /// Samplers as `--sampler` takes them, by position as the materials; `None`, or none at all, where the scene leaves them open.
    pub samplers: Vec<Option<String>>,
    /// The objects.
    pub objects: Vec<ObjectEntry>,
    /// The lights, in the scene's space.
    pub lights: Vec<LightEntry>,
    /// The view; without one the camera frames all objects.
    pub camera: CameraEntry,
    /// Width and height of the picture, if the scene says so.
    pub size: Option<[usize; 2]>,
    /// Paths per pixel, if the scene says so.
    pub spp: Option<u64>,
    /// The most surfaces on a path, if the scene says so.
    pub bounces: Option<u32>,
    /// What is seen past the objects, if the scene says so.
    pub background: Option<Background>,
}

/// An object: a shape, where it is, and its material.
#[derive(Clone, Debug)]
pub struct ObjectEntry {
    /// What it is called in errors.
    pub name: String,
    /// Its shape, in a space of its own.
    pub shape: ShapeEntry,
    /// Takes that space to the scene's.
    pub to_world: DAffine3,
    /// Position in [`SceneDescription::materials`].
    pub material: usize,
    /// Radiance of every point of its surface, in all directions from which it is seen. `None`, and 0, for an object that emits
    /// nothing.
    pub emission: Option<Rgb>,
}

/// The shape of an object.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeEntry {
    /// A sphere.
    Sphere {
        /// Centre.
        centre: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// A parallelogram.
    Quad {
        /// A corner.
        corner: DVec3,
        /// The edges that begin there.
        edges: [DVec3; 2],
    },
    /// A profile of radii and heights, turned about the y axis.
    Revolution {
        /// The profile, from below.
        profile: Vec<DVec2>,
        /// Steps of a whole turn.
        segments: usize,
        /// How it reflects.
        surface: SurfaceEntry,
    },
    /// A sphere with bumps, see [`displace_sphere`].
    DisplacedSphere {
        /// Radius, > 0.
        radius: f64,
        /// Height of the bumps, in radii, in [0, 1).
        amplitude: f64,
        /// Steps along an edge of the octahedron: there are 8·steps² triangles.
        steps: u32,
        /// Which bumps.
        seed: u64,
        /// How it reflects.
        surface: SurfaceEntry,
    },
    /// A mesh file.
    File {
        /// OBJ, PLY or glTF.
        path: PathBuf,
        /// How it reflects.
        surface: SurfaceEntry,
    },
    /// Vertices and faces.
    Mesh {
        /// The mesh.
        data: Arc<MeshData>,
        /// How it reflects.
        surface: SurfaceEntry,
    },
}

/// From where a mesh is seen, and by which normals it reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceEntry {
    /// From where it is seen.
    pub sides: Sides,
    /// Which normals reflect.
    pub shading: Shading,
}

/// A light, by numbers or by a word.
#[derive(Clone, Debug, PartialEq)]
pub enum LightEntry {
    /// With its place in the scene.
    Placed(LightSpec),
    /// By a word of `--light`; where it says no place, it is put before the objects.
    Named(String),
}

/// Where the eye is, as far as it is said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraEntry {
    /// The eye.
    pub eye: Option<DVec3>,
    /// The point in the middle of the picture.
    pub look_at: Option<DVec3>,
    /// Angle between the picture's lower and upper edges, degrees.
    pub fov: Option<f64>,
}

/// The angle of a picture, degrees, where nothing is said.
const FOV: f64 = 40.0;

/// What was built of a description.
#[derive(Debug)]
pub struct BuiltScene {
    /// The scene; its materials are not loaded yet, and which of them are mirrors is not known.
    pub spec: SceneSpec,
    /// Triangles of all meshes, each mesh counted once.
    pub triangles: usize,
    /// Triangles of no area that were dropped.
    pub dropped: usize,
}

impl SceneDescription {
    /// Whether it has a light or an object that emits.
    pub fn is_lit(&self) -> bool {
        let mut emission = self.objects.iter().filter_map(|object| object.emission);
        !self.lights.is_empty() || emission.any(|radiance| radiance != Rgb::ZERO)
    }

    /// Takes away all lights, and the emission of all objects.
    pub fn darken(&mut self) {
        self.lights.clear();
        for object in &mut self.objects {
            object.emission = None;
        }
    }

    /// Reads the mesh files, builds the shapes and places the lights. Equal shapes are one in memory.
    ///
    /// # Errors
    /// Those of [`read_mesh`], [`TriangleMesh::build`] and the shapes; [`Error::Argument`] for an object without a material, a
    /// scene without an object, a sphere that emits light, emission that is negative or not finite, lights that nothing is called
    /// by, and a camera that looks at its own eye.
    pub fn build(&self) -> Result<BuiltScene> {
        let mut built = BuiltScene {
            spec: SceneSpec::row(&[], 1.0),
            triangles: 0,
            dropped: 0,
        };
        built.spec.materials.clone_from(&self.materials);
        let mut known: Vec<(&ShapeEntry, Arc<dyn Shape>)> = Vec::new();
        for object in &self.objects {
            if object.material >= self.materials.len() {
                let what = format!("{} has no material", object.name);
                return Err(Error::argument(what, "name one of the scene's"));
            }
            add_object(object, &mut known, &mut built).map_err(|e| name_object(object, e))?;
            let light = build_emission(object).map_err(|e| name_object(object, e))?;
            built.spec.lights.extend(light);
        }
        let bounds = find_bounds(&built.spec)?;
        built.spec.camera = self.camera.aim(bounds)?;
        let placement = place_lights(bounds);
        for light in &self.lights {
            built.spec.lights.push(match light {
                LightEntry::Placed(light) => light.clone(),
                LightEntry::Named(word) => LightSpec::from_name(word, &placement)?,
            });
        }
        Ok(built)
    }
}

/// Says of which object an error is.
fn name_object(object: &ObjectEntry, error: Error) -> Error {
    match error {
        Error::Argument { what, fix } => Error::argument(format!("{}: {what}", object.name), fix),
        other => other,
    }
}

fn add_object<'a>(
    object: &'a ObjectEntry,
    known: &mut Vec<(&'a ShapeEntry, Arc<dyn Shape>)>,
    built: &mut BuiltScene,
) -> Result<()> {
    let is_placed = object.to_world != DAffine3::IDENTITY;
    // The renderer has a faster way for spheres that are spheres.
    if let ShapeEntry::Sphere { centre, radius } = object.shape {
        let shape = Sphere { centre, radius };
        if !(centre.is_finite() && radius > 0.0 && radius.is_finite()) {
            let what = "a sphere without a finite centre or a radius";
            return Err(Error::argument(what, "give a centre and a radius > 0"));
        }
        if !is_placed {
            built.spec.spheres.push(SphereSpec {
                shape,
                material: object.material,
            });
            return Ok(());
        }
    }
    let same = known.iter().find(|(entry, _)| **entry == object.shape);
    let shape = match same {
        Some((_, shape)) => shape.clone(),
        None => {
            let shape = build_shape(&object.shape, built)?;
            known.push((&object.shape, shape.clone()));
            shape
        }
    };
    built.spec.objects.push(ObjectSpec {
        shape: match is_placed {
            true => Arc::new(Instance::new(shape, object.to_world)?),
            false => shape,
        },
        material: object.material,
    });
    Ok(())
}

fn build_shape(entry: &ShapeEntry, built: &mut BuiltScene) -> Result<Arc<dyn Shape>> {
    match entry {
        ShapeEntry::Sphere { centre, radius } => {
            return Ok(Arc::new(Sphere {
                centre: *centre,
                radius: *radius,
            }));
        }
        ShapeEntry::Quad { corner, edges } => {
            return Ok(Arc::new(Quad::new(*corner, edges[0], edges[1])?));
        }
        _ => {}
    }
    let (data, surface) = build_triangles(entry)?;
    let mesh = TriangleMesh::build(&data, surface.sides, surface.shading)?;
    built.triangles += mesh.face_count();
    built.dropped += mesh.dropped_faces();
    Ok(Arc::new(mesh))
}

/// The triangles of a shape, in its own space.
fn build_triangles(entry: &ShapeEntry) -> Result<(MeshData, SurfaceEntry)> {
    Ok(match entry {
        ShapeEntry::Sphere { .. } => {
            return Err(Error::argument(
                "a sphere has no triangles that emit light",
                "take a displaced-sphere of the amplitude 0",
            ));
        }
        ShapeEntry::Quad { corner, edges } => {
            let across = *corner + edges[0];
            let data = MeshData {
                vertices: vec![*corner, across, across + edges[1], *corner + edges[1]],
                normals: Vec::new(),
                faces: vec![[0, 1, 2], [0, 2, 3]],
            };
            (data, SurfaceEntry::default())
        }
        ShapeEntry::Revolution {
            profile,
            segments,
            surface,
        } => (revolve(profile, *segments)?, *surface),
        ShapeEntry::DisplacedSphere {
            radius,
            amplitude,
            steps,
            seed,
            surface,
        } => (
            displace_sphere(*radius, *amplitude, *steps, *seed)?,
            *surface,
        ),
        ShapeEntry::File { path, surface } => (read_mesh(path)?, *surface),
        ShapeEntry::Mesh { data, surface } => (data.as_ref().clone(), *surface),
    })
}

/// The light of an object that emits.
fn build_emission(object: &ObjectEntry) -> Result<Option<LightSpec>> {
    let Some(radiance) = object.emission.filter(|radiance| *radiance != Rgb::ZERO) else {
        return Ok(None);
    };
    let (mut data, surface) = build_triangles(&object.shape)?;
    for vertex in &mut data.vertices {
        *vertex = object.to_world.transform_point3(*vertex);
    }
    // A map that mirrors turns the order of corners around, and with it the side that a triangle is seen from.
    if object.to_world.matrix3.determinant() < 0.0 {
        for face in &mut data.faces {
            face.swap(1, 2);
        }
    }
    data.normals.clear();
    let light = MeshLight::build(&data, surface.sides, radiance)?;
    Ok(Some(LightSpec::Object(Arc::new(light))))
}

/// The box of all objects.
fn find_bounds(spec: &SceneSpec) -> Result<[DVec3; 2]> {
    let mut shapes: Vec<&dyn Shape> = Vec::new();
    for sphere in &spec.spheres {
        shapes.push(&sphere.shape);
    }
    for object in &spec.objects {
        shapes.push(&*object.shape);
    }
    if shapes.is_empty() {
        return Err(Error::argument(
            "a scene without an object",
            "add an [[object]]",
        ));
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for shape in shapes {
        low = low.min(DVec3::from_array(
            DVec3::AXES.map(|axis| -shape.support(-axis)),
        ));
        high = high.max(DVec3::from_array(
            DVec3::AXES.map(|axis| shape.support(axis)),
        ));
    }
    Ok([low, high])
}

/// As a photographer would: the key light is above the objects, to the left and in front.
fn place_lights([low, high]: [DVec3; 2]) -> Placement {
    let subject = 0.5 * (low + high);
    let reach = 0.5 * (high - low).length();
    Placement {
        subject,
        key: subject + DVec3::new(-0.45, 0.75, 0.8) * (2.0 * reach),
    }
}

impl CameraEntry {
    /// The camera; what is not said follows from the box of all objects.
    ///
    /// # Errors
    /// [`Error::Argument`] for an eye that looks at itself, numbers that are not finite, and an angle that is not in (0, 180).
    pub fn aim(&self, [low, high]: [DVec3; 2]) -> Result<Camera> {
        let angle = self.fov.unwrap_or(FOV);
        if !(angle > 0.0 && angle < 180.0) {
            return Err(Error::argument(
                format!("a field of view of {angle}°"),
                "give degrees above 0 and below 180",
            ));
        }
        let vertical_angle = angle.to_radians();
        let target = self.look_at.unwrap_or(0.5 * (low + high));
        let radius = 0.5 * (high - low).length();
        // A sphere around all objects fills the picture's height but for a tenth.
        let distance = 1.1 * radius / (0.5 * vertical_angle).sin();
        let towards = DVec3::new(0.0, 0.22, 1.0).normalize();
        let eye = self.eye.unwrap_or(target + distance * towards);
        if !(eye.is_finite() && target.is_finite()) || eye == target {
            return Err(Error::argument(
                format!("a camera at {eye} that looks at {target}"),
                "give two different points",
            ));
        }
        Ok(Camera {
            eye,
            target,
            vertical_angle,
        })
    }
}
