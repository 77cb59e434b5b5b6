//! The browser that pages are looked at in, and what drives it; each may be missing.

use std::path::PathBuf;
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

/// A Chromium, if node finds what drives it: `playwright-core`.
pub fn find_driven_chromium() -> Option<PathBuf> {
    let driver = Command::new("node")
        .args(["-e", "require('playwright-core')"])
        .output();
    if driver.is_ok_and(|output| output.status.success()) {
        find_chromium()
    } else {
        None
    }
}
