//! Pictures of every format that is read.

use super::*;

/// A byte of a Radiance picture may stand for 1024 pixels of 12 bytes, held in rows, joined and as they grow; one of a PNG for
/// 1032 bytes of 8 pixels, unpacked to 4 bytes each.
const PICTURE_FACTOR: usize = 4 * 12 * 1032;

/// Our own file and one of each compression that the reader knows.
fn pictures() -> Vec<Vec<u8>> {
    use exr::prelude::{Blocks, WritableImage};
    use exr::prelude::{
        Compression, Encoding, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2,
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(
        &path,
        &Image::from_fn(3, 2, |x, y| Rgb::splat((x + y) as f32)).unwrap(),
        Overwrite::Refuse,
    )
    .unwrap();
    let mut all = vec![std::fs::read(&path).unwrap()];
    for (compression, blocks) in [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::Tiles(Vec2(2, 2))),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44, Blocks::ScanLines),
    ] {
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        let channels = SpecificChannels::rgb(|Vec2(x, y)| (x as f32, y as f32, 0.5f32));
        let layer = Layer::new((4, 3), LayerAttributes::named("l"), encoding, channels);
        let mut bytes = std::io::Cursor::new(Vec::new());
        exr::prelude::Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(&mut bytes)
            .unwrap();
        all.push(bytes.into_inner());
    }
    all
}

#[test]
fn pictures_as_openexr() {
    let seeds = pictures();
    assert!(seeds.iter().all(|s| exercise::picture(s)));
    let make = |random: &mut Stream| {
        let mut bytes = seeds[below(random, seeds.len())].clone();
        if below(random, 2) == 0 {
            scramble(&mut bytes, random);
        } else {
            // A number of the header: sizes, types, offsets.
            let at = below(random, bytes.len().min(420));
            overwrite(&mut bytes, at, 4, NASTY[below(random, NASTY.len())]);
        }
        bytes
    };
    drive("exr", EXR_FACTOR, 1, make, exercise::picture);
}

#[test]
fn pictures_of_other_formats() {
    let radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n";
    let new_row = [
        2, 2, 0, 8, 130, 7, 6, 1, 2, 3, 4, 5, 6, 136, 9, 136, 10, 136, 129,
    ];
    let old_row = [1, 2, 3, 129, 1, 1, 1, 7];
    let pfm = b"PF\n2 1\n-1.0\n";
    let pixels: Vec<u8> = (0..6).flat_map(|i| (i as f32).to_le_bytes()).collect();
    let png = merlkit::image::encode_png(5, 3, &[99; 45]).unwrap();
    let seeds = [
        [&radiance[..], &new_row, &old_row].concat(),
        [&pfm[..], &pixels].concat(),
        png,
    ];
    assert!(seeds.iter().all(|s| exercise::picture(s)));
    let make = |random: &mut Stream| {
        let mut bytes = seeds[below(random, seeds.len())].clone();
        scramble(&mut bytes, random);
        bytes
    };
    drive("picture", PICTURE_FACTOR, 1, make, exercise::picture);
}
