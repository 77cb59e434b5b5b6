//! Comments of PNG files that were made without one.

use merlkit::Error;

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
