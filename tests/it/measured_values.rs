//! Values of measured `.bsdf` files, as an evaluation of every corner by itself gave them, which agreed with Mitsuba 3 to 10⁻⁷.

use crate::measured_data::measured_files;
use glam::Vec3;
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::geometry::spherical;
use merlkit::material::rgl::{BsdfFile, RglBrdf};

/// θ and φ of `wo`, then of `wi`, degrees, and f_r·cosθᵢ.
type GoldenValue = ([f64; 4], [f32; 3]);

/// Three pairs far from each other, then three in the highlight.
const GOLDEN: [(&str, [GoldenValue; 6]); 4] = [
    (
        "paper_white",
        [
            (
                [12.5, 10.0, 63.2, 75.0],
                [0.10918131, 0.1111363, 0.13069254],
            ),
            (
                [47.3, -131.0, 21.9, 20.0],
                [0.2558599, 0.25901693, 0.29977933],
            ),
            (
                [78.1, 77.7, 55.4, -160.0],
                [0.16490132, 0.16545488, 0.1869005],
            ),
            ([8.3, 200.0, 10.5, 19.0], [0.2628044, 0.2667311, 0.31165057]),
            (
                [41.7, 33.0, 40.8, -153.1],
                [0.21918304, 0.22091581, 0.25319844],
            ),
            (
                [69.2, -64.0, 67.9, 116.3],
                [0.17064409, 0.16909058, 0.1794196],
            ),
        ],
    ),
    (
        "chm_mint",
        [
            (
                [12.5, 10.0, 63.2, 75.0],
                [0.018496754, 0.014017727, 0.018033342],
            ),
            (
                [47.3, -131.0, 21.9, 20.0],
                [0.03012428, 0.029145528, 0.03914772],
            ),
            (
                [78.1, 77.7, 55.4, -160.0],
                [0.017352005, 0.01321684, 0.016879162],
            ),
            ([8.3, 200.0, 10.5, 19.0], [0.0, 5.5246377, 4.0451384]),
            ([41.7, 33.0, 40.8, -153.1], [0.0, 0.53709126, 0.39562082]),
            ([69.2, -64.0, 67.9, 116.3], [0.0, 112.91812, 75.126816]),
        ],
    ),
    (
        "satin_purple",
        [
            (
                [12.5, 10.0, 63.2, 75.0],
                [0.079324685, 0.09332214, 0.08009512],
            ),
            (
                [47.3, -131.0, 21.9, 20.0],
                [0.19910385, 0.21879308, 0.2033601],
            ),
            (
                [78.1, 77.7, 55.4, -160.0],
                [0.08607507, 0.09427689, 0.090297915],
            ),
            (
                [8.3, 200.0, 10.5, 19.0],
                [0.84988445, 0.59681827, 1.1146044],
            ),
            (
                [41.7, 33.0, 40.8, -153.1],
                [1.0120653, 0.65934736, 1.099232],
            ),
            ([69.2, -64.0, 67.9, 116.3], [5.3678055, 5.058219, 5.0373983]),
        ],
    ),
    (
        "irid_flake_paint2",
        [
            (
                [12.5, 10.0, 63.2, 75.0],
                [0.012998584, 0.0072690523, 0.0033926968],
            ),
            (
                [47.3, -131.0, 21.9, 20.0],
                [0.025177924, 0.025253406, 0.03636048],
            ),
            (
                [78.1, 77.7, 55.4, -160.0],
                [0.017076626, 0.019552, 0.012071049],
            ),
            ([8.3, 200.0, 10.5, 19.0], [2.1971834, 2.1410153, 2.0625315]),
            (
                [41.7, 33.0, 40.8, -153.1],
                [0.7245336, 0.6508742, 0.5652816],
            ),
            ([69.2, -64.0, 67.9, 116.3], [22.750887, 22.596914, 22.71312]),
        ],
    ),
];

fn direction(theta: f64, phi: f64) -> Vec3 {
    spherical(theta.to_radians(), phi.to_radians()).as_vec3()
}

fn assert_golden(name: &str, rgl: &RglBrdf, values: &[GoldenValue]) {
    for &([theta_o, phi_o, theta_i, phi_i], expected) in values {
        let (wo, wi) = (direction(theta_o, phi_o), direction(theta_i, phi_i));
        let expected = Vec3::from_array(expected);
        let found = rgl.eval_cos(wo, wi);
        let off = (found - expected).abs().cmple(1e-6 * expected.abs());
        assert!(off.all(), "{name}, {wo}, {wi}: {found} for {expected}");
    }
}

/// Batches of one `wo` and of pairs have the bits of single calls on real files as well, whose tables have two slices a look-up.
fn assert_same_bits(name: &str, rgl: &RglBrdf) {
    let (wo, wi): (Vec<Vec3>, Vec<Vec3>) = crate::support::pairs(1000, 5).unzip();
    let (mut each, mut one) = (vec![Vec3::NAN; wi.len()], vec![Vec3::NAN; wi.len()]);
    rgl.eval_batch(Wo::Each(&wo), &wi, &mut each);
    rgl.eval_batch(Wo::One(wo[3]), &wi, &mut one);
    for k in 0..wi.len() {
        assert_eq!(each[k], rgl.eval(wo[k], wi[k]), "{name} {k}");
        assert_eq!(one[k], rgl.eval(wo[3], wi[k]), "{name} one {k}");
    }
}

#[test]
fn measured_values_are_those_of_the_plain_evaluation() {
    for path in measured_files() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some((_, values)) = GOLDEN.iter().find(|(start, _)| name.starts_with(start)) else {
            continue;
        };
        let rgl = RglBrdf::new(BsdfFile::open(&path).unwrap());
        assert_golden(&name, &rgl, values);
        assert_same_bits(&name, &rgl);
    }
}
