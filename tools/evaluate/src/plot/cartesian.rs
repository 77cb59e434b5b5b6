//! The frame of charts with an axis across and one upwards.

use super::area::Area;
use super::axis::{Axis, Ruler, Tick};
use super::drawing::{ChartSize, Drawing, GRID, INK, Paint, Stroke, TOP};
use super::legend::{Entry, Legend};
use super::text::{Anchor, TEXT, shortened, width_of};
use super::{Caption, Scale};

/// Height of the data's area for each pixel of the sheet's width, where no height is given.
const HEIGHT: f64 = 312.0 / 640.0;
/// Below the legend.
const FOOT: f64 = 8.0;
/// From the area's lower edge to the legend.
const BELOW: f64 = 48.0;
/// Right of the area, where nothing else stands there.
pub(super) const MARGIN: f64 = 26.0;

/// Where data go.
pub(super) struct Frame {
    pub area: Area,
    /// Both rulers, if there is anything to show.
    pub rulers: Option<(Ruler, Ruler)>,
    legend: Legend,
    sheet_width: f64,
}

impl Frame {
    /// Room for both axes and a legend of `entries`; `x` and `y` are all values the axes must hold, `right` the pixels to leave
    /// free on the right.
    pub fn new(
        axes: (&Axis, &Axis),
        x: impl Iterator<Item = f64>,
        y: impl Iterator<Item = f64>,
        right: f64,
        entries: Vec<Entry>,
        size: ChartSize,
    ) -> Self {
        let size = size.limited();
        let legend = Legend::new(entries, size.width);
        let around = TOP + BELOW + legend.height() + FOOT;
        // What the legend leaves, but enough for two ticks.
        let height = size.height.map_or(HEIGHT * size.width, |h| h - around);
        let height = height.max(60.0);
        let y = Ruler::new(axes.1, y, TOP + height, TOP);
        let labels = y.iter().flat_map(Ruler::ticks).filter_map(|t| t.label);
        let left = 38.0 + labels.map(|l| width_of(&l, TEXT)).fold(10.0, f64::max);
        let area = Area {
            x: left,
            y: TOP,
            width: size.width - left - right,
            height,
        };
        let x = Ruler::new(axes.0, x, area.x, area.right());
        Self {
            area,
            rulers: x.zip(y),
            legend,
            sheet_width: size.width,
        }
    }

    /// Both pixels of a point; `None` if an axis can't hold it.
    pub fn pixel(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let (across, up) = self.rulers.as_ref()?;
        across.pixel_of(x).zip(up.pixel_of(y))
    }

    /// Begins the picture: sheet, grid, axes and legend.
    pub fn begin(&self, caption: &Caption, axes: (&Axis, &Axis), grid: bool) -> Drawing {
        let height = self.area.bottom() + BELOW + self.legend.height() + FOOT;
        let mut drawing = Drawing::new(self.sheet_width, height, caption);
        if let Some((x, y)) = &self.rulers {
            self.draw_ticks(&mut drawing, &x.ticks(), true, grid);
            self.draw_ticks(&mut drawing, &y.ticks(), false, grid);
        } else {
            drawing.no_data(&self.area);
        }
        let Area {
            x,
            y,
            width,
            height,
        } = self.area;
        drawing.rectangle(&self.area, Paint::outline(Stroke::new(INK)));
        drawing.label(
            (x + width / 2.0, self.area.bottom() + 37.0),
            Anchor::Middle,
            &shortened(&scaled(axes.0), TEXT, width + 60.0),
        );
        let title = shortened(&scaled(axes.1), TEXT, height + 30.0);
        drawing.label_upwards((18.0, y + height / 2.0), &title);
        self.legend.draw(&mut drawing, self.area.bottom() + BELOW);
        drawing
    }

    fn draw_ticks(&self, drawing: &mut Drawing, ticks: &[Tick], across: bool, grid: bool) {
        let Area { x, y, .. } = self.area;
        let (right, bottom) = (self.area.right(), self.area.bottom());
        for tick in ticks {
            let length = if tick.label.is_some() { 5.0 } else { 3.0 };
            let (edge, outside, opposite) = match across {
                true => ((tick.at, bottom), (tick.at, bottom + length), (tick.at, y)),
                false => ((x, tick.at), (x - length, tick.at), (right, tick.at)),
            };
            if grid && tick.label.is_some() {
                drawing.line(edge, opposite, Paint::line(Stroke::new(GRID)));
            }
            drawing.line(edge, outside, Paint::line(Stroke::new(INK)));
            let Some(label) = &tick.label else { continue };
            match across {
                true => drawing.label((tick.at, bottom + 18.0), Anchor::Middle, label),
                false => drawing.label((x - 8.0, tick.at + 4.0), Anchor::End, label),
            }
        }
    }
}

/// An axis's title, with a word on a scale that is not even.
fn scaled(axis: &Axis) -> String {
    match axis.scale {
        Scale::Root if !axis.title.is_empty() => format!("{} (root scale)", axis.title),
        _ => axis.title.clone(),
    }
}
