//! Plots as PNG and PDF, and lobes as solids.

use std::path::Path;
use std::process::Command;

use glam::{DVec3, Vec3};
use merlkit::{LookupRule, Material};

use crate::run::{fails, run, run_in, succeeds, without_origin};

/// Each kind, with options that keep it small.
const KINDS: [&str; 9] = [
    "lobe",
    "lobe-polar",
    "lobe-3d",
    "slice",
    "slice-rgb",
    "disc --sampler adaptive-disc:tables=3",
    "cdf --sampler cascade-cdf:tables=3",
    "cdf-azimuth --sampler cascade-cdf:tables=3",
    "albedo",
];

/// Writes a plot of teflon to `file`.
fn write(folder: &Path, options: &str, file: &str) -> Vec<u8> {
    let words: Vec<&str> = options.split(' ').collect();
    let arguments = [&["plot", "teflon", "--kind"], &words[..], &["-o", file]].concat();
    let printed = succeeds(run_in(folder, &arguments, ""));
    assert_eq!(printed, format!("wrote {file}\n"), "{options}");
    std::fs::read(folder.join(file)).unwrap()
}

/// Pixels of a PNG, three bytes each.
struct Pixels {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Pixels {
    fn decode(bytes: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Self {
            width: info.width as usize,
            height: info.height as usize,
            bytes,
        }
    }

    fn pixel(&self, (x, y): (f64, f64)) -> [u8; 3] {
        let first = 3 * (y as usize * self.width + x as usize);
        [0, 1, 2].map(|c| self.bytes[first + c])
    }
}

/// The points of the first curve of a style in an SVG.
fn curve(svg: &str, colour: &str) -> Vec<(f64, f64)> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let stroked = document
        .descendants()
        .find(|n| n.attribute("stroke") == Some(colour) && n.attribute("d").is_some());
    let data = stroked.unwrap().attribute("d").unwrap();
    let mut points = Vec::new();
    for point in data.split(['M', 'L']).filter(|p| !p.is_empty()) {
        let (x, y) = point.split_once(' ').unwrap();
        points.push((x.parse().unwrap(), y.parse().unwrap()));
    }
    points
}

#[test]
fn pngs_have_the_curve_where_the_svg_has_it() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["lobe", "lobe-polar"] {
        let svg = String::from_utf8(write(folder.path(), kind, &format!("{kind}.svg"))).unwrap();
        let png = write(folder.path(), kind, &format!("{kind}.png"));
        assert_eq!(
            png,
            write(folder.path(), kind, &format!("{kind}-again.png"))
        );
        let pixels = Pixels::decode(&png);
        assert_eq!(pixels.width, 1280);
        let points = curve(&svg, "#0072b2");
        assert!(points.len() > 300);
        let mut on_curve = 0;
        // A PNG has two pixels for each of the SVG's.
        for (x, y) in &points {
            let [r, g, b] = pixels.pixel((2.0 * x, 2.0 * y));
            on_curve += usize::from(r < 60 && g.abs_diff(0x72) < 50 && b.abs_diff(0xb2) < 50);
        }
        // Names of directions and dashed lines lie above the rest of it.
        assert!(
            on_curve * 10 > points.len() * 9,
            "{kind}: {on_curve} of {}",
            points.len()
        );
    }
}

#[test]
fn every_kind_is_written_as_png_and_pdf() {
    let folder = tempfile::tempdir().unwrap();
    for options in KINDS {
        let kind = options.split(' ').next().unwrap();
        let pixels = Pixels::decode(&write(folder.path(), options, &format!("{kind}.png")));
        // A slice is its pixels alone.
        let expected = if kind.starts_with("slice") { 360 } else { 1280 };
        assert_eq!(pixels.width, expected, "{kind}");
        let mut colours: Vec<&[u8]> = pixels.bytes.chunks_exact(3).collect();
        colours.sort_unstable();
        colours.dedup();
        assert!(colours.len() > 20, "{kind}: {} colours", colours.len());
        let name = format!("{kind}.pdf");
        check_pdf(&write(folder.path(), options, &name));
        draw_pdf(&folder.path().join(name));
    }
    let sized = write(folder.path(), "lobe --width 900 --height 500", "sized.png");
    let pixels = Pixels::decode(&sized);
    assert_eq!((pixels.width, pixels.height), (900, 500));
    let text = String::from_utf8_lossy(&write(
        folder.path(),
        "lobe --width 900 --height 500",
        "sized.pdf",
    ))
    .into_owned();
    // Points are three quarters of a pixel.
    assert!(text.contains("/MediaBox [0 0 675 375]"), "{text}");
}

/// Reads a PDF by its table of objects: each is where the table says, one is a page, and the fonts are named.
fn check_pdf(bytes: &[u8]) {
    // Compressed parts become letters without a meaning, one for each byte, so that positions stay.
    let text: String = bytes.iter().map(|&b| char::from(b.min(127))).collect();
    assert!(text.starts_with("%PDF-1.") && text.trim_end().ends_with("%%EOF"));
    let start = text
        .rsplit("startxref\n")
        .next()
        .unwrap()
        .lines()
        .next()
        .unwrap();
    let table = &text[start.parse::<usize>().unwrap()..];
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("xref"));
    let count: usize = lines
        .next()
        .unwrap()
        .split(' ')
        .nth(1)
        .unwrap()
        .parse()
        .unwrap();
    let mut objects = Vec::new();
    for number in 1..count {
        let line = lines.by_ref().nth(usize::from(number == 1)).unwrap();
        let offset: usize = line[..10].parse().unwrap();
        let object = &text[offset..];
        assert!(
            object.starts_with(&format!("{number} 0 obj\n")),
            "{number}: {line}"
        );
        objects.push(&object[..object.find("endobj").unwrap()]);
    }
    for object in &objects {
        if let Some((head, stream)) = object.split_once("stream\n") {
            let length = head.split("/Length ").nth(1).unwrap();
            let length: usize = length
                .split(['\n', ' ', '/'])
                .next()
                .unwrap()
                .parse()
                .unwrap();
            assert_eq!(stream[length..].trim(), "endstream", "{head}");
        }
    }
    let pages = objects.iter().filter(|o| o.contains("/Type /Page\n"));
    assert_eq!(pages.count(), 1);
    for font in ["Helvetica", "Symbol"] {
        assert!(text.contains(&format!("/BaseFont /{font}")), "{font}");
    }
}

/// Has poppler draw a PDF, where it is installed: it complains of nothing, and the page is not blank.
fn draw_pdf(path: &Path) {
    let drawn = Command::new("pdftoppm")
        .args(["-r", "72"])
        .arg(path)
        .output();
    let Ok(drawn) = drawn else { return };
    assert!(
        drawn.status.success() && drawn.stderr.is_empty(),
        "{drawn:?}"
    );
    let ink = drawn.stdout.iter().filter(|&&byte| byte < 128).count();
    assert!(ink > 1000, "{}: {ink}", path.display());
}

/// A row of the CSV of a solid: direction, value and radius.
struct Vertex {
    label: String,
    wi: DVec3,
    value: f64,
    radius: f64,
}

fn vertices(csv: &str) -> Vec<Vertex> {
    let mut vertices = Vec::new();
    for line in csv.lines().skip(1) {
        let fields: Vec<&str> = line.rsplitn(6, ',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        vertices.push(Vertex {
            label: fields[5].to_owned(),
            wi: DVec3::new(number(4), number(3), number(2)),
            value: number(1),
            radius: number(0),
        });
    }
    vertices
}

#[test]
fn vertices_of_a_solid_are_the_library_s_values_and_the_greatest_is_the_highlight() {
    let folder = tempfile::tempdir().unwrap();
    let csv = |options: &str| {
        let options = format!("{options} --force");
        let words = options.split(' ');
        let arguments: Vec<&str> = ["plot"]
            .into_iter()
            .chain(words)
            .chain(["-o", "a.csv"])
            .collect();
        succeeds(run_in(folder.path(), &arguments, ""));
        vertices(&std::fs::read_to_string(folder.path().join("a.csv")).unwrap())
    };
    let (theta, metal) = (40f64, "ggx:ax=0.01,ay=0.01");
    let wo = Vec3::new(
        -theta.to_radians().sin() as f32,
        0.0,
        theta.to_radians().cos() as f32,
    );
    let mirror = DVec3::new(theta.to_radians().sin(), 0.0, theta.to_radians().cos());
    for scale in ["linear", "log", "root"] {
        let shown = csv(&format!(
            "nickel {metal} --kind lobe-3d --theta 40 --scale {scale}"
        ));
        assert!(shown.len() > 10_000, "{}", shown.len());
        let greatest = shown.iter().map(|v| v.value).fold(0.0, f64::max);
        for (name, own) in [("nickel", "nickel"), (metal, "ggx")] {
            let brdf = Material::resolve(name)
                .unwrap()
                .load(LookupRule::Floor)
                .unwrap();
            let own: Vec<&Vertex> = shown.iter().filter(|v| v.label.contains(own)).collect();
            for v in &own {
                assert!((v.wi.length() - 1.0).abs() < 1e-6 && v.wi.z > 0.0);
                let value = merlkit::color::mean(brdf.brdf().eval_cos(wo, v.wi.as_vec3()));
                assert!(
                    (v.value - f64::from(value)).abs() <= 1e-6 * v.value,
                    "{name}"
                );
                let fraction = v.value / greatest;
                let radius = match scale {
                    "linear" => fraction,
                    "root" => fraction.sqrt(),
                    // Four decades at most.
                    _ => (1.0 + fraction.max(1e-4).log10() / 4.0).max(0.0),
                };
                assert!(
                    (v.radius - radius).abs() < 1e-6,
                    "{scale}: {} {radius}",
                    v.radius
                );
            }
            let top = own
                .iter()
                .max_by(|a, b| a.value.total_cmp(&b.value))
                .unwrap();
            let turned = top.wi.angle_between(mirror).to_degrees();
            assert!(turned < 0.5, "{name}: {turned}°");
        }
    }
    // A value without the cosine is that of f alone, and a channel its own.
    let f = csv("lambert:reflectance=0.2/0.4/0.6 --kind lobe-3d --value f --channel g");
    let expected = 0.4 / std::f64::consts::PI;
    assert!(f.iter().all(|v| (v.value - expected).abs() < 1e-6));
}

#[test]
fn solids_are_seen_from_where_it_is_said_and_stay_small() {
    let picture = |options: &str| {
        let words: Vec<&str> = options.split(' ').collect();
        let svg = succeeds(run(
            &[&["plot"], &words[..], &["--kind", "lobe-3d", "-o", "-"]].concat(),
            "",
        ));
        roxmltree::Document::parse(&svg).unwrap();
        assert!(svg.len() < 2_000_000, "{options}: {} bytes", svg.len());
        without_origin(&svg)
    };
    let usual = picture("nickel");
    let named = picture("nickel --theta 30 --elevation 25 --azimuth 20");
    assert!(usual == named, "these are the defaults");
    for name in [">wo<", ">mirror<", ">n<", ">nickel: lobe at θ = 30°<"] {
        assert!(usual.contains(name), "{name}");
    }
    for other in [
        "--elevation 60",
        "--azimuth -40",
        "--scale root",
        "--channel b",
    ] {
        assert_ne!(usual, picture(&format!("nickel {other}")), "{other}");
    }
    assert!(picture("nickel --theta 0").contains(">n = wo = mirror<"));
    let six = picture("nickel teflon --theta 10,45,80");
    assert!(six.contains(">teflon, θ = 80°<"));
    let together = picture("nickel teflon --together");
    assert!(together.contains("opacity=\"0.6\"") && together.contains(">teflon<"));
    for (options, expected) in [
        ("--elevation 91", "0 to 90"),
        ("--azimuth inf", "-360 to 360"),
        ("--together", "--together has no effect"),
        ("chrome --theta 1,2,3,4", "at most 6"),
        ("chrome teflon red-plastic --together", "at most 3"),
        ("--sampler cosine", "--sampler has no effect"),
    ] {
        let words: Vec<&str> = options.split(' ').collect();
        let arguments = [&["plot", "nickel", "--kind", "lobe-3d"], &words[..]].concat();
        let complaint = fails(run(&arguments, ""));
        assert!(complaint.contains(expected), "{options}: {complaint}");
    }
}
