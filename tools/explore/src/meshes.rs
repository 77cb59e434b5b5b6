//! Meshes that take the place of the sphere.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use merlkit::Error;
use merlkit::files::RegularFile;
use merlkit_scene::{CameraEntry, MeshData, MeshFormat, MeshLimits, parse_mesh_within};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::answer::{Answer, ArrayAnswer};
use crate::query::Query;
use crate::refusal::Refusal;
use crate::session::Session;
use crate::upload::{LARGEST_UPLOAD, display_name};

/// What a page draws in one frame, and keeps in its memory.
const LIMITS: MeshLimits = MeshLimits {
    vertices: 1_500_000,
    faces: 1_000_000,
};
/// More meshes are not kept.
const MOST_MESHES: usize = 16;
/// Bytes of the answers of all meshes together.
const MOST_BYTES: usize = 256 << 20;

/// A mesh that can be asked for.
struct KnownMesh {
    /// For people; no two meshes have the same.
    name: String,
    /// What a scene file calls it; `None` for what a request brought, which has no path.
    text: Option<String>,
    faces: usize,
    /// Triangles of no area, which were left out.
    dropped: usize,
    answer: Answer,
}

/// All meshes, in the order of their numbers.
#[derive(Default)]
pub(crate) struct Meshes(Mutex<Vec<Arc<KnownMesh>>>);

impl Meshes {
    /// The entries of the list of meshes.
    pub fn describe(&self) -> Vec<Value> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter()
            .enumerate()
            .map(|(id, mesh)| describe(id, mesh))
            .collect()
    }

    /// Keeps a mesh and describes it.
    fn add(&self, name: &str, text: Option<String>, data: &MeshData) -> Result<Value, Refusal> {
        let prepared = prepare(data)?;
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes: usize = all.iter().map(|mesh| mesh.answer.bytes.len()).sum();
        let is_full = bytes + prepared.answer.bytes.len() > MOST_BYTES;
        if all.len() >= MOST_MESHES || is_full {
            let message = format!(
                "there are {} meshes of {bytes} bytes already; start again",
                all.len()
            );
            return Err(Refusal::new(503, message));
        }
        // "sphere" is what the page calls the shape that is no mesh.
        let mut unique = name.to_owned();
        let mut number = 2;
        while unique == "sphere" || all.iter().any(|mesh| mesh.name == unique) {
            unique = format!("{name}-{number}");
            number += 1;
        }
        let mesh = KnownMesh {
            name: unique,
            text,
            faces: prepared.faces,
            dropped: prepared.dropped,
            answer: prepared.answer,
        };
        let entry = describe(all.len(), &mesh);
        all.push(Arc::new(mesh));
        Ok(entry)
    }

    /// The answer with the arrays of a mesh.
    fn find(&self, id: usize) -> Result<Answer, Refusal> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = all.get(id).map(|mesh| mesh.answer.clone());
        found.ok_or_else(|| Refusal::missing(format!("there is no mesh {id}")))
    }
}

fn describe(id: usize, mesh: &KnownMesh) -> Value {
    json!({
        "id": id,
        "name": mesh.name,
        "faces": mesh.faces,
        "dropped": mesh.dropped,
        "text": mesh.text,
    })
}

/// A mesh as the page takes it.
struct PreparedMesh {
    faces: usize,
    dropped: usize,
    answer: Answer,
}

/// The vertices about the middle of the mesh's box, in halves of the box's diagonal, and the camera that frames them as a scene file without
/// one does.
fn prepare(data: &MeshData) -> Result<PreparedMesh, Refusal> {
    let faces = data.faces_with_area();
    let corners = faces.iter().flat_map(|face| data.corners(*face));
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in corners {
        (low, high) = (low.min(corner), high.max(corner));
    }
    let radius = 0.5 * (high - low).length();
    if faces.is_empty() || !(radius > 0.0 && radius.is_finite()) {
        return Err(Refusal::bad("no triangle of the mesh has an area"));
    }
    let camera = CameraEntry::default().aim([low, high])?;
    let eye = (camera.eye - camera.target) / radius;
    let mut positions = Vec::with_capacity(3 * data.vertices.len());
    for vertex in &data.vertices {
        let place = (*vertex - camera.target) / radius;
        positions.extend(place.as_vec3().to_array());
    }
    let mut normals = Vec::with_capacity(3 * data.vertices.len());
    for normal in data.vertex_normals() {
        normals.extend(normal.as_vec3().to_array());
    }
    let mut answer = ArrayAnswer::new(json!({
        "centre": camera.target.to_array(),
        "radius": radius,
        "eye": eye.to_array(),
        "vertical_angle": camera.vertical_angle,
    }));
    let vertices = data.vertices.len();
    answer.push_f32("positions", &[vertices, 3], &positions);
    answer.push_f32("normals", &[vertices, 3], &normals);
    answer.push_u32("faces", &[faces.len(), 3], faces.as_flattened());
    Ok(PreparedMesh {
        faces: faces.len(),
        dropped: data.faces.len() - faces.len(),
        answer: answer.finish(),
    })
}

/// The arrays of a mesh.
pub(crate) fn mesh(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    session.meshes.find(query.count("mesh", 0..=usize::MAX)?)
}

/// Keeps the mesh in the bytes of a file that is called `name`, by whose ending its format is told.
pub(crate) fn upload_mesh(
    session: &Session,
    query: &Query,
    bytes: &[u8],
) -> Result<Answer, Refusal> {
    let name = query.text("name");
    let format = MeshFormat::from_path(Path::new(name))?;
    // Buffers of a glTF file are searched in its folder. This one has been empty since it was made.
    let folder = TempDir::new()
        .map_err(|e| Refusal::new(500, format!("there is no folder for files: {e}")))?;
    let data = parse_mesh_within(format, bytes, &folder.path().join("mesh"), LIMITS);
    let data = data.map_err(|error| describe_fault(&error))?;
    Answer::json(&session.meshes.add(&display_name(name), None, &data)?)
}

/// What is wrong with a file that was sent, without the path that it never had.
fn describe_fault(error: &Error) -> Refusal {
    match error {
        Error::Unsupported { what, fix, .. } => Refusal::bad(format!("{what}; {fix}")),
        other => Refusal::bad(other.to_string()),
    }
}

impl Session {
    /// Offers the mesh in a file, OBJ, PLY or glTF, in place of the sphere. The first is shown at the start.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that can't be read; [`Error::Unsupported`] for one that holds no mesh, or more than 1,000,000 triangles,
    /// 1,500,000 vertices or 64 MB; [`Error::Argument`] for a mesh without an area, and for more than 16 meshes.
    pub fn add_mesh(&self, path: &Path) -> merlkit::Result<()> {
        let format = MeshFormat::from_path(path)?;
        let bytes = RegularFile::open(path)?.read_all(LARGEST_UPLOAD as u64)?;
        let data = parse_mesh_within(format, &bytes, path, LIMITS)?;
        let text = path.display().to_string();
        let added = self
            .meshes
            .add(&display_name(&text), Some(text.clone()), &data);
        added.map_err(|refusal| {
            Error::argument(format!("{text}: {}", refusal.message), "leave the mesh out")
        })?;
        Ok(())
    }

    /// The answer of a mesh that is sent: `bytes` of an OBJ, PLY or glTF file, with the query `name=FILE`.
    ///
    /// # Errors
    /// A [`Refusal`] for what is no mesh, and for one that is too large.
    pub fn answer_mesh_upload(&self, query: &str, bytes: &[u8]) -> Result<Answer, Refusal> {
        upload_mesh(self, &Query::parse(query, &["name"])?, bytes)
    }
}
