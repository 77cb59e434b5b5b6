//! Mesh files: OBJ, PLY and glTF.
//!
//! A file becomes vertices and triangles. Materials, textures, colours, cameras and animations are left where they are. Files
//! come from anywhere: their size is bounded, counts are compared with it before memory is taken, and every corner and
//! number is checked.

mod gltf;
mod obj;
mod ply;

use std::path::Path;

use merlkit::files::RegularFile;
use merlkit::{Error, Result};

use crate::mesh_data::MeshData;

/// Bytes of a mesh file, at most.
const MOST_BYTES: u64 = 1 << 30;

/// Triangles of a mesh file, at most.
const MOST_FACES: usize = 1 << 26;

/// How much a mesh file may hold. What exceeds a limit is refused before memory is taken for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshLimits {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
}

impl Default for MeshLimits {
    /// Those of [`read_mesh`].
    fn default() -> Self {
        Self {
            vertices: 3 * MOST_FACES,
            faces: MOST_FACES,
        }
    }
}

/// The formats that meshes are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// PLY, as text or binary of either byte order.
    Ply,
    /// glTF 2.0, as JSON with its buffers or as one binary file.
    Gltf,
}

impl MeshFormat {
    /// The format that a file's extension names.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for another extension, or none.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "gltf" | "glb" => Ok(Self::Gltf),
            _ => Err(Error::Unsupported {
                path: path.to_owned(),
                what: format!("a mesh file with the extension \"{extension}\""),
                fix: "give .obj, .ply, .gltf or .glb".into(),
            }),
        }
    }
}

/// What is wrong with a file's content, and what to do.
#[derive(Debug)]
struct Complaint {
    what: String,
    fix: String,
}

impl Complaint {
    fn new(what: impl Into<String>, fix: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            fix: fix.into(),
        }
    }
}

/// Reads a mesh file in the format of its extension.
///
/// # Errors
/// [`Error::Io`] for a file that can't be read; [`Error::Unsupported`] for one that is too large, and for what it holds that is
/// no mesh.
pub fn read_mesh(path: &Path) -> Result<MeshData> {
    let format = MeshFormat::from_path(path)?;
    let bytes = RegularFile::open(path)?.read_all(MOST_BYTES)?;
    parse_mesh(format, &bytes, path)
}

/// Reads the content of a mesh file. Buffers of glTF are searched in the folder of `path` only.
///
/// # Errors
/// As [`read_mesh`].
pub fn parse_mesh(format: MeshFormat, bytes: &[u8], path: &Path) -> Result<MeshData> {
    parse_mesh_within(format, bytes, path, MeshLimits::default())
}

/// [`parse_mesh`] with other limits.
///
/// # Errors
/// As [`read_mesh`], and [`Error::Unsupported`] for a mesh beyond the limits.
pub fn parse_mesh_within(
    format: MeshFormat,
    bytes: &[u8],
    path: &Path,
    limits: MeshLimits,
) -> Result<MeshData> {
    let parsed = match format {
        MeshFormat::Obj => obj::parse(bytes, limits),
        MeshFormat::Ply => ply::parse(bytes, limits),
        MeshFormat::Gltf => gltf::parse(bytes, path.parent().unwrap_or(Path::new("")), limits),
    };
    let parsed = parsed.and_then(|data| {
        limits.check(data.vertices.len(), data.faces.len())?;
        Ok(data)
    });
    let data = parsed.map_err(|complaint| refuse(path, complaint))?;
    data.check().map_err(|error| match error {
        Error::Argument { what, fix } => refuse(path, Complaint { what, fix }),
        other => other,
    })?;
    if data.faces.is_empty() {
        let complaint = Complaint::new("a mesh file without a triangle", "name one with faces");
        return Err(refuse(path, complaint));
    }
    Ok(data)
}

fn refuse(path: &Path, Complaint { what, fix }: Complaint) -> Error {
    Error::Unsupported {
        path: path.to_owned(),
        what,
        fix,
    }
}

/// Adds a polygon as triangles around its first corner.
fn push_polygon(
    faces: &mut Vec<[u32; 3]>,
    corners: &[u32],
    limits: MeshLimits,
) -> std::result::Result<(), Complaint> {
    limits.check(0, faces.len() + corners.len().saturating_sub(2))?;
    for pair in corners.windows(2).skip(1) {
        faces.push([corners[0], pair[0], pair[1]]);
    }
    Ok(())
}

impl MeshLimits {
    /// Refuses more vertices or triangles than there may be.
    fn check(self, vertices: usize, faces: usize) -> std::result::Result<(), Complaint> {
        if vertices <= self.vertices && faces <= self.faces {
            return Ok(());
        }
        let what = format!(
            "a mesh of more than {} triangles or {} vertices",
            self.faces, self.vertices
        );
        Err(Complaint::new(what, "cut it into smaller ones"))
    }
}
