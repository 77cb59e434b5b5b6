#![no_main]

use std::sync::LazyLock;

use merlkit::material::Loaded;

#[allow(dead_code)] // each target uses its own part
#[path = "../../tests/support/exercise.rs"]
mod exercise;

static MATERIAL: LazyLock<Loaded> = LazyLock::new(exercise::material);

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    exercise::sampler(input, &MATERIAL);
});
