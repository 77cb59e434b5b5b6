//! Parts of a mesh: faces that look alike become a mesh of their own.

use std::collections::HashMap;

use super::tree::MeshBlock;
use crate::mesh_data::MeshData;

/// Cosine of the largest angle between the normal of a face and those of its vertices that are believed.
const LEAST_COSINE: f64 = 0.2;

/// The vertices of some faces, in the order of their first use.
pub(super) fn select(mesh: &MeshBlock, faces: &[[u32; 3]]) -> MeshData {
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
pub(super) fn has_own_normals(data: &MeshData) -> bool {
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
