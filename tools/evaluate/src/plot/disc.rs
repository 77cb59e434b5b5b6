//! The hemisphere seen from above: directions at the feet of their perpendiculars on the unit disc.

use std::collections::BTreeSet;

use super::Caption;
use super::drawing::{
    ChartSize, Colour, Drawing, Element, INK, Outline, Paint, Stroke, TOP, WHITE,
};
use super::legend::{Entry, Legend};
use super::style::Style;
use super::text::{Anchor, TEXT, shortened};

/// A place with a name, such as `wo`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiscMark {
    /// Place on the disc, y upwards.
    pub at: (f64, f64),
    /// Its name, beside it.
    pub label: String,
}

/// The unit disc with cells, such as the leaves of a quadtree, and points, such as sampled directions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Disc {
    /// What it is.
    pub caption: Caption,
    /// Outlines, each by its corners; those smaller than a pixel are drawn as dots.
    pub cells: Vec<Vec<(f64, f64)>>,
    /// Points.
    pub points: Vec<(f64, f64)>,
    /// Marked places.
    pub marks: Vec<DiscMark>,
    /// Names of cells and of points in the legend; an empty one is not listed.
    pub labels: [String; 2],
}

/// Radius of the disc for each pixel of the sheet's width, where no height is given.
const USUAL_RADIUS: f64 = 190.0 / 640.0;
/// Above the disc.
const ABOVE: f64 = TOP + 4.0;

/// Where the disc lies.
#[derive(Clone, Copy)]
struct DiscPlace {
    centre: (f64, f64),
    radius: f64,
}

impl DiscPlace {
    /// Pixel of a place; `None` unless it is near the disc.
    fn pixel(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let (centre, radius) = (self.centre, self.radius);
        let near = x.abs() <= 1.01 && y.abs() <= 1.01;
        near.then_some((centre.0 + radius * x, centre.1 - radius * y))
    }
}

/// Cells that are smaller, in pixels, are dots.
const SMALLEST: f64 = 1.2;
const CELLS: Colour = Colour(0x8a8a8a);

impl Disc {
    /// The picture: 640 pixels wide, 440 or so high.
    pub fn svg(&self) -> String {
        self.svg_sized(ChartSize::default())
    }

    /// The picture in another size.
    pub fn svg_sized(&self, size: ChartSize) -> String {
        self.drawing(size).svg()
    }

    /// The shapes of the picture.
    pub fn drawing(&self, size: ChartSize) -> Drawing {
        let size = size.limited();
        // Points look alike in picture and legend; cells are grey squares and need no sample of a curve.
        let mut entries = Vec::new();
        if !self.labels[1].is_empty() {
            entries.push(Entry {
                label: self.labels[1].clone(),
                style: POINTS,
                line: false,
                mark: true,
            });
        }
        let legend = Legend::new(entries, size.width);
        let lines = if self.labels[0].is_empty() { 0.0 } else { 1.0 };
        let foot = 12.0 + 18.0 * lines + legend.height() + 8.0;
        let radius = size.radius(USUAL_RADIUS, 2.0, 24.0, ABOVE + foot);
        let place = DiscPlace {
            centre: (size.width / 2.0, ABOVE + radius),
            radius,
        };
        let below = place.centre.1 + radius + 12.0;
        let height = size.height.unwrap_or(0.0).max(below + foot - 12.0);
        let mut drawing = Drawing::new(size.width, height, &self.caption);
        self.draw_cells(&mut drawing, &place);
        drawing.elements.push(Element::Circle {
            centre: place.centre,
            radius,
            paint: Paint::outline(Stroke::new(INK).with_width(1.4)),
        });
        self.draw_points(&mut drawing, &place);
        for mark in &self.marks {
            draw_mark(&mut drawing, &place, mark);
        }
        if self.cells.is_empty() && self.points.is_empty() {
            drawing.label(place.centre, Anchor::Middle, "no data");
        }
        if lines > 0.0 {
            let label = shortened(&self.labels[0], TEXT, size.width - 66.0);
            drawing.label((58.0, below + 13.0), Anchor::Start, &label);
            let square = Paint::both(WHITE, Stroke::new(CELLS));
            drawing.path(
                &[
                    (32.0, below + 3.0),
                    (43.0, below + 3.0),
                    (43.0, below + 14.0),
                    (32.0, below + 14.0),
                ],
                true,
                square,
            );
        }
        legend.draw(&mut drawing, below + 18.0 * lines);
        drawing
    }

    /// Outlines in one path; each dot once, however many cells it stands for.
    fn draw_cells(&self, drawing: &mut Drawing, place: &DiscPlace) {
        let (mut outlines, mut dots) = (Vec::new(), BTreeSet::new());
        for cell in &self.cells {
            let Some(corners) = cell
                .iter()
                .map(|&p| place.pixel(p))
                .collect::<Option<Vec<_>>>()
            else {
                continue;
            };
            let Some(&first) = corners.first() else {
                continue;
            };
            let reach = |p: &(f64, f64)| (p.0 - first.0).abs().max((p.1 - first.1).abs());
            if corners.iter().map(reach).fold(0.0, f64::max) < SMALLEST {
                dots.insert((first.0.round() as i64, first.1.round() as i64));
            } else {
                outlines.push(Outline::Closed(corners));
            }
        }
        drawing.outlines(outlines, Paint::outline(Stroke::new(CELLS).with_width(0.6)));
        let pixels = dots.into_iter().map(|(x, y)| Outline::Pixel(x, y));
        drawing.outlines(pixels.collect(), Paint::inside(CELLS));
    }

    fn draw_points(&self, drawing: &mut Drawing, place: &DiscPlace) {
        // Round line ends of no length are dots, of a few bytes each.
        let mut dots = Vec::new();
        for &point in &self.points {
            let on_disc = point.0.hypot(point.1) <= 1.0 + 1e-6;
            if let Some((x, y)) = place.pixel(point).filter(|_| on_disc) {
                dots.push(Outline::Dot((x, y)));
            }
        }
        let stroke = Stroke {
            round_caps: true,
            ..Stroke::new(POINTS.colour()).with_width(2.6)
        };
        drawing.outlines(dots, Paint::outline(stroke));
    }
}

const POINTS: Style = Style(0);

fn draw_mark(drawing: &mut Drawing, place: &DiscPlace, mark: &DiscMark) {
    let Some((x, y)) = place.pixel(mark.at) else {
        return;
    };
    for (dx, dy) in [(6.0, 0.0), (0.0, 6.0)] {
        for (ink, width) in [(WHITE, 4.0), (INK, 1.8)] {
            drawing.line(
                (x - dx, y - dy),
                (x + dx, y + dy),
                Paint::line(Stroke::new(ink).with_width(width)),
            );
        }
    }
    // Towards the middle of the sheet, where there is room.
    let (dx, anchor) = if mark.at.0 > 0.5 {
        (-9.0, Anchor::End)
    } else {
        (9.0, Anchor::Start)
    };
    drawing.label_above((x + dx, y - 6.0), anchor, &mark.label);
}
