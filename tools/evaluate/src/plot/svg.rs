//! Writing SVG: elements, numbers and text that can't break the markup.

use super::Caption;

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
/// Size of ordinary text, pixels.
pub(super) const TEXT: f64 = 12.0;
const TITLE_TEXT: f64 = 15.0;
/// Pixels that a title leaves free on either side.
const TITLE_MARGIN: f64 = 12.0;
/// Ink of axes and text.
pub(super) const INK: &str = "#222222";
/// Lines behind the data.
pub(super) const GRID: &str = "#d9d9d9";
/// Coordinates are held within this, far outside every picture, so that no reader's own numbers overflow.
const FAR: f64 = 20_000.0;

/// Where a text's position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// A rectangle of the picture, pixels, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// Whether a point lies in it, half a pixel beyond its edges included.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        let across = (self.x - 0.5..=self.right() + 0.5).contains(&x);
        across && (self.y - 0.5..=self.bottom() + 0.5).contains(&y)
    }
}

/// The text of a picture as it grows.
pub(super) struct Svg {
    text: String,
}

impl Svg {
    /// A white sheet of that size with its title.
    pub fn new(sheet_width: f64, height: f64, caption: &Caption) -> Self {
        let (width, height) = (px(sheet_width), px(height));
        let mut svg = Self {
            text: String::new(),
        };
        svg.push(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"{TEXT}\" fill=\"{INK}\">"
        ));
        svg.push(&format!("<title>{}</title>", escape(&caption.title)));
        svg.push(&format!("<desc>{}</desc>", escape(&caption.description)));
        svg.push(&format!(
            "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        ));
        // A long title is smaller before it is cut.
        let room = sheet_width - 2.0 * TITLE_MARGIN;
        let fitting = TITLE_TEXT * room / width_of(&caption.title, TITLE_TEXT).max(1.0);
        let size = fitting.clamp(TEXT, TITLE_TEXT);
        let title = shortened(&caption.title, size, room);
        svg.push(&format!(
            "<text x=\"{}\" y=\"22\" font-size=\"{}\" text-anchor=\"middle\">{}</text>",
            px(sheet_width / 2.0),
            px(size),
            escape(&title)
        ));
        svg
    }

    /// Adds an element on a line of its own.
    pub fn push(&mut self, element: &str) {
        self.text.push_str(element);
        self.text.push('\n');
    }

    /// A straight line; `style` are further attributes.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &str) {
        let (x1, y1, x2, y2) = (px(from.0), px(from.1), px(to.0), px(to.1));
        self.push(&format!(
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" {style}/>"
        ));
    }

    /// A polyline, or with `close` a polygon; nothing for fewer than two points.
    pub fn path(&mut self, points: &[(f64, f64)], close: bool, style: &str) {
        if points.len() < 2 {
            return;
        }
        self.push(&format!(
            "<path d=\"{}\" {style}/>",
            path_data(points, close)
        ));
    }

    /// Text with its baseline at `at`.
    pub fn label(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        self.styled_label(at, anchor, "", text);
    }

    /// Text on a white rim, to be read above lines.
    pub fn label_above(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        let rim = " paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\"";
        self.styled_label(at, anchor, rim, text);
    }

    /// Text that reads upwards, centred at `at`.
    pub fn label_upwards(&mut self, at: (f64, f64), text: &str) {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", px(at.0), px(at.1));
        self.styled_label(at, Anchor::Middle, &turn, text);
    }

    fn styled_label(&mut self, (x, y): (f64, f64), anchor: Anchor, style: &str, text: &str) {
        let (x, y, anchor, text) = (px(x), px(y), anchor.name(), escape(text));
        self.push(&format!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"{style}>{text}</text>"
        ));
    }

    /// Begins a part of which nothing shows outside `area`; coordinates stay those of the picture. Without an `id` to clip
    /// by, so that pictures can stand in one page.
    pub fn open_window(&mut self, area: &Area) {
        let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(px);
        self.push(&format!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"
        ));
    }

    /// Ends what [`Self::open_window`] began.
    pub fn close_window(&mut self) {
        self.push("</svg>");
    }

    /// "no data" in the middle of `area`.
    pub fn no_data(&mut self, area: &Area) {
        self.label(
            (area.x + area.width / 2.0, area.y + area.height / 2.0),
            Anchor::Middle,
            "no data",
        );
    }

    /// The finished text.
    pub fn finish(mut self) -> String {
        self.push("</svg>");
        self.text
    }
}

/// The commands of a path through `points`.
pub(super) fn path_data(points: &[(f64, f64)], close: bool) -> String {
    let mut data = String::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&format!("{} {}", px(x), px(y)));
    }
    if close {
        data.push('Z');
    }
    data
}

/// A coordinate in hundredths of a pixel, without zeros at its end; 0 for NaN.
pub(super) fn px(x: f64) -> String {
    let x = if x.is_nan() { 0.0 } else { x.clamp(-FAR, FAR) };
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

/// Text as XML content or attribute; characters that XML 1.0 has no place for become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c < ' ' || ('\u{fffe}'..='\u{ffff}').contains(&c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// About how many pixels a text is wide. Fonts differ; this is generous for the usual ones.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    size * text
        .chars()
        .map(|c| if c < '\u{2e80}' { 0.58 } else { 1.0 })
        .sum::<f64>()
}

/// A picture that says in `<metadata>` where it comes from, a line each.
pub fn with_metadata(svg: &str, lines: &[String]) -> String {
    match svg.split_once("<title>") {
        Some((head, rest)) => {
            let text = escape(&lines.join("; "));
            format!("{head}<metadata>{text}</metadata>\n<title>{rest}")
        }
        None => svg.to_owned(),
    }
}

/// As much of a text as is at most `width` pixels wide.
pub(super) fn shortened(text: &str, size: f64, width: f64) -> String {
    if width_of(text, size) <= width {
        return text.into();
    }
    let mut out = String::new();
    for c in text.chars() {
        out.push(c);
        if width_of(&out, size) > width - size {
            out.pop();
            break;
        }
    }
    out.push('…');
    out
}

/// Whether two rectangles have a point in common.
pub(super) fn overlap(a: &Area, b: &Area) -> bool {
    a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom()
}

/// What a label of that width covers.
pub(super) fn label_room(left: f64, baseline: f64, width: f64) -> Area {
    Area {
        x: left,
        y: baseline - 10.0,
        width,
        height: 13.0,
    }
}
