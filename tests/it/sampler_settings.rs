//! Samplers and their settings as text: what is read, what is printed, and what is refused.

use merlkit::geometry::Symmetry;
use merlkit::material::MaterialFacts;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, Construction, CosineSettings, FactoredSettings,
    HalfVectorSettings, LeafChoice, LobeKind, LobeParameters, LobeSettings, Needs,
    OwnSamplerSettings, SamplerSpec,
};

fn parse(text: &str) -> SamplerSpec {
    text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn refusal(text: &str) -> String {
    match text.parse::<SamplerSpec>() {
        Ok(spec) => panic!("{text} was read as {spec}"),
        Err(error) => error.to_string(),
    }
}

/// A value of every setting of every method that is not the default.
const CHANGED: [&str; 36] = [
    "half-vector:tables=3",
    "half-vector:rows=50",
    "half-vector:segments=5",
    "half-vector:folded",
    "half-vector:azimuths=12",
    "half-vector:luminance",
    "adaptive-disc:tables=7",
    "adaptive-disc:azimuths=4",
    "adaptive-disc:depth=10",
    "adaptive-disc:n-max=1.3",
    "adaptive-disc:waste=0",
    "adaptive-disc:leaves=integral",
    "adaptive-disc:rejection-free",
    "adaptive-disc:carry=direction",
    "adaptive-disc:grid=800",
    "adaptive-disc:nearest",
    "adaptive-disc:floor=0.5",
    "adaptive-disc:luminance",
    "cascade-cdf:tables=32",
    "cascade-cdf:azimuths=4",
    "cascade-cdf:cells=90x32",
    "cascade-cdf:tolerance=none",
    "cascade-cdf:tolerance=0.0000001",
    "cascade-cdf:tolerance=inf",
    "cascade-cdf:spacing=uniform",
    "cascade-cdf:nearest",
    "cascade-cdf:floor=1",
    "cascade-cdf:luminance",
    "lobe:ward",
    "lobe:ggx,parameters=0.1/0.1/0.05",
    "lobe:blinn,luminance",
    "lobe:ward,axes=surface",
    "factored:tables=20",
    "factored:azimuths=4",
    "factored:factors=8x4/64x32/half-vector/0.01",
    "factored:luminance",
];

#[test]
fn every_setting_is_printed_as_it_is_read() {
    for text in CHANGED {
        assert_eq!(parse(text).to_string(), text);
    }
    // No setting was forgotten.
    for method in SamplerSpec::methods() {
        for setting in method.setting_facts() {
            let differs = |text: &&str| {
                let spec = parse(text);
                spec.name() == method.name()
                    && spec.setting(setting.key) != method.setting(setting.key)
            };
            assert!(
                CHANGED.iter().any(differs),
                "{} of {}",
                setting.key,
                method.name()
            );
        }
    }
}

#[test]
fn every_preset_and_default_is_printed_as_it_is_read() {
    for method in SamplerSpec::methods() {
        assert_eq!(parse(method.name()), method);
        assert_eq!(parse(&method.to_string()), method);
        for preset in method.preset_facts() {
            let text = format!("{}:{}", method.name(), preset.name);
            assert_eq!(parse(&text).to_string(), text);
            assert_eq!(parse(&text.to_uppercase()), parse(&text));
        }
    }
}

#[test]
fn the_shortest_text_is_printed() {
    for (read, printed) in [
        ("half-vector", "half-vector:64KB"),
        ("half-vector:64kb,rows=53", "half-vector:64KB"),
        ("half-vector:64KB,rows=50", "half-vector:rows=50"),
        ("half-vector:1MB,folded", "half-vector:1MB,folded"),
        ("half-vector:2KB,sides=unfolded", "half-vector:2KB,unfolded"),
        ("adaptive-disc", "adaptive-disc"),
        (
            "adaptive-disc:leaves=rejection-free",
            "adaptive-disc:rejection-free",
        ),
        ("adaptive-disc:depth=0", "adaptive-disc:rejection"),
        (
            "cascade-cdf:cells=256x32,tolerance=none",
            "cascade-cdf:uniform",
        ),
        (
            "cascade-cdf:published, tables=7",
            "cascade-cdf:published,tables=7",
        ),
        ("lobe", "lobe:ggx"),
        (" Cosine ", "cosine"),
    ] {
        assert_eq!(parse(read).to_string(), printed);
    }
}

#[test]
fn texts_and_typed_settings_agree() {
    let disc = AdaptiveDiscSettings {
        depth: 10,
        leaves: LeafChoice::Warp,
        ..Default::default()
    };
    let grid = AdaptiveDiscSettings {
        construction: Construction::Grid(200),
        ..AdaptiveDiscSettings::as_published()
    };
    let cells = CascadeCdfSettings {
        theta_h: 128,
        phi_h: 64,
        tolerance: Some(0.002),
        ..Default::default()
    };
    let folded = HalfVectorSettings {
        fold: true,
        azimuths: Some(12),
        ..Default::default()
    };
    let lobe = LobeSettings {
        parameters: Some(LobeParameters {
            along: 0.1,
            across: 0.1,
            diffuse: 0.05,
        }),
        ..LobeSettings::fitted(LobeKind::Ward)
    };
    for (text, spec) in [
        (
            "adaptive-disc:depth=10,rejection-free",
            SamplerSpec::new(disc),
        ),
        ("adaptive-disc:published,grid=200", SamplerSpec::new(grid)),
        (
            "adaptive-disc:published,depth=4",
            SamplerSpec::new(AdaptiveDiscSettings::as_published()),
        ),
        (
            "cascade-cdf:cells=128x64,tolerance=0.002",
            SamplerSpec::new(cells),
        ),
        (
            "half-vector:64KB,azimuths=12,folded",
            SamplerSpec::new(folded),
        ),
        ("lobe:ward,parameters=0.1/0.1/0.05", SamplerSpec::new(lobe)),
        ("factored", SamplerSpec::new(FactoredSettings::default())),
        ("cosine", SamplerSpec::new(CosineSettings {})),
        ("file", SamplerSpec::new(OwnSamplerSettings {})),
        (
            "cascade-cdf:uniform",
            SamplerSpec::new(CascadeCdfSettings::uniform()),
        ),
        (
            "cascade-cdf:published",
            SamplerSpec::new(CascadeCdfSettings::as_published(true)),
        ),
        (
            "cascade-cdf:published-uniform",
            SamplerSpec::new(CascadeCdfSettings::as_published(false)),
        ),
        (
            "adaptive-disc:rejection",
            SamplerSpec::new(AdaptiveDiscSettings::rejection()),
        ),
    ] {
        assert_eq!(parse(text), spec, "{text}");
        assert_eq!(parse(&spec.to_string()), spec, "{text}");
    }
    assert_ne!(parse("cosine"), parse("file"));
}

/// Numbers of every size survive: what is printed is read as the same bits.
#[test]
fn fitted_numbers_survive_to_the_bit() {
    for along in [1e-4f32, 0.1, 1.0 / 3.0, 1.999_999_9] {
        let settings = LobeSettings {
            parameters: Some(LobeParameters {
                along,
                across: along,
                diffuse: 0.001 + along / 7.0,
            }),
            ..LobeSettings::fitted(LobeKind::Ggx)
        };
        let spec = SamplerSpec::new(settings);
        let again = parse(&spec.to_string());
        assert_eq!(again.settings(), Some(&settings));
    }
}

#[test]
fn what_is_misspelt_is_answered_with_one_clear_error() {
    for (text, words) in [
        (
            "adaptive-disc:dept=3",
            &[
                "no setting of adaptive-disc is called dept",
                "did you mean depth?",
            ][..],
        ),
        (
            "half-vector:48KB",
            &["no setting of half-vector is called 48KB", "did you mean"],
        ),
        (
            "half-vector:fold",
            &["called fold;", "did you mean folded?"],
        ),
        (
            "half-vector:xyz=3",
            &["called xyz", "`merlkit samplers half-vector`"],
        ),
        (
            "half-vector:rows",
            &["rows of half-vector has no value", "2 to 79"],
        ),
        (
            "half-vector:rows=5,rows=6",
            &["rows of half-vector is given twice"],
        ),
        (
            "half-vector:rows=5,2KB",
            &["2KB of half-vector follows other settings", "first"],
        ),
        (
            "half-vector:2KB,4KB",
            &["4KB of half-vector follows other settings"],
        ),
        ("half-vector:", &["empty setting"]),
        ("half-vector:2KB,", &["empty setting"]),
        (
            "cosine:tables=3",
            &["no setting of cosine is called tables", "name alone"],
        ),
        (
            "half-vectr",
            &[
                "no sampler is called \"half-vectr\"",
                "did you mean half-vector?",
            ],
        ),
        (
            "magic",
            &[
                "no sampler is called \"magic\"",
                "half-vector, adaptive-disc",
            ],
        ),
    ] {
        let message = refusal(text);
        for word in words {
            assert!(message.contains(word), "{text}: {message}");
        }
        assert!(!message.contains('\n'), "{message}");
    }
}

/// A value outside its domain is answered with the domain, when it is read and when it is built from.
#[test]
fn values_outside_their_domains_are_answered_with_the_domain() {
    for (text, domain) in [
        ("half-vector:tables=0", "1 to 1024"),
        ("half-vector:rows=80", "2 to 79"),
        ("half-vector:segments=257", "1 to 256"),
        ("half-vector:sides=both", "unfolded or folded"),
        ("half-vector:azimuths=1", "auto, or 2 to 256"),
        ("half-vector:tables=few", "1 to 1024"),
        ("half-vector:importance=max", "mean or luminance"),
        ("adaptive-disc:depth=40", "0 to 14"),
        ("adaptive-disc:n-max=1", "above 1"),
        ("adaptive-disc:n-max=inf", "above 1"),
        ("adaptive-disc:floor=NaN", "0 to 1"),
        ("adaptive-disc:waste=1", "0 to below 1"),
        ("adaptive-disc:grid=4", "none, or 8 to 4096"),
        (
            "adaptive-disc:leaves=all",
            "envelope, integral or rejection-free",
        ),
        ("cascade-cdf:cells=1024", "such as 1024x512"),
        ("cascade-cdf:cells=0x32", "each 1 to 8192"),
        ("cascade-cdf:tolerance=-1", "none, or 0 or more"),
        ("cascade-cdf:tolerance=nan", "none, or 0 or more"),
        ("lobe:ggx,parameters=1", "ALONG/ACROSS/DIFFUSE"),
        ("factored:factors=0x1/2x2/wi/0", "J and K 1 to 64"),
    ] {
        let message = refusal(text);
        assert!(
            message.contains("outside the domain") && message.contains(domain),
            "{text}: {message}"
        );
    }
    for (text, word) in [
        ("adaptive-disc:published,rejection-free", "grid=none"),
        ("cascade-cdf:tables=4096,cells=8192x8192", "4·10⁹"),
        ("lobe:ggx,parameters=3/3/0.5", "0.0001 to 2"),
        ("lobe:ggx,parameters=0.1/0.2/0.5", "same shape"),
        ("lobe:blinn,parameters=10/10/-0.1", "diffuse"),
    ] {
        let message = refusal(text);
        assert!(message.contains(word), "{text}: {message}");
    }
}

#[test]
fn old_names_are_answered_with_the_new_spelling() {
    for (old, new) in [
        ("ggx", "lobe:ggx"),
        ("blinn", "lobe:blinn"),
        ("ward", "lobe:ward"),
        ("ashikhmin-shirley", "lobe:ashikhmin-shirley"),
        ("cosine-lobe", "lobe:cosine"),
        ("cosine-lobe-sphere", "lobe:cosine-sphere"),
        ("disc-rejection", "adaptive-disc:rejection"),
    ] {
        let message = refusal(old);
        assert!(message.contains(new), "{message}");
        assert_eq!(parse(new).to_string(), new);
    }
}

#[test]
fn specs_survive_json_as_their_texts() {
    let mut all = SamplerSpec::methods();
    all.extend(CHANGED.map(parse));
    for spec in all {
        let json = serde_json::to_string(&spec).unwrap();
        assert_eq!(json, format!("\"{spec}\""));
        assert_eq!(serde_json::from_str::<SamplerSpec>(&json).unwrap(), spec);
    }
    assert!(serde_json::from_str::<SamplerSpec>("\"half-vector:rows=80\"").is_err());
}

#[test]
fn materials_are_refused_with_what_is_needed_and_what_there_is() {
    let facts = |symmetry, has_table, has_own_sampler| MaterialFacts {
        symmetry,
        has_table,
        has_own_sampler,
        has_mirror: false,
    };
    let table = facts(Symmetry::Isotropic, true, false);
    let formula = facts(Symmetry::Isotropic, false, false);
    let brushed = facts(Symmetry::Half, false, true);
    let names = |facts: &MaterialFacts| -> Vec<&str> {
        let methods = SamplerSpec::methods();
        let supported = methods.iter().filter(|m| m.check_supports(facts).is_ok());
        supported.map(SamplerSpec::name).collect()
    };
    let of_tables = names(&table);
    assert!(of_tables.contains(&"adaptive-disc") && !of_tables.contains(&"file"));
    let of_formulas = names(&formula);
    assert!(of_formulas.contains(&"cascade-cdf") && of_formulas.contains(&"adaptive-disc"));
    let of_files = names(&brushed);
    assert!(of_files.contains(&"file") && of_files.contains(&"cascade-cdf"));
    for names in [of_tables, of_formulas, of_files] {
        assert!(names.contains(&"half-vector") && names.contains(&"cosine"));
    }
    let refused = |text: &str, facts: &MaterialFacts| {
        parse(text).check_supports(facts).unwrap_err().to_string()
    };
    let message = refused("file", &formula);
    assert!(message.contains("a .bsdf file"), "{message}");
    assert!(
        message.contains("choose half-vector, adaptive-disc"),
        "{message}"
    );
    for text in ["adaptive-disc", "cascade-cdf", "factored"] {
        let azimuths = format!("{text}:azimuths=4");
        let message = refused(&azimuths, &formula);
        assert!(message.contains("leave the azimuths out"), "{message}");
        assert!(parse(&azimuths).check_supports(&brushed).is_ok());
    }
    let message = refused("half-vector:azimuths=4", &table);
    assert!(message.contains("leave the azimuths out"), "{message}");
    assert!(
        parse("half-vector:azimuths=4")
            .check_supports(&brushed)
            .is_ok()
    );
    assert_eq!(parse("file").needs(), Needs::OwnSampler);
}
