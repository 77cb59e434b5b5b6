//! What pictures are made of: the numbers come from the tables that draw.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use glam::DVec2;
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::spherical;
use merlkit::material::Loaded;
use merlkit::material::merl::{Header, MerlTable, decode_embedded};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::Stream;
use merlkit::sampler::{
    AdaptiveDisc, AdaptiveDiscSettings, CascadeCdf, CascadeCdfSettings, CdfCurve, Cosine,
    LeafChoice, Subdivision,
};
use merlkit_evaluate::measure::views::{PlottedChannel, PlottedValue};
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
    AdaptiveDisc::build(&Loaded::from_table(brdf.clone()), settings).unwrap()
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
    let curve = views::lobe(&**NICKEL, 30.0, PlottedValue::default());
    assert!(curve.windows(2).all(|w| w[0].0 < w[1].0), "angles rise");
    let at = |angle: f64| curve.iter().find(|p| p.0 == angle).unwrap().1;
    let wo = spherical(30f64.to_radians(), 0.0).as_vec3();
    for (angle, side) in [(10.0f64, -1.0), (-50.0, 1.0)] {
        let wi =
            spherical(angle.abs().to_radians(), 0.0).as_vec3() * glam::Vec3::new(side, 1.0, 1.0);
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
    let (values, colours) = (views::slice(&table, 90), views::slice_rgb(&table, 90));
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
    let curves = views::albedo_by_rule(NICKEL.table(), PlottedChannel::Mean);
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
