//! Densities that are wrong are rejected.

use super::*;

/// Checks with the usual number of draws.
fn check_tampered(
    draws: &dyn DirectionSampler,
    claims: &dyn DirectionSampler,
    shift: f64,
    wos: &[Vec3],
    brdf: &MerlBrdf,
) -> CheckReport {
    check_sampler(
        &Tampered {
            draws,
            claims,
            shift,
        },
        brdf,
        wos,
        &CheckSettings::default(),
    )
}

#[test]
fn the_density_of_the_neighbouring_tree_is_rejected() {
    let brdf = measured("nickel");
    let sampler = kept(TableChoice::Nearest).build(&loaded(&brdf)).unwrap();
    let wos = [14.5, 45.0, 75.5].map(direction);
    // Its density knows of `wo` only the azimuth and the trees, which stand 90°/59 apart.
    let right = check_tampered(&*sampler, &*sampler, 0.0, &wos, &brdf);
    let wrong = check_tampered(
        &*sampler,
        &*sampler,
        (90.0_f64 / 59.0).to_radians(),
        &wos,
        &brdf,
    );
    assert!(right.pass(), "{:#?}", right.failures().collect::<Vec<_>>());
    assert_eq!(failed(&wrong, Check::ChiSquare), 3, "{wrong:#?}");
}

/// The floor is a thousandth of the draws, which takes a few million of them to see.
#[test]
fn a_density_without_the_floor_is_rejected() {
    let brdf = measured("chrome");
    let without = [
        SamplerSpec::new(AdaptiveDiscSettings {
            floor: 0.0,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            floor: 0.0,
            ..Default::default()
        }),
    ];
    let test = ChiSquareTest {
        draws: 2_000_000,
        tests: 4,
        ..Default::default()
    };
    for (ours, without) in [disc, cascade]
        .map(|s| s(TableChoice::Mixture))
        .into_iter()
        .zip(without)
    {
        let (draws, claims) = (
            ours.build(&loaded(&brdf)).unwrap(),
            without.build(&loaded(&brdf)).unwrap(),
        );
        let wrong = Tampered {
            draws: &*draws,
            claims: &*claims,
            shift: 0.0,
        };
        let (right, wrong) = (
            test.run(&*draws, direction(45.0)),
            test.run(&wrong, direction(45.0)),
        );
        assert_eq!(right.verdict, ChiSquareVerdict::Pass, "{ours:?}: {right:?}");
        assert_ne!(wrong.verdict, ChiSquareVerdict::Pass, "{ours:?}: {wrong:?}");
    }
}

/// Half vectors follow `wo`: their density at an angle of `wo` half a degree away is another.
#[test]
fn a_density_for_another_angle_is_rejected() {
    let brdf = measured("nickel");
    let wos = [14.5, 45.0, 75.5].map(direction);
    for spec in [
        disc(TableChoice::Mixture),
        rejection_free(TableChoice::Mixture),
    ] {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let right = check_tampered(&*sampler, &*sampler, 0.0, &wos, &brdf);
        let wrong = check_tampered(&*sampler, &*sampler, 0.5_f64.to_radians(), &wos, &brdf);
        assert!(
            right.pass(),
            "{spec:?}: {:#?}",
            right.failures().collect::<Vec<_>>()
        );
        assert_eq!(failed(&wrong, Check::ChiSquare), 3, "{spec:?}: {wrong:#?}");
    }
}

#[test]
fn draws_of_the_nearest_table_with_the_density_of_the_mixture_are_rejected() {
    let brdf = measured("nickel");
    // Midway between trees 1.5° apart, and between tables 6° apart where half vectors change fast.
    let cases: [(Spec, _); 2] = [(kept, [14.5, 45.0, 75.5]), (cascade, [75.0, 81.0, 87.0])];
    for (spec, angles) in cases {
        let wos = angles.map(direction);
        let (draws, claims) = (
            spec(TableChoice::Nearest).build(&loaded(&brdf)).unwrap(),
            spec(TableChoice::Mixture).build(&loaded(&brdf)).unwrap(),
        );
        let report = check_tampered(&*draws, &*claims, 0.0, &wos, &brdf);
        assert_eq!(
            failed(&report, Check::ChiSquare),
            3,
            "{:?}: {report:#?}",
            draws.spec()
        );
    }
}
