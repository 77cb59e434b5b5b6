//! Drawings as PNG: the same shapes with smooth edges, and text by the outlines of a font inside the program.

use tiny_skia::{
    FillRule, FilterQuality, LineCap, LineJoin, Mask, PathBuilder, Pixmap, PixmapPaint, StrokeDash,
    Transform,
};
use ttf_parser::OutlineBuilder;

use super::area::Area;
use super::drawing::{
    Canvas, Colour, Drawing, Face, Fill, INK, Outline, Paint, Pen, Raster, SEAM, Stroke, TextLine,
    WHITE, bounded,
};
use super::text::Anchor;
use merlkit::image::encode_png;
use merlkit::{Error, Result};

impl Drawing {
    /// The picture as PNG, `scale` pixels for each of its own, with DejaVu Sans Condensed for text: the same bytes wherever it is
    /// drawn.
    ///
    /// # Errors
    /// [`Error::Argument`] for a scale that leaves no pixel, or more than memory can hold.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>> {
        let [width, height] = [self.width, self.height].map(|side| (side * scale).round());
        let sheet = Pixmap::new(width as u32, height as u32);
        let mut sheet = sheet.ok_or_else(|| {
            let fix = "choose another width or height";
            Error::argument(format!("a picture of {width} × {height} pixels"), fix)
        })?;
        sheet.fill(tiny_skia::Color::WHITE);
        let mut painter = Painter {
            layers: vec![(sheet, 1.0)],
            window: None,
            to_pixels: Transform::from_scale(scale as f32, scale as f32),
            font: ttf_parser::Face::parse(dejavu::sans_condensed::regular(), 0)
                .map_err(|e| Error::argument(format!("the font of plots: {e}"), "report this"))?,
        };
        for element in &self.elements {
            painter.draw(element);
        }
        // Every layer was closed, but one that was not would belong to the picture as well.
        while painter.layers.len() > 1 {
            painter.close_layer();
        }
        let [(sheet, _)] = &painter.layers[..] else {
            return encode_png(0, 0, &[]);
        };
        let mut bytes = Vec::with_capacity(3 * sheet.pixels().len());
        for pixel in sheet.pixels() {
            bytes.extend([pixel.red(), pixel.green(), pixel.blue()]);
        }
        encode_png(width as usize, height as usize, &bytes)
    }
}

/// What is drawn on.
struct Painter<'a> {
    /// The sheet, and layers that are not closed yet with their opacities.
    layers: Vec<(Pixmap, f32)>,
    window: Option<Mask>,
    to_pixels: Transform,
    font: ttf_parser::Face<'a>,
}

impl Painter<'_> {
    fn sheet(&mut self) -> &mut Pixmap {
        let last = self.layers.len() - 1;
        &mut self.layers[last].0
    }

    /// What shows inside `area` alone.
    fn mask(&mut self, area: &Area) -> Option<Mask> {
        let (width, height) = (self.sheet().width(), self.sheet().height());
        let mut mask = Mask::new(width, height)?;
        let mut path = PathBuilder::new();
        Outline::around(area).trace(&mut path);
        mask.fill_path(&path.finish()?, FillRule::Winding, true, self.to_pixels);
        Some(mask)
    }

    fn fill(&mut self, path: &tiny_skia::Path, paint: tiny_skia::Paint<'_>) {
        let (window, place) = (self.window.take(), self.to_pixels);
        self.sheet()
            .fill_path(path, &paint, FillRule::Winding, place, window.as_ref());
        self.window = window;
    }

    fn stroke(&mut self, path: &tiny_skia::Path, stroke: &Stroke) {
        let mut style = tiny_skia::Stroke {
            width: stroke.width as f32,
            ..tiny_skia::Stroke::default()
        };
        if stroke.round_joins {
            style.line_join = LineJoin::Round;
        }
        if stroke.round_caps {
            style.line_cap = LineCap::Round;
        }
        if !stroke.dashes.is_empty() {
            let lengths = stroke.dashes.iter().map(|d| *d as f32).collect();
            style.dash = StrokeDash::new(lengths, 0.0);
        }
        let (window, place) = (self.window.take(), self.to_pixels);
        let paint = solid(stroke.colour, 1.0);
        self.sheet()
            .stroke_path(path, &paint, &style, place, window.as_ref());
        self.window = window;
    }

    fn draw_face(&mut self, face: &Face) {
        let seam = Stroke {
            round_joins: true,
            ..Stroke::new(face.colour).with_width(SEAM)
        };
        let outline = Outline::Closed(face.corners.clone());
        self.draw_outlines(&[outline], &Paint::both(face.colour, seam));
    }

    /// The outlines of a line's glyphs at their place.
    fn text_path(&self, line: &TextLine) -> Option<tiny_skia::Path> {
        let em = f32::from(self.font.units_per_em());
        let (mut glyphs, mut width) = (GlyphPen::default(), 0f32);
        for c in line.text.chars() {
            // What the font lacks is an empty box, its first glyph.
            let glyph = self.font.glyph_index(c).unwrap_or_default();
            glyphs.offset = width;
            self.font.outline_glyph(glyph, &mut glyphs);
            width += f32::from(self.font.glyph_hor_advance(glyph).unwrap_or(0));
        }
        let before = match line.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let size = line.size as f32 / em;
        // Fonts have y upwards.
        let mut place = Transform::from_translate(-before, 0.0).post_scale(size, -size);
        if line.upwards {
            place = place.post_rotate(-90.0);
        }
        let [x, y] = [line.at.0, line.at.1].map(|side| bounded(side) as f32);
        let place = place.post_translate(x, y);
        glyphs.path.finish()?.transform(place)
    }
}

impl Canvas for Painter<'_> {
    fn close_layer(&mut self) {
        if self.layers.len() < 2 {
            return;
        }
        if let Some((layer, opacity)) = self.layers.pop() {
            let paint = PixmapPaint {
                opacity,
                ..PixmapPaint::default()
            };
            let place = Transform::identity();
            self.sheet()
                .draw_pixmap(0, 0, layer.as_ref(), &paint, place, None);
        }
    }

    fn draw_outlines(&mut self, outlines: &[Outline], paint: &Paint) {
        let mut path = PathBuilder::new();
        for outline in outlines {
            outline.trace(&mut path);
        }
        let Some(path) = path.finish() else { return };
        if let Fill::Full(colour, opacity) = paint.fill {
            self.fill(&path, solid(colour, opacity));
        }
        if let Some(stroke) = &paint.stroke {
            self.stroke(&path, stroke);
        }
    }

    fn draw_image(&mut self, area: &Area, raster: &Raster) {
        let Some(mut pixels) = Pixmap::new(raster.width as u32, raster.height as u32) else {
            return;
        };
        for (pixel, rgb) in pixels
            .data_mut()
            .chunks_exact_mut(4)
            .zip(raster.bytes.chunks_exact(3))
        {
            pixel.copy_from_slice(&[rgb[0], rgb[1], rgb[2], 255]);
        }
        let across = area.width / raster.width as f64;
        let down = area.height / raster.height as f64;
        let place = Transform::from_row(
            across as f32,
            0.0,
            0.0,
            down as f32,
            area.x as f32,
            area.y as f32,
        );
        let paint = PixmapPaint {
            quality: FilterQuality::Nearest,
            ..PixmapPaint::default()
        };
        let place = place.post_concat(self.to_pixels);
        self.sheet()
            .draw_pixmap(0, 0, pixels.as_ref(), &paint, place, None);
    }

    fn draw_text(&mut self, line: &TextLine) {
        let Some(path) = self.text_path(line) else {
            return;
        };
        if line.rim {
            let rim = Stroke {
                round_joins: true,
                ..Stroke::new(WHITE).with_width(3.0)
            };
            self.stroke(&path, &rim);
        }
        self.fill(&path, solid(INK, 1.0));
    }

    fn draw_faces(&mut self, faces: &[Face]) {
        for face in faces {
            self.draw_face(face);
        }
    }

    fn open_window(&mut self, area: &Area) {
        self.window = self.mask(area);
    }

    fn close_window(&mut self) {
        self.window = None;
    }

    fn open_layer(&mut self, opacity: f64) {
        let (width, height) = (self.sheet().width(), self.sheet().height());
        if let Some(layer) = Pixmap::new(width, height) {
            self.layers.push((layer, opacity as f32));
        }
    }
}

/// Glyphs one behind the other.
#[derive(Default)]
struct GlyphPen {
    path: PathBuilder,
    offset: f32,
}

impl OutlineBuilder for GlyphPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(x + self.offset, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(x + self.offset, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(x1 + self.offset, y1, x + self.offset, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let offset = self.offset;
        self.path
            .cubic_to(x1 + offset, y1, x2 + offset, y2, x + offset, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

impl Pen for PathBuilder {
    fn start(&mut self, (x, y): (f64, f64)) {
        self.move_to(x as f32, y as f32);
    }

    fn draw_to(&mut self, (x, y): (f64, f64)) {
        self.line_to(x as f32, y as f32);
    }

    fn curve(&mut self, [a, b, end]: [(f64, f64); 3]) {
        let [a, b, end] = [a, b, end].map(|(x, y)| (x as f32, y as f32));
        self.cubic_to(a.0, a.1, b.0, b.1, end.0, end.1);
    }

    fn end(&mut self) {
        self.close();
    }
}

fn solid(colour: Colour, opacity: f64) -> tiny_skia::Paint<'static> {
    let mut paint = tiny_skia::Paint::default();
    let [r, g, b] = colour.to_rgb();
    let alpha = (255.0 * opacity.clamp(0.0, 1.0)).round() as u8;
    paint.set_color_rgba8(r, g, b, alpha);
    paint
}
