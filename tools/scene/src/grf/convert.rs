//! From the blocks of a GRF file to a scene: files are included, names looked up, and meshes put in their places.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use merlkit::color::Rgb;
use merlkit::files::RegularFile;
use merlkit::light::{Area, LightSpec};
use merlkit::{Error, Result};

use super::blocks::read_blocks;
use super::scope::{Looks, Names, compose};
use super::tokens::fault_in_line;
use super::tree::{Attribute, Block, LightBlock, MeshBlock};
use super::words::Fault;
use crate::description::{LightEntry, ObjectEntry, SceneDescription, ShapeEntry, SurfaceEntry};
use crate::mesh::{Shading, Sides};
use crate::mesh_data::MeshData;

/// Bytes of all files of a scene.
const MOST_BYTES: u64 = 1 << 29;
/// How often files are included, and how deep in one another.
const MOST_INCLUDES: usize = 4096;
const MOST_DEEP: usize = 32;
/// Objects and lights.
const MOST_OBJECTS: usize = 20_000;
/// Triangles of all objects.
const MOST_TRIANGLES: usize = 50_000_000;
/// Cosine of the largest angle between the normal of a face and those of its vertices that are believed.
const LEAST_COSINE: f64 = 0.2;

/// Reads a scene. Paths in it are relative to the file that names them.
///
/// # Errors
/// [`Error::Io`] for a file that can't be read; [`Error::Argument`] with file and line for what is no scene, for files that include
/// one another, and for scenes that are too large.
pub(crate) fn read_grf(path: &Path) -> Result<SceneDescription> {
    let mut builder = Builder::default();
    builder.add_file(path, &State::default())?;
    let mut scene = builder.scene;
    if scene.lights.is_empty() {
        // The scene is to be seen.
        scene.lights.push(LightEntry::Named("studio".into()));
    }
    Ok(scene)
}

/// What holds for the blocks of a list.
#[derive(Clone, Default)]
struct State {
    to_world: DAffine3,
    looks: Looks,
}

/// Where blocks come from.
struct Source<'a> {
    name: String,
    folder: &'a Path,
}

impl Source<'_> {
    fn fault(&self, line: usize, (what, fix): Fault) -> Error {
        fault_in_line(&self.name, line, &what, &fix)
    }
}

/// A scene as far as it was read.
#[derive(Default)]
struct Builder {
    scene: SceneDescription,
    names: Names,
    /// Positions of materials by their texts and those of their samplers.
    materials: HashMap<(String, Option<String>), usize>,
    /// The files that are being read, the outermost first.
    open_files: Vec<PathBuf>,
    bytes: u64,
    includes: usize,
    triangles: usize,
}

impl Builder {
    fn add_file(&mut self, path: &Path, state: &State) -> Result<()> {
        let file = RegularFile::open(path)?;
        let whole = path
            .canonicalize()
            .map_err(|e| Error::io(path, "open", e))?;
        if self.open_files.contains(&whole) {
            return Err(Error::argument(
                format!("{} includes itself", path.display()),
                "remove one of the include lines",
            ));
        }
        let bytes = file.read_all(MOST_BYTES - self.bytes)?;
        self.bytes += bytes.len() as u64;
        let name = path.display().to_string();
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            Error::argument(
                format!("{name}: text that is no UTF-8 from byte {valid} on"),
                "save it as UTF-8",
            )
        })?;
        let blocks = read_blocks(&name, &text)?;
        drop(text);
        let source = Source {
            name,
            folder: path.parent().unwrap_or(Path::new("")),
        };
        self.open_files.push(whole);
        self.add_blocks(blocks, &source, state.clone())?;
        self.open_files.pop();
        Ok(())
    }

    fn add_blocks(
        &mut self,
        blocks: Vec<Block>,
        source: &Source<'_>,
        mut state: State,
    ) -> Result<()> {
        for block in blocks {
            match block {
                Block::Mesh(mesh) => self.add_mesh(mesh, source, &state)?,
                Block::Light(light) => self.add_light(&light, source, &state)?,
                Block::Include { file, line } => self.include(&file, line, source, &state)?,
                Block::Transform {
                    steps,
                    blocks,
                    line,
                } => {
                    let to_world = state.to_world * compose(&steps);
                    check_place(to_world).map_err(|fault| source.fault(line, fault))?;
                    let inner = State {
                        to_world,
                        looks: state.looks.clone(),
                    };
                    self.add_blocks(blocks, source, inner)?;
                }
                Block::Define {
                    definitions,
                    blocks,
                    line: _,
                } => {
                    let before = self.names.open(&definitions);
                    self.add_blocks(blocks, source, state.clone())?;
                    self.names.close(before);
                }
                Block::Attribute(attribute) => self.apply(&attribute, source, &mut state.looks)?,
                Block::View(eye) => {
                    let eye = state.to_world.transform_point3(eye);
                    self.scene.camera.eye = Some(eye);
                }
            }
        }
        Ok(())
    }

    fn include(
        &mut self,
        file: &str,
        line: usize,
        source: &Source<'_>,
        state: &State,
    ) -> Result<()> {
        self.includes += 1;
        if self.includes > MOST_INCLUDES || self.open_files.len() >= MOST_DEEP {
            let what = format!(
                "more than {MOST_INCLUDES} included files, or more than {MOST_DEEP} in one another"
            );
            return Err(source.fault(line, (what, "include fewer files".into())));
        }
        let path = source.folder.join(file);
        if !path.is_file() {
            let what = format!("there is no file {}", path.display());
            let fix = "put it there: paths are relative to the file that includes them".into();
            return Err(source.fault(line, (what, fix)));
        }
        self.add_file(&path, state)
    }

    fn apply(&self, attribute: &Attribute, source: &Source<'_>, looks: &mut Looks) -> Result<()> {
        let applied = self.names.apply(attribute, looks);
        applied.map_err(|fault| source.fault(attribute.line, fault))
    }

    /// Adds an object for each part of a mesh that looks alike.
    fn add_mesh(&mut self, mesh: MeshBlock, source: &Source<'_>, state: &State) -> Result<()> {
        let mut looks = state.looks.clone();
        let mut line = mesh.line;
        for attribute in &mesh.attributes {
            self.apply(attribute, source, &mut looks)?;
            line = attribute.line;
        }
        let is_whole = mesh.groups.len() == 1;
        let mut mesh = mesh;
        for group in std::mem::take(&mut mesh.groups) {
            for attribute in &group.attributes {
                self.apply(attribute, source, &mut looks)?;
                line = attribute.line;
            }
            if group.faces.is_empty() {
                continue;
            }
            self.count(group.faces.len(), mesh.line, source)?;
            let material = self.find_material(&looks, source, line)?;
            let data = match is_whole {
                true => MeshData {
                    vertices: std::mem::take(&mut mesh.vertices),
                    normals: std::mem::take(&mut mesh.normals),
                    faces: group.faces,
                },
                false => select(&mesh, &group.faces),
            };
            let shading = match has_own_normals(&data) {
                true => Shading::Smooth,
                false => Shading::Flat,
            };
            self.scene.objects.push(ObjectEntry {
                name: format!("{}, line {}: the mesh", source.name, mesh.line),
                shape: ShapeEntry::Mesh {
                    data: Arc::new(data),
                    surface: SurfaceEntry {
                        sides: Sides::Both,
                        shading,
                    },
                },
                to_world: state.to_world,
                material,
            });
        }
        Ok(())
    }

    /// Counts an object, and refuses too many.
    fn count(&mut self, faces: usize, line: usize, source: &Source<'_>) -> Result<()> {
        self.triangles += faces;
        let objects = self.scene.objects.len() + self.scene.lights.len();
        if self.triangles > MOST_TRIANGLES || objects >= MOST_OBJECTS {
            let what = format!(
                "a scene of more than {MOST_TRIANGLES} triangles, or {MOST_OBJECTS} objects and lights"
            );
            return Err(source.fault(line, (what, "divide it".into())));
        }
        Ok(())
    }

    /// The position of a material, which is added if it is new.
    fn find_material(&mut self, looks: &Looks, source: &Source<'_>, line: usize) -> Result<usize> {
        let text = self.names.material_text(looks, source.folder);
        let text = text.map_err(|fault| source.fault(line, fault))?;
        let sampler = self.names.sampler_text(looks);
        let sampler = sampler.map_err(|fault| source.fault(line, fault))?;
        let next = self.scene.materials.len();
        let key = (text, sampler);
        if let Some(known) = self.materials.get(&key) {
            return Ok(*known);
        }
        self.scene.materials.push(key.0.clone());
        self.scene.samplers.push(key.1.clone());
        self.materials.insert(key, next);
        Ok(next)
    }

    /// Adds a light that shines to both sides: the thesis does not say to which one.
    fn add_light(&mut self, light: &LightBlock, source: &Source<'_>, state: &State) -> Result<()> {
        self.count(0, light.line, source)?;
        if light.rgb.min_element() < 0.0 {
            let what = format!("a light of the colour {}", light.rgb);
            return Err(source.fault(light.line, (what, "give channels ≥ 0".into())));
        }
        let corner = state.to_world.transform_point3(light.corner);
        let [edge_u, edge_v] = light.edges.map(|e| state.to_world.transform_vector3(e));
        let radiance = light.rgb.as_vec3();
        let normal = edge_u.cross(edge_v);
        let is_usable = normal.is_finite()
            && normal != DVec3::ZERO
            && corner.is_finite()
            && radiance.is_finite();
        if !is_usable {
            let what = "a light without a finite place, area and colour".to_owned();
            return Err(source.fault(
                light.line,
                (what, "give two edges that span an area".into()),
            ));
        }
        for (edge_u, edge_v) in [(edge_u, edge_v), (edge_v, edge_u)] {
            let area = Area {
                corner,
                edge_u,
                edge_v,
                radiance: Rgb::from_array(radiance.to_array()),
            };
            self.scene
                .lights
                .push(LightEntry::Placed(LightSpec::Area(area)));
        }
        Ok(())
    }
}

/// Refuses a transformation after which nothing is left, or that leads beyond all numbers.
fn check_place(to_world: DAffine3) -> core::result::Result<(), Fault> {
    let determinant = to_world.matrix3.determinant();
    if to_world.is_finite() && determinant.is_finite() && determinant != 0.0 {
        return Ok(());
    }
    Err((
        "a transformation that leaves no volume, or too large a one".into(),
        "give scales that are not 0".into(),
    ))
}

/// The vertices of some faces, in the order of their first use.
fn select(mesh: &MeshBlock, faces: &[[u32; 3]]) -> MeshData {
    let mut positions: HashMap<u32, u32> = HashMap::new();
    let mut data = MeshData::default();
    for face in faces {
        let mut corners = [0; 3];
        for (corner, old) in corners.iter_mut().zip(face) {
            let next = data.vertices.len() as u32;
            *corner = *positions.entry(*old).or_insert(next);
            if *corner == next {
                data.vertices.push(mesh.vertices[*old as usize]);
                if let Some(normal) = mesh.normals.get(*old as usize) {
                    data.normals.push(*normal);
                }
            }
        }
        data.faces.push(corners);
    }
    data
}

/// Whether every vertex has a normal that is one of its faces', too, as far as a smooth surface allows it. In the first example of the
/// thesis, a box, the normals of its corners lie within its sides.
fn has_own_normals(data: &MeshData) -> bool {
    if data.normals.len() != data.vertices.len() || data.normals.is_empty() {
        return false;
    }
    for face in &data.faces {
        let [a, b, c] = face.map(|corner| data.vertices[corner as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else {
            continue;
        };
        for corner in face {
            let given = data.normals[*corner as usize].normalize_or_zero();
            // NaN fails the comparison, too.
            let agrees = given.dot(normal).abs() >= LEAST_COSINE;
            if !agrees {
                return false;
            }
        }
    }
    true
}
