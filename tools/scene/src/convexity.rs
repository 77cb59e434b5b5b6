//! Whether a mesh is convex or flat: proved without rounding, or not claimed.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use robust::{Coord3D, orient3d};

/// Products of faces and vertices up to which a mesh is examined.
const MOST_TESTS: usize = 4_000_000;

/// The form of a mesh, as far as it is proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// All vertices are in one plane, of this normal.
    Flat(DVec3),
    /// It encloses a convex solid, and its faces point outwards.
    ConvexSolid,
    /// Anything else, or too large to be examined.
    Other,
}

/// Finds the form of a mesh from its triangles, none of which has the area 0.
pub(crate) fn find_form(triangles: &[[DVec3; 3]]) -> Form {
    let (corners, faces) = weld(triangles);
    let Some(first) = triangles.first() else {
        return Form::Other;
    };
    if corners.iter().all(|p| side(first, *p) == 0.0) {
        let normal = (first[1] - first[0]).cross(first[2] - first[0]);
        return normal.try_normalize().map_or(Form::Other, Form::Flat);
    }
    let tests = corners.len().saturating_mul(triangles.len());
    if tests > MOST_TESTS || !is_closed(&faces) {
        return Form::Other;
    }
    // A closed surface that has no point in front of any of its faces bounds the intersection of the half spaces behind them.
    for face in triangles {
        for corner in &corners {
            if side(face, *corner) < 0.0 {
                return Form::Other;
            }
        }
    }
    Form::ConvexSolid
}

/// Positive behind the face, negative in front of it, 0 in its plane; the sign is exact.
fn side([a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    orient3d(coord(*a), coord(*b), coord(*c), coord(p))
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

/// The different corners, and the triangles as positions among them.
fn weld(triangles: &[[DVec3; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let mut corners = Vec::new();
    let mut faces = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        faces.push(triangle.map(|corner| {
            // −0 and 0 are one coordinate.
            let key = (corner + 0.0).to_array().map(f64::to_bits);
            *known.entry(key).or_insert_with(|| {
                corners.push(corner);
                corners.len() as u32 - 1
            })
        }));
    }
    (corners, faces)
}

/// Whether each edge has one face on either side, which run along it in opposite senses.
fn is_closed(faces: &[[u32; 3]]) -> bool {
    let mut edges = HashSet::new();
    for [a, b, c] in faces {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            if !edges.insert(edge) {
                return false;
            }
        }
    }
    edges.iter().all(|(a, b)| edges.contains(&(*b, *a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Vec<[DVec3; 3]> {
        let [o, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        vec![[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
    }

    #[test]
    fn forms_are_proved() {
        let solid = tetrahedron();
        assert_eq!(find_form(&solid), Form::ConvexSolid);
        assert_eq!(find_form(&solid[..3]), Form::Other);
        let inwards: Vec<_> = solid.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        assert_eq!(find_form(&inwards), Form::Other);
        assert!(matches!(find_form(&solid[..1]), Form::Flat(n) if n == DVec3::NEG_Z));
        // A corner that is pressed in by the least that a number can change by.
        let mut dented = tetrahedron();
        let middle = DVec3::new(0.25, 0.25, 0.5_f64.next_down());
        let [x, y, z] = dented.pop().unwrap();
        dented.extend([[x, y, middle], [y, z, middle], [z, x, middle]]);
        assert_eq!(find_form(&dented), Form::Other);
        let mut raised = tetrahedron();
        let middle = DVec3::new(0.25, 0.25, 0.5_f64.next_up());
        raised.pop();
        raised.extend([[x, y, middle], [y, z, middle], [z, x, middle]]);
        assert_eq!(find_form(&raised), Form::ConvexSolid);
    }
}
