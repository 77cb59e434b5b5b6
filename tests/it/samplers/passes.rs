//! Samplers that are right pass every check.

use super::*;

/// Every sampler with the mixture; with the nearest table the default ones for every second material, the others for the rest.
fn assert_all_pass(name: &str, seed: u64) {
    use TableChoice::{Mixture, Nearest};
    let brdf = measured(name);
    let nearest = match seed.is_multiple_of(2) {
        true => [disc(Nearest), cascade(Nearest)],
        false => [whole(Nearest), coarse(Nearest)],
    };
    let mixtures = [
        disc(Mixture),
        rejection_free(Mixture),
        cascade(Mixture),
        whole(Mixture),
        coarse(Mixture),
    ];
    for (i, spec) in mixtures.into_iter().chain(nearest).enumerate() {
        assert_passes(spec, &brdf, &settings(100 * seed + i as u64));
    }
}

macro_rules! all_pass_on {
    ($($test:ident: $name:literal, $seed:literal;)*) => {
        $(#[test]
        fn $test() {
            assert_all_pass($name, $seed);
        })*
    };
}

mod every_sampler_passes_on {
    use super::assert_all_pass;
    all_pass_on! {
        nickel: "nickel", 1;
        chrome: "chrome", 2;
        teflon: "teflon", 3;
        red_plastic: "red-plastic", 4;
        blue_metallic_paint: "blue-metallic-paint", 5;
        black_obsidian: "black-obsidian", 6;
        violet_acrylic: "violet-acrylic", 7;
        alum_bronze: "alum-bronze", 8;
        white_marble: "white-marble", 9;
        beige_fabric: "beige-fabric", 10;
        alumina_oxide: "alumina-oxide", 11;
        yellow_paint: "yellow-paint", 12;
    }
}

#[test]
fn cosine_passes_on_dull_materials() {
    for (seed, name) in ["white-marble", "beige-fabric", "yellow-paint"]
        .into_iter()
        .enumerate()
    {
        assert_passes(
            SamplerSpec::new(CosineSettings {}),
            &measured(name),
            &settings(2000 + seed as u64),
        );
    }
}

#[test]
fn luminance_passes() {
    let brdf = measured("blue-metallic-paint");
    let importance = Importance::Luminance;
    let specs = [
        SamplerSpec::new(AdaptiveDiscSettings {
            importance,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            importance,
            ..Default::default()
        }),
    ];
    for (seed, spec) in specs.into_iter().enumerate() {
        assert_passes(
            spec,
            &brdf,
            &CheckSettings {
                importance,
                ..settings(2100 + seed as u64)
            },
        );
    }
}

#[test]
fn other_lookup_rules_pass() {
    let cases = [
        ("chrome", LookupRule::Linear),
        ("violet-acrylic", LookupRule::Centred),
    ];
    for (seed, (name, rule)) in cases.into_iter().enumerate() {
        let brdf = Arc::new(measured_under(name, rule));
        for spec in [
            disc(TableChoice::Mixture),
            rejection_free(TableChoice::Mixture),
            cascade(TableChoice::Nearest),
        ] {
            assert_passes(spec, &brdf, &settings(2200 + seed as u64));
        }
    }
}
