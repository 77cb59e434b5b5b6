//! The names of a header's functions.

use std::collections::BTreeMap;

use crate::material::Material;
use crate::{Error, Result};

/// What the functions of a material's header begin with: its name with `_` for what no identifier of C and GLSL holds. Names
/// that would be reserved there begin with `m_`.
///
/// See [`Export`](crate::export::Export) for an example.
pub fn identifier(name: &str) -> String {
    let words: Vec<&str> = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|w| !w.is_empty())
        .collect();
    let joined = words.join("_");
    let lower = joined.to_ascii_lowercase();
    let first = lower.split('_').next().unwrap_or_default();
    let is_reserved = matches!(first, "gl" | "merlkit");
    let begins = joined.starts_with(|c: char| c.is_ascii_alphabetic());
    match joined.as_str() {
        "" => "m".into(),
        _ if begins && !is_reserved => joined,
        _ => format!("m_{joined}"),
    }
}

/// Two materials of one [`identifier`] could not be included together.
///
/// See [`Export`](crate::export::Export) for an example.
///
/// # Errors
/// [`Error::Argument`] naming both.
pub fn refuse_same_identifier(materials: &[Material]) -> Result<()> {
    let mut seen = BTreeMap::new();
    match materials.iter().find_map(|m| {
        seen.insert(identifier(m.name()), m.name())
            .map(|first| (first, m.name()))
    }) {
        None => Ok(()),
        Some((first, second)) => Err(Error::argument(
            format!("{first} and {second} would have functions of the same names"),
            "rename one of the files, or export them to separate folders",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_legal_and_unreserved() {
        for (name, expected) in [
            ("nickel", "nickel"),
            ("blue-metallic-paint", "blue_metallic_paint"),
            ("_two--of  them_", "two_of_them"),
            ("2-layer gold", "m_2_layer_gold"),
            ("gl", "m_gl"),
            ("gl-paint", "m_gl_paint"),
            ("glass", "glass"),
            ("merlkit", "m_merlkit"),
            ("MERLKIT", "m_MERLKIT"),
            ("Gl-paint", "m_Gl_paint"),
            ("tôle", "t_le"),
            ("…", "m"),
        ] {
            assert_eq!(identifier(name), expected);
        }
    }
}
