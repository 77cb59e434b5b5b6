//! Linear light on its way to the screen: exposure, tone curve, sRGB.

use super::Image;
use crate::color::Rgb;

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
/// encoded by the sRGB transfer function (IEC 61966-2-1). Of a picture with alpha and without a backdrop, four bytes each: the last
/// is alpha, and the colours are not multiplied by it.
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
pub fn encode_srgb(image: &Image, exposure: f32) -> Vec<u8> {
    let gain = exposure.exp2();
    let mut bytes = Vec::with_capacity(4 * image.pixels().len());
    for (i, colour) in image.pixels().iter().enumerate() {
        let alpha = image.alpha().map_or(1.0, |alpha| alpha[i]);
        let seen = straight(*colour, alpha).map(|x| tone_map(x * gain));
        if image.file_alpha().is_some() {
            bytes.extend(seen.map(|x| to_byte(srgb(x))));
            bytes.push(to_byte(alpha));
            continue;
        }
        // The curve is for what covers the pixel, not for the backdrop, which is as it is to be seen.
        let behind = (1.0 - alpha) * image.backdrop.unwrap_or(Rgb::ZERO);
        for (x, behind) in seen.into_iter().zip(behind.to_array()) {
            bytes.push(to_byte(srgb(x * alpha + behind)));
        }
    }
    bytes
}

/// The colour of what covers a pixel: c/α, and 0 where nothing does.
fn straight(colour: Rgb, alpha: f32) -> [f32; 3] {
    match alpha {
        1.0 => colour.to_array(),
        _ if alpha > 0.0 => (colour / alpha).to_array(),
        _ => [0.0; 3],
    }
}

fn to_byte(x: f32) -> u8 {
    (x * 255.0).round() as u8
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

    #[test]
    fn a_backdrop_is_seen_as_it_is_and_alpha_divides_the_colour() {
        let half = Image::new(2, 1, vec![Rgb::splat(0.25), Rgb::ZERO]).unwrap();
        let half = half.with_alpha(vec![0.5, 0.0]).unwrap();
        let bytes = encode_srgb(&half, 0.0);
        assert_eq!(bytes, [188, 188, 188, 128, 0, 0, 0, 0]);
        let white = half.clone().with_backdrop(Rgb::ONE);
        // 0.5·0.5 + 0.5 = 0.75 linear is byte 225; white stays white at any exposure.
        assert_eq!(encode_srgb(&white, 0.0), [225, 225, 225, 255, 255, 255]);
        assert_eq!(encode_srgb(&white, -3.0)[3..], [255, 255, 255]);
        assert!(half.with_alpha(vec![1.0]).is_err());
    }
}
