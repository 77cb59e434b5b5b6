//! `plot`.

use crate::run::{fails, run, run_in, succeeds, without_origin};

const KINDS: [&str; 9] = [
    "lobe",
    "lobe-polar",
    "lobe-3d",
    "slice",
    "slice-rgb",
    "disc",
    "cdf",
    "cdf-azimuth",
    "albedo",
];

/// Standard output, parsed, without what it says of the command.
fn picture(arguments: &[&str]) -> String {
    let svg = succeeds(run(&[&["plot"], arguments, &["-o", "-"]].concat(), ""));
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(document.root_element().attribute("role"), Some("img"));
    without_origin(&svg)
}

#[test]
fn a_picture_says_where_it_comes_from() {
    let folder = tempfile::tempdir().unwrap();
    let plot = ["plot", "lambert", "--kind", "lobe", "-o", "a.svg"];
    succeeds(run_in(folder.path(), &plot, ""));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let metadata = document
        .descendants()
        .find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "metadata")));
    let said = metadata.unwrap().text().unwrap();
    assert!(
        said.contains("command: merlkit plot lambert --kind lobe;"),
        "{said}"
    );
    assert!(said.contains("SHA-256 "), "{said}");
    let plot = ["plot", "nickel", "--kind", "slice", "-o", "a.png"];
    succeeds(run_in(folder.path(), &plot, ""));
    let said = succeeds(run_in(folder.path(), &["info", "a.png"], ""));
    assert!(said.contains("merlkit plot nickel --kind slice"), "{said}");
}

#[test]
fn every_kind_is_a_picture_and_the_same_each_time() {
    for kind in KINDS {
        // Few tables: these pictures show one.
        let tables: &[&str] = match kind {
            "disc" => &["--sampler", "adaptive-disc:tables=3"],
            "cdf" | "cdf-azimuth" => &["--sampler", "cascade-cdf:tables=3"],
            _ => &[],
        };
        let arguments = [&["teflon", "--kind", kind], tables].concat();
        let svg = picture(&arguments);
        assert!(
            svg.contains("<title>teflon: ") && !svg.contains("no data"),
            "{kind}: {}",
            &svg[..400]
        );
        // The others have nothing that threads share.
        if ["disc", "cdf", "cdf-azimuth", "albedo"].contains(&kind) {
            assert_eq!(
                svg,
                picture(&[&arguments[..], &["--threads", "1"]].concat()),
                "{kind}"
            );
        }
    }
}

#[test]
fn options_change_what_is_drawn() {
    let lobe = ["nickel", "--kind", "lobe"];
    let with = |more: &[&str]| picture(&[&lobe, more].concat());
    assert_eq!(with(&[]), with(&["--theta", "30", "--lookup", "floor"]));
    for more in [
        ["--theta", "60"],
        ["--lookup", "centred"],
        ["--sampler", "half-vector"],
    ] {
        assert_ne!(with(&[]), with(&more), "{more:?}");
    }
    assert_ne!(
        with(&["--sampler", "half-vector"]),
        with(&["--sampler", "half-vector:2KB"])
    );
    let several = with(&["--theta", "0,30", "--theta", "60"]);
    assert!(
        ["θ = 0°", "θ = 30°", "θ = 60°"]
            .iter()
            .all(|l| several.contains(&format!(">{l}<"))),
        "{several}"
    );
    let disc = [
        "nickel",
        "--kind",
        "disc",
        "--sampler",
        "adaptive-disc:tables=3",
    ];
    let seeded = picture(&[&disc[..], &["--samples", "40", "--seed", "3"]].concat());
    assert!(seeded.contains("40 directions drawn"), "{seeded}");
    assert_ne!(
        seeded,
        picture(&[&disc[..], &["--samples", "40", "--seed", "4"]].concat())
    );
    let cosine = picture(&[
        "nickel",
        "--kind",
        "disc",
        "--sampler",
        "cosine",
        "--samples",
        "0",
    ]);
    assert!(cosine.contains("no data"), "{cosine}");
}

#[test]
fn files_have_a_default_name_and_are_replaced_with_force_only() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["plot", "teflon", "--kind", "slice"];
    let wrote = "wrote teflon-slice.svg\n";
    assert_eq!(succeeds(run_in(folder.path(), &arguments, "")), wrote);
    let path = folder.path().join("teflon-slice.svg");
    let svg = std::fs::read_to_string(&path).unwrap();
    assert_eq!(without_origin(&svg), picture(&arguments[1..]));
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("teflon-slice.svg"));
    std::fs::write(&path, "old").unwrap();
    let forced = [&arguments[..], &["--force"]].concat();
    assert_eq!(succeeds(run_in(folder.path(), &forced, "")), wrote);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), svg);
}

#[test]
fn mistakes_are_refused_with_what_to_do() {
    for (arguments, expected) in [
        (&["--kind", "lobe", "--theta", "90"][..], "0 to below 90"),
        (&["--kind", "lobe", "--theta", "nan"], "0 to below 90"),
        (&["--kind", "lobe", "--theta=-3"], "0 to below 90"),
        (
            &["--kind", "lobe", "--theta", "1,2,3,4,5,6,7,8"],
            "at most 7",
        ),
        (
            &["nickel", "--kind", "lobe", "--theta", "1,2,3,4,5,6"],
            "at most 5 with several materials",
        ),
        (&["nickel", "--kind", "slice"], "choose one"),
        (&["teflon", "--kind", "lobe"], "named twice"),
        (
            &["--kind", "cdf", "--sampler", "cosine", "--sampler", "disc"],
            "disc",
        ),
        (
            &["--kind", "lobe-polar", "--scale", "log"],
            "--scale linear or root",
        ),
        (
            &["--kind", "lobe", "--sampler", "cosine", "--value", "f"],
            "--value has no effect on --kind lobe with --sampler",
        ),
        (
            &["--kind", "slice", "--exposure", "1"],
            "--exposure has no effect",
        ),
        (
            &["--kind", "slice-rgb", "--exposure", "nan"],
            "a number of stops",
        ),
        (&["--kind", "lobe", "--phi-d", "1"], "--phi-d has no effect"),
        (
            &["--kind", "lobe", "-o", "a.csv", "--width", "400"],
            "--width has no effect on a CSV file",
        ),
        (&["--kind", "lobe", "-o", "a.exr"], "slice-rgb alone"),
        (&["--kind", "disc", "--theta", "1,2"], "at most 1"),
        (
            &["--kind", "slice", "--theta", "3"],
            "--theta has no effect",
        ),
        (
            &["--kind", "albedo", "--lookup", "floor"],
            "--lookup has no effect",
        ),
        (
            &["--kind", "cdf", "--sampler", "half-vector"],
            "choose cascade-cdf",
        ),
        (
            &["--kind", "lobe", "--samples", "9"],
            "--samples has no effect",
        ),
        (
            &["--kind", "albedo", "--sampler", "cosine"],
            "--sampler has no effect",
        ),
        (
            &["--kind", "lobe", "-o", "lobe.jpg"],
            "SVG, PDF, PNG or CSV",
        ),
        (&["--kind", "round"], "slice-rgb"),
        (&[], "--kind"),
    ] {
        let text = fails(run(&[&["plot", "teflon"], arguments].concat(), ""));
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    assert!(fails(run(&["plot", "nikel", "--kind", "lobe"], "")).contains("nickel"));
}

#[test]
fn materials_samplers_and_angles_share_a_picture_with_a_legend() {
    let lobes = ["nickel", "chrome", "--kind", "lobe"];
    let svg = picture(&lobes);
    for label in [">nickel<", ">chrome<"] {
        assert!(svg.contains(label), "{label}: {svg}");
    }
    let angles = picture(&[&lobes[..], &["--theta", "10,60"]].concat());
    assert!(angles.contains(">chrome, θ = 60°<"), "{angles}");
    // Marks tell apart what has the same dash.
    let marked = |svg: &str| svg.contains("stroke-width=\"0.8\"");
    assert!(marked(&angles) && !marked(&svg));
    let two = ["--sampler", "half-vector:2KB", "--sampler", "half-vector"];
    let samplers = picture(&[&lobes[..], &two].concat());
    for label in [
        ">nickel, ideal<",
        ">nickel, half-vector:2KB<",
        ">chrome, half-vector:64KB<",
    ] {
        assert!(samplers.contains(label), "{label}: {samplers}");
    }
    let albedos = picture(&["nickel", "chrome", "--kind", "albedo", "--scale", "log"]);
    assert!(albedos.contains(">chrome<") && !albedos.contains("no data"));
}

/// A row of a CSV file: its text, and its last two numbers.
fn rows(csv: &str) -> Vec<(String, [f64; 2])> {
    let mut rows = Vec::new();
    for line in csv.lines().skip(1) {
        let mut fields = line.rsplitn(3, ',');
        let [y, x] = [fields.next(), fields.next()].map(|f| f.unwrap().parse().unwrap());
        rows.push((fields.next().unwrap().to_owned(), [x, y]));
    }
    rows
}

#[test]
fn csv_has_the_numbers_of_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let csv = |options: &[&str]| {
        let arguments = [
            &["plot", "lambert:reflectance=0.5", "--kind", "lobe"][..],
            options,
            &["-o", "a.csv", "--force"],
        ];
        succeeds(run_in(folder.path(), &arguments.concat(), ""));
        std::fs::read_to_string(folder.path().join("a.csv")).unwrap()
    };
    let with_cosine = rows(&csv(&[]));
    assert!(with_cosine.len() > 300);
    let f = 0.5 / std::f64::consts::PI;
    for (label, [angle, value]) in &with_cosine {
        assert_eq!(label, "θ = 30°");
        let expected = f * angle.to_radians().cos();
        assert!((value - expected).abs() < 1e-6, "{angle}: {value}");
    }
    for (_, [angle, value]) in rows(&csv(&["--value", "f", "--channel", "g"])) {
        assert!((value - f).abs() < 1e-6, "{angle}: {value}");
    }
    let both = [
        "plot", "teflon", "--kind", "lobe", "--csv", "b.csv", "-o", "b.svg",
    ];
    let wrote = succeeds(run_in(folder.path(), &both, ""));
    assert_eq!(wrote, "wrote b.svg\nwrote b.csv\n");
    // On standard output the numbers are alone.
    let arguments = [
        "plot", "teflon", "--kind", "lobe", "--csv", "-", "-o", "c.svg",
    ];
    let printed = succeeds(run_in(folder.path(), &arguments, ""));
    let written = std::fs::read_to_string(folder.path().join("b.csv")).unwrap();
    assert_eq!(printed, written);
    let arguments = ["plot", "teflon", "--kind", "lobe", "--csv", "-", "-o", "-"];
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("name a file"));
    assert!(fails(run_in(folder.path(), &both, "")).contains("b.svg"));
}

#[test]
fn pictures_have_the_size_asked_for() {
    for kind in ["lobe", "lobe-polar", "slice"] {
        let svg = picture(&[
            "teflon", "--kind", kind, "--width", "900", "--height", "350",
        ]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let root = document.root_element();
        let side = |name| root.attribute(name).unwrap().parse::<f64>().unwrap();
        assert_eq!([side("width"), side("height")], [900.0, 350.0], "{kind}");
    }
}

/// The mean over the pixels of a PNG of the right size.
fn brightness(path: &std::path::Path) -> f32 {
    let image = merlkit::image::read_image(path).unwrap();
    assert_eq!((image.width(), image.height()), (360, 360));
    let sum: f32 = image.pixels().iter().map(|p| p.element_sum()).sum();
    sum / image.pixels().len() as f32
}

#[test]
fn slices_are_written_as_pixels_with_an_exposure() {
    let folder = tempfile::tempdir().unwrap();
    let mut means = Vec::new();
    for exposure in ["-3", "0", "3"] {
        let arguments = [
            "plot",
            "nickel",
            "--kind",
            "slice-rgb",
            "--exposure",
            exposure,
            "-o",
            "a.png",
            "--force",
        ];
        succeeds(run_in(folder.path(), &arguments, ""));
        means.push(brightness(&folder.path().join("a.png")));
    }
    assert!(means.windows(2).all(|m| m[0] < m[1]), "{means:?}");
    let exr = ["plot", "nickel", "--kind", "slice-rgb", "-o", "a.exr"];
    succeeds(run_in(folder.path(), &exr, ""));
    let image = merlkit::image::read_exr(&folder.path().join("a.exr")).unwrap();
    assert_eq!((image.width(), image.height()), (90, 90));
    let straight = picture(&["nickel", "--kind", "slice"]);
    assert_ne!(
        straight,
        picture(&["nickel", "--kind", "slice", "--phi-d", "0"])
    );
}
