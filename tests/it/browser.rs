//! The page of a comparison in a browser: it is not blank, prints, and can be read on a phone, by day and by night.
//!
//! The tests skip, saying so, where there is no Chromium, or no `playwright-core` on `NODE_PATH` for the one that reads the
//! document. `SCREENSHOTS` names a folder that keeps the pictures.

use std::path::Path;
use std::process::Command;

use crate::browsers::{choose_picture_folder, find_chromium, find_driven_chromium};
use crate::page::{comparison_page, full};

fn browse(chromium: &Path, folder: &Path, arguments: &[String], page: &Path) {
    let output = Command::new(chromium)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--hide-scrollbars",
        ])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .args(arguments)
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// 8-bit RGB of a PNG and its width.
fn pixels(path: &Path) -> (usize, Vec<[u8; 3]>) {
    let mut decoder =
        png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let channels = info.color_type.samples();
    assert!(channels >= 3);
    (
        info.width as usize,
        bytes
            .chunks_exact(channels)
            .map(|p| [p[0], p[1], p[2]])
            .collect(),
    )
}

#[test]
fn a_browser_shows_and_prints_it() {
    let Some(chromium) = find_chromium() else {
        eprintln!("skipped: no Chromium in CHROMIUM or PATH");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [page, shot, print] = ["page.html", "page.png", "page.pdf"].map(|n| folder.path().join(n));
    std::fs::write(&page, comparison_page(&full())).unwrap();
    let screen = [
        "--window-size=1280,4000".to_owned(),
        format!("--screenshot={}", shot.display()),
    ];
    browse(&chromium, folder.path(), &screen, &page);
    let (width, pixels) = pixels(&shot);
    assert_eq!(width, 1280);
    let dark = pixels.iter().filter(|p| p.iter().all(|&c| c < 96)).count();
    let coloured = pixels
        .iter()
        .filter(|p| p.iter().max().unwrap() - p.iter().min().unwrap() > 80)
        .count();
    // Text and curves, on a page that stays white for the most part.
    assert!(
        dark > 10_000 && coloured > 2_000,
        "{dark} dark and {coloured} coloured pixels"
    );
    assert!(pixels.iter().filter(|p| **p == [255; 3]).count() > pixels.len() / 2);
    let sheet = [
        "--no-pdf-header-footer".to_owned(),
        format!("--print-to-pdf={}", print.display()),
    ];
    browse(&chromium, folder.path(), &sheet, &page);
    let pdf = std::fs::read(&print).unwrap();
    assert!(
        pdf.starts_with(b"%PDF-") && pdf.len() > 20_000,
        "{} bytes",
        pdf.len()
    );
}

const INSPECT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/browser/inspect.js");

/// What is wrong with a page at some widths, or the usual ones if none is named, by day and by night; pictures go to `folder`.
fn inspect(chromium: &Path, page: &str, folder: &Path, widths: &[&str]) -> Vec<String> {
    let file = folder.join("page.html");
    std::fs::write(&file, page).unwrap();
    let output = Command::new("node")
        .arg(INSPECT)
        .args([chromium, &file, folder])
        .args(widths)
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Also: what is meant to be found is found.
#[test]
fn it_can_be_read_at_every_width_and_in_the_dark() {
    let Some(chromium) = find_driven_chromium() else {
        return;
    };
    let scratch = tempfile::tempdir().unwrap();
    let folder = &choose_picture_folder(scratch.path());
    let page = comparison_page(&full());
    let faults = inspect(&chromium, &page, folder, &[]);
    assert!(faults.is_empty(), "{faults:#?}");
    for name in ["390-light", "390-dark", "1100-light", "1600-dark"] {
        assert!(folder.join(format!("{name}.png")).is_file(), "{name}");
    }
    let (_, night) = pixels(&folder.join("1100-dark.png"));
    let dark = night.iter().filter(|p| p.iter().all(|&c| c < 64)).count();
    assert!(dark > night.len() / 4, "{dark} of {} pixels", night.len());
    for (whole, broken, fault) in [
        ("font-size: .8rem", "font-size: .6rem", "letters of"),
        ("--ink: #1a1a1a", "--ink: #999", "contrast of"),
        (".wide { overflow-x: auto;", ".wide {", "scrolls sideways"),
        (
            "position: sticky",
            "position: static",
            "name of a row moves",
        ),
        ("background: var(--best);", "", "is not shaded"),
        (
            "<main>",
            "<main><img alt=\"x\" src=\"file:///x.png\" />",
            "asks for",
        ),
    ] {
        assert!(page.contains(whole), "{whole}");
        let faults = inspect(
            &chromium,
            &page.replace(whole, broken),
            scratch.path(),
            &["390"],
        );
        let is_found = faults.iter().any(|f| f.contains(fault));
        assert!(is_found, "{whole} to {broken}: {faults:#?}");
    }
}
