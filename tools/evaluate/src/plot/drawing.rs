//! A picture as a list of shapes: what every writer of files starts from.

use super::Caption;
use super::area::Area;
use super::text::{Anchor, TEXT, TITLE_TEXT, shortened, width_of};

/// How large a picture is, in its pixels. Text has the same size in each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartSize {
    /// Pixels across; from 320 to 10,000, and the nearer of these otherwise.
    pub width: f64,
    /// Pixels down, from 240 to 10,000 as well; `None` is as many as suit the width and the legend.
    pub height: Option<f64>,
}

impl Default for ChartSize {
    /// 640 pixels across.
    fn default() -> Self {
        Self {
            width: 640.0,
            height: None,
        }
    }
}

impl ChartSize {
    /// Within the limits.
    pub(super) fn limited(self) -> Self {
        Self {
            width: self.width.clamp(320.0, LARGEST_SIDE),
            height: self.height.map(|h| h.clamp(240.0, LARGEST_SIDE)),
        }
    }

    /// Radius of a circle in the picture: `usual` times the width, or, where a height is given, as much of it as `other` pixels
    /// leave to `circle` radii. `beside` pixels of the width are left free in any case.
    pub(super) fn radius(self, usual: f64, circle: f64, beside: f64, other: f64) -> f64 {
        let widest = 0.5 * (self.width - beside);
        let radius = match self.height {
            Some(height) => (height - other) / circle,
            None => usual * self.width,
        };
        radius.min(widest).max(40.0)
    }
}

const LARGEST_SIDE: f64 = 10_000.0;
/// Pixels from the top to the first of what is drawn.
pub(super) const TOP: f64 = 36.0;
/// Ink of axes and text.
pub(super) const INK: Colour = Colour(0x222222);
/// Lines behind the data.
pub(super) const GRID: Colour = Colour(0xd9d9d9);
pub(super) const WHITE: Colour = Colour(0xffffff);

/// A colour of 8-bit sRGB, as its six hexadecimal digits are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Colour(pub u32);

impl Colour {
    pub fn from_rgb(rgb: [u8; 3]) -> Self {
        let [r, g, b] = rgb.map(u32::from);
        Self(r << 16 | g << 8 | b)
    }

    pub fn to_rgb(self) -> [u8; 3] {
        [16, 8, 0].map(|shift| (self.0 >> shift) as u8)
    }
}

/// What is inside an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fill {
    /// A line has no inside.
    Unset,
    /// What lies behind shows.
    Empty,
    /// A colour, of an opacity from 0 to 1.
    Full(Colour, f64),
}

/// A line along an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub round_joins: bool,
    pub round_caps: bool,
    /// Lengths of dashes and gaps by turns; empty for a whole line.
    pub dashes: &'static [f64],
}

impl Stroke {
    /// A thin, whole line.
    pub fn new(colour: Colour) -> Self {
        Self {
            colour,
            width: 1.0,
            round_joins: false,
            round_caps: false,
            dashes: &[],
        }
    }

    pub fn with_width(self, width: f64) -> Self {
        Self { width, ..self }
    }

    pub fn with_dashes(self, dashes: &'static [f64]) -> Self {
        Self { dashes, ..self }
    }
}

/// How an outline is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paint {
    pub fill: Fill,
    pub stroke: Option<Stroke>,
}

impl Paint {
    /// Of a line alone.
    pub fn line(stroke: Stroke) -> Self {
        Self {
            fill: Fill::Unset,
            stroke: Some(stroke),
        }
    }

    /// Of an outline with nothing in it.
    pub fn outline(stroke: Stroke) -> Self {
        Self {
            fill: Fill::Empty,
            stroke: Some(stroke),
        }
    }

    /// Of an inside without a line around it.
    pub fn inside(colour: Colour) -> Self {
        Self {
            fill: Fill::Full(colour, 1.0),
            stroke: None,
        }
    }

    /// Of both.
    pub fn both(colour: Colour, stroke: Stroke) -> Self {
        Self {
            fill: Fill::Full(colour, 1.0),
            stroke: Some(stroke),
        }
    }
}

/// A piece of a path.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Outline {
    /// Points joined by straight lines.
    Open(Vec<(f64, f64)>),
    /// The same, back to the first.
    Closed(Vec<(f64, f64)>),
    /// A whole circle.
    Disc { centre: (f64, f64), radius: f64 },
    /// The upper half of a circle, from left to right.
    UpperHalf { centre: (f64, f64), radius: f64 },
    /// A pixel by its upper left corner.
    Pixel(i64, i64),
    /// A point, to be drawn by a line with round ends.
    Dot((f64, f64)),
}

/// What follows an outline.
pub(super) trait Pen {
    fn start(&mut self, at: (f64, f64));
    fn draw_to(&mut self, to: (f64, f64));
    /// A cubic Bézier curve by its two control points and its end.
    fn curve(&mut self, points: [(f64, f64); 3]);
    /// Back to where the outline began.
    fn end(&mut self);
}

/// Coordinates are held within this, far outside every picture, so that no reader's own numbers overflow.
const FAR: f64 = 20_000.0;
/// Control points of a quarter of a circle lie on its tangents at 4/3·(√2 − 1) radii.
const QUARTER: f64 = 0.552_284_749_830_793_4;

/// A coordinate within the limits; 0 for NaN.
pub(super) fn bounded(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(-FAR, FAR) }
}

impl Outline {
    /// The four sides of a rectangle.
    pub fn around(area: &Area) -> Self {
        let (right, bottom) = (area.right(), area.bottom());
        Self::Closed(vec![
            (area.x, area.y),
            (right, area.y),
            (right, bottom),
            (area.x, bottom),
        ])
    }

    /// Leads a pen along it.
    pub fn trace(&self, pen: &mut dyn Pen) {
        match self {
            Self::Open(points) => trace_lines(points, pen),
            Self::Closed(points) => {
                trace_lines(points, pen);
                if !points.is_empty() {
                    pen.end();
                }
            }
            Self::Disc { centre, radius } => {
                trace_quarters(*centre, *radius, 4, pen);
                pen.end();
            }
            Self::UpperHalf { centre, radius } => trace_quarters(*centre, *radius, 2, pen),
            Self::Pixel(x, y) => {
                let (x, y) = (*x as f64, *y as f64);
                trace_lines(
                    &[(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)],
                    pen,
                );
                pen.end();
            }
            // Lines of no length are dropped by some.
            Self::Dot((x, y)) => trace_lines(&[(*x, *y), (x + 0.01, *y)], pen),
        }
    }
}

fn trace_lines(points: &[(f64, f64)], pen: &mut dyn Pen) {
    for (i, &(x, y)) in points.iter().enumerate() {
        let at = (bounded(x), bounded(y));
        match i {
            0 => pen.start(at),
            _ => pen.draw_to(at),
        }
    }
}

/// Quarters of a circle from its left end, over the top.
fn trace_quarters(centre: (f64, f64), radius: f64, count: usize, pen: &mut dyn Pen) {
    const ENDS: [(f64, f64); 5] = [
        (-1.0, 0.0),
        (0.0, -1.0),
        (1.0, 0.0),
        (0.0, 1.0),
        (-1.0, 0.0),
    ];
    pen.start(on_circle(centre, radius, ENDS[0]));
    for i in 0..count {
        let (from, to) = (ENDS[i], ENDS[i + 1]);
        let after = (from.0 + QUARTER * to.0, from.1 + QUARTER * to.1);
        let before = (to.0 + QUARTER * from.0, to.1 + QUARTER * from.1);
        pen.curve([after, before, to].map(|place| on_circle(centre, radius, place)));
    }
}

/// Pixel of a place in units of a circle's radius from its centre.
fn on_circle(centre: (f64, f64), radius: f64, (x, y): (f64, f64)) -> (f64, f64) {
    (
        bounded(centre.0 + radius * x),
        bounded(centre.1 + radius * y),
    )
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextLine {
    /// Where its baseline is.
    pub at: (f64, f64),
    pub anchor: Anchor,
    pub size: f64,
    /// Whether it has a white rim, to be read above lines.
    pub rim: bool,
    /// Whether it reads upwards.
    pub upwards: bool,
    pub text: String,
}

/// Pixels of a picture inside the picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Raster {
    pub width: usize,
    pub height: usize,
    /// Three bytes a pixel, sRGB, top row first.
    pub bytes: Vec<u8>,
    /// The same as a PNG.
    pub png: Vec<u8>,
}

/// A small polygon of one colour.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Face {
    pub corners: Vec<(f64, f64)>,
    pub colour: Colour,
}

/// Width of the line of its own colour around each face.
pub(super) const SEAM: f64 = 0.5;

/// A part of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    Line {
        from: (f64, f64),
        to: (f64, f64),
        paint: Paint,
    },
    Path {
        outlines: Vec<Outline>,
        paint: Paint,
    },
    Circle {
        centre: (f64, f64),
        radius: f64,
        paint: Paint,
    },
    Rectangle {
        area: Area,
        paint: Paint,
    },
    Text(TextLine),
    /// Sharp pixels spread over `area`.
    Image {
        area: Area,
        raster: Raster,
    },
    /// Marks of one paint, each with a name that is shown on hovering.
    NamedMarks {
        paint: Paint,
        marks: Vec<(Outline, String)>,
    },
    /// Polygons, later ones above earlier ones, without gaps between neighbours.
    Faces(Vec<Face>),
    /// What follows shows inside `Area` alone.
    OpenWindow(Area),
    CloseWindow,
    /// What follows is drawn together and then laid over the rest with that opacity.
    OpenLayer(f64),
    CloseLayer,
}

/// What shapes are drawn on by writers that know paths, text and images alone.
pub(super) trait Canvas {
    fn draw_outlines(&mut self, outlines: &[Outline], paint: &Paint);
    fn draw_text(&mut self, line: &TextLine);
    fn draw_image(&mut self, area: &Area, raster: &Raster);
    fn draw_faces(&mut self, faces: &[Face]);
    /// Nothing shows outside of `area` until the window is closed.
    fn open_window(&mut self, area: &Area);
    fn close_window(&mut self);
    /// What follows is drawn together and then laid over the rest with that opacity.
    fn open_layer(&mut self, opacity: f64);
    fn close_layer(&mut self);

    fn draw(&mut self, element: &Element) {
        match element {
            Element::Line { from, to, paint } => {
                self.draw_outlines(&[Outline::Open(vec![*from, *to])], paint);
            }
            Element::Path { outlines, paint } => self.draw_outlines(outlines, paint),
            Element::Circle {
                centre,
                radius,
                paint,
            } => {
                let (centre, radius) = (*centre, *radius);
                self.draw_outlines(&[Outline::Disc { centre, radius }], paint);
            }
            Element::Rectangle { area, paint } => {
                self.draw_outlines(&[Outline::around(area)], paint);
            }
            Element::Text(line) => self.draw_text(line),
            Element::Image { area, raster } => self.draw_image(area, raster),
            Element::NamedMarks { paint, marks } => {
                for (mark, _) in marks {
                    self.draw_outlines(std::slice::from_ref(mark), paint);
                }
            }
            Element::Faces(faces) => self.draw_faces(faces),
            Element::OpenWindow(area) => self.open_window(area),
            Element::CloseWindow => self.close_window(),
            Element::OpenLayer(opacity) => self.open_layer(*opacity),
            Element::CloseLayer => self.close_layer(),
        }
    }
}

/// Pixels that a title leaves free on either side.
const TITLE_MARGIN: f64 = 12.0;

/// A picture: a white sheet with a title, and what lies on it.
///
/// [`Drawing::svg`], [`Drawing::png`] and [`Drawing::pdf`] write the same shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) caption: Caption,
    pub(super) elements: Vec<Element>,
}

impl Drawing {
    /// A white sheet of that size with its title.
    pub(super) fn new(width: f64, height: f64, caption: &Caption) -> Self {
        // A long title is smaller before it is cut.
        let room = width - 2.0 * TITLE_MARGIN;
        let fitting = TITLE_TEXT * room / width_of(&caption.title, TITLE_TEXT).max(1.0);
        let size = fitting.clamp(TEXT, TITLE_TEXT);
        let title = TextLine {
            at: (width / 2.0, 22.0),
            anchor: Anchor::Middle,
            size,
            rim: false,
            upwards: false,
            text: shortened(&caption.title, size, room),
        };
        Self {
            width,
            height,
            caption: caption.clone(),
            elements: vec![Element::Text(title)],
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// A straight line.
    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), paint: Paint) {
        self.elements.push(Element::Line { from, to, paint });
    }

    /// A polyline, or with `close` a polygon; nothing for fewer than two points.
    pub(super) fn path(&mut self, points: &[(f64, f64)], close: bool, paint: Paint) {
        if points.len() < 2 {
            return;
        }
        let outline = match close {
            true => Outline::Closed(points.to_vec()),
            false => Outline::Open(points.to_vec()),
        };
        self.outlines(vec![outline], paint);
    }

    /// Several outlines of one paint; nothing for none.
    pub(super) fn outlines(&mut self, outlines: Vec<Outline>, paint: Paint) {
        if !outlines.is_empty() {
            self.elements.push(Element::Path { outlines, paint });
        }
    }

    pub(super) fn rectangle(&mut self, area: &Area, paint: Paint) {
        let area = *area;
        self.elements.push(Element::Rectangle { area, paint });
    }

    /// Text with its baseline at `at`.
    pub(super) fn label(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        self.push_text(at, anchor, text, false, false);
    }

    /// Text on a white rim, to be read above lines.
    pub(super) fn label_above(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        self.push_text(at, anchor, text, true, false);
    }

    /// Text that reads upwards, centred at `at`.
    pub(super) fn label_upwards(&mut self, at: (f64, f64), text: &str) {
        self.push_text(at, Anchor::Middle, text, false, true);
    }

    fn push_text(&mut self, at: (f64, f64), anchor: Anchor, text: &str, rim: bool, upwards: bool) {
        self.elements.push(Element::Text(TextLine {
            at,
            anchor,
            size: TEXT,
            rim,
            upwards,
            text: text.to_owned(),
        }));
    }

    /// Begins a part of which nothing shows outside `area`; coordinates stay those of the picture.
    pub(super) fn open_window(&mut self, area: &Area) {
        self.elements.push(Element::OpenWindow(*area));
    }

    /// Ends what [`Self::open_window`] began.
    pub(super) fn close_window(&mut self) {
        self.elements.push(Element::CloseWindow);
    }

    /// "no data" in the middle of `area`.
    pub(super) fn no_data(&mut self, area: &Area) {
        let middle = (area.x + area.width / 2.0, area.y + area.height / 2.0);
        self.label(middle, Anchor::Middle, "no data");
    }
}
