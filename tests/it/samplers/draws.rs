//! Draws at the horizon, with well-spread points, and from shallow trees.

use super::*;

/// Next to the horizon what is carried past it is turned up; nothing is lost there, and the density knows.
#[test]
fn half_vectors_carried_past_the_horizon_are_accounted_for() {
    let test = ChiSquareTest {
        draws: 400_000,
        tests: 12,
        ..Default::default()
    };
    for name in ["chrome", "white-marble"] {
        let brdf = measured(name);
        for spec in [
            disc(TableChoice::Nearest),
            rejection_free(TableChoice::Mixture),
        ] {
            let sampler = spec.build(&loaded(&brdf)).unwrap();
            for degrees in [83.0, 88.0, 89.8] {
                let result = test.run(&*sampler, direction(degrees));
                assert_eq!(
                    (result.verdict, result.failed),
                    (ChiSquareVerdict::Pass, 0),
                    "{spec:?} {degrees}: {result:?}"
                );
            }
        }
    }
}

/// Two numbers make a draw without rejection, so well-spread points give a better estimate than random ones.
#[test]
fn well_spread_points_serve_the_rejection_free_disc() {
    let brdf = measured("nickel");
    let sampler = rejection_free(TableChoice::Mixture)
        .build(&loaded(&brdf))
        .unwrap();
    for wo in [29.75, 60.25].map(direction) {
        let [random, sobol] = [PointSet::Random, PointSet::Sobol].map(|points| {
            // A smooth light that tells directions apart, so that the spread of places counts, not only that of weights.
            let light = |wi: Vec3| f64::from(1.0 + wi.x).powi(2) + f64::from(wi.y);
            let estimates: Vec<f64> = (0..200)
                .map(|seed| {
                    let weight = |s: DirectionSample| {
                        f64::from(Importance::Mean.reduce(brdf.eval_cos(wo, s.wi)))
                            / f64::from(s.pdf)
                            * light(s.wi)
                    };
                    let draws =
                        (0..256).filter_map(|i| sampler.sample(wo, points.point(seed, i, 0)));
                    draws.map(weight).sum::<f64>() / 256.0
                })
                .collect();
            mean_and_variance(&estimates)
        });
        assert!(
            (random.0 / sobol.0 - 1.0).abs() < 0.01,
            "{wo}: {random:?} {sobol:?}"
        );
        assert!(sobol.1 < 0.25 * random.1, "{wo}: {random:?} {sobol:?}");
    }
}

#[test]
fn builds_do_not_depend_on_threads() {
    let material = Material::resolve("alum-bronze").unwrap();
    let brdf = measured("alum-bronze");
    let specs = [
        SamplerSpec::new(AdaptiveDiscSettings {
            tables: 20,
            ..Default::default()
        }),
        rejection_free(TableChoice::Mixture),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 7,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 7,
            ..CascadeCdfSettings::uniform()
        }),
    ];
    for spec in specs {
        let bytes = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let sampler = pool.install(|| spec.build(&loaded(&brdf))).unwrap();
            encode(&sampler, &material).unwrap()
        });
        assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2], "{spec:?}");
    }
}

/// A tree of four leaves would need thousands of trials a draw, and giving up would contradict the pdf: it stands for the
/// uniform disc.
#[test]
fn shallow_trees_lose_no_draws() {
    let settings = AdaptiveDiscSettings {
        tables: 1,
        depth: 1,
        ..Default::default()
    };
    let disc = SamplerSpec::new(settings)
        .build(&loaded(&measured("nickel")))
        .unwrap();
    for i in 0..200 {
        assert!(
            disc.sample(Vec3::Z, PointSet::Random.point(1, i, 0))
                .is_some(),
            "draw {i}"
        );
    }
    assert!(
        disc.draw_stratified(Vec3::Z, 200, 1)
            .iter()
            .all(Option::is_some)
    );
}
