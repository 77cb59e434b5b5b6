//! Wavefront OBJ.

use std::io::Cursor;
use std::path::Path;

use glam::DVec3;
use tobj::{LoadError, LoadOptions, MTLLoadResult, Mesh};

use super::{Complaint, MeshLimits};
use crate::mesh_data::MeshData;

/// All triangles of a file; polygons are cut into triangles. Materials are not looked for.
pub(super) fn parse(bytes: &[u8], limits: MeshLimits) -> Result<MeshData, Complaint> {
    limits.check(0, count_triangles(bytes))?;
    let options = LoadOptions {
        // Vertices that differ in their normals alone become two, so that each has one normal.
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, leave_materials)
        .map_err(|error| {
            let what = format!("an OBJ file with a fault ({error})");
            Complaint::new(what, "export it again, as polygons")
        })?;
    let mut data = MeshData::default();
    for model in &models {
        append(&mut data, &model.mesh, limits)?;
    }
    Ok(data)
}

/// The triangles that the lines of faces are cut into.
fn count_triangles(bytes: &[u8]) -> usize {
    let mut count = 0;
    for line in bytes.split(|byte| *byte == b'\n' || *byte == b'\r') {
        let pieces = line.split(u8::is_ascii_whitespace);
        let mut words = pieces.filter(|word| !word.is_empty());
        if words.next() == Some(b"f") {
            count += words.count().saturating_sub(2);
        }
    }
    count
}

/// Materials are given by the scene, and no other file is read.
fn leave_materials(_: &Path) -> MTLLoadResult {
    Err(LoadError::OpenFileFailed)
}

fn append(data: &mut MeshData, mesh: &Mesh, limits: MeshLimits) -> Result<(), Complaint> {
    limits.check(
        data.vertices.len() + mesh.positions.len() / 3,
        data.faces.len() + mesh.indices.len() / 3,
    )?;
    let mut part = MeshData {
        vertices: read_vectors(&mesh.positions),
        normals: read_vectors(&mesh.normals),
        faces: mesh.indices.as_chunks().0.to_vec(),
    };
    // Where only some faces name normals, which vertex has which is not known.
    if part.normals.len() != part.vertices.len() {
        part.normals.clear();
    }
    if data.vertices.is_empty() {
        *data = part;
    } else {
        data.append(&part);
    }
    Ok(())
}

fn read_vectors(numbers: &[f64]) -> Vec<DVec3> {
    let (vectors, _) = numbers.as_chunks();
    vectors.iter().copied().map(DVec3::from_array).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_and_normals_are_read() {
        let text = "mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n\
                    usemtl gold\nf 1//1 2//1 3//1 4//1\nl 1 2\n";
        let data = parse(text.as_bytes(), MeshLimits::default()).unwrap();
        assert_eq!(data.faces.len(), 2);
        assert_eq!(data.vertices.len(), 4);
        assert_eq!(data.normals, [DVec3::Z; 4]);
        let groups = "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf -3 -1 -2\n";
        let data = parse(groups.as_bytes(), MeshLimits::default()).unwrap();
        assert_eq!(data.faces.len(), 2);
        assert_eq!(data.corners(data.faces[1])[1], DVec3::Y);
    }

    #[test]
    fn a_corner_that_is_not_there_is_refused() {
        for text in ["v 0 0 0\nf 1 2 3\n", "v 0 0\nf 1 1 1\n", "v a b c\n"] {
            assert!(
                parse(text.as_bytes(), MeshLimits::default()).is_err(),
                "{text}"
            );
        }
    }
}
