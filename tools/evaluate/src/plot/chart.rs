//! Any chart, as a picture or as the numbers in it.

use super::{ChartSize, Disc, Drawing, Heat, Lines, Pixels, Polar, SkyMap, Surfaces};
use merlkit::Result;

/// A chart of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Chart {
    /// Curves over two axes.
    Lines(Lines),
    /// Curves over the angle in one plane.
    Polar(Polar),
    /// The hemisphere from above.
    Disc(Disc),
    /// A picture over two axes.
    Heat(Heat),
    /// Lobes as solids.
    Surfaces(Surfaces),
    /// Directions on an environment.
    Sky(SkyMap),
}

impl Chart {
    /// The shapes of the picture.
    ///
    /// # Errors
    /// Those of [`Heat::drawing`] and [`SkyMap::drawing`].
    pub fn drawing(&self, size: ChartSize) -> Result<Drawing> {
        match self {
            Self::Lines(chart) => Ok(chart.drawing(size)),
            Self::Polar(chart) => Ok(chart.drawing(size)),
            Self::Disc(chart) => Ok(chart.drawing(size)),
            Self::Heat(chart) => chart.drawing(size),
            Self::Surfaces(chart) => Ok(chart.drawing(size)),
            Self::Sky(chart) => chart.drawing(size),
        }
    }

    /// The picture as SVG.
    ///
    /// # Errors
    /// Those of [`Self::drawing`].
    pub fn svg(&self, size: ChartSize) -> Result<String> {
        Ok(self.drawing(size)?.svg())
    }

    /// The numbers of the picture as CSV (RFC 4180), a point a row, under a heading with the axes' titles. Values that the
    /// picture has no place for are in it too.
    pub fn csv(&self) -> String {
        match self {
            Self::Lines(chart) => lines_csv(chart),
            Self::Polar(chart) => polar_csv(chart),
            Self::Disc(chart) => disc_csv(chart),
            Self::Heat(chart) => heat_csv(chart),
            Self::Surfaces(chart) => surfaces_csv(chart),
            Self::Sky(chart) => sky_csv(chart),
        }
    }
}

fn lines_csv(chart: &Lines) -> String {
    let mut text = heading(&["curve", &chart.x.title, &chart.y.title]);
    for series in &chart.series {
        push_points(&mut text, &series.label, &series.points);
    }
    text
}

fn polar_csv(chart: &Polar) -> String {
    let angle = "angle of wi in the plane of incidence [°]";
    let mut text = heading(&["curve", angle, &chart.radius.title]);
    for curve in &chart.curves {
        push_points(&mut text, &curve.label, &curve.points);
    }
    text
}

/// Corners of cells, then points, then marked places, each row with what it is of.
fn disc_csv(chart: &Disc) -> String {
    let mut text = heading(&["what", "x", "y"]);
    for (i, cell) in chart.cells.iter().enumerate() {
        push_points(&mut text, &format!("cell {i}"), cell);
    }
    push_points(&mut text, "direction", &chart.points);
    for mark in &chart.marks {
        push_points(&mut text, &mark.label, &[mark.at]);
    }
    text
}

/// Longitude from the middle of the map to the right, and latitude above the horizon.
fn sky_csv(chart: &SkyMap) -> String {
    let mut text = heading(&["longitude [°]", "latitude [°]"]);
    for &(x, y) in &chart.places {
        push_row(
            &mut text,
            &[number(360.0 * (x - 0.5)), number(90.0 - 180.0 * y)],
        );
    }
    text
}

/// Pixels by column and row from the upper left, with the values of the axes at their centres.
fn heat_csv(chart: &Heat) -> String {
    let titles = [chart.x.title.as_str(), chart.y.title.as_str()];
    let (mut text, width, pixels) = match &chart.pixels {
        Pixels::Values { width, values, bar } => {
            let pixels: Vec<Vec<f64>> = values.iter().map(|&v| vec![v]).collect();
            let text = heading(&[titles[0], titles[1], &bar.title]);
            (text, *width, pixels)
        }
        Pixels::Picture { image, .. } => {
            let mut pixels = Vec::new();
            for colour in image.pixels() {
                pixels.push(colour.to_array().map(f64::from).to_vec());
            }
            let text = heading(&[titles[0], titles[1], "red", "green", "blue"]);
            (text, image.width(), pixels)
        }
    };
    let width = width.max(1);
    let height = pixels.len().div_ceil(width);
    for (i, values) in pixels.iter().enumerate() {
        let across = (i % width) as f64 + 0.5;
        let up = (height - 1 - i / width) as f64 + 0.5;
        let x = chart.x.value_at(across / width as f64);
        let y = chart.y.value_at(up / height as f64);
        let mut row = vec![number(x), number(y)];
        row.extend(values.iter().map(|&v| number(v)));
        push_row(&mut text, &row);
    }
    text
}

/// Vertices: the direction, the value, and the radius as a fraction of the hemisphere's. A vertex is at the direction times the
/// radius.
fn surfaces_csv(chart: &Surfaces) -> String {
    let value = &chart.radius.title;
    let mut text = heading(&["panel", "lobe", "wi_x", "wi_y", "wi_z", value, "radius"]);
    for panel in &chart.panels {
        for lobe in &panel.lobes {
            let names = [field(&panel.title), field(&lobe.label)];
            for (wi, value) in &lobe.vertices {
                let mut row = names.to_vec();
                row.extend(wi.map(number));
                row.extend([number(*value), number(chart.radius_of(*value))]);
                push_row(&mut text, &row);
            }
        }
    }
    text
}

fn heading(titles: &[&str]) -> String {
    let mut text = String::new();
    let fields: Vec<String> = titles.iter().map(|t| field(t)).collect();
    push_row(&mut text, &fields);
    text
}

fn push_points(text: &mut String, name: &str, points: &[(f64, f64)]) {
    let name = field(name);
    for &(x, y) in points {
        push_row(text, &[name.clone(), number(x), number(y)]);
    }
}

fn push_row(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

/// A value with every bit, an empty field for what is no number.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    // Very large and very small values take an exponent instead of hundreds of digits.
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:e}");
    }
    value.to_string()
}

/// Text as one field, in quotes where it has a separator, a quote or a line's end.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Caption, Scale, Series};

    #[test]
    fn a_row_of_csv_is_a_point_and_keeps_every_bit() {
        let points = vec![(0.1 + 0.2, 1e-9), (2.0, f64::NAN), (3.0, -0.0)];
        let series = Series {
            label: "a \"b\", c".into(),
            points,
            ..Series::default()
        };
        let chart = Chart::Lines(Lines {
            caption: Caption::new("t", "d"),
            x: Axis::new("x, s", Scale::Linear),
            y: Axis::new("y", Scale::Log),
            series: vec![series],
        });
        let expected = "curve,\"x, s\",y\n\
            \"a \"\"b\"\", c\",0.30000000000000004,1e-9\n\
            \"a \"\"b\"\", c\",2,\n\
            \"a \"\"b\"\", c\",3,-0\n";
        assert_eq!(chart.csv(), expected);
    }

    #[test]
    fn pixels_have_the_axes_values_at_their_centres() {
        let chart = Chart::Heat(Heat {
            caption: Caption::new("t", "d"),
            x: Axis::new("x", Scale::Root).with_range(0.0, 16.0),
            y: Axis::new("y", Scale::Linear).with_range(0.0, 8.0),
            pixels: Pixels::Values {
                width: 2,
                values: vec![1.0, 2.0, 3.0, 4.0],
                bar: Axis::new("f", Scale::Log),
            },
        });
        assert_eq!(chart.csv(), "x,y,f\n1,6,1\n9,6,2\n1,2,3\n9,2,4\n");
    }
}
