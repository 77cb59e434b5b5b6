//! Pictures over two axes.

use super::Caption;
use super::area::Area;
use super::axis::{Axis, Ruler};
use super::cartesian::{Frame, MARGIN};
use super::colours::viridis;
use super::drawing::{ChartSize, Drawing, Element, INK, Paint, Raster, Stroke};
use super::text::{Anchor, TEXT, shortened, width_of};
use merlkit::image::{Image, encode_png};
use merlkit::{Error, Result};

/// What the pixels are.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// A colour of the bar for each value, row after row from the top: `[y][x]`.
    Values {
        /// Columns.
        width: usize,
        /// The values; a whole number of rows. One that the scale can't hold is white.
        values: Vec<f64>,
        /// Title, scale and range of the colours.
        bar: Axis,
    },
    /// Linear RGB, cut off at 0 and 1 and shown with gamma 2.2.
    Picture {
        /// The picture, top row first.
        image: Image,
        /// Stops by which it is made brighter.
        exposure: f32,
    },
}

/// A picture with axes, and with a bar of its colours if they stand for values.
#[derive(Clone, Debug, PartialEq)]
pub struct Heat {
    /// What it is.
    pub caption: Caption,
    /// The axis across, from the left to the right edge; its range must be given.
    pub x: Axis,
    /// The axis upwards, from the lower to the upper edge; its range must be given.
    pub y: Axis,
    /// The pixels; they are spread evenly over the axes' scales.
    pub pixels: Pixels,
}

/// Right of the picture: the bar and its labels.
const BAR_GAP: f64 = 20.0;
const BAR: f64 = 16.0;
const RIGHT_OF_BAR: f64 = 82.0;
/// Steps of the bar.
const SHADES: usize = 256;

impl Heat {
    /// The picture: 640 by 440 pixels or so, the pixels a PNG in it.
    ///
    /// # Errors
    /// [`Error::Argument`] if values do not fill whole rows, or an axis has no range.
    pub fn svg(&self) -> Result<String> {
        self.svg_sized(ChartSize::default())
    }

    /// The picture in another size.
    ///
    /// # Errors
    /// As [`Self::svg`].
    pub fn svg_sized(&self, size: ChartSize) -> Result<String> {
        Ok(self.drawing(size)?.svg())
    }

    /// The shapes of the picture.
    ///
    /// # Errors
    /// As [`Self::svg`].
    pub fn drawing(&self, size: ChartSize) -> Result<Drawing> {
        let axes = (&self.x, &self.y);
        let right = match &self.pixels {
            Pixels::Values { .. } => BAR_GAP + BAR + RIGHT_OF_BAR,
            Pixels::Picture { .. } => MARGIN,
        };
        let nothing = std::iter::empty;
        let frame = Frame::new(axes, nothing(), nothing(), right, Vec::new(), size);
        if frame.rulers.is_none() {
            return Err(Error::argument(
                "an axis of a picture has no range",
                "give both axes a range",
            ));
        }
        let mut drawing = frame.begin(&self.caption, axes, false);
        let Some(bytes) = self.bytes()? else {
            drawing.no_data(&frame.area);
            return Ok(drawing);
        };
        let (width, height) = self.columns_and_rows()?;
        embed(&mut drawing, &frame.area, raster(width, height, bytes)?);
        if let Pixels::Values { values, bar, .. } = &self.pixels {
            draw_bar(&mut drawing, &frame.area, values, bar)?;
        }
        Ok(drawing)
    }

    /// A PNG of the pixels alone, without axes: each a rectangle, `width` by `height` in all.
    ///
    /// # Errors
    /// [`Error::Argument`] if values do not fill whole rows, if none has a colour, or if a side is 0.
    pub fn pixels_png(&self, width: usize, height: usize) -> Result<Vec<u8>> {
        let bytes = self.bytes()?.ok_or_else(|| {
            let fix = "choose a linear scale, or a table with values above 0";
            Error::argument("a picture without data", fix)
        })?;
        let (columns, rows) = self.columns_and_rows()?;
        let mut spread = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            for x in 0..width {
                let from = 3 * (y * rows / height * columns + x * columns / width);
                spread.extend_from_slice(&bytes[from..from + 3]);
            }
        }
        encode_png(width, height, &spread)
    }

    /// Pixels across and down.
    ///
    /// # Errors
    /// [`Error::Argument`] if values do not fill whole rows.
    fn columns_and_rows(&self) -> Result<(usize, usize)> {
        match &self.pixels {
            Pixels::Picture { image, .. } => Ok((image.width(), image.height())),
            Pixels::Values { width, values, .. } => {
                if *width == 0 || values.is_empty() || !values.len().is_multiple_of(*width) {
                    return Err(Error::argument(
                        format!("{} values in rows of {width}", values.len()),
                        "give whole rows, at least one",
                    ));
                }
                Ok((*width, values.len() / width))
            }
        }
    }

    /// Three bytes a pixel; `None` where no value has a place on the scale.
    fn bytes(&self) -> Result<Option<Vec<u8>>> {
        self.columns_and_rows()?;
        Ok(match &self.pixels {
            Pixels::Picture { image, exposure } => Some(gamma_bytes(image, *exposure)),
            Pixels::Values { values, bar, .. } => value_bytes(values, bar),
        })
    }
}

/// A colour for each value by its place on the bar, white for those that have none.
fn value_bytes(values: &[f64], bar: &Axis) -> Option<Vec<u8>> {
    let ruler = Ruler::new(bar, values.iter().copied(), 0.0, 1.0)?;
    let mut bytes = Vec::with_capacity(3 * values.len());
    for &value in values {
        bytes.extend(ruler.pixel_of(value).map_or([255; 3], viridis));
    }
    Some(bytes)
}

/// (x·2^exposure)^(1/2.2) of each channel, cut off at 0 and 1.
fn gamma_bytes(image: &Image, exposure: f32) -> Vec<u8> {
    let gain = exposure.exp2();
    let mut bytes = Vec::with_capacity(3 * image.pixels().len());
    for colour in image.pixels() {
        for x in colour.to_array() {
            let shown = (x * gain).clamp(0.0, 1.0).powf(1.0 / 2.2);
            bytes.push((shown * 255.0).round() as u8);
        }
    }
    bytes
}

/// The bar, its ticks and its title.
fn draw_bar(drawing: &mut Drawing, area: &Area, values: &[f64], axis: &Axis) -> Result<()> {
    let Some(ruler) = Ruler::new(axis, values.iter().copied(), area.bottom(), area.y) else {
        return Ok(());
    };
    let bar = Area {
        x: area.right() + BAR_GAP,
        width: BAR,
        ..*area
    };
    let shades: Vec<u8> = (0..SHADES)
        .rev()
        .flat_map(|i| viridis((i as f64 + 0.5) / SHADES as f64))
        .collect();
    embed(drawing, &bar, raster(1, SHADES, shades)?);
    let mut widest = 0f64;
    for tick in ruler.ticks() {
        let length = if tick.label.is_some() { 5.0 } else { 3.0 };
        drawing.line(
            (bar.right(), tick.at),
            (bar.right() + length, tick.at),
            Paint::line(Stroke::new(INK)),
        );
        if let Some(label) = tick.label {
            drawing.label((bar.right() + 8.0, tick.at + 4.0), Anchor::Start, &label);
            widest = widest.max(width_of(&label, TEXT));
        }
    }
    let title = shortened(&axis.title, TEXT, area.height + 30.0);
    let x = bar.right() + (8.0 + widest + 18.0).min(RIGHT_OF_BAR - 6.0);
    drawing.label_upwards((x, area.y + area.height / 2.0), &title);
    Ok(())
}

/// Pixels, and the PNG of them.
fn raster(width: usize, height: usize, bytes: Vec<u8>) -> Result<Raster> {
    let png = encode_png(width, height, &bytes)?;
    Ok(Raster {
        width,
        height,
        bytes,
        png,
    })
}

/// Spreads pixels over `area` as sharp rectangles, with a frame around them.
fn embed(drawing: &mut Drawing, area: &Area, raster: Raster) {
    let place = *area;
    drawing.elements.push(Element::Image {
        area: place,
        raster,
    });
    drawing.rectangle(area, Paint::outline(Stroke::new(INK)));
}
