//! Linear RGB and its two reductions to a scalar.

/// Linear RGB: red, green, blue in `x`, `y`, `z`; the unit is that of the quantity it carries.
///
/// The example of [`Image`](crate::image::Image) makes colours and reads them.
pub type Rgb = glam::Vec3;

/// Relative luminance of linear sRGB primaries (ITU-R BT.709 weights); finite for finite channels.
///
/// # Examples
/// ```
/// use merlkit::brdf::Importance;
/// use merlkit::color::{Rgb, luminance, mean};
///
/// let green = Rgb::new(0.0, 1.0, 0.0);
/// assert!(luminance(green) > mean(green));
/// assert_eq!(Importance::Mean.reduce(green), mean(green));
/// ```
#[inline]
pub fn luminance(c: Rgb) -> f32 {
    finite(0.212_671 * c.x + 0.715_160 * c.y + 0.072_169 * c.z, c)
}

/// Mean of the three channels; finite for finite channels.
///
/// The example of [`luminance`] compares the mean with the luminance.
#[inline]
pub fn mean(c: Rgb) -> f32 {
    finite((c.x + c.y + c.z) * (1.0 / 3.0), c)
}

/// A mean of channels ≥ 0; where the sum of the largest f32 overflowed, the largest channel replaces the mean.
#[inline]
fn finite(mean: f32, c: Rgb) -> f32 {
    if mean < f32::INFINITY {
        mean
    } else {
        c.max_element()
    }
}
