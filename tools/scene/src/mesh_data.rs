//! Vertices and faces, as a file or a formula gives them.

use glam::DVec3;
use merlkit::{Error, Result};

/// The largest coordinate of a vertex: squares and products of three of them are far from overflowing.
const LARGEST: f64 = 1e15;

/// Vertices and triangles, not checked yet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// The vertices, world space or that of the object.
    pub vertices: Vec<DVec3>,
    /// A normal for each vertex, of any length; or none at all.
    pub normals: Vec<DVec3>,
    /// Positions in `vertices` of each triangle's corners, counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl MeshData {
    /// Refuses what no mesh can be made of.
    ///
    /// # Errors
    /// [`Error::Argument`] for a vertex or a normal that is not finite, a corner without a vertex, a number of normals other
    /// than that of vertices, and more vertices than a corner can name.
    pub fn check(&self) -> Result<()> {
        let count = self.vertices.len();
        if count >= u32::MAX as usize || self.faces.len() >= u32::MAX as usize / 4 {
            let what = format!("a mesh of {count} vertices and {} faces", self.faces.len());
            return Err(Error::argument(what, "cut it into smaller ones"));
        }
        if let Some(i) = self.vertices.iter().position(|v| !is_usable(*v)) {
            let what = format!("vertex {i} has a coordinate that is not within ±{LARGEST:e}");
            return Err(Error::argument(what, "give finite coordinates"));
        }
        if !self.normals.is_empty() && self.normals.len() != count {
            let what = format!("{} normals for {count} vertices", self.normals.len());
            return Err(Error::argument(what, "give a normal for each, or none"));
        }
        if let Some(i) = self.normals.iter().position(|n| !is_usable(*n)) {
            let what = format!("the normal of vertex {i} is not within ±{LARGEST:e}");
            return Err(Error::argument(what, "give finite normals, or none"));
        }
        for (i, face) in self.faces.iter().enumerate() {
            if let Some(corner) = face.iter().find(|c| **c as usize >= count) {
                let what = format!("face {i} names the vertex {corner} of {count}, counted from 0");
                return Err(Error::argument(what, "name vertices that are there"));
            }
        }
        Ok(())
    }

    /// The corners of a face.
    ///
    /// # Panics
    /// If the face names a vertex that is not there: [`Self::check`] finds it.
    pub fn corners(&self, face: [u32; 3]) -> [DVec3; 3] {
        face.map(|corner| self.vertices[corner as usize])
    }

    /// The faces whose corners span an area that is more than rounding.
    ///
    /// # Panics
    /// As [`Self::corners`].
    pub fn faces_with_area(&self) -> Vec<[u32; 3]> {
        let mut faces = self.faces.clone();
        faces.retain(|face| has_area(self.corners(*face)));
        faces
    }

    /// Normals of vertices: those that are given, or else the mean of the normals of their faces, weighted by area. A vertex
    /// without a face, or whose faces cancel, has the zero vector.
    pub fn vertex_normals(&self) -> Vec<DVec3> {
        let mut normals = self.normals.clone();
        if normals.is_empty() {
            normals = vec![DVec3::ZERO; self.vertices.len()];
            for &face in &self.faces {
                // (b − a) × (c − a) has twice the triangle's area for its length.
                let [a, b, c] = self.corners(face);
                for corner in face {
                    normals[corner as usize] += (b - a).cross(c - a);
                }
            }
        }
        for normal in &mut normals {
            *normal = normal.normalize_or_zero();
        }
        normals
    }

    /// Adds the triangles of another mesh. Normals remain only if both have them.
    pub fn append(&mut self, other: &Self) {
        let first = self.vertices.len() as u32;
        let both = self.vertices.len() == self.normals.len()
            && other.vertices.len() == other.normals.len();
        self.vertices.extend_from_slice(&other.vertices);
        match both {
            true => self.normals.extend_from_slice(&other.normals),
            false => self.normals.clear(),
        }
        for face in &other.faces {
            self.faces
                .push(face.map(|corner| corner.saturating_add(first)));
        }
    }
}

fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - a).length());
    (b - a).cross(c - a).length() > 1e-14 * longest * longest
}

fn is_usable(v: DVec3) -> bool {
    // NaN fails the comparison too.
    v.abs().max_element() <= LARGEST && v.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_mesh_can_be_made_of_is_refused() {
        let good = MeshData {
            vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: Vec::new(),
            faces: vec![[0, 1, 2]],
        };
        assert!(good.check().is_ok());
        let mut bad = good.clone();
        bad.faces[0][1] = 3;
        assert!(
            bad.check()
                .unwrap_err()
                .to_string()
                .contains("vertex 3 of 3")
        );
        let mut bad = good.clone();
        bad.vertices[1].y = f64::NAN;
        assert!(bad.check().is_err());
        let mut bad = good.clone();
        bad.normals = vec![DVec3::Z];
        assert!(bad.check().is_err());
        assert_eq!(good.vertex_normals(), [DVec3::Z; 3]);
    }

    #[test]
    fn meshes_are_joined() {
        let mut mesh = MeshData {
            vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: vec![DVec3::Z; 3],
            faces: vec![[0, 1, 2]],
        };
        mesh.append(&mesh.clone());
        assert_eq!(mesh.faces, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(mesh.normals.len(), 6);
    }
}
