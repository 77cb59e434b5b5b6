//! Where objects are put.

use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot};

/// Scaled, then turned about x, y and z in this order, then moved.
pub(crate) fn place(translate: DVec3, degrees: DVec3, scale: DVec3) -> DAffine3 {
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    // The product of quaternions z·y·x turns about x first.
    let turned = match degrees == DVec3::ZERO {
        true => DMat3::IDENTITY,
        false => DMat3::from_quat(DQuat::from_euler(EulerRot::ZYX, z, y, x)),
    };
    DAffine3 {
        matrix3: turned * DMat3::from_diagonal(scale),
        translation: translate,
    }
}
