//! Text in the fonts that every reader of PDF has: Helvetica, and Symbol for Greek letters and signs.

/// One of the fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StandardFont {
    /// In the encoding of Windows, which is nearly Latin-1.
    Helvetica,
    /// In its own encoding.
    Symbol,
}

/// Letters of one font, size and height.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextRun {
    pub font: StandardFont,
    /// Part of the line's size, and how far above the line's base it is, in parts of that size too.
    pub size: f64,
    pub rise: f64,
    pub codes: Vec<u8>,
    /// Width in the line's size.
    pub width: f64,
}

/// Size and height of letters that are raised.
const RAISED: (f64, f64) = (0.65, 0.36);

/// A line as runs. What neither font has is a question mark.
pub(super) fn text_runs(text: &str) -> Vec<TextRun> {
    let mut runs: Vec<TextRun> = Vec::new();
    for c in text.chars() {
        let (c, (size, rise)) = match lowered(c) {
            Some(c) => (c, RAISED),
            None => (c, (1.0, 0.0)),
        };
        let (font, code) = encode(c);
        let width = size * advance(font, code) / 1000.0;
        match runs.last_mut() {
            Some(run) if (run.font, run.size) == (font, size) => {
                run.codes.push(code);
                run.width += width;
            }
            _ => runs.push(TextRun {
                font,
                size,
                rise,
                codes: vec![code],
                width,
            }),
        }
    }
    runs
}

/// What a superscript is a raised form of.
fn lowered(c: char) -> Option<char> {
    Some(match c {
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁰' => '0',
        '⁴'..='⁹' => char::from(b'4' + (u32::from(c) - u32::from('⁴')) as u8),
        '⁻' => '−',
        '⁺' => '+',
        _ => return None,
    })
}

/// Greek letters in the places of the Latin ones by which Symbol names them.
const GREEK: [(&str, &str); 2] = [
    ("αβχδεφγηιϕκλμνοπθρστυωξψζ", "abcdefghijklmnopqrstuwxyz"),
    ("ΑΒΧΔΕΦΓΗΙΚΛΜΝΟΠΘΡΣΤΥΩΞΨΖ", "ABCDEFGHIKLMNOPQRSTUWXYZ"),
];

/// Signs of Symbol, and those of the Windows encoding that are not where Latin-1 has them.
const SIGNS: [(char, StandardFont, u8); 20] = [
    ('−', StandardFont::Symbol, 0x2d),
    ('≤', StandardFont::Symbol, 0xa3),
    ('∞', StandardFont::Symbol, 0xa5),
    ('→', StandardFont::Symbol, 0xae),
    ('≥', StandardFont::Symbol, 0xb3),
    ('∝', StandardFont::Symbol, 0xb5),
    ('∂', StandardFont::Symbol, 0xb6),
    ('≠', StandardFont::Symbol, 0xb9),
    ('≈', StandardFont::Symbol, 0xbb),
    ('√', StandardFont::Symbol, 0xd6),
    ('∫', StandardFont::Symbol, 0xf2),
    ('€', StandardFont::Helvetica, 0x80),
    ('…', StandardFont::Helvetica, 0x85),
    ('‘', StandardFont::Helvetica, 0x91),
    ('’', StandardFont::Helvetica, 0x92),
    ('“', StandardFont::Helvetica, 0x93),
    ('”', StandardFont::Helvetica, 0x94),
    ('•', StandardFont::Helvetica, 0x95),
    ('–', StandardFont::Helvetica, 0x96),
    ('—', StandardFont::Helvetica, 0x97),
];

fn encode(c: char) -> (StandardFont, u8) {
    if let Some(&(_, font, code)) = SIGNS.iter().find(|sign| sign.0 == c) {
        return (font, code);
    }
    for (letters, names) in GREEK {
        let place = letters.chars().position(|letter| letter == c);
        if let Some(&code) = place.and_then(|i| names.as_bytes().get(i)) {
            return (StandardFont::Symbol, code);
        }
    }
    let code = match u32::from(c) {
        9 | 10 | 13 => b' ',
        code @ (0x20..=0x7e | 0xa0..=0xff) => code as u8,
        _ => b'?',
    };
    (StandardFont::Helvetica, code)
}

/// Helvetica's widths from the space to the tilde, in thousandths of the size.
const ASCII_WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];
/// Symbol's widths of the letters, from capital alpha and from alpha.
const SYMBOL_WIDTHS: [[u16; 26]; 2] = [
    [
        722, 667, 722, 612, 611, 763, 603, 722, 333, 631, 722, 686, 889, 722, 722, 768, 741, 556,
        592, 611, 690, 439, 768, 645, 795, 611,
    ],
    [
        631, 549, 549, 494, 439, 521, 411, 603, 329, 603, 549, 549, 576, 521, 549, 549, 521, 549,
        603, 439, 576, 713, 686, 493, 686, 494,
    ],
];

/// Width of a letter, in thousandths of the size.
fn advance(font: StandardFont, code: u8) -> f64 {
    let width = match (font, code) {
        (StandardFont::Symbol, b'A'..=b'Z') => SYMBOL_WIDTHS[0][usize::from(code - b'A')],
        (StandardFont::Symbol, b'a'..=b'z') => SYMBOL_WIDTHS[1][usize::from(code - b'a')],
        (StandardFont::Symbol, 0xa5 | 0xb5) => 713,
        (StandardFont::Symbol, 0xae) => 987,
        (StandardFont::Symbol, 0xb6) => 494,
        (StandardFont::Symbol, 0xf2) => 274,
        (StandardFont::Symbol, _) => 549,
        (StandardFont::Helvetica, 0x20..=0x7e) => ASCII_WIDTHS[usize::from(code - 0x20)],
        (StandardFont::Helvetica, _) => latin_width(code),
    };
    f64::from(width)
}

/// Helvetica's widths beyond ASCII: letters with accents are as wide as without.
fn latin_width(code: u8) -> u16 {
    match code {
        0x85 | 0x97 | 0xc6 => 1000,
        0x91 | 0x92 => 222,
        0x93 | 0x94 | 0xa8 | 0xaf | 0xb4 | 0xb8 => 333,
        0x95 => 350,
        0xa0 | 0xa1 | 0xb7 | 0xcc..=0xcf | 0xec..=0xef => 278,
        0xa6 => 260,
        0xa9 | 0xae => 737,
        0xaa => 370,
        0xac | 0xb1 | 0xd7 | 0xf7 => 584,
        0xb0 => 400,
        0xb6 => 537,
        0xba => 365,
        0xbc..=0xbe => 834,
        0xc0..=0xc5 | 0xc8..=0xcb | 0xdd | 0xde => 667,
        0xc7 | 0xd0 | 0xd1 | 0xd9..=0xdc => 722,
        0xd2..=0xd6 | 0xd8 => 778,
        0xdf | 0xf8 => 611,
        0xe6 => 889,
        0xe7 | 0xfd | 0xff => 500,
        _ => 556,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_their_superscripts_and_greek_its_font() {
        let runs = text_runs("θ [sr⁻¹] …");
        let fonts: Vec<_> = runs.iter().map(|r| (r.font, r.rise > 0.0)).collect();
        let (latin, greek) = (StandardFont::Helvetica, StandardFont::Symbol);
        let expected = [
            (greek, false),
            (latin, false),
            (greek, true),
            (latin, true),
            (latin, false),
        ];
        assert_eq!(fonts, expected);
        assert_eq!(runs[0].codes, b"q");
        assert_eq!(runs[3].codes, b"1");
        assert_eq!(runs[4].codes, [b']', b' ', 0x85]);
        // The widths of θ, and of a bracket, a space and an ellipsis.
        assert!((runs[0].width - 0.521).abs() < 1e-9);
        assert!((runs[4].width - 1.556).abs() < 1e-9);
        assert_eq!(text_runs("⁹")[0].codes, b"9");
        assert_eq!(text_runs("中")[0].codes, b"?");
    }
}
