//! How the curves of a chart are told apart.

use super::svg::px;

/// Dashes that styles have: a style's number modulo this is its dash.
pub const DASHES: usize = 5;
/// Colours that styles have.
pub const COLOURS: usize = 7;
/// Okabe and Ito's colours but yellow, which is too pale for lines on white.
const PALETTE: [&str; COLOURS] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
];
/// Lengths of dashes and gaps, pixels; the first is a whole line.
const DASH_PATTERNS: [&str; DASHES] = ["", "8 4", "2 3", "10 3 2 3", "14 5"];
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
    pub fn colour(self) -> &'static str {
        PALETTE[self.0 % COLOURS]
    }

    /// Attributes of a line.
    pub fn stroke(self) -> String {
        let dash = match DASH_PATTERNS[self.0 % DASHES] {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\""),
        };
        let colour = self.colour();
        format!(
            "fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-linejoin=\"round\"{dash}"
        )
    }

    /// Attributes of a surface that lets others show through.
    pub fn translucent(self) -> String {
        format!("fill=\"{}\" fill-opacity=\"0.18\"", self.colour())
    }

    /// Attributes of a group of marks.
    pub fn marks(self) -> String {
        format!(
            "fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.8\"",
            self.colour()
        )
    }

    /// Path of the mark at a place: disc, square, triangle, diamond, triangle on its head, cross.
    pub fn mark(self, (x, y): (f64, f64)) -> String {
        let r = MARK;
        let polygon = |corners: &[(f64, f64)]| {
            let at: Vec<_> = corners.iter().map(|c| (x + r * c.0, y + r * c.1)).collect();
            super::svg::path_data(&at, true)
        };
        match self.0 % MARKS {
            0 => {
                let left = px(x - r);
                let d = px(2.0 * r);
                let r = px(r);
                format!(
                    "M{left} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z",
                    px(y)
                )
            }
            1 => polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            2 => polygon(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]),
            3 => polygon(&[(0.0, -1.3), (1.1, 0.0), (0.0, 1.3), (-1.1, 0.0)]),
            4 => polygon(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]),
            _ => polygon(&CROSS),
        }
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
