//! Lines, marks and colours.

use super::*;

#[test]
fn pictures_are_the_same_each_time() {
    let points: Vec<_> = (1..60).map(|i| (f64::from(i), f64::from(i * i))).collect();
    let chart = lines(vec![series(points)], Scale::Log);
    assert_eq!(chart.svg(), chart.clone().svg());
}

#[test]
fn styles_differ_in_colour_dash_and_mark() {
    let curve = |style| Series {
        style,
        label: format!("s{style}"),
        ..series(vec![(0.0, 0.0), (1.0, 1.0)])
    };
    let attributes = |style: usize| {
        let svg = lines(vec![curve(style)], Scale::Linear).svg();
        let keep =
            |l: &&str| l.contains("stroke-width=\"1.8\"") || l.contains("stroke-width=\"0.8\"");
        svg.lines().filter(keep).collect::<Vec<_>>().join("\n")
    };
    let all: std::collections::BTreeSet<String> = (0..210).map(attributes).collect();
    assert_eq!(all.len(), 210);
    for (a, b) in (0..12).flat_map(|a| (0..a).map(move |b| (a, b))) {
        let dash = |i: usize| i % 5;
        assert!(
            dash(a) != dash(b) || a % 6 != b % 6,
            "{a} and {b} look alike in black and white"
        );
    }
}

#[test]
fn a_style_number_has_the_colour_dash_and_mark_asked_for() {
    let mut numbers = std::collections::BTreeSet::new();
    for colour in 0..7 {
        for dash in 0..5 {
            for mark in 0..6 {
                let number = style_number(colour, dash, mark);
                assert_eq!([number % 7, number % 5, number % 6], [colour, dash, mark]);
                numbers.insert(number);
            }
        }
    }
    assert_eq!(numbers.len(), 210);
}

/// Linear values that gamma 2.2 shows as they are known.
#[test]
fn pixels_of_a_picture_have_gamma_2_2_and_an_exposure() {
    let colour = merlkit::color::Rgb::new(0.125, 0.5, -1.0);
    let image = Image::new(1, 1, vec![colour]).unwrap();
    let picture = Heat {
        pixels: Pixels::Picture {
            image,
            exposure: 1.0,
        },
        ..heat(Vec::new(), Scale::Log)
    };
    let png = picture.pixels_png(3, 2).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(png))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    // 255·0.25^(1/2.2) = 135.8.
    assert_eq!(bytes, [136, 255, 0].repeat(6));
}

#[test]
fn every_size_leaves_a_well_formed_picture_of_that_size() {
    let points: Vec<_> = (0..60).map(|i| (f64::from(i), f64::from(i * i))).collect();
    let curve = PolarCurve {
        label: "curve".into(),
        points: points.clone(),
        style: 0,
    };
    let polar = Polar {
        caption: caption(),
        radius: Axis::new("r", Scale::Linear),
        curves: vec![curve; 9],
        wo: vec![0.0, 5.0, 10.0, 80.0],
    };
    let disc = Disc {
        caption: caption(),
        points: vec![(0.1, 0.2)],
        labels: ["cells".into(), "points".into()],
        ..Disc::default()
    };
    let charts = [
        Chart::Lines(lines(vec![series(points); 9], Scale::Linear)),
        Chart::Polar(polar),
        Chart::Disc(disc),
        Chart::Heat(heat(vec![1.0, 2.0, 3.0, 4.0], Scale::Log)),
    ];
    for chart in &charts {
        for (width, height) in [(320.0, 240.0), (2000.0, 300.0), (400.0, 2000.0)] {
            let size = ChartSize {
                width,
                height: Some(height),
            };
            let svg = chart.svg(size).unwrap();
            check(&svg);
            let sides = format!("width=\"{width}\" height=\"{height}\"");
            assert!(svg.contains(&sides), "{sides}: {svg}");
        }
    }
}

/// Names of directions near the normal, where they are closest, have room of their own.
#[test]
fn names_of_directions_do_not_overlap() {
    let polar = Polar {
        caption: caption(),
        radius: Axis::new("r", Scale::Linear),
        curves: Vec::new(),
        wo: vec![2.0, 5.0, 10.0, 12.0, 80.0],
    };
    let svg = polar.svg();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let mut rooms: Vec<[f64; 4]> = Vec::new();
    for node in document.descendants().filter(|n| n.has_tag_name("text")) {
        let text = node.text().unwrap_or_default();
        if !text.starts_with("wo") && !text.starts_with("mirror") {
            continue;
        }
        let [x, y] = ["x", "y"].map(|a| node.attribute(a).unwrap().parse::<f64>().unwrap());
        // Letters of the usual fonts are half as wide as high.
        let width = 6.0 * text.chars().count() as f64;
        let left = match node.attribute("text-anchor") {
            Some("end") => x - width,
            Some("middle") => x - 0.5 * width,
            _ => x,
        };
        rooms.push([left, left + width, y - 9.0, y]);
    }
    assert_eq!(rooms.len(), 10, "{svg}");
    for (i, a) in rooms.iter().enumerate() {
        for b in &rooms[..i] {
            let apart = a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2];
            assert!(apart, "{a:?} {b:?}: {svg}");
        }
    }
}

#[test]
fn the_front_is_what_nothing_beats() {
    let points = [
        (1.0, 9.0),
        (2.0, 5.0),
        (3.0, 6.0),
        (4.0, 2.0),
        (4.0, 3.0),
        (9.0, 2.0),
    ];
    let points = points.iter().enumerate().map(|(i, &(x, y))| ScatterPoint {
        x,
        y,
        label: format!("P{i}"),
    });
    let groups = vec![Group {
        label: "all".into(),
        points: points.collect(),
        style: 1,
    }];
    let axis = |t: &str| Axis::new(t, Scale::Log);
    let scatter = Scatter {
        caption: caption(),
        x: axis("bytes"),
        y: axis("error"),
        groups,
        front: true,
    };
    let svg = scatter.svg();
    check(&svg);
    let labels: Vec<_> = texts(&svg)
        .into_iter()
        .filter(|t| t.starts_with('P'))
        .collect();
    assert_eq!(labels, ["P0", "P1", "P3"]);
    let front = svg
        .lines()
        .find(|l| l.contains("stroke-dasharray=\"5 3\""))
        .unwrap();
    assert_eq!(front.matches('L').count(), 2 + 2 * 2);
    assert_eq!(
        svg.matches("<title>P").count(),
        6,
        "every point has its label on hovering"
    );
}

#[test]
fn a_picture_holds_its_values_as_colours() {
    let svg = heat(vec![1.0, 100.0, 10.0, f64::NAN], Scale::Log)
        .svg()
        .unwrap();
    check(&svg);
    let data = svg
        .split("base64,")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    use base64::Engine as _;
    let png = base64::engine::general_purpose::STANDARD
        .decode(data)
        .unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(png))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    assert_eq!(bytes[..3], viridis(0.0));
    assert_eq!(bytes[3..6], viridis(1.0));
    assert_eq!(bytes[6..9], viridis(0.5));
    assert_eq!(bytes[9..12], [255; 3]);
    assert!(heat(vec![1.0; 3], Scale::Log).svg().is_err());
    let mut without_range = heat(vec![1.0; 4], Scale::Log);
    without_range.x.range = None;
    assert!(without_range.svg().is_err());
    let image = Image::new(1, 1, vec![merlkit::color::Rgb::ONE]).unwrap();
    let picture = Heat {
        pixels: Pixels::Picture {
            image,
            exposure: 0.0,
        },
        ..heat(Vec::new(), Scale::Log)
    };
    check(&picture.svg().unwrap());
}

/// Lightness rises in even steps, so that equal ratios look equal and print in grey.
#[test]
fn the_colours_of_values_grow_lighter_evenly() {
    let lightness = |v: f64| {
        let linear = viridis(v).map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        });
        let y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        116.0 * y.cbrt() - 16.0
    };
    let steps: Vec<f64> = (0..16)
        .map(|i| lightness(f64::from(i + 1) / 16.0) - lightness(f64::from(i) / 16.0))
        .collect();
    let mean = steps.iter().sum::<f64>() / 16.0;
    assert!(
        steps.iter().all(|s| (s / mean - 1.0).abs() < 0.3),
        "{steps:?}"
    );
    assert_eq!(
        (viridis(f64::NAN), viridis(f64::INFINITY)),
        (viridis(0.0), viridis(1.0))
    );
}
