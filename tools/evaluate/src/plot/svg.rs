//! Drawings as SVG: elements, numbers and text that can't break the markup.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::area::Area;
use super::drawing::{
    Colour, Drawing, Element, Face, Fill, INK, Outline, Paint, SEAM, TextLine, bounded,
};
use super::text::{Anchor, TEXT};

impl Drawing {
    /// The picture as SVG: the same text for the same shapes.
    pub fn svg(&self) -> String {
        let (width, height) = (px(self.width), px(self.height));
        let ink = hex(INK);
        let mut lines = vec![
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"{TEXT}\" fill=\"{ink}\">"
            ),
            format!("<title>{}</title>", escape(&self.caption.title)),
            format!("<desc>{}</desc>", escape(&self.caption.description)),
            format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"),
        ];
        for element in &self.elements {
            lines.push(markup(element));
        }
        lines.push("</svg>\n".into());
        lines.join("\n")
    }
}

fn markup(element: &Element) -> String {
    match element {
        Element::Line { from, to, paint } => {
            let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(px);
            let style = attributes(paint);
            format!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{style}/>")
        }
        Element::Path { outlines, paint } => {
            let data: String = outlines.iter().map(path_data).collect();
            format!("<path d=\"{data}\"{}/>", attributes(paint))
        }
        Element::Circle {
            centre,
            radius,
            paint,
        } => {
            let [x, y, r] = [centre.0, centre.1, *radius].map(px);
            let style = attributes(paint);
            format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{style}/>")
        }
        Element::Rectangle { area, paint } => {
            format!("<rect {}{}/>", place_attributes(area), attributes(paint))
        }
        Element::Text(line) => text(line),
        Element::Image { area, raster } => format!(
            "<image {} preserveAspectRatio=\"none\" image-rendering=\"optimizeSpeed\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
            place_attributes(area),
            STANDARD.encode(&raster.png)
        ),
        Element::NamedMarks { paint, marks } => named_marks(paint, marks),
        Element::Faces(faces) => polygons(faces),
        // Without an `id` to clip by, so that pictures can stand in one page.
        Element::OpenWindow(area) => {
            let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(px);
            let place = place_attributes(area);
            format!("<svg {place} viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">")
        }
        Element::CloseWindow => "</svg>".into(),
        Element::OpenLayer(opacity) => format!("<g opacity=\"{}\">", px(*opacity)),
        Element::CloseLayer => "</g>".into(),
    }
}

fn named_marks(paint: &Paint, marks: &[(Outline, String)]) -> String {
    let mut lines = vec![format!("<g{}>", attributes(paint))];
    for (mark, name) in marks {
        let (data, name) = (path_data(mark), escape(name));
        lines.push(format!("<path d=\"{data}\"><title>{name}</title></path>"));
    }
    lines.push("</g>".into());
    lines.join("\n")
}

fn polygons(faces: &[Face]) -> String {
    // A line of the face's own colour covers the seam to its neighbour.
    let mut lines = vec![format!(
        "<g stroke-width=\"{}\" stroke-linejoin=\"round\">",
        px(SEAM)
    )];
    for face in faces {
        let (data, colour) = (join(&face.corners), hex(face.colour));
        lines.push(format!(
            "<path d=\"{data}Z\" fill=\"{colour}\" stroke=\"{colour}\"/>"
        ));
    }
    lines.push("</g>".into());
    lines.join("\n")
}

fn place_attributes(area: &Area) -> String {
    let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(px);
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

fn text(line: &TextLine) -> String {
    let [x, y] = [line.at.0, line.at.1].map(px);
    let anchor = match line.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let mut style = String::new();
    if line.rim {
        style.push_str(
            " paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\"",
        );
    }
    if line.upwards {
        style.push_str(&format!(" transform=\"rotate(-90 {x} {y})\""));
    }
    let size = if line.size == TEXT {
        String::new()
    } else {
        format!(" font-size=\"{}\"", px(line.size))
    };
    let text = escape(&line.text);
    format!("<text x=\"{x}\" y=\"{y}\"{size} text-anchor=\"{anchor}\"{style}>{text}</text>")
}

/// The attributes of a paint, each after a space.
fn attributes(paint: &Paint) -> String {
    let mut out = match paint.fill {
        Fill::Unset => String::new(),
        Fill::Empty => " fill=\"none\"".into(),
        Fill::Full(colour, 1.0) => format!(" fill=\"{}\"", hex(colour)),
        Fill::Full(colour, opacity) => {
            let opacity = px(opacity);
            format!(" fill=\"{}\" fill-opacity=\"{opacity}\"", hex(colour))
        }
    };
    let Some(stroke) = &paint.stroke else {
        return out;
    };
    out.push_str(&format!(" stroke=\"{}\"", hex(stroke.colour)));
    if stroke.width != 1.0 {
        out.push_str(&format!(" stroke-width=\"{}\"", px(stroke.width)));
    }
    if stroke.round_joins {
        out.push_str(" stroke-linejoin=\"round\"");
    }
    if stroke.round_caps {
        out.push_str(" stroke-linecap=\"round\"");
    }
    if !stroke.dashes.is_empty() {
        let dashes: Vec<String> = stroke.dashes.iter().map(|d| px(*d)).collect();
        out.push_str(&format!(" stroke-dasharray=\"{}\"", dashes.join(" ")));
    }
    out
}

fn hex(colour: Colour) -> String {
    format!("#{:06x}", colour.0)
}

/// The commands of a path.
fn path_data(outline: &Outline) -> String {
    match outline {
        Outline::Open(points) => join(points),
        Outline::Closed(points) => join(points) + "Z",
        Outline::Disc { centre, radius } => {
            let [left, y, r, d] = [centre.0 - radius, centre.1, *radius, 2.0 * radius].map(px);
            format!("M{left} {y}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z")
        }
        Outline::UpperHalf { centre, radius } => {
            let [left, right] = [centre.0 - radius, centre.0 + radius].map(px);
            let [y, r] = [centre.1, *radius].map(px);
            format!("M{left} {y}A{r} {r} 0 0 1 {right} {y}")
        }
        Outline::Pixel(x, y) => format!("M{x} {y}h1v1h-1Z"),
        Outline::Dot((x, y)) => format!("M{} {}h0", px(*x), px(*y)),
    }
}

/// Straight lines through `points`.
fn join(points: &[(f64, f64)]) -> String {
    let mut data = String::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&format!("{} {}", px(x), px(y)));
    }
    data
}

/// A coordinate in hundredths of a pixel, without zeros at its end; 0 for NaN.
fn px(x: f64) -> String {
    let text = format!("{:.2}", bounded(x));
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
