//! Lobes over the hemisphere as shaded solids.

use std::collections::BTreeSet;

use glam::DVec3;

use super::Caption;
use super::area::Area;
use super::axis::{Axis, Ruler};
use super::drawing::{ChartSize, Colour, Drawing, Element, Face, INK, Paint, Stroke};
use super::legend::{Entry, Legend};
use super::stage::{ARROW, Stage, arrows, draw_base, draw_names};
use super::style::Style;
use super::text::{Anchor, TEXT, shortened};
use super::viewpoint::Viewpoint;

/// A lobe by the vertices of its surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceLobe {
    /// Its name.
    pub label: String,
    /// Unit directions with their values: one in the middle, then rings of `spokes` around it, from the inmost.
    pub vertices: Vec<([f64; 3], f64)>,
    /// Vertices of a ring.
    pub spokes: usize,
    /// Chooses the colour.
    pub style: usize,
}

/// A hemisphere with lobes about one `wo`. Several are drawn translucent, the smallest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfacePanel {
    /// Stands above it.
    pub title: String,
    /// The lobes.
    pub lobes: Vec<SurfaceLobe>,
    /// Polar angle of `wo`, degrees; it is at x < 0, and its mirror direction at x > 0.
    pub theta_o: f64,
}

/// Lobes around the point where light is reflected: the farther out a surface is in a direction, the greater the value there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// What it is.
    pub caption: Caption,
    /// What the radius is, with its unit; its range must be given, the low end is in the middle and the high one on the
    /// hemisphere.
    pub radius: Axis,
    /// Hemispheres, in rows.
    pub panels: Vec<SurfacePanel>,
    /// From where all are seen.
    pub viewpoint: Viewpoint,
}

/// Pixels above a panel's solid for its title, and below it for the ruler.
const ABOVE: f64 = 34.0;
const BELOW: f64 = 66.0;
/// Pixels left and right of the arrows.
const SIDE: f64 = 48.0;
/// Opacity of lobes that share a hemisphere.
const TRANSLUCENT: f64 = 0.6;
/// Pieces of an arrow that are hidden or shown one by one.
const PIECES: usize = 24;

/// A piece of a panel, to be drawn from the farthest to the nearest.
enum Piece {
    Face(Face),
    Arrow(ArrowPiece),
}

/// A piece of an arrow: the arrow and the piece by their numbers, and its ends.
struct ArrowPiece {
    arrow: usize,
    number: usize,
    ends: [(f64, f64); 2],
}

/// Columns and rows, pixels of a panel, and the hemisphere's radius.
struct PanelGrid {
    columns: usize,
    width: f64,
    height: f64,
    radius: f64,
}

impl Surfaces {
    /// The shapes of the picture.
    pub fn drawing(&self, size: ChartSize) -> Drawing {
        let size = size.limited();
        let legend = Legend::new(self.entries(), size.width);
        let foot = legend.height() + 8.0;
        let grid = self.grid(size, foot);
        let rows = self.panels.len().div_ceil(grid.columns).max(1);
        let bottom = 30.0 + grid.height * rows as f64;
        let height = size.height.unwrap_or(0.0).max(bottom + foot);
        let mut drawing = Drawing::new(size.width, height, &self.caption);
        for (i, panel) in self.panels.iter().enumerate() {
            let area = Area {
                x: grid.width * (i % grid.columns) as f64,
                y: 30.0 + grid.height * (i / grid.columns) as f64,
                width: grid.width,
                height: grid.height,
            };
            self.draw_panel(&mut drawing, panel, &area, grid.radius);
        }
        if self.panels.is_empty() {
            drawing.no_data(&Area {
                x: 0.0,
                y: 30.0,
                width: size.width,
                height: grid.height,
            });
        }
        legend.draw(&mut drawing, height - foot);
        drawing
    }

    /// Radius of a value as a fraction of the hemisphere's; 0 for what has no place on the scale.
    pub fn radius_of(&self, value: f64) -> f64 {
        let ruler = Ruler::new(&self.radius, std::iter::empty(), 0.0, 1.0);
        ruler.map_or(0.0, |ruler| radius_on(&ruler, value))
    }

    /// Every lobe once, where hemispheres have several.
    fn entries(&self) -> Vec<Entry> {
        let (mut entries, mut named) = (Vec::new(), BTreeSet::new());
        for panel in self.panels.iter().filter(|p| p.lobes.len() > 1) {
            for lobe in panel.lobes.iter().filter(|l| !l.label.is_empty()) {
                if named.insert(&lobe.label) {
                    entries.push(Entry {
                        label: lobe.label.clone(),
                        style: Style(lobe.style),
                        line: false,
                        mark: true,
                    });
                }
            }
        }
        entries
    }

    /// One column, two for up to four panels, three for more.
    fn grid(&self, size: ChartSize, foot: f64) -> PanelGrid {
        let columns = match self.panels.len() {
            0 | 1 => 1,
            2..=4 => 2,
            _ => 3,
        };
        let rows = self.panels.len().div_ceil(columns).max(1) as f64;
        let width = size.width / columns as f64;
        let (up, down) = self.reach();
        let mut radius = (0.5 * width - SIDE) / ARROW;
        if let Some(height) = size.height {
            radius = radius.min(((height - 30.0 - foot) / rows - ABOVE - BELOW) / (up + down));
        }
        let radius = radius.max(30.0);
        PanelGrid {
            columns,
            width,
            height: ABOVE + BELOW + (up + down) * radius,
            radius,
        }
    }

    /// How far panels reach above and below their centres, in radii.
    fn reach(&self) -> (f64, f64) {
        let (sin, cos) = self.viewpoint.elevation.to_radians().sin_cos();
        // The hemisphere's top and rim, and the arrows' tips with their names.
        ((ARROW * cos).max(1.0).max(sin) + 0.06, sin.max(0.05))
    }

    fn draw_panel(&self, drawing: &mut Drawing, panel: &SurfacePanel, area: &Area, radius: f64) {
        let stage = Stage {
            centre: (
                area.x + 0.5 * area.width,
                area.y + ABOVE + self.reach().0 * radius,
            ),
            radius,
            projection: self.viewpoint.projection(),
        };
        // One panel is what the picture's title says.
        if self.panels.len() > 1 {
            let title = shortened(&panel.title, TEXT, area.width - 16.0);
            drawing.label((stage.centre.0, area.y + 12.0), Anchor::Middle, &title);
        }
        draw_base(drawing, &stage);
        let ruler = Ruler::new(&self.radius, std::iter::empty(), 0.0, 1.0);
        let Some(ruler) = ruler.filter(|_| !panel.lobes.is_empty()) else {
            drawing.label(stage.centre, Anchor::Middle, "no data");
            return;
        };
        let mut solids: Vec<Solid> = Vec::new();
        for lobe in &panel.lobes {
            solids.push(Solid::new(lobe, &ruler));
        }
        solids.sort_by(|a, b| a.mean_radius().total_cmp(&b.mean_radius()));
        let arrows = arrows(panel.theta_o);
        let mut pieces = arrow_pieces(&stage, &arrows, &solids);
        if let [solid] = &solids[..] {
            pieces.extend(solid.faces(&stage));
            draw_pieces(drawing, pieces);
        } else {
            draw_pieces(drawing, pieces);
            for solid in &solids {
                drawing.elements.push(Element::OpenLayer(TRANSLUCENT));
                draw_pieces(drawing, solid.faces(&stage));
                drawing.elements.push(Element::CloseLayer);
            }
        }
        draw_names(drawing, &stage, &arrows, area);
        self.draw_ruler(drawing, &stage, area);
    }

    /// The radius as a scale below the solid, as long as the hemisphere's own.
    fn draw_ruler(&self, drawing: &mut Drawing, stage: &Stage, area: &Area) {
        let y = area.bottom() - BELOW + 22.0;
        let left = stage.centre.0 - 0.5 * stage.radius;
        let right = left + stage.radius;
        let Some(ruler) = Ruler::new(&self.radius, std::iter::empty(), left, right) else {
            return;
        };
        let paint = Paint::line(Stroke::new(INK));
        drawing.line((left, y), (right, y), paint);
        for tick in ruler.ticks() {
            let length = if tick.label.is_some() { 5.0 } else { 3.0 };
            drawing.line((tick.at, y), (tick.at, y + length), paint);
            if let Some(label) = &tick.label {
                drawing.label((tick.at, y + 17.0), Anchor::Middle, label);
            }
        }
        let title = shortened(&self.radius.title, TEXT, area.width - 16.0);
        drawing.label((stage.centre.0, y + 32.0), Anchor::Middle, &title);
    }
}

/// The place of a value on a ruler from 0 to 1, within it.
fn radius_on(ruler: &Ruler, value: f64) -> f64 {
    ruler.pixel_of(value).unwrap_or(0.0).clamp(0.0, 1.0)
}

/// A lobe as points around the origin, in radii of the hemisphere.
struct Solid {
    directions: Vec<DVec3>,
    radii: Vec<f64>,
    spokes: usize,
    colour: Colour,
}

impl Solid {
    fn new(lobe: &SurfaceLobe, ruler: &Ruler) -> Self {
        let (mut directions, mut radii) = (Vec::new(), Vec::new());
        for (direction, value) in &lobe.vertices {
            let direction = DVec3::from_array(*direction);
            directions.push(if direction.is_finite() {
                direction
            } else {
                DVec3::Z
            });
            radii.push(radius_on(ruler, *value));
        }
        Self {
            directions,
            radii,
            spokes: lobe.spokes.max(1),
            colour: Style(lobe.style).colour(),
        }
    }

    fn mean_radius(&self) -> f64 {
        self.radii.iter().sum::<f64>() / self.radii.len().max(1) as f64
    }

    /// The radius at the vertex that is nearest to a direction.
    fn radius_towards(&self, direction: DVec3) -> f64 {
        let mut nearest = (f64::NEG_INFINITY, 0.0);
        for (vertex, radius) in self.directions.iter().zip(&self.radii) {
            let cosine = vertex.dot(direction);
            if cosine > nearest.0 {
                nearest = (cosine, *radius);
            }
        }
        nearest.1
    }

    /// Faces whose outside is seen, with how near each is.
    fn faces(&self, stage: &Stage) -> Vec<(f64, Piece)> {
        let points: Vec<DVec3> = self
            .directions
            .iter()
            .zip(&self.radii)
            .map(|(d, r)| *d * *r)
            .collect();
        let rings = points.len().saturating_sub(1) / self.spokes;
        let mut faces = Vec::new();
        for ring in 0..rings {
            for spoke in 0..self.spokes {
                let next = (spoke + 1) % self.spokes;
                let outer = 1 + ring * self.spokes;
                // Triangles around the middle, quadrangles between rings.
                let corners: Vec<DVec3> = match ring.checked_sub(1) {
                    None => vec![points[0], points[outer + spoke], points[outer + next]],
                    Some(inside) => {
                        let inner = 1 + inside * self.spokes;
                        let indices = [inner + spoke, outer + spoke, outer + next, inner + next];
                        indices.map(|i| points[i]).to_vec()
                    }
                };
                faces.extend(self.face(stage, &corners));
            }
        }
        faces
    }

    /// A face, unless it is seen from inside or has no area.
    fn face(&self, stage: &Stage, corners: &[DVec3]) -> Option<(f64, Piece)> {
        let last = corners[corners.len() - 1];
        // The normal by the diagonals; corners run anticlockwise about the mirror direction.
        let normal = (corners[corners.len() / 2] - corners[0]).cross(last - corners[1]);
        let normal = normal.try_normalize()?;
        if stage.projection.nearness(normal) <= 0.0 {
            return None;
        }
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let face = Face {
            corners: stage.pixels(corners.iter().copied()),
            colour: stage.projection.shade(self.colour, normal),
        };
        Some((stage.projection.nearness(middle), Piece::Face(face)))
    }
}

/// Draws pieces from the farthest to the nearest.
fn draw_pieces(drawing: &mut Drawing, mut pieces: Vec<(f64, Piece)>) {
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut faces, mut arrows) = (Vec::new(), Vec::new());
    for (_, piece) in pieces {
        // Neighbours in this order that are alike are drawn together.
        match piece {
            Piece::Face(face) => {
                draw_arrows(drawing, std::mem::take(&mut arrows));
                faces.push(face);
            }
            Piece::Arrow(piece) => {
                draw_faces(drawing, std::mem::take(&mut faces));
                arrows.push(piece);
            }
        }
    }
    draw_faces(drawing, faces);
    draw_arrows(drawing, arrows);
}

fn draw_faces(drawing: &mut Drawing, faces: Vec<Face>) {
    if !faces.is_empty() {
        drawing.elements.push(Element::Faces(faces));
    }
}

/// Draws pieces of arrows, those that follow each other as one line.
fn draw_arrows(drawing: &mut Drawing, mut pieces: Vec<ArrowPiece>) {
    let paint = Paint::line(Stroke::new(INK).with_width(1.6));
    pieces.sort_by_key(|piece| (piece.arrow, piece.number));
    let mut rest = &pieces[..];
    while let Some(first) = rest.first() {
        let joined = rest.iter().enumerate().take_while(|(i, piece)| {
            (piece.arrow, piece.number) == (first.arrow, first.number + i)
        });
        let count = joined.count();
        drawing.line(first.ends[0], rest[count - 1].ends[1], paint);
        rest = &rest[count..];
    }
}

/// Arrows from the surface of what they leave: inside it they are hidden.
fn arrow_pieces(stage: &Stage, arrows: &[(DVec3, &str)], solids: &[Solid]) -> Vec<(f64, Piece)> {
    let mut pieces = Vec::new();
    for (arrow, (direction, _)) in arrows.iter().enumerate() {
        let inside = match solids {
            [solid] => solid.radius_towards(*direction),
            _ => 0.0,
        };
        for number in 0..PIECES {
            let ends = [number, number + 1].map(|k| {
                let along = k as f64 / PIECES as f64;
                *direction * (inside + along * (ARROW - inside))
            });
            let nearness = stage.projection.nearness((ends[0] + ends[1]) / 2.0);
            let piece = ArrowPiece {
                arrow,
                number,
                ends: ends.map(|end| stage.pixel(end)),
            };
            pieces.push((nearness, Piece::Arrow(piece)));
        }
    }
    pieces
}
