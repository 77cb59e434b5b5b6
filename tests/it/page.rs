//! The page of a comparison: well-formed whatever it holds. [`crate::browser`] looks at it in a browser.

use merlkit::distribution::Heuristic;
use merlkit::image::encode_png;
use merlkit::material::merl::LookupRule;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, CosineSettings, FactoredSettings, HalfVectorSettings,
    SamplerSpec,
};
use merlkit_evaluate::measure::compare::{
    Comparison, ComparisonPlan, Competitor, CountedCost, Curve, ErrorPoint, Knob, MaterialCharts,
    MaterialComparison, PICTURE_SAMPLES, PictureComparison, PicturePlan, PictureReference,
    PictureResult, PointPlan, Reference, SCHEMA, SceneKind, Setting, SettingsComparison, verdict,
};
use merlkit_evaluate::measure::convergence::Technique;
use merlkit_evaluate::measure::cost::{CallCost, Seconds};
use merlkit_evaluate::measure::difference::PictureErrors;
use merlkit_evaluate::plot::{ChartSize, Disc, Polar};
use merlkit_evaluate::report::{
    ComparisonDocument, Machine, Provenance, beside_thesis, write_json,
};

const HALF_VECTOR: fn() -> SamplerSpec = || SamplerSpec::new(HalfVectorSettings::default());

fn cost(ns: f64) -> CallCost {
    CallCost {
        ns,
        low: 0.98 * ns,
        high: 1.03 * ns,
        spread: 0.02,
    }
}

/// Error `scale`/√N under random numbers, half of it under Sobol points; samples take `ns`, counted and measured.
fn curve(competitor: Competitor, label: &str, ns: f64, scale: f64) -> Curve {
    let errors = |scale: f64| {
        let at = |samples: usize| {
            let rmse = scale / (samples as f64).sqrt();
            ErrorPoint {
                samples,
                rmse,
                low: rmse * 0.9,
                high: rmse * 1.1,
            }
        };
        [1, 4, 16, 64, 256, 1024].map(at).to_vec()
    };
    Curve {
        competitor,
        label: label.into(),
        table_bytes: 4096,
        build_seconds: 0.05,
        counted: CountedCost {
            sample_ns: ns,
            build_seconds: 0.05,
        },
        ns_per_sample: cost(ns),
        random: errors(scale),
        sobol: errors(scale * 0.5),
        random_slope: -0.5,
        sobol_slope: -0.5,
    }
}

/// All kinds of samplers; the half-vector table's samples take `ns`.
fn material(name: &str, ns: f64) -> MaterialComparison {
    let light = Competitor {
        spec: HALF_VECTOR(),
        technique: Technique::Mis(Heuristic::Power),
    };
    let curves = vec![
        curve(
            Competitor::brdf(SamplerSpec::new(CosineSettings {})),
            "cosine",
            100.0,
            3.0,
        ),
        curve(Competitor::brdf(HALF_VECTOR()), "half-vector 64KB", ns, 1.0),
        curve(
            Competitor::brdf(SamplerSpec::new(CascadeCdfSettings::default())),
            "cascade",
            200.0,
            1.1,
        ),
        curve(
            Competitor::brdf(SamplerSpec::new(AdaptiveDiscSettings::default())),
            "disc",
            300.0,
            1.1,
        ),
        curve(light, "MIS (power) of light and half-vector", 200.0, 0.5),
    ];
    let references = vec![Reference {
        theta_o_deg: 45.0,
        radiance: 0.5,
        error: 1e-5,
    }];
    let verdict = verdict(name, &curves);
    MaterialComparison {
        material: name.into(),
        references,
        curves,
        verdict,
        notes: Vec::new(),
    }
}

fn picture(scene: SceneKind, material: &str) -> PictureComparison {
    let png = |grey: u8| encode_png(2, 2, &[grey; 12]).unwrap();
    let result = |(spec, error): (SamplerSpec, f64), samples: u64| PictureResult {
        label: spec.to_string(),
        competitor: Competitor::brdf(spec),
        samples,
        seconds: Seconds {
            wall: 0.5,
            cpu: 1.0,
        },
        build_seconds: 0.1,
        errors: PictureErrors {
            mean_relative: error / (samples as f64).sqrt(),
            rel_mse: 0.01,
        },
        flip: Some(0.0512),
        png: if samples == PICTURE_SAMPLES {
            png(100)
        } else {
            Vec::new()
        },
        difference: if samples == PICTURE_SAMPLES {
            png(200)
        } else {
            Vec::new()
        },
    };
    let specs = [
        (SamplerSpec::new(CosineSettings {}), 3.0),
        (HALF_VECTOR(), 0.5),
        (SamplerSpec::new(AdaptiveDiscSettings::default()), 0.75),
        (SamplerSpec::new(FactoredSettings::default()), 1.0),
    ];
    let results = [PICTURE_SAMPLES, 100]
        .iter()
        .flat_map(|&n| specs.clone().map(|s| result(s, n)))
        .collect();
    let reference = PictureReference {
        label: "many".into(),
        samples: 1000,
        relative_error: 0.01,
        png: png(90),
    };
    PictureComparison {
        scene,
        material: material.into(),
        reference,
        results,
    }
}

fn settings(material: &str) -> SettingsComparison {
    let setting = |tables: usize| {
        let spec = SamplerSpec::new(CascadeCdfSettings {
            tolerance: None,
            tables,
            ..Default::default()
        });
        Setting {
            knob: Knob {
                name: "tables".into(),
                value: tables.to_string(),
                spec,
                lookup: LookupRule::default(),
            },
            table_bytes: tables * 1000,
            build_seconds: 0.1,
            sample_ns: cost(50.0),
            relstd: 0.3 / tables as f64,
            rmse: 0.1 / tables as f64,
        }
    };
    SettingsComparison {
        material: material.into(),
        settings: [8, 16].map(setting).to_vec(),
    }
}

fn empty() -> Comparison {
    let plan = ComparisonPlan {
        schema: SCHEMA,
        quick: true,
        samplers: Vec::new(),
        lookup: LookupRule::default(),
        sky: "lamps".into(),
        point: PointPlan::quick(1),
        picture: PicturePlan::quick(1),
    };
    Comparison {
        plan,
        threads: 2,
        materials: Vec::new(),
        pictures: Vec::new(),
        settings: Vec::new(),
        charts: Vec::new(),
    }
}

/// As wide as the charts of a page.
const NARROW: ChartSize = ChartSize {
    width: 360.0,
    height: None,
};

/// Everything a comparison can hold; the half-vector table is the quickest on nickel, cosine on teflon.
pub fn full() -> Comparison {
    let charts = |name: &str| MaterialCharts {
        material: name.into(),
        theta_o_deg: 45.0,
        lobe: Polar::default().svg_sized(NARROW),
        densities: vec![Polar::default().svg_sized(NARROW)],
        discs: vec![Disc::default().svg_sized(NARROW)],
    };
    Comparison {
        materials: vec![material("nickel", 100.0), material("teflon", 5000.0)],
        pictures: [SceneKind::Environment, SceneKind::Glossy]
            .map(|s| picture(s, "nickel"))
            .to_vec(),
        settings: vec![settings("nickel")],
        charts: vec![charts("nickel"), charts("teflon")],
        ..empty()
    }
}

/// A command line, a day and a machine.
fn provenance() -> Provenance {
    Provenance {
        version: "1.2.3".into(),
        command: "merlkit compare nickel teflon --quick".into(),
        seed: Some(1),
        materials: Vec::new(),
        date: Some("2026-11-30".into()),
        machine: Some(Machine {
            processor: "Some Processor 9".into(),
            cores: 2,
            system: "x86_64 linux".into(),
        }),
    }
}

pub fn comparison_page(comparison: &Comparison) -> String {
    merlkit_evaluate::report::comparison_page(comparison, &provenance())
}

/// Parses the page and holds what every one must.
fn check(page: &str) {
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    let document = roxmltree::Document::parse_with_options(page, options).unwrap();
    let root = document.root_element();
    assert_eq!(
        (root.tag_name().name(), root.attribute("lang")),
        ("html", Some("en"))
    );
    assert!(
        !page
            .replace("xmlns=\"http://www.w3.org/2000/svg\"", "")
            .contains("http")
    );
    assert!(!page.contains("NaN") && !page.contains("inf%"));
    let count = |name: &str| {
        root.descendants()
            .filter(|n| n.tag_name().name() == name)
            .count()
    };
    assert_eq!(
        (count("script"), count("h1"), count("link"), count("iframe")),
        (0, 1, 0, 0)
    );
    assert_eq!(count("table"), count("caption"));
    let ids: Vec<_> = root
        .descendants()
        .filter_map(|n| n.attribute("id"))
        .collect();
    for node in root.descendants().filter(|n| n.is_element()) {
        let (name, attribute) = (node.tag_name().name(), |a| node.attribute(a));
        assert!(
            node.attributes().all(|a| !a.name().starts_with("on")),
            "{name}"
        );
        match name {
            "img" => {
                assert!(!attribute("alt").unwrap().is_empty());
                assert!(
                    attribute("src")
                        .unwrap()
                        .starts_with("data:image/png;base64,")
                );
            }
            "th" => assert!(
                ["row", "col", "rowgroup", "colgroup"].contains(&attribute("scope").unwrap())
            ),
            "a" => assert!(ids.contains(&attribute("href").unwrap().trim_start_matches('#'))),
            "svg" => assert!(attribute("role") == Some("img") || attribute("viewBox").is_some()),
            _ => {}
        }
    }
}

#[test]
fn a_page_holds_everything_and_every_verdict() {
    let comparison = full();
    let page = comparison_page(&comparison);
    check(&page);
    for material in &comparison.materials {
        assert!(page.contains(&material.verdict.as_ref().unwrap().sentence));
    }
    for part in [
        "verdicts",
        "needs",
        "point",
        "settings",
        "pictures",
        "shapes",
        "thesis",
        "definitions",
    ] {
        assert!(page.contains(&format!("<section id=\"{part}\">")), "{part}");
    }
    // The reference, and by scene four pictures with their differences.
    assert_eq!(page.matches("<img ").count(), 2 * (1 + 4 * 2));
}

#[test]
fn a_page_can_be_cited_and_repeated() {
    let page = comparison_page(&full());
    for words in [
        "merlkit compare nickel teflon --quick",
        "1.2.3",
        "2026-11-30",
        "Some Processor 9, 2 cores, x86_64 linux",
        "FLIP 0.051",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

/// In each column of times one cell of each group is the best, and it is the choice of the verdict in that to 1 %.
#[test]
fn the_winners_cell_is_marked() {
    let page = comparison_page(&full());
    let table = page.split("nickel: samples and counted time").nth(2);
    let table = table.unwrap().split("</table>").next().unwrap();
    // Four errors, and two groups.
    assert_eq!(table.matches("class=\"best\"").count(), 8, "{table}");
    let row = table.split("half-vector 64KB").nth(1).unwrap();
    let row = row.split("</tr>").next().unwrap();
    assert_eq!(row.matches("class=\"best\"").count(), 4, "{row}");
    assert!(
        !table.contains(" min<") && !table.contains(" h<"),
        "{table}"
    );
}

#[test]
fn an_empty_comparison_is_a_page() {
    let page = comparison_page(&empty());
    check(&page);
    assert!(page.contains("Nothing was measured") && page.contains("Definitions"));
    let mut hollow = empty();
    hollow.materials.push(MaterialComparison {
        material: "none".into(),
        references: Vec::new(),
        curves: Vec::new(),
        verdict: None,
        notes: Vec::new(),
    });
    let page = comparison_page(&hollow);
    check(&page);
    assert!(page.contains("none: no sampler"));
}

#[test]
fn names_cannot_break_the_markup() {
    let name = "a<b> & \"c\"</p><script>'";
    let mut comparison = full();
    comparison.plan.sky = name.into();
    comparison.materials.push(material(name, 100.0));
    comparison.materials[0].curves[0].label = name.into();
    comparison.pictures.push(picture(SceneKind::Three, name));
    comparison.settings.push(settings(name));
    comparison.charts[0].material = name.into();
    let page = comparison_page(&comparison);
    check(&page);
    assert!(!page.contains(name) && page.contains("a&lt;b&gt; &amp; &quot;c&quot;"));
}

#[test]
fn a_half_vector_table_that_loses_is_named() {
    let loses = |name: &str| format!("On {name}, the half-vector table is not the fastest");
    let page = comparison_page(&full());
    assert!(
        page.contains(&loses("teflon")) && !page.contains(&loses("nickel")),
        "{:.3000}",
        page
    );
}

#[test]
fn numbers_that_are_not_are_no_obstacle() {
    let mut comparison = full();
    let curve = &mut comparison.materials[0].curves[1];
    (curve.ns_per_sample.ns, curve.build_seconds) = (f64::INFINITY, f64::NAN);
    curve.counted.sample_ns = f64::INFINITY;
    curve.sobol[3].rmse = f64::NAN;
    curve.random.clear();
    comparison.settings[0].settings[0].rmse = 0.0;
    comparison.pictures[0].results.clear();
    let page = comparison_page(&comparison);
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    roxmltree::Document::parse_with_options(&page, options).unwrap();
}

#[test]
fn the_thesis_stands_beside_ours_as_ratios() {
    let comparison = full();
    let tables = beside_thesis(&comparison);
    let of = |number: &str| {
        &tables
            .iter()
            .find(|t| t.title.contains(number))
            .unwrap_or_else(|| panic!("{number}"))
            .sheet
    };
    // Nickel's adaptive disc: 846.15 KB and 71.36 s for 60 trees against 4096 bytes and 0.05 s for 20.
    let row = of("6.23")
        .rows
        .iter()
        .find(|r| r[1] == "adaptive disc")
        .unwrap();
    assert_eq!(
        (row[0].as_str(), row[5].as_str(), row[7].as_str()),
        ("nickel", "14.10", "70.51")
    );
    assert_eq!(row[10], "476");
    // 1023.62 KB for 512 tables against 4 KB for 16.
    assert_eq!(of("5.10").rows[0][7], "8.00");
    // The thesis's means end the table.
    let last = &of("6.23").rows[of("6.23").rows.len() - 1];
    assert_eq!(
        (last[0].as_str(), last[3].as_str(), last[5].as_str()),
        ("the thesis's mean of 11", "445", "7.42")
    );
    // Drawing alone is not measured at a lit point.
    assert!(tables.iter().all(|t| !t.title.contains("6.24")));
    assert!(!of("5.9").rows.is_empty());
    // At 25 samples: 50.27, 51.42, 52.17, 64.41 and 101.85 %; ours half-vector, disc, factored, cosine.
    let ranking = of("6.14");
    let last = ranking.heading.len() - 1;
    assert!(
        ranking.rows[0][last]
            .starts_with("adaptive disc < lobe on the hemisphere < lobe on the sphere")
    );
    assert_eq!(
        ranking.rows[1][last],
        "half-vector < adaptive disc < factored < cosine"
    );
    assert_eq!(ranking.rows[1][2], "6.00 (60.0 %)");
    // 25 and 100 samples, the thesis and nickel.
    assert_eq!((ranking.rows.len(), of("6.22").rows.len()), (4, 4));
    assert!(beside_thesis(&empty()).is_empty());
    let mut strange = empty();
    strange.materials.push(material("mine", 100.0));
    assert!(beside_thesis(&strange).is_empty());
}

#[test]
fn the_document_is_the_comparison_and_the_thesis() {
    let comparison = full();
    let mut json = Vec::new();
    write_json(
        &mut json,
        "compare",
        &provenance(),
        &ComparisonDocument::new(&comparison),
    )
    .unwrap();
    let document: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let results = &document["results"];
    assert_eq!(
        results["thesis"].as_array().unwrap().len(),
        beside_thesis(&comparison).len()
    );
    let again: Comparison = serde_json::from_value(results.clone()).unwrap();
    // JSON may move the last digit of a number.
    assert!(comparison_page(&again) == comparison_page(&comparison));
}
