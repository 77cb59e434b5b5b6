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
