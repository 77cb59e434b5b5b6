//! Charts as SVG text, from numbers alone.
//!
//! One struct a kind of chart, its fields the numbers to show, and `svg()`, which gives the text of one picture: the same
//! text for the same numbers. What to show, and where the numbers come from, is the callers' business
//! ([`crate::measure::views`] has some).
//!
//! Every picture stands alone and can be put into a page beside others: text stays text in the reader's sans-serif font,
//! nothing has an `id`, a script or an address outside the file, `<title>` and `<desc>` tell a screen reader what it is.
//! Colours are those of Okabe and Ito (2008), which colour-blind readers tell apart; dashes and marks tell the same curves
//! apart in black and white.
//!
//! Values that an axis can't hold are left out, and break a line where they stand: NaN and infinity, 0 and less on a
//! logarithmic axis, less than 0 under a root, and 10³⁰⁰ and more. Without anything to draw a chart says "no data". Labels
//! too long for their place end in "…".

mod area;
mod axis;
mod cartesian;
mod chart;
mod colours;
mod disc;
mod drawing;
mod heat;
mod legend;
mod lines;
mod pdf;
mod pdf_text;
mod png;
mod polar;
mod scatter;
mod sky;
mod stage;
mod style;
mod surfaces;
mod svg;
mod text;
mod viewpoint;

pub use axis::{Axis, Scale};
pub use chart::Chart;
pub use colours::viridis;
pub use disc::{Disc, DiscMark};
pub use drawing::{ChartSize, Drawing};
pub use heat::{Heat, Pixels};
pub use lines::{Lines, Marks, Series};
pub use polar::{Polar, PolarCurve};
pub use scatter::{Group, Scatter, ScatterPoint};
pub use sky::SkyMap;
pub use style::{COLOURS, DASHES, style_number};
pub use surfaces::{SurfaceLobe, SurfacePanel, Surfaces};
pub(crate) use svg::escape;
pub use svg::with_metadata;
pub use viewpoint::Viewpoint;

/// What a chart is called, and what it shows in a sentence or two, for those who don't see it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Caption {
    /// Stands above the chart, and in `<title>`.
    pub title: String,
    /// Stands in `<desc>` only.
    pub description: String,
}

impl Caption {
    /// A title and a description.
    pub fn new(title: impl Into<String>, description: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            description: description.into(),
        }
    }
}
