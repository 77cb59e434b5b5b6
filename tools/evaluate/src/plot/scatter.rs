//! Points over two axes, and which of them nothing beats.

use super::Caption;
use super::area::{Area, overlap};
use super::axis::Axis;
use super::cartesian::{Frame, MARGIN};
use super::drawing::{ChartSize, Drawing, Element, INK, Paint, Stroke};
use super::legend::Entry;
use super::style::Style;
use super::text::{Anchor, TEXT, label_room, width_of};

/// A point and what it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterPoint {
    /// Across.
    pub x: f64,
    /// Upwards.
    pub y: f64,
    /// Shown beside points of the front where there is room, and on hovering beside all.
    pub label: String,
}

/// Points of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Its name in the legend; an empty one is not listed.
    pub label: String,
    /// Its points.
    pub points: Vec<ScatterPoint>,
    /// Chooses colour and mark.
    pub style: usize,
}

/// Points in groups, smaller values better on both axes; the front of those that no other beats is a step line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scatter {
    /// What it is.
    pub caption: Caption,
    /// The axis across.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The points.
    pub groups: Vec<Group>,
    /// Whether the front is drawn and its points labelled; without it all points are labelled where there is room.
    pub front: bool,
}

/// A point in the picture.
struct Placed<'a> {
    at: (f64, f64),
    label: &'a str,
    on_front: bool,
}

impl Scatter {
    /// The picture: 640 pixels wide, 440 or so high, more with a long legend.
    pub fn svg(&self) -> String {
        self.svg_sized(ChartSize::default())
    }

    /// The picture in another size.
    pub fn svg_sized(&self, size: ChartSize) -> String {
        let axes = (&self.x, &self.y);
        let frame = Frame::new(
            axes,
            self.points().map(|p| p.x),
            self.points().map(|p| p.y),
            MARGIN,
            self.legend_entries(),
            size,
        );
        let mut drawing = frame.begin(&self.caption, axes, true);
        let placed = self.lay_out(&frame);
        if self.front {
            let front: Vec<_> = placed
                .iter()
                .flatten()
                .filter(|p| p.on_front)
                .map(|p| p.at)
                .collect();
            draw_front(&mut drawing, &frame.area, front);
        }
        for (group, points) in self.groups.iter().zip(&placed) {
            let style = Style(group.style);
            let shown = points.iter().filter(|p| frame.area.holds(p.at));
            drawing.elements.push(Element::NamedMarks {
                paint: style.marks(),
                marks: shown.map(|p| (style.mark(p.at), p.label.into())).collect(),
            });
        }
        draw_labels(&mut drawing, &frame.area, &placed, self.front);
        drawing.svg()
    }

    /// The points of all groups.
    fn points(&self) -> impl Iterator<Item = &ScatterPoint> {
        self.groups.iter().flat_map(|g| &g.points)
    }

    fn legend_entries(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        for group in self.groups.iter().filter(|g| !g.label.is_empty()) {
            entries.push(Entry {
                label: group.label.clone(),
                style: Style(group.style),
                line: false,
                mark: true,
            });
        }
        entries
    }

    fn lay_out<'a>(&'a self, frame: &Frame) -> Vec<Vec<Placed<'a>>> {
        let mut drawable = Vec::new();
        for p in self.points() {
            if frame.pixel((p.x, p.y)).is_some() {
                drawable.push((p.x, p.y));
            }
        }
        let front = front(&drawable);
        let mut groups = Vec::new();
        for group in &self.groups {
            let mut placed = Vec::new();
            for p in &group.points {
                if let Some(at) = frame.pixel((p.x, p.y)) {
                    placed.push(Placed {
                        at,
                        label: &p.label,
                        on_front: front.contains(&(p.x, p.y)),
                    });
                }
            }
            groups.push(placed);
        }
        groups
    }
}

/// The points that no other beats: none is smaller on one axis and not greater on the other. By rising x.
fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    sorted.retain(|p| {
        let unbeaten = p.1 < least;
        least = least.min(p.1);
        unbeaten
    });
    sorted
}

/// Steps from the upper edge along the front to the right edge.
fn draw_front(drawing: &mut Drawing, area: &Area, mut front: Vec<(f64, f64)>) {
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((&first, &last)) = front.first().zip(front.last()) else {
        return;
    };
    let mut steps = vec![(first.0, area.y), first];
    for pair in front.windows(2) {
        steps.extend([(pair[1].0, pair[0].1), pair[1]]);
    }
    steps.push((area.right(), last.1));
    drawing.open_window(area);
    drawing.path(
        &steps,
        false,
        Paint::outline(Stroke::new(INK).with_dashes(&[5.0, 3.0])),
    );
    drawing.close_window();
}

/// Labels where they cover neither points nor each other, and nowhere else.
fn draw_labels(drawing: &mut Drawing, area: &Area, placed: &[Vec<Placed<'_>>], front_only: bool) {
    let points: Vec<&Placed<'_>> = placed
        .iter()
        .flatten()
        .filter(|p| area.holds(p.at))
        .collect();
    let mut taken: Vec<Area> = points.iter().map(|p| around(p.at)).collect();
    for (own, p) in points.iter().enumerate() {
        if p.label.is_empty() || (front_only && !p.on_front) {
            continue;
        }
        for (at, anchor, room) in places(p) {
            if is_free(&room, area, &taken, own) {
                drawing.label_above(at, anchor, p.label);
                taken.push(room);
                break;
            }
        }
    }
}

/// Whether `room` lies within `area` and overlaps nothing that is taken, but for the label's `own` point.
fn is_free(room: &Area, area: &Area, taken: &[Area], own: usize) -> bool {
    let inside = area.holds((room.x, room.y)) && area.holds((room.right(), room.bottom()));
    inside
        && taken
            .iter()
            .enumerate()
            .all(|(i, t)| i == own || !overlap(t, room))
}

fn around((x, y): (f64, f64)) -> Area {
    Area {
        x: x - 4.0,
        y: y - 4.0,
        width: 8.0,
        height: 8.0,
    }
}

/// Where a label may stand, the best place first, and the room it takes there.
fn places(p: &Placed<'_>) -> Vec<((f64, f64), Anchor, Area)> {
    let (width, (x, y)) = (width_of(p.label, TEXT), p.at);
    let mut out = Vec::new();
    // Left of a point and below it none can beat it, so that there is room.
    for dy in [15.0, 4.0, -6.0] {
        out.push((
            (x - 7.0, y + dy),
            Anchor::End,
            label_room(x - 7.0 - width, y + dy, width),
        ));
    }
    for dy in [4.0, -6.0, 15.0] {
        out.push((
            (x + 7.0, y + dy),
            Anchor::Start,
            label_room(x + 7.0, y + dy, width),
        ));
    }
    for dy in [-8.0, 17.0] {
        out.push((
            (x, y + dy),
            Anchor::Middle,
            label_room(x - width / 2.0, y + dy, width),
        ));
    }
    out
}
