//! PNG from SVG, in builds with the feature `png-plots`, and the comments of PNG files.

use merlkit::Error;

/// Pixels for each of the SVG's.
#[cfg(feature = "png-plots")]
const SCALE: f32 = 2.0;

/// Whether PNG can be made at all.
///
/// # Errors
/// [`Error::Argument`] in a build that can't.
pub fn check() -> Result<(), Error> {
    if cfg!(feature = "png-plots") {
        return Ok(());
    }
    Err(Error::argument(
        "this build writes SVG only",
        "name a file that ends in .svg, or build with --features png-plots",
    ))
}

/// The picture at twice its size on white, its text in a sans-serif font of the system.
///
/// # Errors
/// [`Error::Argument`] where the system has no font.
#[cfg(feature = "png-plots")]
pub fn png(svg: &str) -> Result<Vec<u8>, Error> {
    use resvg::{tiny_skia, usvg};
    let mut options = usvg::Options::default();
    options.fontdb_mut().load_system_fonts();
    // Which font is the system's sans-serif is not asked; by default it would be one that few systems have.
    let family = sans_serif(&options.fontdb).ok_or_else(|| {
        let fix = "install one, such as the package fonts-dejavu, or name a file that ends in .svg";
        Error::argument("there is no font for the picture's text", fix)
    })?;
    options.fontdb_mut().set_sans_serif_family(&family);
    options.font_family = family;
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| broken(e.to_string()))?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|side| (side * SCALE).ceil() as u32);
    let mut pixels =
        tiny_skia::Pixmap::new(width, height).ok_or_else(|| broken("it has no size".into()))?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(
        &tree,
        tiny_skia::Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(|e| broken(e.to_string()))
}

#[cfg(feature = "png-plots")]
fn broken(why: String) -> Error {
    Error::argument(
        format!("the picture could not be drawn: {why}"),
        "report this",
    )
}

/// A family for text: one that calls itself sans, but for those of equal widths, or else any.
#[cfg(feature = "png-plots")]
fn sans_serif(fonts: &resvg::usvg::fontdb::Database) -> Option<String> {
    let names = || {
        fonts
            .faces()
            .filter_map(|face| face.families.first())
            .map(|family| family.0.clone())
    };
    names()
        .find(|n| n.contains("Sans") && !n.contains("Mono"))
        .or_else(|| names().next())
}

/// As [`check`].
///
/// # Errors
/// Always.
#[cfg(not(feature = "png-plots"))]
pub fn png(_: &str) -> Result<Vec<u8>, Error> {
    check().map(|()| Vec::new())
}

/// The same PNG with lines of text under the keyword `Comment`, as [`merlkit::image::write_png`] writes them.
///
/// # Errors
/// [`Error::Argument`] for bytes that are no PNG.
pub fn with_comment(png: &[u8], lines: &[String]) -> Result<Vec<u8>, Error> {
    add_comment(png, lines.join("\n")).map_err(|e| {
        let what = format!("the picture's text could not be written: {e}");
        Error::argument(what, "report this")
    })
}

fn add_comment(png: &[u8], text: String) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info()?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut pixels = vec![0; size];
    let frame = reader.next_frame(&mut pixels)?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, frame.width, frame.height);
    encoder.set_color(frame.color_type);
    encoder.set_depth(frame.bit_depth);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_itxt_chunk("Comment".into(), text)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels[..frame.buffer_size()])?;
    writer.finish()?;
    Ok(bytes)
}
