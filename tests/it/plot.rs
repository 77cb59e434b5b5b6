//! Charts: well-formed pictures whatever the numbers, and in their right places for ordinary ones.

use merlkit::image::Image;
use merlkit_evaluate::plot::{
    Axis, Caption, Disc, DiscMark, Group, Heat, Lines, Marks, Pixels, Polar, PolarCurve, Scale,
    Scatter, ScatterPoint, Series, viridis,
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

#[test]
fn empty_charts_say_so() {
    let nothing = [
        lines(Vec::new(), Scale::Linear).svg(),
        lines(vec![series(vec![(0.0, 1.0), (-1.0, f64::NAN)])], Scale::Log).svg(),
        Scatter::default().svg(),
        Polar::default().svg(),
        Disc::default().svg(),
        heat(vec![f64::NAN; 4], Scale::Log).svg().unwrap(),
    ];
    for svg in nothing {
        check(&svg);
        assert!(texts(&svg).contains(&"no data".to_owned()), "{svg}");
    }
    assert!(
        !texts(&lines(vec![series(vec![(1.0, 1.0)])], Scale::Log).svg())
            .contains(&"no data".to_owned())
    );
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

#[test]
fn hostile_numbers_and_texts_leave_a_well_formed_picture() {
    let pairs: Vec<(f64, f64)> = HOSTILE
        .iter()
        .flat_map(|&a| HOSTILE.map(|b| (a, b)))
        .collect();
    let band: Vec<(f64, f64, f64)> = pairs.iter().map(|&(a, b)| (a, b, -b)).collect();
    let style = usize::MAX;
    for scale in [Scale::Linear, Scale::Log, Scale::Root] {
        for range in [
            None,
            Some((f64::NAN, 1.0)),
            Some((2.0, 1.0)),
            Some((5e-324, f64::MAX)),
            Some((1e17, 1e17 + 16.0)),
        ] {
            let axis = Axis {
                title: HOSTILE_TEXT.repeat(9),
                scale,
                range,
            };
            let label = HOSTILE_TEXT.repeat(5);
            let caption = Caption::new(HOSTILE_TEXT.repeat(5), HOSTILE_TEXT);
            for marks in [Marks::Few, Marks::Each, Marks::Only, Marks::None] {
                let one = Series {
                    label: label.clone(),
                    points: pairs.clone(),
                    band: band.clone(),
                    style,
                    marks,
                };
                let series = vec![one; 9];
                check(
                    &Lines {
                        caption: caption.clone(),
                        x: axis.clone(),
                        y: axis.clone(),
                        series,
                    }
                    .svg(),
                );
            }
            let points = pairs
                .iter()
                .map(|&(x, y)| ScatterPoint {
                    x,
                    y,
                    label: label.clone(),
                })
                .collect();
            let groups = vec![Group {
                label: label.clone(),
                points,
                style,
            }];
            check(
                &Scatter {
                    caption: caption.clone(),
                    x: axis.clone(),
                    y: axis.clone(),
                    groups,
                    front: true,
                }
                .svg(),
            );
            let curves = vec![PolarCurve {
                label: label.clone(),
                points: pairs.clone(),
                style,
            }];
            check(
                &Polar {
                    caption: caption.clone(),
                    radius: axis.clone(),
                    curves,
                    wo: HOSTILE.to_vec(),
                }
                .svg(),
            );
            let mut heat = heat(HOSTILE.to_vec(), scale);
            if let Pixels::Values { bar, .. } = &mut heat.pixels {
                *bar = axis.clone();
            }
            check(&heat.svg().unwrap());
        }
    }
    let marks = pairs
        .iter()
        .map(|&at| DiscMark {
            at,
            label: HOSTILE_TEXT.into(),
        })
        .collect();
    let cells = vec![pairs.clone(), Vec::new()];
    check(
        &Disc {
            caption: caption(),
            cells,
            points: pairs,
            marks,
            labels: [HOSTILE_TEXT.into(), "p".into()],
        }
        .svg(),
    );
}

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
fn pictures_are_the_same_each_time() {
    let points: Vec<_> = (1..60).map(|i| (f64::from(i), f64::from(i * i))).collect();
    let chart = lines(vec![series(points)], Scale::Log);
    assert_eq!(chart.svg(), chart.clone().svg());
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

/// What pictures are made of: the numbers come from the tables that draw.
mod views {
    use std::f64::consts::PI;
    use std::sync::{Arc, LazyLock};

    use glam::DVec2;
    use merlkit::brdf::Brdf;
    use merlkit::direction_sampler::DirectionSampler;
    use merlkit::geometry::spherical;
    use merlkit::material::merl::{Header, MerlTable, decode_embedded};
    use merlkit::material::merl::{LookupRule, MerlBrdf};
    use merlkit::points::Stream;
    use merlkit::sampler::{
        AdaptiveDisc, AdaptiveDiscSettings, CascadeCdf, CascadeCdfSettings, CdfCurve, Cosine,
        LeafChoice, Subdivision,
    };
    use merlkit_evaluate::measure::{directional_albedo, views};

    static NICKEL: LazyLock<Arc<MerlBrdf>> = LazyLock::new(|| {
        Arc::new(MerlBrdf::new(
            Arc::new(decode_embedded("nickel").unwrap()),
            LookupRule::Floor,
        ))
    });

    fn black() -> Arc<MerlBrdf> {
        let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| [0.0; 3]);
        Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor))
    }

    fn disc(brdf: &Arc<MerlBrdf>, leaves: LeafChoice) -> AdaptiveDisc {
        let settings = AdaptiveDiscSettings {
            tables: 4,
            depth: 10,
            leaves,
            floor: 0.0,
            ..Default::default()
        };
        AdaptiveDisc::build(brdf.clone(), settings).unwrap()
    }

    /// Squares cover [−1, 1]² once: their areas add up and no point has two.
    fn assert_tiles(tree: &Subdivision) {
        let area: f64 = tree.cells.iter().map(|c| c.side * c.side).sum();
        assert!((area - 4.0).abs() < 1e-12, "{area}");
        let share: f64 = tree.cells.iter().map(|c| c.share).sum();
        assert!((share - 1.0).abs() < 1e-6, "{share}");
        let mut random = Stream::new(5);
        for _ in 0..200 {
            let p = 2.0 * DVec2::new(random.next_f64(), random.next_f64()) - 1.0;
            let holds = |c: &&merlkit::sampler::Cell| {
                p.cmpge(c.corner).all() && p.cmplt(c.corner + c.side).all()
            };
            assert_eq!(tree.cells.iter().filter(holds).count(), 1, "{p}");
        }
    }

    fn polygon_area(outline: &[DVec2]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        0.5 * outline
            .iter()
            .zip(next)
            .map(|(a, b)| a.perp_dot(*b))
            .sum::<f64>()
    }

    #[test]
    fn squares_tile_the_square_and_their_shares_are_those_of_draws() {
        for leaves in [LeafChoice::Envelope, LeafChoice::Integral, LeafChoice::Warp] {
            let disc = disc(&NICKEL, leaves);
            for degrees in [0.0f64, 33.0, 80.0] {
                let tree = disc.subdivision(degrees.to_radians());
                assert!(
                    tree.cells.len() > 100,
                    "{leaves:?}: {} cells",
                    tree.cells.len()
                );
                assert!((tree.theta_o.to_degrees() - degrees).abs() <= 15.0);
                assert_tiles(&tree);
                let areas: f64 = tree
                    .cells
                    .iter()
                    .map(|c| polygon_area(&tree.outline(c)))
                    .sum();
                let expected = if leaves == LeafChoice::Warp { PI } else { 4.0 };
                // Bent outlines are polygons, a little inside the rim.
                assert!(
                    (areas / expected - 1.0).abs() < 2e-3,
                    "{leaves:?} {degrees}: {areas}"
                );
            }
        }
    }

    #[test]
    fn a_warp_s_density_is_each_cell_s_share_over_its_area() {
        let disc = disc(&NICKEL, LeafChoice::Warp);
        let tree = disc.subdivision(30f64.to_radians());
        let wo = spherical(tree.theta_o, 0.0).as_vec3();
        let mut compared = 0;
        for cell in tree.cells.iter().filter(|c| c.side > 0.01) {
            let outline = tree.outline(cell);
            let centre =
                merlkit::geometry::concentric_disc((cell.corner + 0.5 * cell.side + 1.0) * 0.5);
            let z = (1.0 - centre.length_squared()).max(0.0).sqrt();
            let wi = centre.extend(z).as_vec3();
            let area = PI * cell.side * cell.side / 4.0;
            let (pdf, expected) = (f64::from(disc.pdf(wo, wi)), cell.share / area * z);
            // Turned about the normal the tree's own direction is served alone; carried through itself it stays.
            assert!(
                (pdf - expected).abs() < 2e-3 * expected + 1e-6,
                "{cell:?} {outline:?}: {pdf}, {expected}"
            );
            compared += 1;
        }
        assert!(compared > 50);
    }

    #[test]
    fn a_material_without_light_is_one_empty_square_and_has_no_curves() {
        for leaves in [LeafChoice::Envelope, LeafChoice::Warp] {
            let tree = disc(&black(), leaves).subdivision(f64::NAN);
            assert_eq!(
                (tree.cells.len(), tree.cells[0].side, tree.cells[0].share),
                (1, 2.0, 0.0)
            );
            assert_eq!(tree.theta_o, 0.0);
        }
        let cdf = CascadeCdf::build(
            &*black(),
            CascadeCdfSettings {
                tables: 2,
                ..Default::default()
            },
        )
        .unwrap();
        for curve in [cdf.marginal(0.0), cdf.conditional(0.0)] {
            assert!(curve.knots.is_empty() && curve.curve.is_empty());
        }
        assert!(views::ideal_density(&*black(), 30.0).is_empty());
    }

    /// Both are of the piece that holds the median, rise from 0 to 1 over a turn, and the compressed one has fewer knots.
    fn conditionals(before: &CdfCurve, after: &CdfCurve, whole: &CdfCurve, small: &CdfCurve) {
        for (cdf, marginal) in [(before, whole), (after, small)] {
            let below = |theta_h: f64| marginal.knots.iter().find(|k| k.0 == theta_h).unwrap().1;
            let [from, to] = cdf.theta_h.map(below);
            assert!(from <= 0.5 && 0.5 <= to, "{from} {to}");
            assert_eq!(cdf.curve.len(), 65);
            assert!(
                cdf.curve
                    .windows(2)
                    .all(|w| w[0].0 < w[1].0 && w[0].1 <= w[1].1)
            );
            assert_eq!(
                (cdf.curve[0], cdf.curve[64]),
                ((0.0, 0.0), (std::f64::consts::TAU, 1.0))
            );
            assert!(cdf.knots.iter().all(|k| cdf.curve.contains(k)));
        }
        assert_eq!(before.knots, before.curve);
        assert!(after.knots.len() < 60, "{}", after.knots.len());
        // Half vectors of a metal turn about the normal's direction alike: no lobe of azimuths is far from the other.
        let far = before
            .curve
            .iter()
            .zip(&after.curve)
            .map(|(a, b)| (a.1 - b.1).abs())
            .fold(0.0, f64::max);
        assert!(far < 0.2, "{far}");
    }

    #[test]
    fn knots_lie_on_the_curve_before_compression() {
        let settings = CascadeCdfSettings {
            tables: 3,
            theta_h: 256,
            phi_h: 64,
            ..Default::default()
        };
        let whole = CascadeCdf::build(
            &**NICKEL,
            CascadeCdfSettings {
                tolerance: None,
                ..settings
            },
        )
        .unwrap();
        for tolerance in [1e-3, 1e-2] {
            let small = CascadeCdfSettings {
                tolerance: Some(tolerance),
                ..settings
            };
            let small = CascadeCdf::build(&**NICKEL, small).unwrap();
            for theta in [0.0, 0.7, 1.5] {
                let (before, after) = (whole.marginal(theta), small.marginal(theta));
                assert_eq!(
                    (before.knots.len(), before.curve.len(), after.curve.len()),
                    (257, 257, 257)
                );
                assert_eq!(before.knots, before.curve, "every edge has a knot");
                assert!(
                    after.knots.len() >= 3 && after.knots.len() < 128,
                    "{}",
                    after.knots.len()
                );
                for &(theta_h, c) in &after.knots {
                    let (_, on) = before.curve.iter().find(|p| p.0 == theta_h).unwrap();
                    // 16 bits, and a unit more for every piece whose mass is less than one.
                    assert!(
                        (c - on).abs() < 257.0 / 65535.0 * 0.1 + 2.0 / 65535.0,
                        "{theta_h}: {c}, {on}"
                    );
                    assert!(after.curve.contains(&(theta_h, c)));
                }
                for (a, b) in after.curve.iter().zip(&before.curve) {
                    assert!(
                        a.0 == b.0 && (a.1 - b.1).abs() < tolerance + 5e-4,
                        "{a:?} {b:?}"
                    );
                }
                assert_eq!((after.curve[0], after.curve[256].1), ((0.0, 0.0), 1.0));
                conditionals(
                    &whole.conditional(theta),
                    &small.conditional(theta),
                    &before,
                    &after,
                );
            }
        }
    }

    #[test]
    fn lobes_are_the_brdf_s_values() {
        let curve = views::lobe(&**NICKEL, 30.0);
        assert!(curve.windows(2).all(|w| w[0].0 < w[1].0), "angles rise");
        let at = |angle: f64| curve.iter().find(|p| p.0 == angle).unwrap().1;
        let wo = spherical(30f64.to_radians(), 0.0).as_vec3();
        for (angle, side) in [(10.0f64, -1.0), (-50.0, 1.0)] {
            let wi = spherical(angle.abs().to_radians(), 0.0).as_vec3()
                * glam::Vec3::new(side, 1.0, 1.0);
            let expected = f64::from(merlkit::color::mean(NICKEL.eval_cos(wo, wi)));
            assert!(
                (at(angle) / expected - 1.0).abs() < 1e-5,
                "{angle}: {} {expected}",
                at(angle)
            );
        }
        let peak = curve.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(
            (peak.0 - 30.0).abs() < 2.0,
            "the mirror direction is on the right: {peak:?}"
        );
        let albedo = f64::from(merlkit::color::mean(directional_albedo(
            &**NICKEL,
            30f64.to_radians(),
        )));
        let ideal = views::ideal_density(&**NICKEL, 30.0);
        assert!(
            ideal
                .iter()
                .zip(&curve)
                .all(|(i, c)| (i.1 * albedo - c.1).abs() <= 1e-9 * c.1)
        );
        let cosine = views::density(&Cosine, 60.0);
        assert!(
            cosine
                .iter()
                .all(|&(a, p)| (p - a.to_radians().cos() / PI).abs() < 1e-6)
        );
    }

    #[test]
    fn slices_are_the_table_s_own_values() {
        let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |h, d, p| match (h, d) {
            (3, 5) => [-1.0; 3],
            _ => [h as f64, d as f64, p as f64],
        });
        let (values, colours) = (views::slice(&table), views::slice_rgb(&table));
        assert_eq!((values.len(), colours.len()), (90 * 90, 90 * 90));
        let place = |h: usize, d: usize| (89 - d) * 90 + h;
        assert_eq!(colours[place(7, 11)].to_array(), [7.0, 11.0, 90.0]);
        assert_eq!(values[place(7, 11)], 36.0);
        assert!(values[place(3, 5)].is_nan());
        assert_eq!(values.iter().filter(|v| v.is_nan()).count(), 1);
    }

    #[test]
    fn drawn_directions_are_on_the_disc_and_on_the_mirror_s_side() {
        let disc = disc(&NICKEL, LeafChoice::Envelope);
        let sampler = merlkit::sampler::SamplerSpec::new(*disc.settings())
            .build(&crate::support::loaded(&NICKEL))
            .unwrap();
        let (feet, failed) = views::sampled_directions(Some(&sampler), 45.0, 500, 2);
        assert_eq!(feet.len() + failed, 500);
        assert!(feet.iter().all(|p| p.length() <= 1.0));
        assert!(
            feet.iter().filter(|p| p.x > 0.0).count() > 400,
            "wo is on the left"
        );
        let (outlines, theta) = views::leaf_outlines(&disc, 45.0);
        assert!(
            (theta - 30.0).abs() < 1e-9 || (theta - 60.0).abs() < 1e-9,
            "{theta}"
        );
        let small = |o: &&Vec<DVec2>| polygon_area(o).abs() < 1e-3;
        let mean = outlines.iter().filter(small).map(|o| o[0].x).sum::<f64>();
        assert!(mean > 0.0, "leaves are fine where draws are many");
    }

    #[test]
    fn albedos_are_those_of_the_three_rules() {
        let curves = views::albedo_by_rule(NICKEL.table());
        assert!(curves.iter().all(|c| c.len() == 90 && c[89].0 == 89.0));
        let centred = MerlBrdf::new(NICKEL.table().clone(), LookupRule::Centred);
        let expected = f64::from(merlkit::color::mean(directional_albedo(
            &centred,
            20f64.to_radians(),
        )));
        assert!(
            (curves[2][20].1 / expected - 1.0).abs() < 2e-2,
            "{} {expected}",
            curves[2][20].1
        );
        assert!(
            (curves[0][20].1 - curves[1][20].1).abs() > 1e-3,
            "rules differ"
        );
    }
}
