//! Values that an independent program computed, to six digits.
//!
//! Those of Poulin and Fournier's model are integrals by 10⁶ midpoints: with 200 the third value of the rougher surface is off in
//! the fourth digit, because a shadow ends on the cylinder there.
//!
//! Strauss's value follows his paper, with Fresnel's factor of the light's angle.

use glam::DVec3;

use super::pair::UpperPair;
use super::parse;
use crate::geometry::{Quadrature, spherical};

/// The pairs of directions, (theta, phi) of each in degrees.
const PAIRS: [[(f64, f64); 2]; 5] = [
    [(0.0, 0.0), (0.0, 0.0)],
    [(45.0, 0.0), (45.0, 180.0)],
    [(45.0, 0.0), (30.0, 120.0)],
    [(75.0, 0.0), (75.0, 180.0)],
    [(30.0, 40.0), (60.0, 200.0)],
];

/// Angles of the viewer of the albedos, in degrees.
const ANGLES: [f64; 4] = [1.0, 45.0, 75.0, 85.0];

const NONE: f64 = f64::NAN;

const TORRANCE: &str = "torrance:rough=0.35,nreal=0.617,nimag=2.63,ks=0.7,kd=0.3";
const BEARD_MAXWELL: &str =
    "beardmaxwell:omega=1,tau=0,nreal=0.37,nimag=2.82,Rs=0.4,Rd=0.75,Rv=0.5";

/// A model, its values at the pairs, and its albedos; NaN where there is none.
type Row = (&'static str, [f64; 5], [f64; 4]);

// 0.318310 is a value here, and equal to 1/π by the model alone.
#[allow(clippy::approx_constant)]
const ROWS: [Row; 25] = [
    (
        "minnaert:k=0.8,kd=1",
        [0.318310, 0.365642, 0.351113, 0.546577, 0.376314],
        [1.111, 1.191, 1.456, 1.810],
    ),
    (
        "phong:n=100,ks=0.4,kd=0.6",
        [6.68451, 6.68451, 0.190986, 6.68451, 0.190986],
        [1.000, 0.883, 0.704, 0.639],
    ),
    (
        "phong:n=100,ks=0.4,kd=0.6,form=printed",
        [1.0, 0.824264, 0.519615, 0.555291, 0.3],
        [1.281, 1.274, 1.263, 1.259],
    ),
    (
        "blinn:n=100,ks=1,kd=0.67,form=printed",
        [1.67, 1.47376, 0.474355, 1.17341, 0.588839],
        [2.341, 1.609, 0.565, 0.189],
    ),
    (
        "lewis:n=100,ks=1,kd=0",
        [4.22079, 4.22079, 0.00250500, 4.22079, 0.0363073],
        [1.000, 0.510, 0.086, 0.025],
    ),
    (
        "blinn:n=100,ks=1,kd=0",
        [4.22079, 4.22079, 0.00250500, 4.22079, 0.0363073],
        [1.000, 0.510, 0.086, 0.025],
    ),
    (
        "lewis:n=100,ks=1,kd=0,form=printed",
        [16.2338, 16.2338, 0.00963461, 16.2338, 0.139643],
        [3.845, 1.962, 0.331, 0.095],
    ),
    (
        TORRANCE,
        [0.432479, 0.769695, 0.295813, 5.40262, 0.512447],
        [0.811, 0.785, 0.795, 0.844],
    ),
    (
        "ward:sx=0.2,sy=0.2,ks=0.5,kd=0.5",
        [1.15387, 1.56590, 0.182322, 4.00245, 0.283905],
        [0.947, 0.819, 0.635, 0.591],
    ),
    (
        "ward:sx=0.05,sy=0.3,ks=0.05,kd=0.4",
        [0.392582, 0.502456, 0.127324, 1.15220, 0.127324],
        [0.444, 0.431, 0.412, NONE],
    ),
    (
        "schlick:SC=0.7,Sr=0.31,Sp=1",
        [0.179691, 0.330375, 0.179585, 1.00056, 0.269960],
        [0.537, 0.582, 0.800, 1.012],
    ),
    (
        "schlick",
        [0.123737, 0.237004, 0.0476436, 2.04279, 0.0781589],
        [0.211, 0.210, 0.281, 0.413],
    ),
    (
        "oren:s=0,r=1",
        [0.318310, 0.318310, 0.318310, 0.318310, 0.318310],
        [1.0, 1.0, 1.0, 1.0],
    ),
    (
        "oren",
        [0.225287, 0.177750, 0.209034, 0.109236, 0.186272],
        [0.708, 0.718, 0.764, 0.794],
    ),
    (
        "lafortune:Cx=-1,Cy=-1,Cz=1,n=100,kp=0.96",
        [1.30558, 1.30558, 0.305577, 1.30558, 0.305578],
        [1.022, 1.004, 0.976, 0.966],
    ),
    (
        "coupled",
        [0.317514, 0.316147, 0.316816, 0.191359, 0.307579],
        [0.950, 0.948, 0.738, 0.348],
    ),
    (
        "ashikhmin:ex=25,ey=25,Rs=0.39,Rd=0.6",
        [0.536560, 0.921249, 0.204282, 8.16547, 0.300480],
        [0.689, 0.631, 0.474, 0.394],
    ),
    (
        "ashikhmin",
        [0.309755, 0.514858, 0.222800, 4.02179, 0.289226],
        [NONE, NONE, NONE, NONE],
    ),
    (
        "strauss:s=0.76,m=0.91,ks=0.64,kd=0.5",
        [0.308482, 0.317543, 0.0423083, 0.365268, 0.0615795],
        [0.209, 0.176, 0.126, 0.110],
    ),
    (
        BEARD_MAXWELL,
        [0.698312, 1.06407, 0.521710, 5.42893, 0.683589],
        [1.637, 1.773, 2.201, 2.724],
    ),
    (
        "he:sigma=0.5,tau=3,lambda=800",
        [0.539651, 1.098756, 0.269778, 8.267864, 0.590087],
        [0.736, 0.685, 0.564, NONE],
    ),
    (
        "he",
        [0.537939, 1.091433, 0.270931, 8.306423, 0.591936],
        [NONE, NONE, NONE, NONE],
    ),
    (
        "poulin:d=2,h=0.01,n=100,ks=0.8,kd=0.2",
        [0.860458, 1.194471, 0.0501884, 3.124030, 0.0432897],
        [0.636, 0.496, 0.288, NONE],
    ),
    (
        "poulin",
        [0.684468, 0.699787, 0.123724, 0.762674, 0.169325],
        [NONE, NONE, NONE, NONE],
    ),
    (
        "torrance",
        [0.973339, 1.617805, 0.312054, 8.501096, 0.316922],
        [NONE, NONE, NONE, NONE],
    ),
];

fn direction((theta, phi): (f64, f64)) -> DVec3 {
    spherical(theta.to_radians(), phi.to_radians())
}

/// Whether `value` agrees with a number of six digits whose last may be off by one.
fn agrees(value: f64, expected: f64) -> bool {
    let unit = 10f64.powf(expected.abs().log10().floor() - 5.0);
    (value - expected).abs() <= 1.6 * unit
}

#[test]
fn values_are_those_of_an_independent_program() {
    let mut wrong = Vec::new();
    for (text, values, _) in ROWS {
        let parsed = parse(text).unwrap();
        for (number, (pair, expected)) in PAIRS.iter().zip(values).enumerate() {
            let [wo, wi] = pair.map(direction);
            let pair = UpperPair::new(wo, wi);
            let value = parsed.formula.value(&pair, DVec3::ONE).x;
            if !agrees(value, expected) {
                wrong.push(format!("{text} P{}: {value}, not {expected}", number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn albedos_are_those_of_an_independent_program() {
    let mut wrong = Vec::new();
    for (text, _, albedos) in ROWS {
        let brdf = parse(text).unwrap().brdf();
        for (angle, expected) in ANGLES.iter().zip(albedos) {
            if expected.is_nan() {
                continue;
            }
            let wo = direction((*angle, 0.0)).as_vec3();
            let albedo = Quadrature::new(wo, 55).integrate(|wi| brdf.eval_cos(wo, wi).x.into());
            if (albedo - expected).abs() > 2e-3 * expected.max(1.0) {
                wrong.push(format!("{text} at {angle}\u{b0}: {albedo}, not {expected}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
