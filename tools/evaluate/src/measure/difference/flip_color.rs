//! The colour spaces of FLIP: linear RGB (sRGB's primaries, D65), YCxCz for filters, CIELAB for distances.

use glam::{DMat3, DVec3};

/// Columns of the matrix from linear RGB to CIE XYZ, from the chromaticities of sRGB's primaries and of D65 (IEC 61966-2-1).
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(
        10_135_552.0 / 24_577_794.0,
        2_613_072.0 / 12_288_897.0,
        1_425_312.0 / 73_733_382.0,
    ),
    DVec3::new(
        8_788_810.0 / 24_577_794.0,
        8_788_810.0 / 12_288_897.0,
        8_788_810.0 / 73_733_382.0,
    ),
    DVec3::new(
        4_435_075.0 / 24_577_794.0,
        887_015.0 / 12_288_897.0,
        70_074_185.0 / 73_733_382.0,
    ),
);

/// XYZ over that of white.
fn relative_xyz(rgb: DVec3) -> DVec3 {
    (XYZ_FROM_RGB * rgb) / (XYZ_FROM_RGB * DVec3::ONE)
}

/// Y, Cx, Cz: linear in the light, with opponent channels: Y = 116·y − 16, Cx = 500·(x − y), Cz = 200·(y − z).
pub(super) fn opponent_from_rgb(rgb: DVec3) -> DVec3 {
    let xyz = relative_xyz(rgb);
    DVec3::new(
        116.0 * xyz.y - 16.0,
        500.0 * (xyz.x - xyz.y),
        200.0 * (xyz.y - xyz.z),
    )
}

/// The inverse of [`opponent_from_rgb`].
pub(super) fn rgb_from_opponent(c: DVec3) -> DVec3 {
    let y = (c.x + 16.0) / 116.0;
    let relative = DVec3::new(y + c.y / 500.0, y, y - c.z / 200.0);
    XYZ_FROM_RGB.inverse() * (relative * (XYZ_FROM_RGB * DVec3::ONE))
}

/// CIELAB whose opponent channels are scaled by 0.01·L: colours differ less where it is dark (Hunt).
pub(super) fn hunt_lab_from_rgb(rgb: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let mut f = relative_xyz(rgb);
    for channel in 0..3 {
        let t = f[channel];
        f[channel] = if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        };
    }
    let lightness = 116.0 * f.y - 16.0;
    let hunt = 0.01 * lightness;
    DVec3::new(
        lightness,
        hunt * 500.0 * (f.x - f.y),
        hunt * 200.0 * (f.y - f.z),
    )
}

/// HyAB: the distance of lightness and that of the opponent channels, added (Abasi et al. 2020).
pub(super) fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}
