//! glTF 2.0: the triangles of its default scene, where its nodes put them.

use std::fmt::Display;
use std::path::{Component, Path};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::{DMat4, DVec3, Mat4};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::json::Root;
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Primitive, Semantic};
use merlkit::files::RegularFile;

use super::{Complaint, MOST_BYTES, MeshLimits};
use crate::mesh_data::MeshData;

/// Nodes that are visited, at most: a node can be the child of many.
const MOST_NODES: usize = 100_000;

/// Objects of the JSON, at most: each takes much more memory than its two bytes.
const MOST_OBJECTS: usize = 500_000;

/// Nodes below one another, at most.
const MOST_DEPTH: usize = 256;

/// All triangles of the default scene. Buffers are in the file, or in others of `folder`.
pub(super) fn parse(
    bytes: &[u8],
    folder: &Path,
    limits: MeshLimits,
) -> Result<MeshData, Complaint> {
    let (json, blob) = split_chunks(bytes)?;
    let document = read_document(json)?;
    let buffers = load_buffers(&document, blob, folder)?;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let scene = scene
        .ok_or_else(|| Complaint::new("a glTF file without a scene", "export it with a scene"))?;
    let mut data = MeshData::default();
    let mut open = Vec::new();
    for node in scene.nodes() {
        open.push((node, DMat4::IDENTITY, 0));
    }
    let mut visited = 0;
    while let Some((node, above, depth)) = open.pop() {
        visited += 1;
        if visited > MOST_NODES || depth > MOST_DEPTH {
            let what = "a glTF file whose nodes are too many, too deep or in a circle";
            return Err(Complaint::new(what, "export it as one mesh"));
        }
        let to_world = above * Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                add_primitive(&mut data, &primitive, &buffers, to_world, limits)?;
            }
        }
        for child in node.children() {
            open.push((child, to_world, depth + 1));
        }
    }
    Ok(data)
}

/// The structure of a file, validated.
fn read_document(json: &[u8]) -> Result<Document, Complaint> {
    let objects = json.iter().filter(|byte| **byte == b'{').count();
    if objects > MOST_OBJECTS {
        let what = format!("a glTF file of {objects} JSON objects");
        return Err(Complaint::new(what, "export it as one mesh"));
    }
    let root: Root = gltf::json::deserialize::from_slice(json).map_err(|e| explain(&e))?;
    // The validation looks these accessors up before it knows that they are there.
    for mesh in &root.meshes {
        for primitive in &mesh.primitives {
            let mut accessors = primitive.attributes.values();
            if accessors.any(|accessor| accessor.value() >= root.accessors.len()) {
                return Err(explain(&"a primitive names an accessor that is not there"));
            }
        }
    }
    Document::from_json(root).map_err(|error| explain(&error))
}

fn explain(error: &dyn Display) -> Complaint {
    let what = format!("a glTF file with a fault ({error})");
    Complaint::new(what, "name a glTF 2.0 file without required extensions")
}

/// The JSON of a file, and the buffer that follows it in a binary one: a header of 12 bytes, and chunks that begin with their
/// length and their kind.
fn split_chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Complaint> {
    let Some(mut rest) = bytes.strip_prefix(b"glTF") else {
        return Ok((bytes, None));
    };
    rest = rest.get(8..).unwrap_or_default();
    let (mut json, mut blob) = (None, None);
    while let Some((head, content)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, kind @ ..] = *head;
        let length = u32::from_le_bytes([a, b, c, d]) as usize;
        let Some((chunk, after)) = content.split_at_checked(length) else {
            let what = format!("a binary glTF file that ends within a chunk of {length} bytes");
            return Err(Complaint::new(what, "name a file that is complete"));
        };
        match &kind {
            b"JSON" => json = json.or(Some(chunk)),
            b"BIN\0" => blob = blob.or(Some(chunk)),
            // Other chunks may be there, and have no meaning here.
            _ => {}
        }
        rest = after;
    }
    match json {
        Some(json) => Ok((json, blob)),
        None => Err(Complaint::new(
            "a binary glTF file without JSON",
            "name a file that is complete",
        )),
    }
}

/// The buffers, each at least as long as the file says.
fn load_buffers(
    document: &Document,
    blob: Option<&[u8]>,
    folder: &Path,
) -> Result<Vec<Vec<u8>>, Complaint> {
    let mut buffers = Vec::new();
    let mut total = 0;
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            Source::Bin => blob.unwrap_or_default().to_vec(),
            Source::Uri(uri) => load_uri(uri, folder)?,
        };
        total += bytes.len() as u64;
        if total > MOST_BYTES || bytes.len() < buffer.length() {
            let what = format!(
                "a glTF buffer of {} bytes with {} bytes of content",
                buffer.length(),
                bytes.len()
            );
            return Err(Complaint::new(what, "name a file that is complete"));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// What is in the file, or a file of the folder; no other place, and no network.
fn load_uri(uri: &str, folder: &Path) -> Result<Vec<u8>, Complaint> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let bytes = text.and_then(|text| BASE64_STANDARD.decode(text).ok());
        return bytes
            .ok_or_else(|| Complaint::new("a glTF buffer that is no base64", "export it as .glb"));
    }
    let name = uri.replace("%20", " ");
    let is_inside = Path::new(&name)
        .components()
        .all(|part| matches!(part, Component::Normal(_)));
    if !is_inside || name.contains([':', '%', '\\', '\0']) || name.is_empty() {
        let what = format!("a glTF buffer at \"{uri}\"");
        return Err(Complaint::new(what, "put it into the folder of the file"));
    }
    let path = folder.join(name);
    if leads_out(&path, folder) {
        let what = format!("a glTF buffer that a link leads to (\"{uri}\")");
        return Err(Complaint::new(what, "put it into the folder of the file"));
    }
    let bytes = RegularFile::open(&path).and_then(|file| file.read_all(MOST_BYTES));
    bytes.map_err(|error| Complaint::new(format!("a glTF buffer ({error})"), "export it as .glb"))
}

/// Whether a path leads out of a folder by links.
fn leads_out(path: &Path, folder: &Path) -> bool {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(path), Ok(folder)) => !path.starts_with(folder),
        // What is not there is reported when it is opened.
        _ => false,
    }
}

/// Adds the triangles of a primitive; points and lines have none.
fn add_primitive(
    data: &mut MeshData,
    primitive: &Primitive<'_>,
    buffers: &[Vec<u8>],
    to_world: DMat4,
    limits: MeshLimits,
) -> Result<(), Complaint> {
    let is_surface = matches!(
        primitive.mode(),
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    );
    let Some(positions) = primitive.get(&Semantic::Positions).filter(|_| is_surface) else {
        return Ok(());
    };
    let corners = primitive.indices().map_or(0, |indices| indices.count());
    limits.check(
        data.vertices.len().saturating_add(positions.count()),
        data.faces.len().saturating_add(corners / 3),
    )?;
    let mut part = MeshData {
        vertices: read_vectors(&positions, buffers)?,
        ..MeshData::default()
    };
    for vertex in &mut part.vertices {
        *vertex = to_world.transform_point3(*vertex);
    }
    if let Some(normals) = primitive.get(&Semantic::Normals) {
        // Normals go by the transpose of the inverse.
        let of_normals = to_world.inverse().transpose();
        for normal in read_vectors(&normals, buffers)? {
            part.normals.push(of_normals.transform_vector3(normal));
        }
    }
    let corners = match primitive.indices() {
        Some(indices) => read_indices(&indices, buffers)?,
        None => (0..part.vertices.len() as u32).collect(),
    };
    part.faces = list_triangles(primitive.mode(), &corners);
    if to_world.determinant() < 0.0 {
        // A map that mirrors turns the sense of all triangles.
        part.faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    limits.check(0, data.faces.len() + part.faces.len())?;
    // Corners are counted within the primitive, which they must not leave.
    part.check()
        .map_err(|error| Complaint::new(format!("a glTF mesh ({error})"), "export it again"))?;
    if data.vertices.is_empty() {
        *data = part;
    } else {
        data.append(&part);
    }
    Ok(())
}

fn list_triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let mut faces = Vec::new();
            for (k, corners) in corners.windows(3).enumerate() {
                // Every other triangle of a strip runs the other way round.
                faces.push(match k % 2 {
                    0 => [corners[0], corners[1], corners[2]],
                    _ => [corners[1], corners[0], corners[2]],
                });
            }
            faces
        }
        Mode::TriangleFan => {
            let pairs = corners.windows(2).skip(1);
            pairs.map(|pair| [corners[0], pair[0], pair[1]]).collect()
        }
        _ => corners.as_chunks().0.to_vec(),
    }
}

/// Where an accessor's elements are: the buffer's bytes from the first of them, and the distance between two.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

fn refuse_accessor(accessor: &Accessor<'_>) -> Complaint {
    let what = format!("the glTF accessor {}", accessor.index());
    Complaint::new(what, "export it complete, without sparse accessors")
}

/// The bytes of an accessor's view, from its first element on; `None` if they are not there.
fn find_bytes<'a>(accessor: &Accessor<'_>, buffers: &'a [Vec<u8>]) -> Option<&'a [u8]> {
    if accessor.sparse().is_some() {
        return None;
    }
    let view = accessor.view()?;
    let end = view.offset().checked_add(view.length())?;
    let bytes = buffers
        .get(view.buffer().index())?
        .get(view.offset()..end)?;
    bytes.get(accessor.offset()..)
}

/// Finds an accessor's elements, all of which are inside its view, which is inside its buffer.
fn find_elements<'a>(
    accessor: &Accessor<'_>,
    buffers: &'a [Vec<u8>],
) -> Result<Elements<'a>, Complaint> {
    let bytes = find_bytes(accessor, buffers).ok_or_else(|| refuse_accessor(accessor))?;
    let size = accessor.size();
    let stride = accessor.view().and_then(|view| view.stride());
    let (stride, count) = (stride.unwrap_or(size), accessor.count());
    // (count − 1)·stride + size bytes, of which each element has some of its own.
    let needed = count.saturating_sub(1).checked_mul(stride);
    let needed = needed.and_then(|bytes| bytes.checked_add(size));
    let fits = needed.is_some_and(|needed| needed <= bytes.len());
    if count > 0 && (stride < size || !fits) {
        return Err(refuse_accessor(accessor));
    }
    Ok(Elements {
        bytes,
        stride,
        count,
    })
}

fn read_vectors(accessor: &Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<DVec3>, Complaint> {
    if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
        let what = "glTF positions or normals that are no vectors of three floats";
        return Err(Complaint::new(what, "export it without quantization"));
    }
    let elements = find_elements(accessor, buffers)?;
    let mut vectors = Vec::with_capacity(elements.count);
    for k in 0..elements.count {
        let mut vector = [0.0; 3];
        for (axis, number) in vector.iter_mut().enumerate() {
            let bytes = read_bytes(&elements, k, 4 * axis);
            *number = f64::from(f32::from_le_bytes(bytes));
        }
        vectors.push(DVec3::from_array(vector));
    }
    Ok(vectors)
}

fn read_indices(accessor: &Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<u32>, Complaint> {
    let elements = find_elements(accessor, buffers)?;
    let is_scalar = accessor.dimensions() == Dimensions::Scalar;
    let mut indices = Vec::with_capacity(elements.count);
    for k in 0..elements.count {
        indices.push(match accessor.data_type() {
            DataType::U8 if is_scalar => u32::from(u8::from_le_bytes(read_bytes(&elements, k, 0))),
            DataType::U16 if is_scalar => {
                u32::from(u16::from_le_bytes(read_bytes(&elements, k, 0)))
            }
            DataType::U32 if is_scalar => u32::from_le_bytes(read_bytes(&elements, k, 0)),
            _ => {
                let what = "glTF indices that are no unsigned integers";
                return Err(Complaint::new(what, "export it again"));
            }
        });
    }
    Ok(indices)
}

/// `N` bytes of element `k`, which [`find_elements`] found to be there.
fn read_bytes<const N: usize>(elements: &Elements<'_>, k: usize, offset: usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&elements.bytes[k * elements.stride + offset..][..N]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle in a node that moves, scales and mirrors it.
    fn triangle(uri: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"children":[1],"translation":[1,2,3]}},{{"mesh":0,"scale":[2,2,-2]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "accessors":[
              {{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
              {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "buffers":[{{"byteLength":42,"uri":"{uri}"}}]}}"#
        )
    }

    fn content() -> Vec<u8> {
        let mut bytes = Vec::new();
        for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(number.to_le_bytes());
        }
        for corner in [0u16, 1, 2] {
            bytes.extend(corner.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn nodes_place_their_meshes() {
        let uri = format!(
            "data:application/octet-stream;base64,{}",
            BASE64_STANDARD.encode(content())
        );
        let data = parse(
            triangle(&uri).as_bytes(),
            Path::new(""),
            MeshLimits::default(),
        )
        .unwrap();
        let corners = data.corners(data.faces[0]);
        let expected = [
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(1.0, 4.0, 3.0),
            DVec3::new(3.0, 2.0, 3.0),
        ];
        assert_eq!(corners, expected);
    }

    #[test]
    fn buffers_outside_of_the_folder_are_refused() {
        for uri in [
            "../secret.bin",
            "/etc/passwd",
            "file:///etc/passwd",
            "https://example.org/a.bin",
            "a/../../b",
            "%2e%2e/b",
        ] {
            let refused = parse(
                triangle(uri).as_bytes(),
                Path::new("folder"),
                MeshLimits::default(),
            )
            .unwrap_err();
            assert!(
                refused.what.contains("buffer at"),
                "{uri}: {}",
                refused.what
            );
        }
    }
}
