//! The browser that pages are looked at in, and what drives it; each may be missing.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A Chromium: `CHROMIUM`, or one in `PATH`.
pub fn find_chromium() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM").filter(|path| !path.is_empty()) {
        return Some(path.into());
    }
    let path = std::env::var_os("PATH")?;
    for folder in std::env::split_paths(&path) {
        for name in ["chromium", "chromium-browser", "google-chrome"] {
            let file = folder.join(name);
            if file.is_file() {
                return Some(file);
            }
        }
    }
    None
}

/// Where a test keeps its pictures: in the folder `SCREENSHOTS`, for people, or in one of its own.
pub fn choose_picture_folder(own: &Path) -> PathBuf {
    std::env::var_os("SCREENSHOTS").map_or_else(|| own.to_owned(), PathBuf::from)
}

/// A Chromium, if node finds what drives it: `playwright-core`. Says so where it does not.
pub fn find_driven_chromium() -> Option<PathBuf> {
    let driver = Command::new("node")
        .args(["-e", "require('playwright-core')"])
        .output();
    if driver.is_ok_and(|output| output.status.success()) {
        let chromium = find_chromium();
        if chromium.is_some() {
            return chromium;
        }
    }
    eprintln!("skipped: no Chromium, or no node with playwright-core on NODE_PATH");
    None
}
