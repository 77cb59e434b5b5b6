//! Wavefront OBJ.

use std::io::Cursor;
use std::path::Path;

use glam::DVec3;
use tobj::{LoadError, LoadOptions, MTLLoadResult, Mesh};

use super::{Complaint, MOST_FACES, too_many_faces};
use crate::mesh_data::MeshData;

/// All triangles of a file; polygons are cut into triangles. Materials are not looked for.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshData, Complaint> {
    let options = LoadOptions {
        // Vertices that differ in their normals alone become two, so that each has one normal.
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, leave_materials)
        .map_err(|error| {
            let what = format!("an OBJ file with a fault ({error})");
            Complaint::new(what, "export it again, as polygons")
        })?;
    let mut data = MeshData::default();
    for model in &models {
        append(&mut data, &model.mesh)?;
    }
    Ok(data)
}

/// Materials are given by the scene, and no other file is read.
fn leave_materials(_: &Path) -> MTLLoadResult {
    Err(LoadError::OpenFileFailed)
}

fn append(data: &mut MeshData, mesh: &Mesh) -> Result<(), Complaint> {
    if data.faces.len() + mesh.indices.len() / 3 > MOST_FACES {
        return Err(too_many_faces());
    }
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
        let data = parse(text.as_bytes()).unwrap();
        assert_eq!(data.faces.len(), 2);
        assert_eq!(data.vertices.len(), 4);
        assert_eq!(data.normals, [DVec3::Z; 4]);
        let groups = "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf -3 -1 -2\n";
        let data = parse(groups.as_bytes()).unwrap();
        assert_eq!(data.faces.len(), 2);
        assert_eq!(data.corners(data.faces[1])[1], DVec3::Y);
    }

    #[test]
    fn a_corner_that_is_not_there_is_refused() {
        for text in ["v 0 0 0\nf 1 2 3\n", "v 0 0\nf 1 1 1\n", "v a b c\n"] {
            assert!(parse(text.as_bytes()).is_err(), "{text}");
        }
    }
}
