//! Pictures whose pixels are known: closed forms and quadrature.

use super::*;

/// f_r·cosθᵢ of world directions, in a frame worked out here.
fn reflect(brdf: &dyn Brdf, normal: DVec3, wo: DVec3, wi: DVec3) -> DVec3 {
    let helper = if normal.x.abs() < 0.5 {
        DVec3::X
    } else {
        DVec3::Z
    };
    let x = normal.cross(helper).normalize();
    let y = normal.cross(x);
    let local = |w: DVec3| DVec3::new(w.dot(x), w.dot(y), w.dot(normal)).as_vec3();
    brdf.eval(local(wo), local(wi)).as_dvec3() * wi.dot(normal).max(0.0)
}

fn assert_pixels_match(
    spec: &SceneSpec,
    brdf: &Arc<dyn Brdf>,
    expected: impl Fn(&Ray, DVec3, DVec3) -> DVec3,
) {
    let side = 16;
    let film = planned(spec, std::slice::from_ref(brdf), side, 2048);
    let mut compared = 0;
    for (x, y) in (0..side * side).map(|i| (i % side, i / side)) {
        let Some(value) = over_pixel(spec, side, x, y, &expected) else {
            continue;
        };
        let slack = 4.5 * film.standard_error(x, y) + 2e-3 * value + 1e-6;
        let off = (film.mean(x, y) - value).abs();
        assert!(
            off.cmple(slack).all(),
            "({x}, {y}): {} for {value}",
            film.mean(x, y)
        );
        compared += usize::from(value.x > 0.01);
    }
    assert!(compared > 12, "{compared} lit pixels compared");
}

#[test]
fn a_lambert_sphere_in_uniform_light_shows_its_albedo() {
    for strategy in STRATEGIES {
        let spec = row(1, vec![uniform(1.0)], strategy);
        let film = planned(&spec, &[lambert(0.6)], 16, 1024);
        let mut compared = 0;
        for (x, y) in (0..256).map(|i| (i % 16, i / 16)) {
            let (mean, error) = (film.mean(x, y).x, film.standard_error(x, y).x);
            if over_pixel(&spec, 16, x, y, |_, _, _| DVec3::ZERO).is_some() {
                assert!(
                    (mean - 0.6).abs() < 4.5 * error + 1e-6,
                    "{strategy:?} ({x}, {y}): {mean} ± {error}"
                );
                compared += 1;
            }
        }
        assert!(compared > 60);
        assert_eq!(film.mean(0, 0), DVec3::ONE);
    }
}

#[test]
fn a_white_sphere_on_a_white_floor_in_uniform_light_is_invisible() {
    let spec = SceneSpec {
        floor: Some(1.0),
        depth: 200,
        ..row(1, vec![uniform(1.0)], MIS)
    };
    let film = planned(&spec, &[lambert(1.0)], 12, 512);
    let mut sum = 0.0;
    for (x, y) in (0..144).map(|i| (i % 12, i / 12)) {
        let z = (film.mean(x, y).x - 1.0) / film.standard_error(x, y).x.max(1e-9);
        assert!(
            z.abs() < 4.5,
            "({x}, {y}): {} is {z} standard errors from 1",
            film.mean(x, y).x
        );
        sum += film.mean(x, y).x / 144.0;
    }
    assert!((sum - 1.0).abs() < 5e-3, "{sum}");
}

#[test]
fn a_point_light_follows_the_closed_form() {
    let light = Point {
        position: DVec3::new(-2.0, 4.0, 3.0),
        intensity: Rgb::new(20.0, 40.0, 60.0),
    };
    let spec = row(1, vec![LightSpec::Point(light)], MIS);
    for brdf in [lambert(0.5), embedded("blue-metallic-paint")] {
        assert_pixels_match(&spec, &brdf, |ray, at, normal| {
            let to = light.position - at;
            let irradiance = light.intensity.as_dvec3() / to.length_squared();
            reflect(brdf.as_ref(), normal, -ray.direction, to.normalize()) * irradiance
        });
    }
}

#[test]
fn parallel_light_follows_the_closed_form() {
    let light = Directional {
        towards: DVec3::new(0.5, 1.0, 1.5),
        irradiance: Rgb::new(1.0, 2.0, 3.0),
    };
    let spec = row(1, vec![LightSpec::Directional(light)], MIS);
    for brdf in [lambert(0.5), embedded("blue-metallic-paint")] {
        assert_pixels_match(&spec, &brdf, |ray, _, normal| {
            let wi = light.towards.normalize();
            reflect(brdf.as_ref(), normal, -ray.direction, wi) * light.irradiance.as_dvec3()
        });
    }
}

#[test]
fn an_area_light_agrees_with_quadrature() {
    let light = Area {
        corner: DVec3::new(-1.5, 3.0, 1.0),
        edge_u: DVec3::new(0.0, 0.0, 1.5),
        edge_v: DVec3::new(-1.0, 0.5, 0.0),
        radiance: Rgb::new(10.0, 5.0, 2.0),
    };
    let facing = light.edge_u.cross(light.edge_v);
    let light = if facing.y < 0.0 {
        light
    } else {
        Area {
            edge_u: light.edge_v,
            edge_v: light.edge_u,
            ..light
        }
    };
    for strategy in STRATEGIES {
        let mut spec = row(1, vec![LightSpec::Area(light)], strategy);
        let normal = DVec3::new(-0.3, 0.9, 0.2).normalize();
        let (at, wo) = look_at_point(&mut spec, normal);
        let brdf = lambert(0.7);
        let (n, mut sum) = (200, DVec3::ZERO);
        for i in 0..n * n {
            let (u, v) = (f64::from(i % n) + 0.5, f64::from(i / n) + 0.5);
            let to = light.corner + (u * light.edge_u + v * light.edge_v) / f64::from(n) - at;
            let area = -light.edge_u.cross(light.edge_v).dot(to.normalize()) / f64::from(n * n);
            sum += reflect(brdf.as_ref(), normal, wo, to.normalize()) * area / to.length_squared();
        }
        let expected = sum * light.radiance.as_dvec3();
        assert_pixel(
            &planned(&spec, &[brdf], 1, 1 << 16),
            expected,
            1e-4,
            &format!("{strategy:?}"),
        );
    }
}

#[test]
fn an_environment_on_a_metal_agrees_with_quadrature() {
    let (sky, nickel) = (studio(SkySampling::Uniform), embedded("nickel"));
    let studio = || vec![LightSpec::Environment(EnvironmentSource::Studio)];
    for normal in [
        DVec3::new(-0.4, 0.6, 0.7),
        DVec3::new(0.5, 0.1, 0.8),
        DVec3::new(0.0, -0.6, 0.7),
    ] {
        let normal = normal.normalize();
        let mut spec = row(1, studio(), MIS);
        let (_, wo) = look_at_point(&mut spec, normal);
        let (rows, mut expected) = (1200, DVec3::ZERO);
        for i in 0..rows {
            let theta = (f64::from(i) + 0.5) / f64::from(rows) * PI;
            let cell = theta.sin() * (PI / f64::from(rows)).powi(2);
            for j in 0..2 * rows {
                let w = spherical(theta, (f64::from(j) + 0.5) / f64::from(2 * rows) * TAU);
                let reflected = reflect(nickel.as_ref(), normal, wo, w);
                expected += reflected * sky.radiance(w).as_dvec3() * cell;
            }
        }
        let film = planned(&spec, std::slice::from_ref(&nickel), 1, 1 << 20);
        assert_pixel(&film, expected, 3e-3, &format!("normal {normal}"));
    }
}

#[test]
fn an_environment_file_lights_as_its_pixels_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.exr");
    // Light from the upper half only: irradiance on the top of the sphere is that of a uniform sky.
    let half = Image::from_fn(64, 32, |_, y| Rgb::splat(if y < 16 { 2.0 } else { 0.0 })).unwrap();
    write_exr(&path, &half, Overwrite::Refuse).unwrap();
    let sky = LightSpec::Environment(EnvironmentSource::File { path, clamp: None });
    let mut spec = row(1, vec![sky], MIS);
    look_at_point(&mut spec, DVec3::Y);
    let film = planned(&spec, &[lambert(0.5)], 1, 1 << 14);
    assert_pixel(&film, DVec3::ONE, 1e-3, "half sky");
}
