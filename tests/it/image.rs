//! OpenEXR files: what is written comes back, and what can't be read is explained.

use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::image::{Image, read_exr, write_exr};

#[test]
fn exr_files_keep_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let value =
        |x: usize, y: usize| Rgb::new(x as f32 * 1e-20, y as f32 * 1e20, 1.0 / (x + y + 1) as f32);
    let image = Image::from_fn(37, 19, value).unwrap();
    write_exr(&path, &image, Overwrite::Refuse).unwrap();
    assert_eq!(read_exr(&path).unwrap(), image);
    let again = write_exr(&path, &image, Overwrite::Refuse)
        .unwrap_err()
        .to_string();
    assert!(again.contains("--force"), "{again}");
    write_exr(&path, &image, Overwrite::Replace).unwrap();
}

#[test]
fn bad_exr_files_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let message = |name: &str| read_exr(&file(name)).unwrap_err().to_string();
    assert!(
        message("missing.exr").contains("cannot open"),
        "{}",
        message("missing.exr")
    );
    std::fs::write(file("text.exr"), "not a picture").unwrap();
    assert!(
        message("text.exr").contains("expected an OpenEXR file"),
        "{}",
        message("text.exr")
    );
    std::fs::write(file("empty.exr"), "").unwrap();
    assert!(
        message("empty.exr").contains("expected an OpenEXR file"),
        "{}",
        message("empty.exr")
    );
    let bad = |x: usize, y: usize| match (x, y) {
        (1, 2) => Rgb::new(0.0, -1.0, 0.0),
        (2, 2) => Rgb::splat(f32::NAN),
        (3, 2) => Rgb::splat(f32::INFINITY),
        _ => Rgb::ONE,
    };
    let image = Image::from_fn(8, 4, bad).unwrap();
    write_exr(&file("bad.exr"), &image, Overwrite::Refuse).unwrap();
    let text = message("bad.exr");
    assert!(
        text.contains("1 pixels with a negative") && text.contains("2 with NaN"),
        "{text}"
    );
    assert!(text.contains("column 1, row 2"), "{text}");
    // Cut off anywhere, changed anywhere: an error or a picture, never a panic.
    let good = Image::from_fn(16, 16, |x, y| Rgb::splat((x * y) as f32)).unwrap();
    write_exr(&file("good.exr"), &good, Overwrite::Refuse).unwrap();
    let bytes = std::fs::read(file("good.exr")).unwrap();
    for cut in (0..bytes.len()).step_by(7) {
        std::fs::write(file("cut.exr"), &bytes[..cut]).unwrap();
        assert!(read_exr(&file("cut.exr")).is_err(), "cut at {cut}");
    }
    for at in 0..bytes.len().min(600) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x55;
        std::fs::write(file("changed.exr"), &changed).unwrap();
        let _ = read_exr(&file("changed.exr"));
    }
}

#[test]
fn one_channel_exr_files_are_not_supported() {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
        WritableImage,
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.exr");
    let grey = AnyChannel::new("Y", FlatSamples::F32(vec![0.5; 4]));
    let channels = AnyChannels::sort([grey].into_iter().collect());
    let layer = Layer::new(
        (2, 2),
        LayerAttributes::named("grey"),
        Encoding::UNCOMPRESSED,
        channels,
    );
    Image::from_layer(layer).write().to_file(&path).unwrap();
    let message = read_exr(&path).unwrap_err().to_string();
    assert!(message.contains("channels R, G and B"), "{message}");
}
