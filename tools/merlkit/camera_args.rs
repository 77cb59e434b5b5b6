//! Where the eye is.

use merlkit::Error;
use merlkit::glam::DVec3;
use merlkit::render::Camera;
use merlkit_scene::CameraEntry;

/// Place and angle of the camera.
#[derive(Clone, clap::Args)]
pub struct CameraOptions {
    /// Position of the eye in radii of a sphere; +y is up, +z to the viewer [default: it frames the spheres]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "elevation", value_parser = position)]
    eye: Option<DVec3>,
    /// The point in the middle of the picture [default: the middle of the spheres, or what the scene says]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = position)]
    look_at: Option<DVec3>,
    /// Elevation of the eye above the horizon in degrees, -89 to 89 [default: 12.4]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = within::<-89, 89>)]
    elevation: Option<f64>,
    /// Vertical field of view in degrees, 1 to 120; spheres keep their size [default: 24]
    #[arg(long, value_name = "DEG", value_parser = within::<1, 120>)]
    fov: Option<f64>,
}

impl CameraOptions {
    /// The camera that was asked for, where the scene has `framed`.
    pub fn aim(&self, framed: Camera) -> Camera {
        let framed = Camera {
            target: self.look_at.unwrap_or(framed.target),
            ..framed
        };
        if let Some(eye) = self.eye {
            return Camera {
                eye,
                vertical_angle: self.fov.map_or(framed.vertical_angle, f64::to_radians),
                ..framed
            };
        }
        let Camera {
            eye,
            target,
            vertical_angle: framed_angle,
        } = framed;
        let vertical_angle = self.fov.map_or(framed_angle, f64::to_radians);
        // The nearest points of the spheres, one radius before their centres, keep their size in the picture.
        let zoom = (0.5 * framed_angle).tan() / (0.5 * vertical_angle).tan();
        let distance = ((eye - target).length() - 1.0) * zoom + 1.0;
        let towards = match self.elevation.map(f64::to_radians) {
            Some(elevation) => DVec3::new(0.0, elevation.sin(), elevation.cos()),
            None => (eye - target).normalize(),
        };
        Camera {
            eye: target + towards * distance,
            target,
            vertical_angle,
        }
    }
}

impl CameraOptions {
    /// Puts what was said here before what a scene file says.
    ///
    /// # Errors
    /// [`Error::Argument`] for an elevation: a scene has a place for the eye.
    pub fn override_file(&self, camera: &mut CameraEntry) -> Result<(), Error> {
        if self.elevation.is_some() {
            let what = "--elevation has no effect on a scene file";
            return Err(Error::argument(what, "give --eye X,Y,Z"));
        }
        camera.eye = self.eye.or(camera.eye);
        camera.look_at = self.look_at.or(camera.look_at);
        camera.fov = self.fov.or(camera.fov);
        Ok(())
    }
}

/// "X,Y,Z" as a point.
fn position(argument: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = argument.split(',').map(|n| n.trim().parse().ok()).collect();
    let point = match numbers.as_deref() {
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    };
    point
        .filter(|p| p.is_finite())
        .ok_or_else(|| "expected three numbers, such as 0,2,8".into())
}

/// A number from `LEAST` to `MOST`.
fn within<const LEAST: i32, const MOST: i32>(argument: &str) -> Result<f64, String> {
    let domain = f64::from(LEAST)..=f64::from(MOST);
    let number = argument.parse().ok();
    number
        .filter(|x| domain.contains(x))
        .ok_or_else(|| format!("expected a number from {LEAST} to {MOST}"))
}
