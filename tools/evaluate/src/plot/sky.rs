//! An environment as a map with directions on it: in its colours, and its luminance below.

use merlkit::image::{Image, encode_png, encode_srgb};
use merlkit::{Result, color};

use super::Caption;
use super::area::Area;
use super::colours::viridis;
use super::drawing::{
    ChartSize, Drawing, Element, INK, Outline, Paint, Raster, Stroke, TOP, WHITE,
};
use super::style::Style;
use super::text::Anchor;

/// A map of latitude and longitude with marked places.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyMap {
    /// What it is.
    pub caption: Caption,
    /// Radiance, twice as many columns as rows; the top is the zenith.
    pub image: Image,
    /// Stops by which it is shown brighter.
    pub exposure: f32,
    /// Places of directions as fractions of width and height from the upper left corner.
    pub places: Vec<(f64, f64)>,
    /// What the places are, below the map.
    pub label: String,
}

/// Pixels beside the map.
const BESIDE: f64 = 24.0;
/// Pixels of a line of text.
const LINE: f64 = 20.0;
/// Decades below the greatest luminance that the luminance image tells apart.
const DECADES: f32 = 4.0;
const DOTS: Style = Style(0);

impl SkyMap {
    /// The shapes of the picture.
    ///
    /// # Errors
    /// Those of encoding a PNG.
    pub fn drawing(&self, size: ChartSize) -> Result<Drawing> {
        let size = size.limited();
        // Two maps, each half as high as wide, each with a line of text below.
        let around = TOP + 2.0 * LINE + 12.0;
        let mut width = size.width - 2.0 * BESIDE;
        if let Some(height) = size.height {
            width = width.min(height - around).max(80.0);
        }
        let upper = Area {
            x: (size.width - width) / 2.0,
            y: TOP,
            width,
            height: width / 2.0,
        };
        let lower = Area {
            y: upper.bottom() + LINE + 4.0,
            ..upper
        };
        let height = size.height.unwrap_or(0.0).max(around + width);
        let mut drawing = Drawing::new(size.width, height, &self.caption);
        let colours = encode_srgb(&self.image, self.exposure);
        self.place_image(&mut drawing, &upper, colours)?;
        self.draw_places(&mut drawing, &upper);
        drawing.label((upper.x, upper.bottom() + 14.0), Anchor::Start, &self.label);
        let (shades, label) = self.shades();
        self.place_image(&mut drawing, &lower, shades)?;
        drawing.label((lower.x, lower.bottom() + 14.0), Anchor::Start, &label);
        Ok(drawing)
    }

    fn place_image(&self, drawing: &mut Drawing, area: &Area, bytes: Vec<u8>) -> Result<()> {
        let (width, height) = (self.image.width(), self.image.height());
        let png = encode_png(width, height, &bytes)?;
        drawing.elements.push(Element::Image {
            area: *area,
            raster: Raster {
                width,
                height,
                bytes,
                png,
            },
        });
        drawing.rectangle(area, Paint::outline(Stroke::new(INK)));
        Ok(())
    }

    /// A dot at each place, with a white rim that shows on dark skies.
    fn draw_places(&self, drawing: &mut Drawing, area: &Area) {
        let mut dots = Vec::new();
        for &(x, y) in &self.places {
            if (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y) {
                dots.push(Outline::Dot((
                    area.x + x * area.width,
                    area.y + y * area.height,
                )));
            }
        }
        for (colour, width) in [(WHITE, 4.2), (DOTS.colour(), 2.6)] {
            let stroke = Stroke {
                round_caps: true,
                ..Stroke::new(colour).with_width(width)
            };
            drawing.outlines(dots.clone(), Paint::outline(stroke));
        }
    }

    /// Colours of the luminance on a logarithmic scale that ends at the greatest, and what they mean.
    fn shades(&self) -> (Vec<u8>, String) {
        let luminances: Vec<f32> = self
            .image
            .pixels()
            .iter()
            .map(|pixel| color::luminance(*pixel))
            .collect();
        let greatest = luminances.iter().copied().fold(0.0, f32::max);
        let mut bytes = Vec::with_capacity(3 * luminances.len());
        for luminance in luminances {
            // 1 + log10(L/L_max)/decades; what is darker, or black, has the darkest colour.
            let place = 1.0 + (luminance / greatest.max(f32::MIN_POSITIVE)).log10() / DECADES;
            bytes.extend(viridis(f64::from(place.max(0.0))));
        }
        let lowest = greatest / 10f32.powf(DECADES);
        let label = format!(
            "luminance, logarithmic from {lowest:.1e} or less (dark) to {greatest:.1e} (yellow)"
        );
        (bytes, label)
    }
}
