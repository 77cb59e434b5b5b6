//! What this binary is, for reports of faults.

use std::env::consts::{ARCH, OS};
use std::sync::LazyLock;

/// Instructions that the compiler was allowed to use beyond the architecture's least, of those that matter here.
const INSTRUCTIONS: [(&str, bool); 4] = [
    ("avx2", cfg!(target_feature = "avx2")),
    ("fma", cfg!(target_feature = "fma")),
    ("avx512f", cfg!(target_feature = "avx512f")),
    ("neon", cfg!(target_feature = "neon")),
];

/// Version, target and profile, one a line.
pub fn long() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(text);
    &TEXT
}

fn text() -> String {
    let profile = if cfg!(debug_assertions) {
        "debug (with assertions)"
    } else {
        "release"
    };
    format!(
        "{}\ntarget: {ARCH} {OS}, {} bits\ncpu features: {}\nprofile: {profile}",
        env!("CARGO_PKG_VERSION"),
        usize::BITS,
        list_chosen(&INSTRUCTIONS, "the baseline of the architecture"),
    )
}

/// Names of those that were chosen, or `none`.
fn list_chosen(list: &[(&str, bool)], none: &str) -> String {
    let names: Vec<&str> = list.iter().filter(|f| f.1).map(|f| f.0).collect();
    if names.is_empty() {
        none.into()
    } else {
        names.join(", ")
    }
}
