//! OpenEXR files: what is written comes back, and what can't be read is explained.

use std::path::Path;

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
    // What is no radiance is read as it is: whoever uses the picture decides.
    let wild = |x: usize, y: usize| match (x, y) {
        (1, 2) => Rgb::new(0.0, -1.0, 0.0),
        (3, 2) => Rgb::splat(f32::INFINITY),
        _ => Rgb::ONE,
    };
    let image = Image::from_fn(8, 4, wild).unwrap();
    write_exr(&file("wild.exr"), &image, Overwrite::Refuse).unwrap();
    assert_eq!(read_exr(&file("wild.exr")).unwrap(), image);
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

/// Writes a picture of 2 × 1 with these channels; channel k has 0.25 k and 0.25 k + 8.
fn write_channels(path: &Path, names: &[&str]) {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
        WritableImage,
    };
    let mut channels = Vec::new();
    for (k, &name) in names.iter().enumerate() {
        let value = 0.25 * k as f32;
        channels.push(AnyChannel::new(
            name,
            FlatSamples::F32(vec![value, value + 8.0]),
        ));
    }
    let layer = Layer::new(
        (2, 1),
        LayerAttributes::named("layer"),
        Encoding::UNCOMPRESSED,
        AnyChannels::sort(channels.into_iter().collect()),
    );
    Image::from_layer(layer).write().to_file(path).unwrap();
}

#[test]
fn colours_of_exr_files_are_found_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let first = |names: &[&str]| {
        write_channels(&path, names);
        let image = read_exr(&path).unwrap();
        assert_eq!((image.width(), image.height()), (2, 1));
        assert_eq!(image.pixel(1, 0), image.pixel(0, 0) + 8.0);
        image.pixel(0, 0)
    };
    assert_eq!(first(&["A", "B", "G", "R"]), Rgb::new(0.75, 0.5, 0.25));
    assert_eq!(first(&["A", "Y"]), Rgb::splat(0.25));
    let combined = [
        "ViewLayer.Combined.A",
        "ViewLayer.Combined.B",
        "ViewLayer.Combined.G",
        "ViewLayer.Combined.R",
        "ViewLayer.Depth.Z",
    ];
    assert_eq!(first(&combined), Rgb::new(0.75, 0.5, 0.25));
    // Channels without a layer's name go first.
    let both = ["B", "G", "R", "a.B", "a.G", "a.R", "Y"];
    assert_eq!(first(&both), Rgb::new(0.5, 0.25, 0.0));
    for (names, expected) in [
        (&["Z", "A"][..], "channels A, Z, not R, G and B or Y alone"),
        (&["Y", "RY", "BY"], "channels BY, RY, Y, not"),
        (&["R", "G"], "channels G, R, not"),
        (
            &["a.R", "a.G", "a.B", "b.R", "b.G", "b.B"],
            "several layers of colours (a, b)",
        ),
    ] {
        write_channels(&path, names);
        let text = read_exr(&path).unwrap_err().to_string();
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn an_exr_file_that_ends_early_is_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.exr");
    write_channels(&path, &["R", "G", "B"]);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 3]).unwrap();
    let text = read_exr(&path).unwrap_err().to_string();
    let place = format!("at byte {}: ", bytes.len() - 3);
    assert!(text.contains(&place) && text.contains("cut off"), "{text}");
}
