//! Radiance, PFM and PNG pictures, written here: what was written comes back, and what can't be read is explained.

use std::path::Path;

use merlkit::color::Rgb;
use merlkit::image::{Image, decode_image, encode_png, read_image};

fn decode(bytes: &[u8]) -> Image {
    decode_image(bytes, Path::new("sky")).unwrap()
}

fn message(bytes: &[u8]) -> String {
    decode_image(bytes, Path::new("sky"))
        .unwrap_err()
        .to_string()
}

type Rgbe = [u8; 4];

/// A Radiance picture with these lines in its header.
fn radiance(lines: &str, resolution: &str, body: &[u8]) -> Vec<u8> {
    let head = format!("#?RADIANCE\n{lines}\n{resolution}\n");
    [head.as_bytes(), body].concat()
}

/// A row in the new encoding: repeated bytes as runs, others as they are.
fn encode_new(row: &[Rgbe]) -> Vec<u8> {
    let mut out = vec![2, 2, (row.len() >> 8) as u8, row.len() as u8];
    for channel in 0..4 {
        let mut x = 0;
        while x < row.len() {
            let value = row[x][channel];
            let run = row[x..]
                .iter()
                .take(127)
                .take_while(|p| p[channel] == value)
                .count();
            if run > 2 {
                out.extend([128 + run as u8, value]);
            } else {
                out.push(run as u8);
                out.extend(std::iter::repeat_n(value, run));
            }
            x += run;
        }
    }
    out
}

/// Rows of 300 pixels with long and short runs.
fn pixels() -> Vec<Rgbe> {
    let mut pixels = Vec::new();
    for i in 0..600u32 {
        let pixel = match i % 300 {
            0..200 => [128, 64, 32, 129],
            x => [x as u8, 7, (x % 5) as u8, 120 + (x % 16) as u8],
        };
        pixels.push(pixel);
    }
    pixels
}

fn expected([r, g, b, e]: Rgbe) -> Rgb {
    let scale = 2f32.powi(i32::from(e) - 136);
    Rgb::new(f32::from(r), f32::from(g), f32::from(b)) * scale
}

#[test]
fn radiance_pictures_are_read_flat_and_in_both_encodings() {
    let pixels = pixels();
    let flat: Vec<u8> = pixels.concat();
    let new: Vec<u8> = pixels.chunks(300).flat_map(encode_new).collect();
    // The first 200 pixels of each row are one, repeated 199 times.
    let mut old = Vec::new();
    for row in pixels.chunks(300) {
        old.extend(row[0]);
        old.extend([1, 1, 1, 199]);
        old.extend(row[200..].concat());
    }
    for body in [&flat, &new, &old] {
        let image = decode(&radiance("FORMAT=32-bit_rle_rgbe\n", "-Y 2 +X 300", body));
        assert_eq!((image.width(), image.height()), (300, 2));
        for (found, pixel) in image.pixels().iter().zip(&pixels) {
            assert_eq!(*found, expected(*pixel));
        }
    }
    assert_eq!(expected(pixels[0]), Rgb::new(1.0, 0.5, 0.25));
    // Two counts in a row: 3 + 256 · 1 repeats.
    let long = [[9, 9, 9, 130], [1, 1, 1, 3], [1, 1, 1, 1]].concat();
    let image = decode(&radiance("", "-Y 1 +X 260", &long));
    assert!(
        image
            .pixels()
            .iter()
            .all(|&c| c == expected([9, 9, 9, 130]))
    );
    // An exponent of 0 is black whatever the mantissas say.
    assert_eq!(
        decode(&radiance("", "-Y 1 +X 1", &[9, 9, 9, 0])).pixel(0, 0),
        Rgb::ZERO
    );
}

#[test]
fn radiance_headers_say_exposure_and_orientation() {
    let body = [
        [128, 0, 0, 129],
        [0, 128, 0, 129],
        [0, 0, 128, 129],
        [128, 128, 128, 129],
    ]
    .concat();
    let read = |lines: &str, resolution: &str| decode(&radiance(lines, resolution, &body));
    let (red, green, blue, white) = (Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE);
    assert_eq!(read("", "-Y 2 +X 2").pixels(), [red, green, blue, white]);
    assert_eq!(read("", "+Y 2 +X 2").pixels(), [blue, white, red, green]);
    assert_eq!(read("", "-Y 2 -X 2").pixels(), [green, red, white, blue]);
    // Factors multiply, and were multiplied into the values.
    let exposed = read("EXPOSURE=4\nVIEW=-vtv\nEXPOSURE= 0.5\n", "-Y 2 +X 2");
    assert_eq!(exposed.pixel(0, 0), red / 2.0);
}

#[test]
fn bad_radiance_pictures_are_explained() {
    let row = encode_new(&[[1, 2, 3, 4]; 16]);
    let good = radiance("", "-Y 1 +X 16", &row);
    let start = good.len() - row.len();
    assert_eq!(decode(&good).width(), 16);
    for (bytes, expected) in [
        (
            radiance("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1", &[0; 4]),
            "ra_xyze -r sky",
        ),
        (
            radiance("FORMAT=float\n", "-Y 1 +X 1", &[0; 4]),
            "at byte 11: expected FORMAT=32-bit_rle_rgbe, found float",
        ),
        (
            radiance("EXPOSURE=0\n", "-Y 1 +X 1", &[0; 4]),
            "expected an exposure above 0",
        ),
        (radiance("", "+X 1 -Y 1", &[0; 4]), "stored by columns"),
        (
            radiance("", "-Y one +X 1", &[0; 4]),
            "expected a resolution, as -Y 512 +X 1024, found -Y one +X 1",
        ),
        (radiance("", "-Y 0 +X 1", &[0; 4]), "a picture of 1 × 0"),
        (
            radiance("", "-Y 65536 +X 65536", &[0; 4]),
            "at most 134217728",
        ),
        (
            radiance("", "-Y 8192 +X 16384", &[0; 4]),
            "4 bytes, which can't hold it",
        ),
        (
            radiance("", "-Y 1 +X 2", &[1, 1, 1, 2, 0, 0, 0, 0]),
            "found a run of 2 in column 0",
        ),
        (
            radiance("", "-Y 1 +X 2", &[7, 7, 7, 2, 1, 1, 1, 2]),
            "found a run of 2 in column 1",
        ),
        (
            radiance("", "-Y 1 +X 16", &[2, 2, 0, 17, 0]),
            "found one of 17",
        ),
        (
            radiance("", "-Y 1 +X 16", &[2, 2, 0, 16, 0]),
            "found one of 0",
        ),
        (
            radiance("", "-Y 1 +X 16", &[2, 2, 0, 16, 128 + 17, 0]),
            "expected a run of 1 to 16 bytes, found one of 17",
        ),
        (good[..good.len() - 1].to_vec(), "cut off"),
        (b"#?RADIANCE\nFORM".to_vec(), "cut off"),
    ] {
        let text = message(&bytes);
        assert!(
            text.starts_with("sky: ") && text.contains(expected),
            "{text}"
        );
    }
    for cut in 2..good.len() {
        let text = message(&good[..cut]);
        assert!(
            text.contains(&format!("at byte {cut}: ")) || cut < start,
            "{text}"
        );
    }
}

/// A PFM picture of these rows, the top one first.
fn pfm(kind: &str, scale: &str, rows: &[&[f32]], width: usize) -> Vec<u8> {
    let mut out = format!("{kind}\n{width} {}\n{scale}\n", rows.len()).into_bytes();
    for row in rows.iter().rev() {
        for value in *row {
            match scale.starts_with('-') {
                true => out.extend(value.to_le_bytes()),
                false => out.extend(value.to_be_bytes()),
            }
        }
    }
    out
}

#[test]
fn pfm_pictures_are_read_in_both_byte_orders() {
    let rows: [&[f32]; 2] = [
        &[1.0, 2.0, 3.0, 4e30, -5.0, f32::INFINITY],
        &[0.0, 1e-30, 0.5, 7.0, 8.0, 9.0],
    ];
    for scale in ["-1.0", "1.0"] {
        let image = decode(&pfm("PF", scale, &rows, 2));
        assert_eq!((image.width(), image.height()), (2, 2));
        assert_eq!(image.pixel(0, 0), Rgb::new(1.0, 2.0, 3.0));
        assert_eq!(image.pixel(1, 0), Rgb::new(4e30, -5.0, f32::INFINITY));
        assert_eq!(image.pixel(1, 1), Rgb::new(7.0, 8.0, 9.0));
    }
    let grey = decode(&pfm("Pf", "-2", &[&[1.0, 0.25]], 2));
    assert_eq!(grey.pixels(), [Rgb::splat(2.0), Rgb::splat(0.5)]);
}

#[test]
fn bad_pfm_pictures_are_explained() {
    let good = pfm("PF", "-1", &[&[1.0, 2.0, 3.0]], 1);
    let text = |old: &str, new: &str| {
        let head = String::from_utf8(good[..10].to_vec())
            .unwrap()
            .replace(old, new);
        message(&[head.as_bytes(), &good[10..]].concat())
    };
    assert!(text("1 1", "x 1").contains("at byte 2: expected a width, found \"x\""));
    assert!(text("1 1", "1 0").contains("expected a height"));
    assert!(text("-1", "0").contains("expected a scale other than 0"));
    assert!(text("1 1", "99999999999 1").contains("at most 134217728"));
    assert!(text("1 1", "16384 8192").contains("expected 1610612736 bytes"));
    assert!(text("-1\n", "-1\r\n").contains("line feed alone"));
    assert!(message(&good[..good.len() - 1]).contains("found 11 bytes; fetch the file again"));
    for cut in 3..good.len() {
        assert!(!message(&good[..cut]).is_empty());
    }
}

/// A PNG of one row; `chunks` adds to its header.
fn png(
    color: png::ColorType,
    depth: png::BitDepth,
    width: u32,
    bytes: &[u8],
    gamma: Option<f32>,
) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, 1);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 188, 0]);
    }
    if let Some(gamma) = gamma {
        encoder.set_source_gamma(png::ScaledFloat::new(gamma));
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(bytes).unwrap();
    writer.finish().unwrap();
    out
}

#[test]
fn png_pictures_become_linear() {
    use png::{BitDepth, ColorType};
    let near = |found: Rgb, expected: [f32; 3]| {
        let expected = Rgb::from_array(expected);
        assert!(
            (found - expected).abs().max_element() < 1e-6,
            "{found} {expected}"
        );
    };
    // sRGB by IEC 61966-2-1: 188/255 is 0.502886, 10/255 (on the line) 0.00303527.
    let rgb = decode(&encode_png(2, 1, &[255, 188, 10, 0, 0, 128]).unwrap());
    near(rgb.pixel(0, 0), [1.0, 0.502_886_5, 0.003_035_27]);
    near(rgb.pixel(1, 0), [0.0, 0.0, 0.215_860_5]);
    let fine = decode(&png(
        ColorType::Grayscale,
        BitDepth::Sixteen,
        2,
        &[0x80, 0, 0xff, 0xff],
        None,
    ));
    near(fine.pixel(0, 0), [0.214_048_2; 3]);
    near(fine.pixel(1, 0), [1.0; 3]);
    let indexed = decode(&png(
        ColorType::Indexed,
        BitDepth::One,
        2,
        &[0b0100_0000],
        None,
    ));
    near(indexed.pixel(0, 0), [0.0; 3]);
    near(indexed.pixel(1, 0), [1.0, 0.502_886_5, 0.0]);
    // A stated exponent goes before, unless it is the one that means sRGB.
    let linear = decode(&png(
        ColorType::Grayscale,
        BitDepth::Eight,
        1,
        &[51],
        Some(1.0),
    ));
    near(linear.pixel(0, 0), [0.2; 3]);
    let usual = decode(&png(
        ColorType::Grayscale,
        BitDepth::Eight,
        1,
        &[188],
        Some(1.0 / 2.2),
    ));
    near(usual.pixel(0, 0), [0.502_886_5; 3]);
    let opaque = decode(&png(
        ColorType::Rgba,
        BitDepth::Eight,
        1,
        &[255, 0, 0, 255],
        None,
    ));
    near(opaque.pixel(0, 0), [1.0, 0.0, 0.0]);
}

#[test]
fn bad_png_pictures_are_explained() {
    use png::{BitDepth, ColorType};
    let clear = png(ColorType::Rgba, BitDepth::Eight, 1, &[255, 0, 0, 254], None);
    assert!(message(&clear).contains("transparent pixels is not supported; fill them: magick sky"));
    let good = encode_png(16, 8, &[77; 16 * 8 * 3]).unwrap();
    for cut in 8..good.len() {
        let text = message(&good[..cut]);
        assert!(text.contains("cut off"), "{cut}: {text}");
    }
    // Its width, with the checksum that belongs to it.
    let mut lie = good.clone();
    lie[16..20].copy_from_slice(&0x0100_0000u32.to_be_bytes());
    assert!(message(&lie).contains("PNG"), "{}", message(&lie));
    for at in 8..good.len() {
        let mut changed = good.clone();
        changed[at] ^= 0x55;
        let _ = decode_image(&changed, Path::new("sky"));
    }
}

#[test]
fn formats_are_recognised_whatever_the_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.exr");
    std::fs::write(&path, radiance("", "-Y 1 +X 1", &[128, 128, 128, 129])).unwrap();
    assert_eq!(read_image(&path).unwrap().pixel(0, 0), Rgb::ONE);
    std::fs::write(&path, b"\xff\xd8\xff\xe0\0\x10JFIF").unwrap();
    let text = read_image(&path).unwrap_err().to_string();
    assert!(
        text.contains("a JPEG picture is not supported; convert it: magick"),
        "{text}"
    );
    std::fs::write(&path, b"").unwrap();
    let text = read_image(&path).unwrap_err().to_string();
    assert!(text.contains("found an empty file"), "{text}");
}

/// Radiance 0.2 everywhere but 50 at row 10, column 30, written by the OpenEXR library 3.x from Python, not by this one.
const BY_OPENEXR: [(&str, &[u8], f32); 2] = [
    // Lossy blocks of 8 × 8 pixels.
    ("DWAA", include_bytes!("../golden/dwaa.exr"), 0.15),
    // Channels as Blender names them: ViewLayer.Combined.R, and a depth.
    ("layered", include_bytes!("../golden/layered.exr"), 1e-6),
];

#[test]
fn files_of_the_openexr_library_are_read() {
    for (name, bytes, tolerance) in BY_OPENEXR {
        let picture = decode(bytes);
        assert_eq!((picture.width(), picture.height()), (128, 64), "{name}");
        for (x, y, expected) in [(30, 10, 50.0_f32), (90, 40, 0.2), (0, 0, 0.2)] {
            let found = picture.pixels()[y * 128 + x];
            let error = (found - Rgb::splat(expected)).abs().max_element();
            assert!(error <= tolerance * expected, "{name} at {x}, {y}: {found}");
        }
    }
}
