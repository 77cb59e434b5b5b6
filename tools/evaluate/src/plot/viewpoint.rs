//! Solids seen from a point far away.

use glam::DVec3;

use super::drawing::Colour;

/// From where a solid is seen: degrees above the surface, and about its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// From 0, along the surface, to 90, from above.
    pub elevation: f64,
    /// At 0 the plane of incidence is seen face on, `wo` on the left; at 90 `wo` points towards the viewer.
    pub azimuth: f64,
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self {
            elevation: 25.0,
            azimuth: 20.0,
        }
    }
}

/// A parallel projection: the axes of the picture in the frame of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    right: DVec3,
    up: DVec3,
    /// Towards the viewer.
    near: DVec3,
    /// Towards the light that shades faces.
    light: DVec3,
}

impl Viewpoint {
    pub(super) fn projection(self) -> Projection {
        let (sin_e, cos_e) = self.elevation.to_radians().sin_cos();
        let (sin_a, cos_a) = self.azimuth.to_radians().sin_cos();
        // At azimuth 90 the viewer is at x < 0, where wo is.
        let right = DVec3::new(cos_a, -sin_a, 0.0);
        let up = DVec3::new(sin_a * sin_e, cos_a * sin_e, cos_e);
        let near = DVec3::new(-sin_a * cos_e, -cos_a * cos_e, sin_e);
        let light = (0.6 * up - 0.45 * right + 0.75 * near).normalize();
        Projection {
            right,
            up,
            near,
            light,
        }
    }
}

impl Projection {
    /// Place in the picture, y upwards, in the solid's own units.
    pub fn project(&self, point: DVec3) -> (f64, f64) {
        (point.dot(self.right), point.dot(self.up))
    }

    /// How near to the viewer a point is; greater is nearer.
    pub fn nearness(&self, point: DVec3) -> f64 {
        point.dot(self.near)
    }

    /// A colour on a face with that normal, by Lambert's law with light from everywhere added.
    pub fn shade(&self, colour: Colour, normal: DVec3) -> Colour {
        let cosine = normal.dot(self.light).max(0.0);
        // Below 1 towards black, above 1 towards white.
        let gain = 0.5 + 0.75 * cosine;
        Colour::from_rgb(colour.to_rgb().map(|channel| {
            let channel = f64::from(channel);
            let shown = match gain > 1.0 {
                true => channel + (gain - 1.0) * (255.0 - channel),
                false => channel * gain,
            };
            shown.round() as u8
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_s_axes_are_right_angled_and_show_wo_where_it_says() {
        for (elevation, azimuth) in [(25.0, 20.0), (0.0, 0.0), (90.0, -130.0)] {
            let p = Viewpoint { elevation, azimuth }.projection();
            assert!((p.right.cross(p.up) - p.near).length() < 1e-12);
        }
        let wo = DVec3::new(-0.5, 0.0, 0.75f64.sqrt());
        let face_on = Viewpoint {
            elevation: 0.0,
            azimuth: 0.0,
        };
        let (x, y) = face_on.projection().project(wo);
        assert!((x + 0.5).abs() < 1e-12 && (y - wo.z).abs() < 1e-12);
        let turned = Viewpoint {
            elevation: 0.0,
            azimuth: 90.0,
        };
        assert!((turned.projection().nearness(wo) - 0.5).abs() < 1e-12);
    }
}
