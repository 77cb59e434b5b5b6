//! Linear RGB and its two reductions to a scalar.

/// Linear RGB: red, green, blue in `x`, `y`, `z`; the unit is that of the quantity it carries.
pub type Rgb = glam::Vec3;

/// Relative luminance of linear sRGB primaries (ITU-R BT.709 weights).
pub fn luminance(c: Rgb) -> f32 {
    0.212_671 * c.x + 0.715_160 * c.y + 0.072_169 * c.z
}

/// Mean of the three channels.
pub fn mean(c: Rgb) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}
