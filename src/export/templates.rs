//! Texts of C that headers and shaders are made of, and how they are filled in.
//!
//! `@…@` is a key whose value is filled in. [`MATHS`], [`DRAW`], [`FLOOR`] and [`LINEAR`] are the same for a material's own header,
//! the run-time header and the shaders, of which [`super::wgsl`] translates one. So they keep to what all languages have: one
//! declaration a line, a function's head on one line, and no `?:`. In the last three, `NAME` begins what a material's header
//! and the run-time header call differently. All texts are ASCII without backslashes.

pub(super) const SPELLING_C: &str = include_str!("templates/spelling_c.h");
pub(super) const SPELLING_GLSL: &str = include_str!("templates/spelling_glsl.h");
pub(super) const SPELLING_HLSL: &str = include_str!("templates/spelling_hlsl.h");
pub(super) const SHARED: &str = include_str!("templates/shared.h");
pub(super) const MATHS: &str = include_str!("templates/maths.h");
pub(super) const DRAW: &str = include_str!("templates/draw.h");
pub(super) const FLOOR: &str = include_str!("templates/floor.h");
pub(super) const LINEAR: &str = include_str!("templates/linear.h");

/// A key and its value.
pub(super) type Entry = (&'static str, String);

/// What both kinds of headers define once: the spelling of a language and the maths of directions and bins.
pub(super) fn shared(spelling: &str) -> String {
    let entries = [("SPELLING", spelling.into()), ("MATHS", MATHS.into())];
    fill(SHARED, &entries)
}

/// Every `@key@` of a template by its value. Values are taken as they are.
pub(super) fn fill(template: &str, entries: &[Entry]) -> String {
    let mut filled = String::new();
    // Every second piece is a key.
    for (i, piece) in template.split('@').enumerate() {
        if i % 2 == 0 {
            filled += piece;
            continue;
        }
        match entries.iter().find(|entry| entry.0 == piece) {
            Some((_, value)) => filled += value,
            None => debug_assert!(false, "a template has the unknown key {piece}"),
        }
    }
    filled
}

/// The numbers of draws that all templates have.
pub(super) fn version_and_units() -> Vec<Entry> {
    vec![
        ("VERSION", env!("CARGO_PKG_VERSION").into()),
        ("ROW_UNIT", format!("{:?}", crate::sampler::ROW_UNIT)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_filled_and_values_left_alone() {
        let entries = [("A", "1@B@".to_owned()), ("B", "2".to_owned())];
        assert_eq!(fill("x@A@y@B@", &entries), "x1@B@y2");
    }

    #[test]
    fn templates_are_plain_and_shared_ones_keep_to_the_common_subset() {
        for text in [SPELLING_C, SPELLING_GLSL, SPELLING_HLSL, SHARED] {
            assert!(text.is_ascii() && !text.contains('\\'));
        }
        for text in [MATHS, DRAW, FLOOR, LINEAR] {
            assert!(text.is_ascii() && !text.contains(['\\', '?', '#']));
            let code = text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            for line in code {
                let is_head = line.starts_with("MERLKIT_FN");
                assert!(!is_head || line.ends_with(')'), "{line}");
            }
        }
    }
}
