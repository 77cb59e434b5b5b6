//! What the settings of the thesis do, and ours do not.

use super::*;

fn spreads(spec: SamplerSpec, brdf: &Arc<MerlBrdf>) -> Vec<WeightSpread> {
    let sampler = spec.build(&loaded(brdf)).unwrap();
    let at = |&degrees: &f64| {
        let quadrature = Quadrature::new(direction(degrees), POINTS_PER_BIN);
        weight_spread(&*sampler, &**brdf, &quadrature, Importance::Mean)
    };
    LIMIT_ANGLES_DEG.iter().map(at).collect()
}

#[test]
fn the_published_cascade_has_holes() {
    let brdf = measured("teflon");
    let sampler = SamplerSpec::new(CascadeCdfSettings::as_published(true))
        .build(&loaded(&brdf))
        .unwrap();
    let report = check_sampler(
        &*sampler,
        &*brdf,
        &[direction(29.75), direction(30.0)],
        &settings(1),
    );
    assert_eq!(failed(&report, Check::Positivity), 2, "{report:#?}");
    // It is honest about them: its density is what it draws from.
    assert_eq!(failed(&report, Check::ChiSquare), 0, "{report:#?}");
}

#[test]
fn the_published_cascade_is_heavy_tailed_and_ours_is_not() {
    let brdf = measured("red-plastic");
    let published = spreads(
        SamplerSpec::new(CascadeCdfSettings::as_published(true)),
        &brdf,
    );
    let ours = spreads(SamplerSpec::new(CascadeCdfSettings::default()), &brdf);
    assert!(published.iter().any(|s| s.relstd > 1.0), "{published:#?}");
    assert!(
        ours.iter().all(|s| s.relstd < 0.3 && s.holes == 0.0),
        "{ours:#?}"
    );
}

#[test]
fn the_published_disc_has_a_density_that_is_off() {
    let brdf = measured("chrome");
    // Ten subdivisions follow chrome's peak as far as the image does, so that what is left are the image's errors.
    let deep = AdaptiveDiscSettings {
        depth: 10,
        ..AdaptiveDiscSettings::as_published()
    };
    let sampler = SamplerSpec::new(deep).build(&loaded(&brdf)).unwrap();
    let report = check_sampler(
        &*sampler,
        &*brdf,
        &[0.0, 45.0, 75.5].map(direction),
        &settings(1),
    );
    assert_eq!(failed(&report, Check::ChiSquare), 3, "{report:#?}");
    assert_eq!(failed(&report, Check::PdfIntegral), 3, "{report:#?}");
    let bias = report
        .failures()
        .filter(|o| o.check == Check::Bias)
        .map(|o| o.value)
        .fold(0.0, f64::max);
    assert!(bias > 0.02, "{report:#?}");
}
