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
use super::selection::{has_own_normals, select};
use super::tokens::fault_in_line;
use super::tree::{Attribute, GrfBlock, LightBlock, MeshBlock};
use super::words::GrfFault;
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

/// Reads a scene. Paths in it are relative to the file that names them.
///
/// # Errors
/// [`Error::Io`] for a file that can't be read; [`Error::Argument`] with file and line for what is no scene, for files that include
/// one another, and for scenes that are too large.
pub(crate) fn read_grf(path: &Path) -> Result<SceneDescription> {
    let mut builder = Builder::default();
    builder.add_file(path, &BlockState::default())?;
    let mut scene = builder.scene;
    if !scene.is_lit() {
        // The scene is to be seen.
        scene.lights.push(LightEntry::Named("studio".into()));
    }
    Ok(scene)
}

/// What holds for the blocks of a list.
#[derive(Clone, Default)]
struct BlockState {
    to_world: DAffine3,
    looks: Looks,
}

/// Where blocks come from.
struct Source<'a> {
    name: String,
    folder: &'a Path,
}

impl Source<'_> {
    fn fault(&self, line: usize, (what, fix): GrfFault) -> Error {
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
    fn add_file(&mut self, path: &Path, state: &BlockState) -> Result<()> {
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
        self.open_files.push(whole);
        let folder = path.parent().unwrap_or(Path::new(""));
        self.add_text(&text, Source { name, folder }, state)?;
        self.open_files.pop();
        Ok(())
    }

    fn add_text(&mut self, text: &str, source: Source<'_>, state: &BlockState) -> Result<()> {
        let blocks = read_blocks(&source.name, text)?;
        self.add_blocks(blocks, &source, state.clone())
    }

    fn add_blocks(
        &mut self,
        blocks: Vec<GrfBlock>,
        source: &Source<'_>,
        mut state: BlockState,
    ) -> Result<()> {
        for block in blocks {
            match block {
                GrfBlock::Mesh(mesh) => self.add_mesh(mesh, source, &state)?,
                GrfBlock::Light(light) => self.add_light(&light, source, &state)?,
                GrfBlock::Include { file, line } => self.include(&file, line, source, &state)?,
                GrfBlock::Transform {
                    steps,
                    blocks,
                    line,
                } => {
                    let to_world = state.to_world * compose(&steps);
                    check_place(to_world).map_err(|fault| source.fault(line, fault))?;
                    let inner = BlockState {
                        to_world,
                        looks: state.looks.clone(),
                    };
                    self.add_blocks(blocks, source, inner)?;
                }
                GrfBlock::Define {
                    definitions,
                    blocks,
                    line: _,
                } => {
                    let before = self.names.open(&definitions);
                    self.add_blocks(blocks, source, state.clone())?;
                    self.names.close(before);
                }
                GrfBlock::Attribute(attribute) => {
                    self.apply(&attribute, source, &mut state.looks)?
                }
                GrfBlock::View(eye) => {
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
        state: &BlockState,
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
    fn add_mesh(&mut self, mesh: MeshBlock, source: &Source<'_>, state: &BlockState) -> Result<()> {
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
                emission: looks.emission,
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
    fn add_light(
        &mut self,
        light: &LightBlock,
        source: &Source<'_>,
        state: &BlockState,
    ) -> Result<()> {
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
fn check_place(to_world: DAffine3) -> core::result::Result<(), GrfFault> {
    let determinant = to_world.matrix3.determinant();
    if to_world.is_finite() && determinant.is_finite() && determinant != 0.0 {
        return Ok(());
    }
    Err((
        "a transformation that leaves no volume, or too large a one".into(),
        "give scales that are not 0".into(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::BuiltScene;

    /// The scene of a text, whose includes are relative to the examples.
    fn read(text: &str) -> Result<SceneDescription> {
        let mut builder = Builder::default();
        let source = Source {
            name: "a.grf".into(),
            folder: Path::new(EXAMPLES),
        };
        builder.add_text(text, source, &BlockState::default())?;
        Ok(builder.scene)
    }

    fn fault(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/thesis/grf");

    /// A triangle with everything that the grammar allows around it.
    const TRIANGLE: &str = include_str!("../../scenes/grammar.grf");

    #[test]
    fn all_of_the_grammar_is_understood() {
        let scene = read(TRIANGLE).unwrap();
        let rgb = "rgb=0.4/0.05/0.05";
        let second = "diffuse:kd=0.2,rgb=0.2/0.025/0.025";
        let sum = format!("phong:n=20,KS=0.4,kd=0.3,{rgb}+{second}");
        assert_eq!(scene.materials, [sum.as_str(), "nickel"]);
        let samplers: Vec<_> = scene.samplers.iter().map(Option::as_deref).collect();
        let lobe = "lobe:cosine-hemisphere,parameters=30/30/0.1";
        assert_eq!(samplers, [Some("adaptive-disc:tables=30"), Some(lobe)]);
        assert_eq!(scene.camera.eye, Some(DVec3::new(0.0, 1.0, 5.0)));
        assert_eq!((scene.objects.len(), scene.lights.len()), (2, 2));
        // Scaled, then turned from x to y, then moved.
        let moved = scene.objects[0].to_world.transform_point3(DVec3::X);
        assert!(
            moved.abs_diff_eq(DVec3::new(1.0, 2.0, 0.0), 1e-6),
            "{moved}"
        );
        let built: BuiltScene = scene.build().unwrap();
        assert_eq!(built.triangles, 2);
        // The second face emits.
        let emission = Rgb::from_array([1.0, 2.0, 0.5]);
        let found: Vec<_> = scene.objects.iter().map(|o| o.emission).collect();
        assert_eq!(found, [None, Some(emission)]);
        assert_eq!(built.spec.lights.len(), 3);
    }

    #[test]
    fn the_examples_of_the_thesis_are_read() {
        let read_file = |name: &str| read_grf(&Path::new(EXAMPLES).join(name)).unwrap();
        let box_scene = read_file("box.grf");
        let expected = "ward:sx=0.05,sy=0.3,ks=0.05,kd=0.4,rgb=0.3/0.8/1";
        assert_eq!(box_scene.materials, [expected]);
        let built = box_scene.build().unwrap();
        assert_eq!((built.triangles, built.dropped), (12, 0));
        // The normals of the corners are not those of four of the sides.
        let ShapeEntry::Mesh { surface, .. } = &box_scene.objects[0].shape else {
            panic!("a mesh");
        };
        assert_eq!(surface.shading, Shading::Flat);
        let dragon = read_file("dragon.grf");
        // Two lamps that shine to both sides; wall, floor and dragon.
        assert_eq!((dragon.lights.len(), dragon.objects.len()), (4, 3));
        let ShapeEntry::Mesh { surface, data } = &dragon.objects[2].shape else {
            panic!("a mesh");
        };
        assert_eq!(
            (surface.shading, data.vertices.len()),
            (Shading::Smooth, 362)
        );
        assert!(dragon.build().is_ok());
    }

    #[test]
    fn faults_name_the_line_and_what_to_do() {
        for (from, to, expected) in [
            ("3 0 1 2", "3 0 1 3", "line 16: 3 is none of the 3 vertices"),
            (
                "use brdf both",
                "use brdf bath",
                "no BRDF is called bath here; the names here are a, b",
            ),
            ("KS=0.4", "KS=-1", "line 10"),
            ("use color red", "use color a", "no colour is called a"),
            (
                "scale (2,2,2)",
                "scale (2,0,2)",
                "line 9: a transformation that leaves no volume",
            ),
            ("nQT=30", "trees=30", "adaptive has no parameter trees"),
            (
                "(0,0,1) rgb",
                "(2,0,0) rgb",
                "line 3: a light without a finite place, area",
            ),
            ("nickel.binary", "nickle.binary", "there is no file"),
            (
                "(1,0,0)\n      normal (0,0,1) (0",
                "(1,0)\n (0",
                "line 13: expected ,, found )",
            ),
            (
                "end mesh\n  end\nend\n",
                "end mesh\n  end\n",
                "expected end, found the end of the file",
            ),
            ("params", "parems", "line 2: expected begin mesh, light"),
            (
                "irad (1,1,1) uv",
                "emission (1,1,1) uv",
                "expected a vertex",
            ),
            (
                "use color red",
                "emission (1,-1,1)",
                "an emission of [1, -1, 1]",
            ),
        ] {
            assert!(TRIANGLE.contains(from), "{from}");
            let error = fault(&TRIANGLE.replacen(from, to, 1));
            assert!(error.contains(expected), "{to}: {error}");
        }
        let deep = "def a = rgb (1,1,1) begin ".repeat(100_000);
        assert!(fault(&deep).contains("more than 64 deep"));
        let many = "light begin (0,0,0) (1,0,0) (0,1,0) end ".repeat(MOST_OBJECTS);
        assert!(fault(&many).contains("20000 objects"));
    }

    #[test]
    fn files_that_include_themselves_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::write(file("a.grf"), "include \"b.grf\"").unwrap();
        std::fs::write(file("b.grf"), "include \"./a.grf\"").unwrap();
        let error = read_grf(&file("a.grf")).unwrap_err().to_string();
        assert!(error.contains("includes itself"), "{error}");
        // Sixteen levels that double: more files than anybody means.
        for i in 0..16 {
            let next = format!("include \"c{}.grf\" ", i + 1);
            std::fs::write(file(&format!("c{i}.grf")), next.repeat(2)).unwrap();
        }
        std::fs::write(file("c16.grf"), "").unwrap();
        let error = read_grf(&file("c0.grf")).unwrap_err().to_string();
        assert!(error.contains("4096 included files"), "{error}");
    }
}
