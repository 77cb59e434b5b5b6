//! Curves over the angle in one plane.

use super::Caption;
use super::area::{Area, overlap};
use super::axis::{Axis, Ruler, Scale};
use super::drawing::{ChartSize, Colour, Drawing, GRID, INK, Outline, Paint, Stroke, TOP};
use super::legend::{Entry, Legend};
use super::lines::runs;
use super::style::Style;
use super::text::{Anchor, TEXT, label_room, shortened, width_of};

/// A curve around the origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolarCurve {
    /// Its name in the legend; an empty one is not listed.
    pub label: String,
    /// (angle, radius): degrees from the normal, −90 to 90, positive to the right; a point that can't be drawn breaks the
    /// curve.
    pub points: Vec<(f64, f64)>,
    /// Chooses colour and dash.
    pub style: usize,
}

/// Curves over −90° to 90° in the plane of incidence, such as lobes and densities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polar {
    /// What it is.
    pub caption: Caption,
    /// What the radius is, with its unit; [`Scale::Log`] has no place for 0 at the origin and is taken for
    /// [`Scale::Root`]. A range must begin at 0.
    pub radius: Axis,
    /// The curves.
    pub curves: Vec<PolarCurve>,
    /// Polar angles of `wo`, degrees: each is marked on the left, and its mirror direction on the right.
    pub wo: Vec<f64>,
}

/// Radius of the half circle for each pixel of the sheet's width, where no height is given.
const USUAL_RADIUS: f64 = 262.0 / 640.0;
/// Pixels left and right of the half circle, for the angles' names, and above it.
const SIDES: f64 = 84.0;
const ABOVE: f64 = TOP + 26.0;

/// Where the half circle lies.
#[derive(Clone, Copy)]
struct HalfCircle {
    centre: (f64, f64),
    radius: f64,
}

/// Angle between a direction's line and its name, degrees.
const BESIDE: f64 = 2.8;
/// Distances at which names may stand, and pixels between them.
const NAME_RINGS: u8 = 12;
const NAME_RING: f64 = 16.0;
/// From the base line to the legend.
const BELOW: f64 = 46.0;

impl Polar {
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
        let size = size.limited();
        let mut entries = Vec::new();
        for curve in self.curves.iter().filter(|c| !c.label.is_empty()) {
            entries.push(Entry {
                label: curve.label.clone(),
                style: Style(curve.style),
                line: true,
                mark: false,
            });
        }
        let legend = Legend::new(entries, size.width);
        let below = BELOW + legend.height() + 8.0;
        let radius = size.radius(USUAL_RADIUS, 1.0, SIDES, ABOVE + below);
        let half = HalfCircle {
            centre: (size.width / 2.0, ABOVE + radius),
            radius,
        };
        let base = half.centre.1;
        let height = size.height.unwrap_or(0.0).max(base + below);
        let mut drawing = Drawing::new(size.width, height, &self.caption);
        let ruler = self.ruler(&half);
        half.draw_grid(&mut drawing, ruler.as_ref());
        let title = match self.axis().scale {
            Scale::Root => format!("{} (root scale)", self.radius.title),
            _ => self.radius.title.clone(),
        };
        let title = shortened(&title, TEXT, size.width - 40.0);
        drawing.label((half.centre.0, base + 36.0), Anchor::Middle, &title);
        match ruler {
            Some(ruler) => self.draw_curves(&mut drawing, &half, &ruler),
            None => drawing.no_data(&half.area()),
        }
        self.draw_directions(&mut drawing, &half);
        legend.draw(&mut drawing, base + BELOW);
        drawing
    }

    fn axis(&self) -> Axis {
        let scale = if self.radius.scale == Scale::Linear {
            Scale::Linear
        } else {
            Scale::Root
        };
        Axis {
            scale,
            ..self.radius.clone()
        }
    }

    /// From the origin outwards; the origin is 0.
    fn ruler(&self, half: &HalfCircle) -> Option<Ruler> {
        let axis = self.axis();
        let radii = self.curves.iter().flat_map(|c| &c.points).map(|p| p.1);
        let greatest = radii
            .filter(|r| r.is_finite() && *r > 0.0)
            .fold(0.0, f64::max);
        let range = axis
            .range
            .filter(|r| r.0 == 0.0)
            .or((greatest > 0.0).then_some((0.0, greatest * 1.04)));
        range.and_then(|(low, high)| {
            Ruler::new(
                &axis.with_range(low, high),
                std::iter::empty(),
                half.centre.0,
                half.centre.0 + half.radius,
            )
        })
    }

    fn draw_curves(&self, drawing: &mut Drawing, half: &HalfCircle, ruler: &Ruler) {
        drawing.open_window(&half.area());
        for curve in &self.curves {
            let place = |&(angle, radius): &(f64, f64)| {
                let distance = ruler.pixel_of(radius)? - half.centre.0;
                (angle.abs() <= 90.0 && distance >= 0.0).then(|| half.around(angle, distance))
            };
            for run in runs(curve.points.iter().map(place)) {
                drawing.path(&run, false, Style(curve.style).stroke());
            }
        }
        drawing.close_window();
    }

    /// Lines towards `wo` and its mirror direction, and which is which.
    fn draw_directions(&self, drawing: &mut Drawing, half: &HalfCircle) {
        let thetas = self.wo.iter().filter(|t| (0.0..=90.0).contains(*t));
        let mut ends: Vec<(f64, String, &'static [f64])> = Vec::new();
        for &theta in thetas {
            let angle = if self.wo.len() == 1 {
                String::new()
            } else {
                format!(" {theta}°")
            };
            ends.push((-theta, format!("wo{angle}"), &[6.0, 3.0]));
            // At the normal both are one.
            if theta != 0.0 {
                ends.push((theta, format!("mirror{angle}"), &[1.5, 3.0]));
            }
        }
        for (angle, _, dashes) in &ends {
            let paint = Paint::line(Stroke::new(INK).with_dashes(dashes));
            drawing.line(half.centre, half.around(*angle, half.radius), paint);
        }
        // Above all lines, and apart from each other. Those near the normal, where room is short, give way.
        ends.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        let mut taken = Vec::new();
        for (angle, label, _) in &ends {
            half.draw_direction_name(drawing, *angle, label, &mut taken);
        }
    }
}

impl HalfCircle {
    /// The name of a direction beside its line, on the normal's side or the other, as far out as no other name is in its way; what
    /// it covers joins `taken`.
    fn draw_direction_name(
        &self,
        drawing: &mut Drawing,
        angle: f64,
        label: &str,
        taken: &mut Vec<Area>,
    ) {
        let width = width_of(label, TEXT);
        for step in 0..NAME_RINGS {
            let distance = self.radius - 14.0 - NAME_RING * f64::from(step);
            // The same pixels from the line at each distance.
            let beside = BESIDE * self.radius / distance;
            for side in [-1.0, 1.0] {
                let (x, y) = self.around(angle + side * angle.signum() * beside, distance);
                let (anchor, left) = if angle == 0.0 {
                    (Anchor::Middle, x - 0.5 * width)
                } else if (angle < 0.0) == (side < 0.0) {
                    (Anchor::Start, x)
                } else {
                    (Anchor::End, x - width)
                };
                let room = label_room(left, y + 4.0, width);
                let free = taken.iter().all(|t| !overlap(t, &room));
                if free && (angle == 0.0 || self.holds_on_one_side(&room)) {
                    drawing.label_above((x, y + 4.0), anchor, label);
                    taken.push(room);
                    return;
                }
            }
        }
    }

    /// Whether a name lies within the half circle and does not reach across the normal, where it would seem another line's.
    fn holds_on_one_side(&self, room: &Area) -> bool {
        let (x, y) = self.centre;
        let farthest = (room.x - x).abs().max((room.right() - x).abs());
        let inside = farthest.hypot(y - room.y) < self.radius - 2.0;
        inside && (room.x >= x || room.right() <= x)
    }

    /// The picture's part above the base line.
    fn area(&self) -> Area {
        Area {
            x: self.centre.0 - self.radius - 1.0,
            y: self.centre.1 - self.radius - 1.0,
            width: 2.0 * self.radius + 2.0,
            height: self.radius + 2.0,
        }
    }

    /// Pixel at an angle in degrees and a distance from the centre.
    fn around(&self, angle: f64, distance: f64) -> (f64, f64) {
        let (sin, cos) = angle.to_radians().sin_cos();
        (
            self.centre.0 + distance * sin,
            self.centre.1 - distance * cos,
        )
    }

    /// The half of a circle about the centre that lies above the surface.
    fn draw_ring(&self, drawing: &mut Drawing, radius: f64, ink: Colour) {
        let centre = self.centre;
        let half = Outline::UpperHalf { centre, radius };
        drawing.outlines(vec![half], Paint::outline(Stroke::new(ink)));
    }

    /// Rings with their radii, spokes with their angles, and the surface.
    fn draw_grid(&self, drawing: &mut Drawing, ruler: Option<&Ruler>) {
        for tick in ruler.map(Ruler::ticks).unwrap_or_default() {
            let radius = tick.at - self.centre.0;
            if radius > 1.0 && radius < self.radius - 1.0 {
                self.draw_ring(drawing, radius, GRID);
            }
            if let Some(label) = tick.label {
                drawing.label((tick.at, self.centre.1 + 18.0), Anchor::Middle, &label);
                drawing.line(
                    (tick.at, self.centre.1),
                    (tick.at, self.centre.1 + 5.0),
                    Paint::line(Stroke::new(INK)),
                );
            }
        }
        self.draw_ring(drawing, self.radius, INK);
        for step in -6..=6 {
            let angle = f64::from(step) * 15.0;
            drawing.line(
                self.centre,
                self.around(angle, self.radius),
                Paint::line(Stroke::new(GRID)),
            );
            if step % 2 == 0 {
                let (x, y) = self.around(angle, self.radius + 12.0);
                let anchor = match step {
                    0 => Anchor::Middle,
                    s if s < 0 => Anchor::End,
                    _ => Anchor::Start,
                };
                drawing.label((x, y + 4.0), anchor, &format!("{}°", angle.abs()));
            }
        }
        drawing.line(
            self.around(-90.0, self.radius),
            self.around(90.0, self.radius),
            Paint::line(Stroke::new(INK)),
        );
    }
}
