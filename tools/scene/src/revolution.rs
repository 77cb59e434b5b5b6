//! Surfaces of revolution about the y axis, such as a jar.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use merlkit::{Error, Result};

use crate::mesh_data::MeshData;

/// Segments and profile points, at most: some 34 million triangles.
const MOST: usize = 4096;

/// The outline of a jar of height 2 that rests on y = 0: radius and height of 12 points, from the middle of its bottom to the inside
/// of its mouth.
pub fn jar_profile() -> [DVec2; 12] {
    [
        [0.0, 0.0],
        [0.42, 0.0],
        [0.5, 0.06],
        [0.72, 0.38],
        [0.86, 0.78],
        [0.82, 1.16],
        [0.6, 1.48],
        [0.36, 1.68],
        [0.34, 1.84],
        [0.46, 2.0],
        [0.38, 1.96],
        [0.24, 1.7],
    ]
    .map(DVec2::from_array)
}

/// `count` points of a curve through all points of a profile (Catmull and Rom 1974), at equal steps between the points. Radii
/// are never negative. Fewer than two points, or a `count` that is no more than theirs, leave the profile as it is.
pub fn smooth_profile(points: &[DVec2], count: usize) -> Vec<DVec2> {
    if points.len() < 2 || count <= points.len() {
        return points.to_vec();
    }
    let last = points.len() - 1;
    let mut curve = Vec::with_capacity(count);
    for k in 0..count {
        // Step 1: the segment, and the place t within it.
        let along = k as f64 / (count - 1) as f64 * last as f64;
        let i = (along as usize).min(last - 1);
        let t = along - i as f64;
        // Step 2: tangents are half the chords of the neighbours; the ends are neighbours of themselves.
        let (p0, p1) = (points[i.saturating_sub(1)], points[i]);
        let (p2, p3) = (points[i + 1], points[(i + 2).min(last)]);
        let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
        // Step 3: Hermite's cubic, (2t³−3t²+1)·p1 + (t³−2t²+t)·m1 + (3t²−2t³)·p2 + (t³−t²)·m2.
        let (t2, t3) = (t * t, t * t * t);
        let point = (2.0 * t3 - 3.0 * t2 + 1.0) * p1
            + (t3 - 2.0 * t2 + t) * m1
            + (3.0 * t2 - 2.0 * t3) * p2
            + (t3 - t2) * m2;
        curve.push(DVec2::new(point.x.max(0.0), point.y));
    }
    curve
}

/// Turns a profile of radii and heights about the y axis, in `segments` steps. A profile that goes upwards with its radius to the
/// right is seen from outside.
///
/// # Errors
/// [`Error::Argument`] for fewer than two points or three segments, more than 4096 of either, and radii that are negative or not
/// finite.
pub fn revolve(profile: &[DVec2], segments: usize) -> Result<MeshData> {
    if !(2..=MOST).contains(&profile.len()) || !(3..=MOST).contains(&segments) {
        let what = format!(
            "a surface of revolution of {} points and {segments} segments",
            profile.len()
        );
        let fix = format!("give 2 to {MOST} points and 3 to {MOST} segments");
        return Err(Error::argument(what, fix));
    }
    if let Some(point) = profile.iter().find(|p| !(p.is_finite() && p.x >= 0.0)) {
        return Err(Error::argument(
            format!("{point} is no point of a profile"),
            "give a radius ≥ 0 and a height, both finite",
        ));
    }
    let mut data = MeshData::default();
    for point in profile {
        for j in 0..segments {
            // Counter-clockwise as seen from above.
            let (sin, cos) = (TAU * j as f64 / segments as f64).sin_cos();
            data.vertices
                .push(DVec3::new(point.x * cos, point.y, -point.x * sin));
        }
    }
    for i in 0..profile.len() - 1 {
        for j in 0..segments {
            let next = (j + 1) % segments;
            let corner =
                [j, next, next + segments, j + segments].map(|k| (i * segments + k) as u32);
            // On the axis all corners of a ring are one, and one of the two triangles has no area.
            if profile[i].x > 0.0 {
                data.faces.push([corner[0], corner[1], corner[2]]);
            }
            if profile[i + 1].x > 0.0 {
                data.faces.push([corner[0], corner[2], corner[3]]);
            }
        }
    }
    Ok(data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Shading, Sides, TriangleMesh};
    use merlkit::render::{Ray, Shape};

    #[test]
    fn a_profile_is_smoothed_through_its_points() {
        let curve = smooth_profile(&jar_profile(), 45);
        for (i, point) in jar_profile().iter().enumerate() {
            assert!(curve[4 * i].abs_diff_eq(*point, 1e-12), "{i}");
        }
        assert_eq!(smooth_profile(&jar_profile(), 12).len(), 12);
    }

    #[test]
    fn a_jar_is_seen_from_outside() {
        let profile = smooth_profile(&jar_profile(), 49);
        let data = revolve(&profile, 48).unwrap();
        let jar = TriangleMesh::build(&data, Sides::Outer, Shading::Flat).unwrap();
        assert_eq!(jar.dropped_faces(), 0);
        assert_eq!(jar.face_count(), 2 * 48 * 48 - 48);
        let ray = Ray {
            origin: DVec3::new(0.0, 0.8, 4.0),
            direction: DVec3::NEG_Z,
        };
        let hit = jar.intersect(&ray, 0.0, f64::INFINITY).unwrap();
        assert!(hit.normal.z > 0.9 && (hit.distance - (4.0 - 0.86)).abs() < 0.02);
        assert!(revolve(&profile, 2).is_err());
        assert!(revolve(&[DVec2::NEG_X, DVec2::X], 8).is_err());
    }
}
