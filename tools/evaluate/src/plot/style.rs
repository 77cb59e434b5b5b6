//! How the curves of a chart are told apart.

use super::drawing::{Colour, Fill, Outline, Paint, Stroke, WHITE};

/// Dashes that styles have: a style's number modulo this is its dash.
pub const DASHES: usize = 5;
/// Colours that styles have.
pub const COLOURS: usize = 7;
/// Okabe and Ito's colours but yellow, which is too pale for lines on white.
const PALETTE: [Colour; COLOURS] = [
    Colour(0x0072b2),
    Colour(0xd55e00),
    Colour(0x009e73),
    Colour(0xcc79a7),
    Colour(0xe69f00),
    Colour(0x56b4e9),
    Colour(0x000000),
];
/// Lengths of dashes and gaps, pixels; the first is a whole line.
const DASH_PATTERNS: [&[f64]; DASHES] = [
    &[],
    &[8.0, 4.0],
    &[2.0, 3.0],
    &[10.0, 3.0, 2.0, 3.0],
    &[14.0, 5.0],
];
const MARKS: usize = 6;
/// Half the width of a mark.
const MARK: f64 = 3.6;

/// The number of the style with the given colour, dash and mark, each counted from 0 and taken again from the first when there
/// are no more.
pub fn style_number(colour: usize, dash: usize, mark: usize) -> usize {
    // The Chinese remainder theorem: 120, 126 and 175 are 1 modulo 7, 5 and 6, and 0 modulo the two others.
    let sum = 120 * (colour % COLOURS) + 126 * (dash % DASHES) + 175 * (mark % MARKS);
    sum % (COLOURS * DASHES * MARKS)
}

/// Colour, dash and mark of a number: 210 different ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Style(pub usize);

impl Style {
    pub fn colour(self) -> Colour {
        PALETTE[self.0 % COLOURS]
    }

    /// Of a line.
    pub fn stroke(self) -> Paint {
        let stroke = Stroke {
            round_joins: true,
            ..Stroke::new(self.colour()).with_width(1.8)
        };
        Paint::outline(stroke.with_dashes(DASH_PATTERNS[self.0 % DASHES]))
    }

    /// Of a surface that lets others show through.
    pub fn translucent(self) -> Paint {
        Paint {
            fill: Fill::Full(self.colour(), 0.18),
            stroke: None,
        }
    }

    /// Of marks.
    pub fn marks(self) -> Paint {
        Paint::both(self.colour(), Stroke::new(WHITE).with_width(0.8))
    }

    /// The mark at a place: disc, square, triangle, diamond, triangle on its head, cross.
    pub fn mark(self, (x, y): (f64, f64)) -> Outline {
        let corners: &[(f64, f64)] = match self.0 % MARKS {
            0 => {
                return Outline::Disc {
                    centre: (x, y),
                    radius: MARK,
                };
            }
            1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            2 => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
            3 => &[(0.0, -1.3), (1.1, 0.0), (0.0, 1.3), (-1.1, 0.0)],
            4 => &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
            _ => &CROSS,
        };
        let corners = corners.iter().map(|c| (x + MARK * c.0, y + MARK * c.1));
        Outline::Closed(corners.collect())
    }
}

/// Corners of a plus sign.
const CROSS: [(f64, f64); 12] = [
    (-0.4, -1.2),
    (0.4, -1.2),
    (0.4, -0.4),
    (1.2, -0.4),
    (1.2, 0.4),
    (0.4, 0.4),
    (0.4, 1.2),
    (-0.4, 1.2),
    (-0.4, 0.4),
    (-1.2, 0.4),
    (-1.2, -0.4),
    (-0.4, -0.4),
];
