//! Drawings as PDF: one page with the same shapes, and text in fonts that every reader has.

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{LineCapStyle, LineJoinStyle, TextRenderingMode};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::area::Area;
use super::drawing::{
    Canvas, Colour, Drawing, Face, Fill, INK, Outline, Paint, Pen, Raster, SEAM, Stroke, TextLine,
    WHITE, bounded,
};
use super::pdf_text::{StandardFont, TextRun, text_runs};
use super::text::Anchor;

/// Points of a page for each pixel: 96 pixels are an inch.
const POINTS: f32 = 0.75;
/// Effort of the compression.
const LEVEL: u8 = 6;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const RESOURCES: Ref = Ref::new(5);
const HELVETICA: Ref = Ref::new(6);
const SYMBOL: Ref = Ref::new(7);
const INFO: Ref = Ref::new(8);
/// Objects that a picture has any number of come behind.
const FIRST_OTHER: i32 = 9;

impl Drawing {
    /// The picture as a PDF of one page: the same bytes for the same shapes. Its text is text, in Helvetica and Symbol, which the
    /// file names and does not hold.
    pub fn pdf(&self) -> Vec<u8> {
        let mut writer = PageWriter::new(self);
        for element in &self.elements {
            writer.draw(element);
        }
        writer.finish(self)
    }
}

/// A page as it grows.
struct PageWriter {
    pdf: Pdf,
    /// The page, and layers that are not closed yet with their opacities.
    layers: Vec<(Content, f64)>,
    /// Images and layers, and opacities, each the object of the number in its name.
    x_objects: Vec<Ref>,
    opacities: Vec<f64>,
    page: Rect,
}

impl PageWriter {
    fn new(drawing: &Drawing) -> Self {
        let (width, height) = (drawing.width as f32, drawing.height as f32);
        let mut content = Content::new();
        // Pixels with y downwards from here on.
        content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, POINTS * height]);
        Self {
            pdf: Pdf::new(),
            layers: vec![(content, 1.0)],
            x_objects: Vec::new(),
            opacities: Vec::new(),
            page: Rect::new(0.0, 0.0, POINTS * width, POINTS * height),
        }
    }

    fn content(&mut self) -> &mut Content {
        let last = self.layers.len() - 1;
        &mut self.layers[last].0
    }

    /// The number of the next object.
    fn next_ref(&self) -> Ref {
        Ref::new(FIRST_OTHER + self.x_objects.len() as i32)
    }

    /// The name of what is painted as a whole and comes next.
    fn push_x_object(&mut self) -> (Ref, String) {
        let id = self.next_ref();
        self.x_objects.push(id);
        (id, format!("X{}", self.x_objects.len() - 1))
    }

    fn opacity_name(&mut self, opacity: f64) -> String {
        let known = self.opacities.iter().position(|o| *o == opacity);
        let number = known.unwrap_or_else(|| {
            self.opacities.push(opacity);
            self.opacities.len() - 1
        });
        format!("G{number}")
    }

    fn finish(mut self, drawing: &Drawing) -> Vec<u8> {
        while self.layers.len() > 1 {
            self.close_layer();
        }
        let Some((content, _)) = self.layers.pop() else {
            return Vec::new();
        };
        let bytes = compress_to_vec_zlib(content.finish().as_slice(), LEVEL);
        self.pdf.stream(CONTENT, &bytes).filter(Filter::FlateDecode);
        self.pdf.catalog(CATALOG).pages(PAGES);
        self.pdf.pages(PAGES).kids([PAGE]).count(1);
        let mut page = self.pdf.page(PAGE);
        page.parent(PAGES).media_box(self.page).contents(CONTENT);
        page.pair(Name(b"Resources"), RESOURCES);
        page.finish();
        self.write_resources();
        let mut helvetica = self.pdf.type1_font(HELVETICA);
        helvetica.base_font(Name(b"Helvetica"));
        helvetica.encoding_predefined(Name(b"WinAnsiEncoding"));
        helvetica.finish();
        self.pdf.type1_font(SYMBOL).base_font(Name(b"Symbol"));
        let mut info = self.pdf.document_info(INFO);
        info.title(TextStr(&drawing.caption.title));
        info.subject(TextStr(&drawing.caption.description));
        info.finish();
        self.pdf.finish()
    }

    fn write_resources(&mut self) {
        let mut resources = self.pdf.indirect(RESOURCES).dict();
        let mut fonts = resources.insert(Name(b"Font")).dict();
        fonts.pair(Name(b"H"), HELVETICA).pair(Name(b"S"), SYMBOL);
        fonts.finish();
        let mut x_objects = resources.insert(Name(b"XObject")).dict();
        for (number, id) in self.x_objects.iter().enumerate() {
            x_objects.pair(Name(format!("X{number}").as_bytes()), *id);
        }
        x_objects.finish();
        let mut states = resources.insert(Name(b"ExtGState")).dict();
        for (number, opacity) in self.opacities.iter().enumerate() {
            let mut state = states.insert(Name(format!("G{number}").as_bytes())).dict();
            state.pair(Name(b"ca"), *opacity as f32);
        }
    }
}

impl Canvas for PageWriter {
    fn draw_outlines(&mut self, outlines: &[Outline], paint: &Paint) {
        let (fill, opacity) = match paint.fill {
            Fill::Full(colour, opacity) => (Some(colour), opacity),
            Fill::Unset | Fill::Empty => (None, 1.0),
        };
        let state = (opacity < 1.0).then(|| self.opacity_name(opacity));
        let content = self.content();
        content.save_state();
        if let Some(name) = state {
            content.set_parameters(Name(name.as_bytes()));
        }
        if let Some(colour) = fill {
            set_fill(content, colour);
        }
        if let Some(stroke) = &paint.stroke {
            set_stroke(content, stroke);
        }
        for outline in outlines {
            outline.trace(&mut ContentPen(content));
        }
        match (fill.is_some(), paint.stroke.is_some()) {
            (true, true) => content.fill_nonzero_and_stroke(),
            (true, false) => content.fill_nonzero(),
            (false, true) => content.stroke(),
            (false, false) => content.end_path(),
        };
        content.restore_state();
    }

    fn draw_faces(&mut self, faces: &[Face]) {
        let content = self.content();
        content.save_state();
        for face in faces {
            let seam = Stroke {
                round_joins: true,
                ..Stroke::new(face.colour).with_width(SEAM)
            };
            set_fill(content, face.colour);
            set_stroke(content, &seam);
            Outline::Closed(face.corners.clone()).trace(&mut ContentPen(content));
            content.fill_nonzero_and_stroke();
        }
        content.restore_state();
    }

    fn draw_image(&mut self, area: &Area, raster: &Raster) {
        let (id, name) = self.push_x_object();
        let bytes = compress_to_vec_zlib(&raster.bytes, LEVEL);
        let mut image = self.pdf.image_xobject(id, &bytes);
        image.filter(Filter::FlateDecode);
        image
            .width(raster.width as i32)
            .height(raster.height as i32);
        image.color_space().device_rgb();
        image.bits_per_component(8);
        image.finish();
        let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(|v| v as f32);
        let content = self.content();
        content.save_state();
        // Images fill the unit square, top row uppermost.
        content.transform([width, 0.0, 0.0, -height, x, y + height]);
        content.x_object(Name(name.as_bytes())).restore_state();
    }

    /// Draws a layer as one object, so that its opacity is that of the whole.
    fn close_layer(&mut self) {
        if self.layers.len() < 2 {
            return;
        }
        let Some((layer, opacity)) = self.layers.pop() else {
            return;
        };
        let (id, name) = self.push_x_object();
        let bytes = compress_to_vec_zlib(layer.finish().as_slice(), LEVEL);
        let mut form = self.pdf.form_xobject(id, &bytes);
        form.filter(Filter::FlateDecode);
        // In pixels of the page, whose sides are longer than in points.
        form.bbox(Rect::new(
            0.0,
            0.0,
            self.page.x2 / POINTS,
            self.page.y2 / POINTS,
        ));
        form.pair(Name(b"Resources"), RESOURCES);
        form.group().transparency().isolated(true);
        form.finish();
        let state = self.opacity_name(opacity);
        let content = self.content();
        content.save_state();
        content.set_parameters(Name(state.as_bytes()));
        content.x_object(Name(name.as_bytes())).restore_state();
    }

    fn draw_text(&mut self, line: &TextLine) {
        let runs = text_runs(&line.text);
        let width: f64 = line.size * runs.iter().map(|r| r.width).sum::<f64>();
        let before = match line.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let [x, y] = [line.at.0, line.at.1].map(|side| bounded(side) as f32);
        let before = before as f32;
        // Letters have y upwards.
        let place = match line.upwards {
            false => [1.0, 0.0, 0.0, -1.0, x - before, y],
            true => [0.0, -1.0, -1.0, 0.0, x, y + before],
        };
        let content = self.content();
        content.save_state();
        // Raised letters are text for eyes alone: what is copied is the line itself.
        let mut span = content.begin_marked_content_with_properties(Name(b"Span"));
        span.properties().actual_text(TextStr(&line.text));
        span.finish();
        if line.rim {
            let rim = Stroke {
                round_joins: true,
                ..Stroke::new(WHITE).with_width(3.0)
            };
            set_stroke(content, &rim);
            show(content, &runs, line.size, place, TextRenderingMode::Stroke);
        }
        set_fill(content, INK);
        show(content, &runs, line.size, place, TextRenderingMode::Fill);
        content.end_marked_content().restore_state();
    }

    fn open_window(&mut self, area: &Area) {
        let content = self.content();
        content.save_state();
        Outline::around(area).trace(&mut ContentPen(content));
        content.clip_nonzero().end_path();
    }

    fn close_window(&mut self) {
        self.content().restore_state();
    }

    fn open_layer(&mut self, opacity: f64) {
        self.layers.push((Content::new(), opacity));
    }
}

/// Shows runs one behind the other.
fn show(
    content: &mut Content,
    runs: &[TextRun],
    size: f64,
    place: [f32; 6],
    mode: TextRenderingMode,
) {
    content.begin_text();
    content.set_text_rendering_mode(mode);
    content.set_text_matrix(place);
    for run in runs {
        let font: &[u8] = match run.font {
            StandardFont::Helvetica => b"H",
            StandardFont::Symbol => b"S",
        };
        content.set_font(Name(font), (size * run.size) as f32);
        content.set_rise((size * run.rise) as f32);
        content.show(Str(&run.codes));
    }
    content.end_text();
}

fn set_fill(content: &mut Content, colour: Colour) {
    let [r, g, b] = colour.to_rgb().map(|c| f32::from(c) / 255.0);
    content.set_fill_rgb(r, g, b);
}

fn set_stroke(content: &mut Content, stroke: &Stroke) {
    let [r, g, b] = stroke.colour.to_rgb().map(|c| f32::from(c) / 255.0);
    content.set_stroke_rgb(r, g, b);
    content.set_line_width(stroke.width as f32);
    if stroke.round_joins {
        content.set_line_join(LineJoinStyle::RoundJoin);
    }
    if stroke.round_caps {
        content.set_line_cap(LineCapStyle::RoundCap);
    }
    if !stroke.dashes.is_empty() {
        content.set_dash_pattern(stroke.dashes.iter().map(|d| *d as f32), 0.0);
    }
}

struct ContentPen<'a>(&'a mut Content);

/// In hundredths of a pixel, as SVG.
fn rounded(x: f64) -> f32 {
    ((x * 100.0).round() / 100.0) as f32
}

impl Pen for ContentPen<'_> {
    fn start(&mut self, (x, y): (f64, f64)) {
        self.0.move_to(rounded(x), rounded(y));
    }

    fn draw_to(&mut self, (x, y): (f64, f64)) {
        self.0.line_to(rounded(x), rounded(y));
    }

    fn curve(&mut self, [a, b, end]: [(f64, f64); 3]) {
        let [a, b, end] = [a, b, end].map(|(x, y)| (rounded(x), rounded(y)));
        self.0.cubic_to(a.0, a.1, b.0, b.1, end.0, end.1);
    }

    fn end(&mut self) {
        self.0.close_path();
    }
}
