#![no_main]

#[allow(dead_code)] // each target uses its own part
#[path = "../../tests/support/exercise.rs"]
mod exercise;

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    exercise::picture(input);
});
