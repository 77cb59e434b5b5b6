//! Linear light on its way to the screen: exposure, tone curve, sRGB.

use super::Image;

/// Where the tone curve leaves the straight line.
const SHOULDER: f32 = 0.5;

/// A linear channel on its way to the screen, in [0, 1), still linear.
///
/// The identity up to ½, so that mid-tones keep their ratios, then an exponential shoulder that approaches 1 and joins the
/// line without a kink: ½ + ½(1 − exp(1 − 2x)). A negative or NaN channel is 0.
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
pub fn tone_map(x: f32) -> f32 {
    if x <= SHOULDER || x.is_nan() {
        return x.max(0.0);
    }
    let room = 1.0 - SHOULDER;
    SHOULDER + room * -((SHOULDER - x) / room).exp_m1()
}

/// The picture's pixels as 8-bit sRGB, three bytes each: each channel is multiplied by 2^`exposure`, passes [`tone_map`] and is
/// encoded by the sRGB transfer function (IEC 61966-2-1).
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
pub fn encode_srgb(image: &Image, exposure: f32) -> Vec<u8> {
    let gain = exposure.exp2();
    let mut bytes = Vec::with_capacity(3 * image.pixels().len());
    for colour in image.pixels() {
        for x in colour.to_array() {
            bytes.push((srgb(tone_map(x * gain)) * 255.0).round() as u8);
        }
    }
    bytes
}

/// sRGB's transfer function, from linear [0, 1] to encoded [0, 1].
fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn the_tone_curve_starts_as_a_line_and_approaches_one() {
        assert_eq!(tone_map(0.25), 0.25);
        assert_eq!(tone_map(-1.0), 0.0);
        assert_eq!(tone_map(f32::NAN), 0.0);
        assert_eq!(tone_map(f32::INFINITY), 1.0);
        let h = 1e-3;
        let slope = (tone_map(SHOULDER + h) - tone_map(SHOULDER)) / h;
        assert!((slope - 1.0).abs() < 5e-3, "kink at the shoulder: {slope}");
        assert!((1..60).all(|i| tone_map(i as f32 * 0.1) > tone_map((i - 1) as f32 * 0.1)));
    }

    #[test]
    fn bytes_are_srgb_of_the_exposed_value() {
        let image = Image::new(
            2,
            1,
            vec![Rgb::splat(0.214_041_14), Rgb::new(0.0, 0.5, 1e9)],
        )
        .unwrap();
        // sRGB 0.5 is linear 0.21404; 0.5 linear is byte 188.
        assert_eq!(encode_srgb(&image, 0.0), [128, 128, 128, 0, 188, 255]);
        assert_eq!(
            encode_srgb(&image, 1.0)[..3],
            encode_srgb(
                &Image::new(1, 1, vec![Rgb::splat(2.0 * 0.214_041_14)]).unwrap(),
                0.0
            )
        );
    }
}
