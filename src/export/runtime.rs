//! Tables that programs load at run time: the file, and the header that reads it.
//!
//! `docs/export.md` describes the file byte by byte.

use super::contents::Export;
use super::packed::Packed;
use super::table_code::{HEAD_WORDS, table_code, table_entries};
use super::templates::{Entry, SPELLING_C, fill, shared, version_and_units};
use crate::brdf::Importance;
use crate::material::merl::LookupRule;

const TOP_C: &str = include_str!("templates/runtime/top_c.h");
const WORDS_C: &str = include_str!("templates/runtime/words_c.h");
const LOAD: &str = include_str!("templates/runtime/load.h");

/// The first eight bytes of a file, as two words.
const MAGIC: [u32; 2] = [0x6c72_656d, 0x0074_696b];
const FILE_VERSION: u32 = 1;
/// Bytes for the material's name, the last of them 0.
const NAME_BYTES: usize = 48;
/// Words in front of those that the checksum covers.
const UNCHECKED: usize = 5;

/// A file of a material: words of 32 bits, little-endian.
pub(super) fn file(export: &Export) -> Vec<u8> {
    let packed = Packed::new(&export.table.to_stored());
    let mut words = head(export);
    let floats = [&packed.cosines, &packed.edges_fixed, &packed.edges_weight];
    words.extend(floats.into_iter().flatten().map(|x| x.to_bits()));
    words.extend(packed.words());
    words.extend(export.values().map(f32::to_bits));
    words[3] = words.len() as u32;
    words[4] = checksum(&words[UNCHECKED..]);
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// The first 32 words, without length and checksum.
fn head(export: &Export) -> Vec<u32> {
    let settings = export.table.settings();
    let rule = match export.brdf.rule() {
        LookupRule::Floor => 0,
        LookupRule::Linear => 1,
        LookupRule::Centred => 2,
    };
    let importance = match settings.importance {
        Importance::Mean => 0,
        Importance::Luminance => 1,
    };
    let mut words = vec![
        MAGIC[0],
        MAGIC[1],
        FILE_VERSION,
        0,
        0,
        settings.tables as u32,
        settings.rows as u32,
        settings.segments as u32,
        u32::from(settings.fold),
        rule,
        export.dimensions().phi_d_bins as u32,
        importance,
    ];
    words.extend(digest_words(&export.sha256));
    words.extend(name_words(&export.name));
    words
}

/// The 64 hexadecimal digits of a checksum as eight words, its first byte in the lowest bits of the first.
fn digest_words(sha256: &str) -> [u32; 8] {
    let mut words = [0; 8];
    for (i, word) in words.iter_mut().enumerate() {
        let digits = sha256.get(8 * i..8 * i + 8).unwrap_or_default();
        *word = u32::from_str_radix(digits, 16).unwrap_or(0).swap_bytes();
    }
    words
}

/// A name in UTF-8 with zeros behind it, cut between characters.
fn name_words(name: &str) -> Vec<u32> {
    let mut end = name.len().min(NAME_BYTES - 1);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    let mut bytes = name.as_bytes()[..end].to_vec();
    bytes.resize(NAME_BYTES, 0);
    let words = bytes.as_chunks::<4>().0;
    words.iter().map(|four| u32::from_le_bytes(*four)).collect()
}

/// FNV-1a, a word at a time.
fn checksum(words: &[u32]) -> u32 {
    let mut sum = 0x811c_9dc5_u32;
    for word in words {
        sum = (sum ^ word).wrapping_mul(0x0100_0193);
    }
    sum
}

/// `merlkit.h`.
pub(super) fn c_header() -> String {
    let mut entries = version_and_units();
    entries.extend(c_entries());
    let top = fill(TOP_C, &entries) + &shared(SPELLING_C) + WORDS_C;
    top + &table_code(&entries, "table->") + LOAD
}

/// The run-time header's tables are handed over by pointer.
fn c_entries() -> Vec<Entry> {
    let mut entries = table_entries("const merlkit_table *table, ", "table->");
    entries.extend([
        ("WORDS_MEMBER", "    const uint32_t *words;\n".into()),
        ("SET_WORDS", "    table.words = words;\n".into()),
        ("OPEN_PARAMETER", "const uint32_t *words".into()),
        ("FIRST", String::new()),
        (
            "OPEN_COMMENT",
            "// The table of a file without any check: merlkit_load is for files.".into(),
        ),
    ]);
    for (key, word) in HEAD_WORDS {
        entries.push((key, format!("words[{word}]")));
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_magic_word_is_text() {
        let bytes: Vec<u8> = MAGIC.into_iter().flat_map(u32::to_le_bytes).collect();
        assert_eq!(bytes, b"merlkit\0");
    }

    #[test]
    fn names_are_cut_between_characters_and_end_with_a_zero() {
        let long = name_words(&"é".repeat(30));
        let bytes: Vec<u8> = long.into_iter().flat_map(u32::to_le_bytes).collect();
        assert_eq!(bytes.len(), NAME_BYTES);
        assert_eq!(bytes[..46], *"é".repeat(23).as_bytes());
        assert_eq!(bytes[46..], [0, 0]);
        assert_eq!(name_words("nickel")[..3], [0x6b63_696e, 0x0000_6c65, 0]);
    }

    #[test]
    fn digests_keep_the_order_of_their_bytes() {
        let digest = "00010203".to_owned() + &"0".repeat(56);
        assert_eq!(digest_words(&digest)[0].to_le_bytes(), [0, 1, 2, 3]);
    }

    #[test]
    fn checksums_are_those_of_fnv_1a() {
        assert_eq!(checksum(&[]), 0x811c_9dc5);
        // Of one byte, as published for the text "a".
        assert_eq!(checksum(&[0x61]), 0xe40c_292c);
    }

    #[test]
    fn every_name_of_a_template_is_replaced() {
        let text = c_header();
        assert!(text.is_ascii() && !text.contains(['@', '\\', '\t']) && !text.contains("NAME"));
    }
}
