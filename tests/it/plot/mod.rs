//! Charts: well-formed pictures whatever the numbers, and in their right places for ordinary ones.

mod axes;
mod hostile;
mod styles;
mod views;

use merlkit::image::Image;
use merlkit_evaluate::plot::{
    Axis, Caption, Chart, ChartSize, Disc, DiscMark, Group, Heat, Lines, Marks, Pixels, Polar,
    PolarCurve, Scale, Scatter, ScatterPoint, Series, SurfaceLobe, SurfacePanel, Surfaces,
    Viewpoint, style_number, viridis,
};

/// Numbers that charts must survive.
const HOSTILE: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    5e-324,
    -5e-324,
    1e300,
    -1e300,
    0.0,
    -0.0,
    1e17,
    1e17 + 16.0,
    -3.0,
];

const HOSTILE_TEXT: &str =
    "</text><script>alert(\"1\")</script>&amp; ' \u{0} \u{1b} \u{ffff} \u{202e}\n";

fn caption() -> Caption {
    Caption::new("Title", "What it shows")
}

fn lines(series: Vec<Series>, scale: Scale) -> Lines {
    let axis = |title: &str| Axis::new(title, scale);
    Lines {
        caption: caption(),
        x: axis("x [s]"),
        y: axis("y [1]"),
        series,
    }
}

fn series(points: Vec<(f64, f64)>) -> Series {
    Series {
        label: "series".into(),
        points,
        ..Series::default()
    }
}

/// Parses a picture and holds what every one must: a role, a title, a description; no ids, scripts or addresses; numbers
/// that are finite; text within the sheet.
fn check(svg: &str) {
    let document = roxmltree::Document::parse(svg).unwrap_or_else(|e| panic!("{e}: {svg}"));
    let root = document.root_element();
    assert_eq!(
        (root.tag_name().name(), root.attribute("role")),
        ("svg", Some("img"))
    );
    let children: Vec<_> = root
        .children()
        .filter(|c| c.is_element())
        .map(|c| c.tag_name().name())
        .collect();
    assert_eq!(children[..2], ["title", "desc"]);
    let [width, height] =
        ["width", "height"].map(|a| root.attribute(a).unwrap().parse::<f64>().unwrap());
    for node in root.descendants().filter(|n| n.is_element()) {
        let name = node.tag_name().name();
        let known = [
            "svg", "title", "desc", "rect", "text", "line", "path", "g", "circle", "image",
        ];
        assert!(known.contains(&name), "{name}");
        for attribute in node.attributes() {
            let (key, value) = (attribute.name(), attribute.value());
            assert!(key != "id" && !key.starts_with("on"), "{key}");
            assert!(
                key != "href" || value.starts_with("data:image/png;base64,"),
                "{value}"
            );
            assert!(
                !value.contains("NaN") && !value.contains("inf"),
                "{key}={value}"
            );
        }
        if name == "text" {
            let [x, y] = ["x", "y"].map(|a| node.attribute(a).unwrap().parse::<f64>().unwrap());
            assert!(
                (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
                "text at {x}, {y}: {svg}"
            );
        }
    }
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document
        .descendants()
        .filter(|n| n.has_tag_name("text") || n.tag_name().name() == "text");
    texts.filter_map(|n| n.text().map(str::to_owned)).collect()
}

/// A hemisphere with lobes of four vertices about the normal, all of one value.
fn surfaces(values: &[f64], label: &str, range: (f64, f64)) -> Surfaces {
    let directions = [
        [0.0, 0.0, 1.0],
        [0.9, 0.0, 0.4],
        [-0.5, 0.8, 0.4],
        [-0.5, -0.8, 0.4],
    ];
    let mut lobes = Vec::new();
    for &value in values {
        lobes.push(SurfaceLobe {
            label: label.into(),
            vertices: directions.map(|wi| (wi, value)).to_vec(),
            spokes: 3,
            style: lobes.len(),
        });
    }
    Surfaces {
        caption: caption(),
        radius: Axis::new("f", Scale::Linear).with_range(range.0, range.1),
        panels: vec![SurfacePanel {
            title: label.into(),
            lobes,
            theta_o: 30.0,
        }],
        viewpoint: Viewpoint::default(),
    }
}

fn heat(values: Vec<f64>, scale: Scale) -> Heat {
    Heat {
        caption: caption(),
        x: Axis::new("x", Scale::Root).with_range(0.0, 90.0),
        y: Axis::new("y", Scale::Linear).with_range(0.0, 90.0),
        pixels: Pixels::Values {
            width: 2,
            values,
            bar: Axis::new("f [sr⁻¹]", scale),
        },
    }
}
