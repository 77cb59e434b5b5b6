#![no_main]

use std::sync::{Arc, LazyLock};

use merlkit::material::merl::MerlBrdf;

#[allow(dead_code)] // each target uses its own part
#[path = "../../tests/support/exercise.rs"]
mod exercise;

static BRDF: LazyLock<Arc<MerlBrdf>> = LazyLock::new(exercise::brdf);

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    exercise::sampler(input, &BRDF);
});
