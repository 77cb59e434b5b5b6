//! A pinhole.

use glam::{DVec2, DVec3};

use super::shape::Ray;

/// A pinhole camera, `y` up.
///
/// See [`render`](fn@crate::render::render) for an example that renders a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub target: DVec3,
    /// Angle between the picture's lower and upper edges, radians, in (0, π).
    pub vertical_angle: f64,
}

impl Camera {
    /// The ray through a point of a picture of `aspect` = width over height, in [0, 1]² from its upper left corner.
    pub fn ray(&self, p: DVec2, aspect: f64) -> Ray {
        Ray {
            origin: self.eye,
            direction: self.axes(aspect).direction(p),
        }
    }

    /// The camera's axes, ready to make rays for a picture of the given width over height.
    pub(super) fn axes(&self, aspect: f64) -> CameraAxes {
        let forward = (self.target - self.eye).normalize_or(-DVec3::Z);
        // Looking straight up or down, −z is up in the picture.
        let right = forward.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
        // tan(angle/2) is half of the picture's height at the distance 1.
        let half = (self.vertical_angle * 0.5).tan();
        let up = right.cross(forward);
        CameraAxes {
            forward,
            across: right * half * aspect,
            up: up * half,
        }
    }
}

/// A camera's axes, scaled to a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct CameraAxes {
    forward: DVec3,
    across: DVec3,
    up: DVec3,
}

impl CameraAxes {
    /// The unit direction through a point of the picture, in [0, 1]² from its upper left corner.
    #[inline(always)]
    pub(super) fn direction(&self, p: DVec2) -> DVec3 {
        // From the upper left corner: x runs from −across to +across, y from +up to −up.
        let direction =
            self.forward + (2.0 * p.x - 1.0) * self.across + (1.0 - 2.0 * p.y) * self.up;
        direction.normalize_or(self.forward)
    }
}
