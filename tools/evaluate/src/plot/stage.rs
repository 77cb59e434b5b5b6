//! What a lobe stands on: the base of the hemisphere, the plane of incidence, and directions with their names.

use glam::DVec3;

use super::area::{Area, overlap};
use super::drawing::{Colour, Drawing, GRID, INK, Paint, Stroke};
use super::text::{Anchor, TEXT, label_room, width_of};
use super::viewpoint::Projection;

/// Length of arrows, in radii of the hemisphere, and where their names are.
pub(super) const ARROW: f64 = 1.2;
const NAME: f64 = 1.27;
/// Pixels left and right of a name.
const GAP: f64 = 3.0;
/// Hemispheres of a smaller radius have no room for the angles of the arc.
const LEAST_NAMED: f64 = 75.0;
/// Corners of the base.
const BASE_CORNERS: usize = 90;
const BASE: Colour = Colour(0xf4f4f4);

/// Where a panel's hemisphere lies.
pub(super) struct Stage {
    pub centre: (f64, f64),
    pub radius: f64,
    pub projection: Projection,
}

impl Stage {
    pub fn pixel(&self, point: DVec3) -> (f64, f64) {
        let (x, y) = self.projection.project(point);
        (
            self.centre.0 + self.radius * x,
            self.centre.1 - self.radius * y,
        )
    }

    pub fn pixels(&self, points: impl IntoIterator<Item = DVec3>) -> Vec<(f64, f64)> {
        points.into_iter().map(|p| self.pixel(p)).collect()
    }
}

/// The base with rings of polar angle and lines of azimuth, each 30°, and the hemisphere's arc in the plane of incidence.
pub(super) fn draw_base(drawing: &mut Drawing, stage: &Stage) {
    let grid = Paint::outline(Stroke::new(GRID));
    for theta in [90f64, 60.0, 30.0] {
        let ring = (0..BASE_CORNERS).map(|i| {
            let phi = std::f64::consts::TAU * i as f64 / BASE_CORNERS as f64;
            theta.to_radians().sin() * DVec3::new(phi.cos(), phi.sin(), 0.0)
        });
        let paint = match theta {
            90.0 => Paint::both(BASE, Stroke::new(Colour(0x8a8a8a))),
            _ => grid,
        };
        drawing.path(&stage.pixels(ring), true, paint);
    }
    for step in 0..6 {
        let (y, x) = (f64::from(step) * 30.0).to_radians().sin_cos();
        let ends = [DVec3::new(x, y, 0.0), DVec3::new(-x, -y, 0.0)];
        drawing.path(&stage.pixels(ends), false, grid);
    }
    let arc = (-45..=45).map(|i| in_plane(f64::from(i) * 2.0));
    let dashes = Stroke::new(Colour(0x8a8a8a)).with_dashes(&[2.0, 3.0]);
    drawing.path(&stage.pixels(arc), false, Paint::outline(dashes));
}

/// The direction at a signed angle from the normal in the plane of incidence, degrees.
fn in_plane(angle: f64) -> DVec3 {
    let (sin, cos) = angle.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// Directions with their names; those that are one have one name.
pub(super) fn arrows(theta_o: f64) -> Vec<(DVec3, &'static str)> {
    if theta_o == 0.0 {
        return vec![(DVec3::Z, "n = wo = mirror")];
    }
    vec![
        (in_plane(-theta_o), "wo"),
        (in_plane(theta_o), "mirror"),
        (DVec3::Z, "n"),
    ]
}

/// Heads and names of arrows, then the angles of the arc, where there is room.
pub(super) fn draw_names(
    drawing: &mut Drawing,
    stage: &Stage,
    arrows: &[(DVec3, &str)],
    panel: &Area,
) {
    let mut taken = Vec::new();
    for (direction, name) in arrows {
        draw_head(drawing, stage, *direction);
        let (x, y) = stage.pixel(*direction * ARROW);
        taken.push(Area {
            x: x - 5.0,
            y: y - 5.0,
            width: 10.0,
            height: 10.0,
        });
        draw_name(drawing, stage, *direction, (name, NAME), &mut taken, panel);
    }
    if stage.radius < LEAST_NAMED {
        return;
    }
    for angle in [-60.0, -30.0, 0.0, 30.0, 60.0] {
        let direction = in_plane(angle);
        // A name on an arrow would seem to be the arrow's.
        if arrows
            .iter()
            .all(|(a, _)| a.dot(direction) < 8f64.to_radians().cos())
        {
            let name = format!("{}°", angle.abs());
            draw_name(drawing, stage, direction, (&name, 1.06), &mut taken, panel);
        }
    }
}

/// A triangle at an arrow's tip; nothing where the arrow points at the viewer.
fn draw_head(drawing: &mut Drawing, stage: &Stage, direction: DVec3) {
    let (from, tip) = (stage.pixel(direction), stage.pixel(direction * ARROW));
    let (dx, dy) = (tip.0 - from.0, tip.1 - from.1);
    let length = dx.hypot(dy);
    if length < 3.0 {
        return;
    }
    let (dx, dy) = (dx / length, dy / length);
    let back = (tip.0 - 9.0 * dx, tip.1 - 9.0 * dy);
    let corners = [
        (tip.0 + 2.0 * dx, tip.1 + 2.0 * dy),
        (back.0 - 3.5 * dy, back.1 + 3.5 * dx),
        (back.0 + 3.5 * dy, back.1 - 3.5 * dx),
    ];
    drawing.path(&corners, true, Paint::inside(INK));
}

/// A name beyond the end of a direction, at the first of some places where it covers none of `taken`, which it joins.
fn draw_name(
    drawing: &mut Drawing,
    stage: &Stage,
    direction: DVec3,
    (name, distance): (&str, f64),
    taken: &mut Vec<Area>,
    panel: &Area,
) {
    let width = width_of(name, TEXT);
    let (x, y) = stage.pixel(direction * distance);
    let side = (x - stage.centre.0).signum();
    let leaning = 0.5 * width * ((x - stage.centre.0) / stage.radius).clamp(-1.0, 1.0);
    let shifts = [
        (leaning, 4.0),
        (leaning, -8.0),
        (side * (0.5 * width + 10.0), 4.0),
        (-side * (0.5 * width + 10.0), 4.0),
        (side * (0.5 * width + 10.0), 16.0),
    ];
    for (dx, dy) in shifts {
        let left = x + dx - 0.5 * width - GAP;
        let room = label_room(left, y + dy, width + 2.0 * GAP);
        let inside = room.x >= panel.x && room.right() <= panel.right();
        if inside && taken.iter().all(|t| !overlap(t, &room)) {
            drawing.label_above((x + dx, y + dy), Anchor::Middle, name);
            taken.push(room);
            return;
        }
    }
}
