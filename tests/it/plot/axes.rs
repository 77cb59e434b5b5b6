//! Where axes put their labels and their points.

use super::*;

/// One value on a linear, a logarithmic and a root axis: extents from the least to the greatest f64.
#[test]
fn every_single_value_and_pair_has_an_axis() {
    for scale in [Scale::Linear, Scale::Log, Scale::Root] {
        for a in HOSTILE {
            for b in HOSTILE {
                let svg = lines(vec![series(vec![(a, b), (b, a)])], scale).svg();
                check(&svg);
                assert!(svg.len() < 60_000, "{scale:?} {a} {b}: {} bytes", svg.len());
            }
        }
    }
}

#[test]
fn logarithmic_axes_have_a_label_at_each_decade() {
    let svg = lines(vec![series(vec![(1e-6, 1.0), (1.0, 1e4)])], Scale::Log).svg();
    let texts = texts(&svg);
    for label in ["10⁻⁶", "10⁻⁵", "10⁻¹", "10⁰", "1", "10", "1000", "10000"] {
        assert!(texts.contains(&label.to_owned()), "{label}: {texts:?}");
    }
    // Ticks without labels at 2 to 9 in each of six and four decades, and nowhere else.
    let short = svg.matches("y2=\"351\"").count();
    assert_eq!(short, 6 * 8, "{svg}");
}

#[test]
fn points_lie_where_the_axes_say() {
    let x = Axis::new("x", Scale::Log).with_range(1.0, 100.0);
    let y = Axis::new("y", Scale::Linear).with_range(0.0, 2.0);
    let one = Series {
        marks: Marks::None,
        ..series(vec![(1.0, 0.0), (10.0, 1.0), (100.0, 2.0)])
    };
    let svg = Lines {
        caption: caption(),
        x,
        y,
        series: vec![one],
    }
    .svg();
    let line = svg
        .lines()
        .find(|l| l.starts_with("<path d=\"M") && l.contains("stroke=\"#0072b2\""))
        .unwrap();
    let data = line.split('"').nth(1).unwrap().trim_start_matches('M');
    let points: Vec<Vec<f64>> = data
        .split('L')
        .map(|p| p.split(' ').map(|n| n.parse().unwrap()).collect())
        .collect();
    assert!(
        (points[1][0] - (points[0][0] + points[2][0]) / 2.0).abs() < 0.02,
        "{data}"
    );
    assert!(
        (points[1][1] - (points[0][1] + points[2][1]) / 2.0).abs() < 0.02,
        "{data}"
    );
    assert!(points[0][1] > points[2][1], "y runs upwards: {data}");
}

#[test]
fn points_that_cannot_be_drawn_break_the_line() {
    let points = vec![
        (1.0, 1.0),
        (2.0, 2.0),
        (3.0, 0.0),
        (4.0, 1.0),
        (5.0, f64::NAN),
        (6.0, 3.0),
        (7.0, 3.0),
    ];
    let one = Series {
        marks: Marks::None,
        ..series(points)
    };
    let svg = lines(vec![one], Scale::Log).svg();
    // Two pieces of two points and a lone one, which no line can show; and the legend's.
    assert_eq!(svg.matches("stroke-width=\"1.8\"").count(), 2 + 1, "{svg}");
}
