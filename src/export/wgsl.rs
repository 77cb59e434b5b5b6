//! From the C that all templates keep to, to WGSL.
//!
//! WGSL has no preprocessor and declares in another order. All else in the templates, operators and statements, is the same.

/// Words of C and what WGSL calls them.
const WORDS: [(&str, &str); 10] = [
    ("float", "f32"),
    ("int", "i32"),
    ("MERLKIT_UINT", "u32"),
    ("MERLKIT_TO_UINT", "u32"),
    ("MERLKIT_TO_INT", "i32"),
    ("MERLKIT_TO_FLOAT", "f32"),
    ("MERLKIT_SQRT", "sqrt"),
    ("MERLKIT_ABS", "abs"),
    ("MERLKIT_BITS", "bitcast<f32>"),
    ("MERLKIT_WORD", "merlkit_word"),
];

/// What the other languages define by macros.
const VECTORS: &str = "alias merlkit_vec3 = vec3<f32>;\n\n\
                       fn merlkit_v(x: f32, y: f32, z: f32) -> merlkit_vec3\n{\n    return merlkit_vec3(x, y, z);\n}\n\n";

/// Code of the templates as WGSL.
pub(super) fn translate(code: &str) -> String {
    let mut text = VECTORS.to_owned();
    let mut is_struct = false;
    for line in code.lines() {
        is_struct |= line.starts_with("struct ");
        text += &translate_line(line, is_struct);
        text.push('\n');
        is_struct &= line != "};";
    }
    text
}

fn translate_line(line: &str, is_struct: bool) -> String {
    let code = line.trim_start();
    let indent = &line[..line.len() - code.len()];
    if code.starts_with("//") {
        return line.to_owned();
    }
    if let Some(head) = code.strip_prefix("MERLKIT_FN ") {
        return translate_head(head);
    }
    if is_struct && code == "};" {
        return "}".to_owned();
    }
    let Some((kind, name, rest)) = split_declaration(code) else {
        return replace_words(line);
    };
    let kind = replace_words(kind);
    if is_struct {
        return format!("{indent}{name}: {kind},");
    }
    format!("{indent}var {name}: {kind}{}", replace_words(rest))
}

/// `float f(int a, float b)` as `fn f(a: i32, b: f32) -> f32`.
fn translate_head(head: &str) -> String {
    let (declared, parameters) = head.split_once('(').unwrap_or((head, ")"));
    let (kind, name) = declared.split_once(' ').unwrap_or(("", declared));
    let mut translated = Vec::new();
    for parameter in parameters.trim_end_matches(')').split(", ") {
        let (kind, name) = parameter.split_once(' ').unwrap_or(("", parameter));
        translated.push(format!("{name}: {}", replace_words(kind)));
    }
    let parameters = translated.join(", ");
    format!("fn {name}({parameters}) -> {}", replace_words(kind))
}

/// A declaration's type, its name, and what follows: ` = …` or `;`.
fn split_declaration(code: &str) -> Option<(&str, &str, &str)> {
    let (kind, behind) = code.split_once(' ')?;
    let is_type = matches!(kind, "float" | "int" | "bool" | "MERLKIT_UINT")
        || kind.starts_with("merlkit_") && kind.chars().all(is_word);
    let end = behind.find(|c| !is_word(c))?;
    let (name, rest) = behind.split_at(end);
    let is_declaration = is_type && !name.is_empty() && (rest == ";" || rest.starts_with(" = "));
    is_declaration.then_some((kind, name, rest))
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Every whole word of [`WORDS`] by what WGSL calls it.
fn replace_words(code: &str) -> String {
    let mut replaced = String::with_capacity(code.len());
    let mut rest = code;
    while !rest.is_empty() {
        let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        let (word, behind) = rest.split_at(end);
        let known = WORDS.iter().find(|known| known.0 == word);
        replaced += known.map_or(word, |known| known.1);
        // What separates this word from the next.
        let next = behind.find(is_word).unwrap_or(behind.len());
        replaced += &behind[..next];
        rest = &behind[next..];
    }
    replaced
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_translated() {
        for (line, expected) in [
            ("// float x;", "// float x;"),
            ("    float x = y * 2.0f", "    var x: f32 = y * 2.0f"),
            ("    merlkit_draw draw;", "    var draw: merlkit_draw;"),
            ("    draw.pdf = 0.0f;", "    draw.pdf = 0.0f;"),
            ("        return -x;", "        return -x;"),
            (
                "    MERLKIT_UINT a = MERLKIT_TO_UINT(scaled);",
                "    var a: u32 = u32(scaled);",
            ),
            (
                "MERLKIT_FN float f(merlkit_vec3 w, int n)",
                "fn f(w: merlkit_vec3, n: i32) -> f32",
            ),
        ] {
            assert_eq!(translate_line(line, false), expected);
        }
        assert_eq!(translate_line("    int low;", true), "    low: i32,");
        assert_eq!(translate_line("};", true), "}");
    }
}
