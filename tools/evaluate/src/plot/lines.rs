//! Curves over two axes.

use super::Caption;
use super::area::Area;
use super::axis::Axis;
use super::cartesian::{Frame, MARGIN};
use super::drawing::{ChartSize, Drawing};
use super::legend::Entry;
use super::style::Style;

/// Where a series has marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marks {
    /// On a line, at most twelve of its points: enough to tell it from others in black and white.
    #[default]
    Few,
    /// On a line, at each point.
    Each,
    /// At each point, without a line.
    Only,
    /// None: a line alone.
    None,
}

/// Marks that tell a line from others.
const FEW: usize = 12;

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend; an empty one is not listed.
    pub label: String,
    /// (x, y), joined in this order; a point that an axis can't hold breaks the line.
    pub points: Vec<(f64, f64)>,
    /// (x, low, high): a translucent band, such as a confidence interval. A `low` that the axis can't hold is its lower end.
    pub band: Vec<(f64, f64, f64)>,
    /// Chooses colour, dash and mark: the same number looks the same in every chart.
    pub style: usize,
    /// Where marks stand.
    pub marks: Marks,
}

/// Curves, with bands, over linear or logarithmic axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// What it is.
    pub caption: Caption,
    /// The axis across.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The curves, later ones above earlier ones.
    pub series: Vec<Series>,
}

impl Lines {
    /// The picture: 640 pixels wide, 440 or so high, more with a long legend.
    pub fn svg(&self) -> String {
        self.svg_sized(ChartSize::default())
    }

    /// The picture in another size.
    pub fn svg_sized(&self, size: ChartSize) -> String {
        self.drawing(size).svg()
    }

    /// The shapes of the picture.
    pub fn drawing(&self, size: ChartSize) -> Drawing {
        let axes = (&self.x, &self.y);
        let listed = self.series.iter().filter(|s| !s.label.is_empty());
        let entries = listed.map(Series::entry).collect();
        let frame = Frame::new(axes, self.all_x(), self.all_y(), MARGIN, entries, size);
        let mut drawing = frame.begin(&self.caption, axes, true);
        drawing.open_window(&frame.area);
        for series in &self.series {
            series.draw_band(&frame, &mut drawing);
        }
        for series in &self.series {
            series.draw_line(&frame, &mut drawing);
        }
        drawing.close_window();
        for (i, series) in self.series.iter().enumerate() {
            series.draw_marks(&frame, &mut drawing, i);
        }
        drawing
    }

    fn all_x(&self) -> impl Iterator<Item = f64> {
        self.series.iter().flat_map(|s| {
            s.points
                .iter()
                .map(|p| p.0)
                .chain(s.band.iter().map(|b| b.0))
        })
    }

    fn all_y(&self) -> impl Iterator<Item = f64> {
        self.series.iter().flat_map(|s| {
            let of_band = s.band.iter().flat_map(|&(_, low, high)| [low, high]);
            s.points.iter().map(|p| p.1).chain(of_band)
        })
    }
}

impl Series {
    fn entry(&self) -> Entry {
        Entry {
            label: self.label.clone(),
            style: Style(self.style),
            line: self.marks != Marks::Only,
            mark: self.marks != Marks::None,
        }
    }

    fn draw_band(&self, frame: &Frame, drawing: &mut Drawing) {
        let edges = |&(x, low, high): &(f64, f64, f64)| {
            let above = frame.pixel((x, high))?;
            let floor = frame.rulers.as_ref().map_or(above.1, |r| r.1.bottom());
            let below = frame.pixel((x, low)).map_or((above.0, floor), |p| p);
            Some((below, above))
        };
        for run in runs(self.band.iter().map(edges)) {
            let outline: Vec<_> = run
                .iter()
                .map(|e| e.0)
                .chain(run.iter().rev().map(|e| e.1))
                .collect();
            drawing.path(&outline, true, Style(self.style).translucent());
        }
    }

    fn draw_line(&self, frame: &Frame, drawing: &mut Drawing) {
        if self.marks == Marks::Only {
            return;
        }
        for run in runs(self.points.iter().map(|&p| frame.pixel(p))) {
            drawing.path(&run, false, Style(self.style).stroke());
        }
    }

    fn draw_marks(&self, frame: &Frame, drawing: &mut Drawing, order: usize) {
        let inside = self
            .points
            .iter()
            .filter_map(|&p| frame.pixel(p))
            .filter(|&p| frame.area.holds(p));
        let points: Vec<_> = inside.collect();
        let chosen = match self.marks {
            Marks::None => Vec::new(),
            Marks::Few if points.len() > FEW => spread(&points, frame.area, order),
            _ => points,
        };
        draw_marks(drawing, Style(self.style), &chosen);
    }
}

/// A mark at each of `points`, in one path: marks that overlap don't hide each other's rims.
pub(super) fn draw_marks(drawing: &mut Drawing, style: Style, points: &[(f64, f64)]) {
    let marks = points.iter().map(|&p| style.mark(p));
    drawing.outlines(marks.collect(), style.marks());
}

/// A few points, about as far apart across the picture; not the same ones for the next curve, which may hide this one.
fn spread(points: &[(f64, f64)], area: Area, order: usize) -> Vec<(f64, f64)> {
    let step = area.width / (FEW - 1) as f64;
    let mut next = area.x + step * (order % 3) as f64 / 3.0;
    let mut chosen = Vec::new();
    for &p in points {
        if chosen.len() < FEW && p.0 >= next {
            chosen.push(p);
            next = p.0 + step;
        }
    }
    // A curve shorter than a step has one all the same.
    if chosen.is_empty() {
        chosen.extend(points.get(points.len() / 2));
    }
    chosen
}

/// Pieces without a gap.
pub(super) fn runs<T>(places: impl Iterator<Item = Option<T>>) -> Vec<Vec<T>> {
    let mut out = vec![Vec::new()];
    for place in places {
        match (place, out.last_mut()) {
            (Some(place), Some(run)) => run.push(place),
            _ => out.push(Vec::new()),
        }
    }
    out.retain(|run| !run.is_empty());
    out
}
