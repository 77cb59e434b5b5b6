//! How much room text takes.

use super::area::Area;

/// Size of ordinary text, pixels.
pub(super) const TEXT: f64 = 12.0;
pub(super) const TITLE_TEXT: f64 = 15.0;

/// Where a text's position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// About how many pixels a text is wide. Fonts differ; this is generous for the usual ones.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    size * text
        .chars()
        .map(|c| if c < '\u{2e80}' { 0.58 } else { 1.0 })
        .sum::<f64>()
}

/// As much of a text as is at most `width` pixels wide.
pub(super) fn shortened(text: &str, size: f64, width: f64) -> String {
    if width_of(text, size) <= width {
        return text.into();
    }
    let mut out = String::new();
    for c in text.chars() {
        out.push(c);
        if width_of(&out, size) > width - size {
            out.pop();
            break;
        }
    }
    out.push('…');
    out
}

/// What a label of that width covers.
pub(super) fn label_room(left: f64, baseline: f64, width: f64) -> Area {
    Area {
        x: left,
        y: baseline - 10.0,
        width,
        height: 13.0,
    }
}
