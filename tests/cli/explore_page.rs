//! The page of `merlkit explore` in a browser: every panel is drawn, and what is read back from the canvases is what the library says.
//!
//! The tests skip, saying so, where there is no Chromium, or no `playwright-core` on `NODE_PATH`. `SCREENSHOTS` names a folder that keeps the
//! pictures.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use merlkit_evaluate::plot::viridis;
use serde_json::Value;

use crate::browsers::{choose_picture_folder, find_driven_chromium};
use crate::run::{run_in, succeeds};

const EXPLORE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../tests/browser/explore.js"
);

/// A server that ends with the test.
pub(crate) struct Server {
    child: Child,
    pub(crate) address: String,
}

impl Server {
    pub(crate) fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(cargo_bin!("merlkit"))
            .args(["explore", "--no-open"])
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut address = String::new();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        lines.read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        assert!(address.starts_with("http://127.0.0.1:"), "{address}");
        Self { child, address }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// What the script found at an address.
fn look(chromium: &Path, address: &str, folder: &Path) -> Value {
    run_script(EXPLORE, chromium, address, folder)
}

/// What a script found at an address.
pub(crate) fn run_script(script: &str, chromium: &Path, address: &str, folder: &Path) -> Value {
    let output = Command::new("node")
        .arg(script)
        .arg(chromium)
        .arg(address)
        .arg(folder)
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["faults"], serde_json::json!([]));
    found
}

/// 8-bit RGB of a PNG.
pub(crate) fn colours(path: &Path) -> Vec<[u8; 3]> {
    let mut decoder = png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap()));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let channels = reader.next_frame(&mut bytes).unwrap().color_type.samples();
    let pixels = bytes.chunks_exact(channels);
    pixels.map(|p| [p[0], p[1], p[2]]).collect()
}

/// How far two pictures are from one another.
pub(crate) struct Difference {
    /// Pixels that differ by more than 2 of 255.
    off: usize,
    /// Pixels that are not black in the second one.
    lit: usize,
    /// The sum of the differences over that of the second picture's values.
    relative: f64,
}

impl Difference {
    pub(crate) fn measure(seen: &Path, rendered: &Path) -> Self {
        let (seen, rendered) = (colours(seen), colours(rendered));
        assert_eq!(seen.len(), rendered.len());
        let (mut off, mut sum, mut total) = (0, 0.0, 0.0);
        for (a, b) in seen.iter().zip(&rendered) {
            let distance = (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
            off += usize::from(distance > 2);
            sum += f64::from(distance);
            total += f64::from(*b.iter().max().unwrap());
        }
        let lit = rendered.iter().filter(|p| **p != [0; 3]).count();
        assert!(lit > 5000, "{lit} pixels are lit");
        Self {
            off,
            lit,
            relative: sum / total,
        }
    }

    /// Asserts that at most this part of the lit pixels is off, and at most this part of the brightness.
    pub(crate) fn assert_within(&self, pixels: f64, brightness: f64) {
        let part = self.off as f64 / self.lit as f64;
        assert!(
            part <= pixels && self.relative <= brightness,
            "{part:.4} of the pixels differ, and {:.4} of the brightness",
            self.relative
        );
    }
}

/// The sphere's pixels against those of the command that the page names.
fn compare_sphere(folder: &Path, command: &str, size: u64) {
    let arguments = command.replace("512x512", &format!("{size}x{size} --spp 16"));
    let arguments: Vec<&str> = arguments.split_whitespace().skip(1).collect();
    succeeds(run_in(
        folder,
        &[&arguments[..arguments.len() - 1], &["rendered"]].concat(),
        "",
    ));
    // Edges of bins and of the sphere are smoothed by other points.
    Difference::measure(&folder.join("sphere.png"), &folder.join("rendered.png"))
        .assert_within(0.01, 0.01);
}

/// Each command that the page names is one that `merlkit` takes.
fn run_commands(folder: &Path, commands: &[Value]) {
    assert_eq!(commands.len(), 9);
    for command in commands {
        let command = command.as_str().unwrap();
        let small = command.replace("--size 512x512", "");
        let mut arguments: Vec<&str> = small.split_whitespace().skip(1).collect();
        if arguments[0] == "render" {
            arguments.extend(["--size", "16x16", "--spp", "1"]);
        }
        arguments.extend((arguments[0] != "sample").then_some("--force"));
        let output = run_in(folder, &arguments, "");
        let complaints = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {complaints}");
    }
}

#[test]
fn the_page_shows_what_the_library_computes() {
    let Some(chromium) = find_driven_chromium() else {
        return;
    };
    let scratch = tempfile::tempdir().unwrap();
    let folder = &choose_picture_folder(scratch.path());
    let server = Server::start(&["red-plastic", "nickel"]);
    let found = look(&chromium, &server.address, folder);

    let commands = found["commands"].as_array().unwrap();
    compare_sphere(
        folder,
        commands[0].as_str().unwrap(),
        found["size"].as_u64().unwrap(),
    );

    // The outline of the lobe, from the side, is that of the server's values.
    let lobe = &found["lobe"];
    assert!(lobe["lines"].as_u64().unwrap() > 60, "{lobe}");
    assert!(lobe["worst"].as_f64().unwrap() < 2.0, "{lobe}");

    // 99.9 % of draws of that density have a chi-square of less than 84.0 with 47 degrees of freedom; nickel's are far from uniform.
    let [uniform, narrow] = [0, 1].map(|i| &found["chiSquare"][i]);
    assert!(uniform["total"].as_u64().unwrap() > 900, "{uniform}");
    assert!(uniform["value"].as_f64().unwrap() < 84.0, "{uniform}");
    assert!(narrow["value"].as_f64().unwrap() > 840.0, "{narrow}");

    let texts = &found["texts"];
    assert!(
        texts["Software"].as_str().unwrap().starts_with("merlkit "),
        "{texts}"
    );
    assert!(
        texts["Title"].as_str().unwrap().contains("red-plastic"),
        "{texts}"
    );
    let state = texts["Comment"].as_str().unwrap();
    assert!(
        state.contains("material=red-plastic") && !state.contains("token"),
        "{texts}"
    );
    run_commands(folder, commands);
}

/// The exported page needs no server: all panels are drawn from what it holds.
#[test]
fn an_exported_page_opens_from_a_file() {
    let Some(chromium) = find_driven_chromium() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["explore", "red-plastic", "--export", "page.html"];
    let output = run_in(folder.path(), &arguments, "");
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    let address = format!("file://{}", folder.path().join("page.html").display());
    let found = look(&chromium, &address, folder.path());
    assert!(found["size"].as_u64().unwrap() > 200, "{found}");
}

/// The page's shader is the text that is exported; a copy of it is part of the script.
#[test]
fn the_page_has_the_shader_that_is_exported() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../explore/page/shaders/merlkit.glsl"
    );
    let copy = std::fs::read_to_string(path).unwrap();
    let code = merlkit::export::Export::runtime_code();
    let (_, exported) = code
        .iter()
        .find(|(name, _)| *name == "merlkit.glsl")
        .unwrap();
    assert!(
        copy == *exported,
        "copy merlkit.glsl of `merlkit export nickel --format runtime` there and run tools/explore/page/build"
    );
    assert!(
        include_str!("../../tools/explore/page/dist/explore.js").contains("merlkit_bins_of"),
        "the script has no shader"
    );
}

/// The arms of the page's colours that are numbers, each as three in brackets.
fn read_triples(text: &str) -> Vec<[u8; 3]> {
    let mut triples = Vec::new();
    for piece in text.split('[').skip(1) {
        let inside = piece.split(']').next().unwrap_or_default();
        let numbers: Vec<u8> = inside
            .split(',')
            .filter_map(|n| n.trim().parse().ok())
            .collect();
        if let [red, green, blue] = numbers[..] {
            triples.push([red, green, blue]);
        }
    }
    triples
}

/// The page's colours of values are those of the plots: it has a copy of their table.
#[test]
fn the_page_has_the_colours_of_the_plots() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../explore/page/src/colours.ts"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let (table, _) = text.split_once("export type Rgb").unwrap();
    let copied = read_triples(table);
    assert_eq!(copied.len(), 9);
    for (k, colour) in copied.iter().enumerate() {
        assert_eq!(*colour, viridis(k as f64 / 8.0), "viridis {k}");
    }
}

/// The first number in hexadecimal behind each place of a word.
fn read_hexadecimal(text: &str, word: &str) -> Vec<String> {
    let pieces = text.split(word).skip(1);
    pieces.map(|piece| piece[..6].to_lowercase()).collect()
}

/// Materials and samplers have the colours of curves in the plots, where the page is light.
#[test]
fn the_page_has_the_colours_of_curves() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let plots = std::fs::read_to_string(format!("{folder}/evaluate/src/plot/style.rs")).unwrap();
    let page = std::fs::read_to_string(format!("{folder}/explore/page/style.css")).unwrap();
    let curves = read_hexadecimal(&plots, "Colour(0x");
    for (k, name) in ["--first: #", "--second: #", "--third: #"]
        .iter()
        .enumerate()
    {
        assert_eq!(read_hexadecimal(&page, name)[0], curves[k], "{name}");
    }
}
