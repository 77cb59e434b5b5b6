//! The maths of run-time tables as GLSL, HLSL and WGSL.

use super::table_code::{HEAD_WORDS, table_code, table_entries};
use super::templates::{Entry, MATHS, SPELLING_GLSL, SPELLING_HLSL, fill, version_and_units};
use super::wgsl::translate;

const TOP_GLSL: &str = include_str!("templates/runtime/top_glsl.h");
const TOP_HLSL: &str = include_str!("templates/runtime/top_hlsl.h");
const TOP_WGSL: &str = include_str!("templates/runtime/top_wgsl.h");
const TOP_SHADER: &str = include_str!("templates/runtime/top_shader.h");
const WORDS_GLSL: &str = include_str!("templates/runtime/words_glsl.h");
const WORDS_HLSL: &str = include_str!("templates/runtime/words_hlsl.h");

/// Width of the texture of words: all of WebGL 2's have 2048 or more, and two hundred materials fit into its least height.
const TEXELS: usize = 2048;

/// `merlkit.glsl`.
pub(super) fn glsl() -> String {
    let parts = [
        TOP_GLSL,
        TOP_SHADER,
        SPELLING_GLSL,
        "\n",
        MATHS,
        "\n",
        WORDS_GLSL,
    ];
    guarded("MERLKIT_GLSL_INCLUDED", &parts)
}

/// `merlkit.hlsl`.
pub(super) fn hlsl() -> String {
    let parts = [
        TOP_HLSL,
        TOP_SHADER,
        SPELLING_HLSL,
        "\n",
        MATHS,
        "\n",
        WORDS_HLSL,
    ];
    guarded("MERLKIT_HLSL_INCLUDED", &parts)
}

/// A text that may be included twice.
fn guarded(guard: &str, parts: &[&str]) -> String {
    let entries = entries();
    let text = fill(&parts.concat(), &entries) + &table_code(&entries, "table.");
    format!("#ifndef {guard}\n#define {guard} 1\n{text}#endif\n")
}

/// `merlkit.wgsl`.
pub(super) fn wgsl() -> String {
    let entries = entries();
    let code = [MATHS, "\n", &table_code(&entries, "table.")].concat();
    fill(&[TOP_WGSL, TOP_SHADER].concat(), &entries) + &translate(&code)
}

/// Tables of shaders are values, and their files begin somewhere in the words.
fn entries() -> Vec<Entry> {
    let mut entries = version_and_units();
    entries.extend(table_entries("merlkit_table table, ", "table."));
    entries.extend([
        ("AT", "@".into()),
        ("TEXELS", TEXELS.to_string()),
        ("WORDS_MEMBER", String::new()),
        ("SET_WORDS", String::new()),
        ("OPEN_PARAMETER", "MERLKIT_UINT first".into()),
        ("FIRST", "first + ".into()),
        (
            "OPEN_COMMENT",
            "// The table of the file that begins at word `first`.".into(),
        ),
    ]);
    for (key, word) in HEAD_WORDS {
        entries.push((key, format!("MERLKIT_WORD(first + {word}u)")));
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaders_are_plain_and_filled() {
        for text in [glsl(), hlsl(), wgsl()] {
            assert!(text.is_ascii() && !text.contains(['\\', '\t', '?', '"']));
            assert!(!text.contains("NAME") && text.lines().all(|l| l.trim_end() == l));
        }
        let text = wgsl();
        for word in text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            assert!(!word.starts_with("MERLKIT") && word != "float", "{word}");
        }
    }
}
