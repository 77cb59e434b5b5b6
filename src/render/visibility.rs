//! What can be in the way of what, by planes between objects: the facts that the plan's effects on visibility follow from.
//!
//! A surface A is lit by a light L along segments, all of which lie in the convex hull of A and L. Another object B hides none of
//! them if a plane has B on one side, and A and L on the other. A few planes are tried for each. One that fits is a proof,
//! and without one the plan keeps its shadow rays.

use glam::{DQuat, DVec3};

use super::shape::Shape;
use super::spec::SceneSpec;
use crate::light::LightSpec;

/// Objects up to which all pairs are examined.
const MOST_OBJECTS: usize = 32;

/// Planes that are tried on the way from a surface to a light at a finite place.
const STEPS: u32 = 32;

/// By how much objects may reach through a plane, in units of the scene's largest coordinate: rounding of turned walls.
const TOLERANCE: f64 = 1e-10;

/// Where a light's rays end.
enum LightPlace {
    /// In the convex hull of these points.
    Within(Vec<DVec3>),
    /// Infinitely far away, along this direction.
    Towards(DVec3),
    /// On all sides.
    Everywhere,
}

/// Whether an object may be between a surface of the scene and a light.
pub(super) fn may_hide_lights(spec: &SceneSpec) -> bool {
    let shapes = spec.shapes();
    if shapes.iter().any(|shape| !shape.is_convex()) {
        return true;
    }
    // A convex object does not hide lights from itself.
    if shapes.len() < 2 {
        return false;
    }
    if shapes.len() > MOST_OBJECTS {
        return true;
    }
    let mut places = Vec::new();
    for light in spec.lights.iter().filter(|light| !light.is_dark()) {
        places.push(find_place(light, spec.light_turn));
    }
    let tolerance = TOLERANCE * measure(&shapes, &places);
    for place in &places {
        for (i, surface) in shapes.iter().enumerate() {
            for (j, other) in shapes.iter().enumerate() {
                if i != j && !is_separated(*other, *surface, place, tolerance) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether a surface of the scene may be seen from another, or from itself.
pub(super) fn may_see_one_another(spec: &SceneSpec) -> bool {
    let shapes = spec.shapes();
    if shapes.iter().any(|shape| !shape.is_convex()) {
        return true;
    }
    let Some((first, others)) = shapes.split_first() else {
        return false;
    };
    // Points of one plane see one another along the plane only, where surfaces reflect nothing.
    let tolerance = TOLERANCE * measure(&shapes, &[]);
    others
        .iter()
        .any(|other| !are_in_one_plane(*first, *other, tolerance))
}

fn find_place(light: &LightSpec, turn: f64) -> LightPlace {
    let turned = DQuat::from_rotation_y(turn);
    match light {
        LightSpec::Point(point) => LightPlace::Within(vec![turned * point.position]),
        LightSpec::Area(area) => {
            let across = area.corner + area.edge_u;
            let corners = [
                area.corner,
                across,
                area.corner + area.edge_v,
                across + area.edge_v,
            ];
            LightPlace::Within(corners.map(|corner| turned * corner).to_vec())
        }
        LightSpec::Directional(light) => LightPlace::Towards(turned * light.towards),
        LightSpec::Environment(_) => LightPlace::Everywhere,
        LightSpec::Object(light) => match light.hull() {
            unknown if unknown.is_empty() => LightPlace::Everywhere,
            // It is not turned.
            corners => LightPlace::Within(corners),
        },
    }
}

/// The largest finite coordinate of objects and lights.
fn measure(shapes: &[&dyn Shape], places: &[LightPlace]) -> f64 {
    let mut largest = 0f64;
    for shape in shapes {
        for axis in DVec3::AXES {
            for end in [shape.support(axis), shape.support(-axis)] {
                if end.is_finite() {
                    largest = largest.max(end.abs());
                }
            }
        }
    }
    for place in places {
        if let LightPlace::Within(points) = place {
            for point in points {
                largest = largest.max(point.abs().max_element());
            }
        }
    }
    largest
}

/// Whether a plane is found that has `other` on one side and all segments from `surface` to the light on the other.
fn is_separated(
    other: &dyn Shape,
    surface: &dyn Shape,
    place: &LightPlace,
    tolerance: f64,
) -> bool {
    let normals = propose_normals(other, surface, place);
    normals.into_iter().any(|normal| {
        // The plane touches `other`, which is below it: max n·b. Then min n·a and min n·l must not be lower.
        let plane = other.support(normal);
        let surface_ends = -surface.support(-normal);
        let light_is_above = match place {
            LightPlace::Within(points) => points
                .iter()
                .all(|point| normal.dot(*point) >= plane - tolerance),
            LightPlace::Towards(direction) => normal.dot(*direction) >= 0.0,
            LightPlace::Everywhere => false,
        };
        light_is_above && plane.is_finite() && surface_ends >= plane - tolerance
    })
}

/// Normals of planes that may be between an object and what goes from a surface to a light.
fn propose_normals(other: &dyn Shape, surface: &dyn Shape, place: &LightPlace) -> Vec<DVec3> {
    // Step 1: the axes, and the planes that flat objects lie in.
    let mut normals = DVec3::AXES.to_vec();
    normals.extend(other.plane_normal());
    normals.extend(surface.plane_normal());
    let opposite: Vec<DVec3> = normals.iter().map(|normal| -*normal).collect();
    normals.extend(opposite);
    // Step 2: from the object's middle to points on the way from the surface's middle to the light.
    let (Some(from), Some(to)) = (find_middle(other), find_middle(surface)) else {
        return normals;
    };
    match place {
        LightPlace::Within(points) => {
            let sum: DVec3 = points.iter().sum();
            let light = sum / points.len() as f64;
            for step in 0..=STEPS {
                let on_way = to.lerp(light, f64::from(step) / f64::from(STEPS));
                normals.extend((on_way - from).try_normalize());
            }
        }
        LightPlace::Towards(direction) => {
            let aside = (to - from).reject_from_normalized(*direction);
            // Rounding must not leave a plane that faces away from the light.
            let aside = aside - aside.dot(*direction).min(0.0) * *direction;
            normals.extend(aside.try_normalize());
            normals.extend((to - from).try_normalize());
        }
        LightPlace::Everywhere => {}
    }
    normals
}

/// The middle of a shape's box; `None` without a finite one.
fn find_middle(shape: &dyn Shape) -> Option<DVec3> {
    let middle = DVec3::AXES.map(|axis| 0.5 * (shape.support(axis) - shape.support(-axis)));
    let middle = DVec3::from_array(middle);
    middle.is_finite().then_some(middle)
}

fn are_in_one_plane(a: &dyn Shape, b: &dyn Shape, tolerance: f64) -> bool {
    let (Some(normal), Some(_)) = (a.plane_normal(), b.plane_normal()) else {
        return false;
    };
    let [upper_a, upper_b] = [a.support(normal), b.support(normal)];
    let thickness = upper_b + b.support(-normal);
    (upper_a - upper_b).abs() <= tolerance && thickness.abs() <= tolerance
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(count: usize, light: &str) -> SceneSpec {
        let names: Vec<String> = (0..count).map(|i| i.to_string()).collect();
        let row = SceneSpec::row(&names, 1.5);
        SceneSpec {
            lights: vec![row.light(light).unwrap()],
            ..row
        }
    }

    #[test]
    fn spheres_hide_lights_where_no_plane_is_between() {
        // The row runs along x, and azimuths count from z. Two spheres are 2.25 apart: from 27° off the zenith on
        // they hide one another, 2.25·cos 27° = 2.
        for (light, hides) in [
            ("point:0,1,9", false),
            ("point:9,1,0", true),
            ("directional:0,0", false),
            ("directional:90,0", false),
            ("directional:20,90", false),
            ("directional:45,90", true),
            ("directional:90,90", true),
            ("studio", true),
        ] {
            assert_eq!(may_hide_lights(&row(3, light)), hides, "{light}");
            assert!(!may_hide_lights(&row(1, light)));
        }
        let turned = SceneSpec {
            light_turn: std::f64::consts::FRAC_PI_2,
            ..row(3, "point:0,1,9")
        };
        assert!(may_hide_lights(&turned));
    }

    #[test]
    fn spheres_hide_lights_from_the_ground_and_it_hides_none_from_them() {
        let grounded = |light: &str| SceneSpec {
            floor: Some(0.5),
            ..row(1, light)
        };
        assert!(may_hide_lights(&grounded("point:0,1,9")));
        // From below the ground.
        assert!(may_hide_lights(&grounded("point:0,-1,9")));
        assert!(may_see_one_another(&grounded("point:0,1,9")));
        assert!(may_see_one_another(&row(2, "studio")) && !may_see_one_another(&row(1, "studio")));
    }
}
