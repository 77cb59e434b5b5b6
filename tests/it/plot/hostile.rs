//! Charts of nothing, and of numbers and texts that break what is careless.

use super::*;

#[test]
fn empty_charts_say_so() {
    let nothing = [
        lines(Vec::new(), Scale::Linear).svg(),
        lines(vec![series(vec![(0.0, 1.0), (-1.0, f64::NAN)])], Scale::Log).svg(),
        Scatter::default().svg(),
        Polar::default().svg(),
        Disc::default().svg(),
        heat(vec![f64::NAN; 4], Scale::Log).svg().unwrap(),
        Surfaces::default().drawing(ChartSize::default()).svg(),
        surfaces(&[], "lobe", (0.0, 1.0))
            .drawing(ChartSize::default())
            .svg(),
        surfaces(&[1.0], "lobe", (1.0, f64::NAN))
            .drawing(ChartSize::default())
            .svg(),
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

/// Every writer takes what SVG takes, with numbers and texts that no picture has a place for.
#[test]
fn hostile_pictures_are_drawn_as_png_and_pdf() {
    let pairs: Vec<(f64, f64)> = HOSTILE
        .iter()
        .flat_map(|&a| HOSTILE.map(|b| (a, b)))
        .collect();
    let mut solids = surfaces(&HOSTILE, HOSTILE_TEXT, (0.0, 1.0));
    solids.panels[0].lobes[0].vertices[1].0 = [f64::NAN, f64::INFINITY, 1e300];
    solids.panels[0].lobes[1].spokes = 0;
    let mut one = surfaces(&[1e17], HOSTILE_TEXT, (0.0, 1e17));
    one.viewpoint.elevation = f64::NAN;
    let size = ChartSize::default();
    let drawings = [
        lines(vec![series(pairs.clone())], Scale::Linear).drawing(size),
        Disc {
            caption: Caption::new(HOSTILE_TEXT.repeat(9), HOSTILE_TEXT),
            points: pairs.clone(),
            cells: vec![pairs],
            ..Disc::default()
        }
        .drawing(size),
        heat(HOSTILE.to_vec(), Scale::Root).drawing(size).unwrap(),
        solids.drawing(size),
        one.drawing(size),
    ];
    for drawing in drawings {
        check(&drawing.svg());
        let (width, height) = drawing.size();
        let png = drawing.png(0.5).unwrap();
        let sides = [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()));
        assert_eq!(
            sides.map(f64::from),
            [width, height].map(|s| (0.5 * s).round())
        );
        assert!(drawing.pdf().starts_with(b"%PDF"));
        assert!(drawing.png(0.0).is_err() && drawing.png(f64::NAN).is_err());
    }
}
