//! What every model promises, over difficult parameters and directions.

use std::f64::consts::TAU;

use glam::{Quat, Vec3};

use super::{MODELS, parse};
use crate::geometry::{Quadrature, Symmetry, spherical};

/// Parameters at which formulas tend to break, apart from every model's defaults.
const HARD: [&str; 46] = [
    "specular:form=printed",
    "minnaert:k=0.8,kd=1",
    "minnaert:k=0",
    "minnaert:k=2",
    "phong:n=1000000",
    "phong:n=0",
    "phong:form=printed",
    "blinn:n=1000000,ks=1,kd=0.67",
    "blinn:n=0",
    "blinn:n=1",
    "blinn:form=printed",
    "lewis:n=1000000",
    "lewis:form=printed",
    "torrance:rough=0.35,nreal=0.617,nimag=2.63",
    "torrance:rough=0.001",
    "torrance:rough=10",
    "torrance:form=printed",
    "ward:sx=0.2,sy=0.2,ks=0.5,kd=0.5",
    "ward:sx=0.001,sy=0.3",
    "schlick:Sr=0",
    "schlick:Sp=0",
    "schlick:Sr=0,Sp=0,Ly=T,Dr=0,Dp=0",
    "schlick:SC=0.7,Sr=0.31,Sp=1,Ly=T,DC=1,Dr=0,Dp=1",
    "schlick:form=printed,Ly=T",
    "schlick:form=printed,Sr=0",
    "oren:s=0,r=1",
    "oren:s=1.57,r=1",
    "lafortune:Cx=-1,Cy=-1,Cz=-1",
    "lafortune:Cx=2,Cy=2,Cz=2,n=1000000",
    "coupled:form=printed",
    "ashikhmin:ex=25,ey=25,Rs=0.39,Rd=0.6",
    "ashikhmin:ex=1000000,ey=0",
    "ashikhmin:form=printed",
    "strauss:s=1",
    "strauss:s=0,m=1",
    "strauss:form=printed",
    "beardmaxwell:omega=1,tau=0,nreal=0.37,nimag=2.82,Rs=0.4,Rd=0.75,Rv=0.5",
    "beardmaxwell:form=printed",
    "he:sigma=0.5,tau=3,lambda=800",
    "he:sigma=8,tau=3,lambda=800",
    "he:sigma=0",
    "poulin:d=0",
    "poulin:h=1",
    "poulin:d=1,h=0",
    "coated:eta=1,ax=0.01,ay=0.5,kd=1",
    "sheen:alpha=0.01,ks=1",
];

/// All models with their defaults, and the hard parameters.
fn texts() -> Vec<&'static str> {
    let mut texts: Vec<&str> = MODELS.iter().map(|model| model.name).collect();
    texts.extend(HARD);
    texts
}

/// Random directions, grazing ones, the normal and its surroundings, and the axes.
fn difficult_directions() -> Vec<Vec3> {
    let mut directions = vec![Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
    for z in [1e-38, 1e-20, 1e-6, 1e-3] {
        directions.push(Vec3::new(1.0, 0.0, z));
        directions.push(Vec3::new(0.0, -1.0, z));
        directions.push(Vec3::new(-0.6, 0.8, z));
    }
    for tilt in [1e-7, 1e-4, 1e-2] {
        directions.push(Vec3::new(tilt, 0.0, 1.0));
        directions.push(Vec3::new(-tilt, tilt, 1.0));
    }
    for k in 1..=24 {
        let (height, turn) = ((f64::from(k) * 0.618_034).fract(), f64::from(k) * 0.754_878);
        directions.push(spherical(height.acos(), turn.fract() * TAU).as_vec3());
    }
    directions
}

#[test]
fn values_are_finite_and_not_negative() {
    let directions = difficult_directions();
    let mut odd = directions.clone();
    odd.extend([Vec3::X, -Vec3::Z, Vec3::NAN, Vec3::ZERO, Vec3::INFINITY]);
    for text in texts() {
        let brdf = parse(text).unwrap().brdf();
        for &wo in &odd {
            for &wi in &odd {
                let upper = |w: Vec3| w.z > 0.0 && w.is_finite();
                let value = brdf.eval(wo, wi);
                assert!(value.is_finite(), "{text}: {wo} {wi}: {value}");
                assert!(value.min_element() >= 0.0, "{text}: {wo} {wi}: {value}");
                let is_black = value == Vec3::ZERO;
                assert!(upper(wo) && upper(wi) || is_black, "{text}: {wo} {wi}");
                assert_eq!(brdf.eval(wo, -wo), Vec3::ZERO, "{text}");
            }
            if let Some(mirror) = brdf.mirror(wo) {
                assert!(wo.z > 0.0 && mirror.is_finite(), "{text}: {wo}: {mirror}");
                assert!((0.0..=1.01).contains(&mirror.x), "{text}: {wo}: {mirror}");
            }
        }
    }
}

/// Relative difference of two values, which counts as absolute below 10⁻⁶.
fn difference(a: Vec3, b: Vec3) -> f32 {
    (a - b).abs().max_element() / a.max(b).max_element().max(1e-6)
}

#[test]
fn what_is_stated_of_symmetries_holds() {
    let directions: Vec<Vec3> = difficult_directions()
        .into_iter()
        .filter(|w| w.z > 1e-4)
        .collect();
    for text in texts() {
        let parsed = parse(text).unwrap();
        let (properties, brdf) = (parsed.formula.properties(), parsed.brdf());
        assert_eq!(brdf.symmetry(), properties.symmetry, "{text}");
        let mut worst = [0.0f32; 3];
        for &wo in &directions {
            for &wi in &directions {
                let pair = super::pair::UpperPair::new(wo.as_dvec3(), wi.as_dvec3());
                // Where a lobe of this exponent is steep, rounding of turned directions to f32 changes its value.
                let steep = text.contains("1000000") || text.contains("0.001");
                let value = parsed.formula.value(&pair, glam::DVec3::ONE).as_vec3();
                if properties.reciprocal {
                    worst[0] = worst[0].max(difference(value, brdf.eval(wi, wo)));
                }
                if properties.symmetry == Symmetry::Isotropic && !steep {
                    let turn = Quat::from_rotation_z(1.1);
                    worst[1] = worst[1].max(difference(value, brdf.eval(turn * wo, turn * wi)));
                }
                if properties.symmetry != Symmetry::Whole {
                    let sign = Vec3::new(-1.0, 1.0, 1.0);
                    worst[2] = worst[2].max(difference(value, brdf.eval(sign * wo, sign * wi)));
                }
            }
        }
        assert!(worst.iter().all(|&w| w < 2e-3), "{text}: {worst:?}");
    }
}

#[test]
fn what_is_not_reciprocal_says_so() {
    let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.8, 0.1, 0.6));
    for text in texts() {
        let parsed = parse(text).unwrap();
        if !parsed.formula.properties().reciprocal {
            let brdf = parsed.brdf();
            assert!(
                difference(brdf.eval(wo, wi), brdf.eval(wi, wo)) > 1e-3,
                "{text}"
            );
        }
    }
}

#[test]
fn albedos_keep_their_bounds() {
    let mut wrong = Vec::new();
    for text in texts() {
        let parsed = parse(text).unwrap();
        let Some(bound) = parsed.formula.properties().albedo_bound else {
            continue;
        };
        // The quadrature of so few points misses a lobe this narrow.
        if text.contains("0.001") {
            continue;
        }
        let brdf = parsed.brdf();
        for theta in [0.0f64, 20.0, 45.0, 70.0, 80.0, 88.0] {
            let wo = spherical(theta.to_radians(), 0.4).as_vec3();
            let mut albedo = f64::from(brdf.mirror(wo).unwrap_or_default().x);
            albedo += Quadrature::new(wo, 34).integrate(|wi| brdf.eval_cos(wo, wi).x.into());
            if albedo > bound * 1.004 + 1e-6 {
                wrong.push(format!("{text} at {theta}: {albedo} > {bound}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
