//! What is wrong in a scene file, with the line and the key that was meant.

/// What is wrong in a scene file, and where.
#[derive(Debug)]
pub(crate) struct SceneFault {
    pub(crate) line: Option<usize>,
    pub(crate) what: String,
    pub(crate) fix: String,
}

impl SceneFault {
    pub(crate) fn new(what: impl Into<String>, fix: impl Into<String>) -> Self {
        Self {
            line: None,
            what: what.into(),
            fix: fix.into(),
        }
    }

    /// The same at the line of a byte.
    pub(crate) fn with_line(self, text: &str, offset: usize) -> Self {
        Self {
            line: Some(count_lines(text, offset)),
            ..self
        }
    }
}

/// The line of a byte, counted from 1.
pub(crate) fn count_lines(text: &str, offset: usize) -> usize {
    let before = text.as_bytes().iter().take(offset);
    before.filter(|byte| **byte == b'\n').count() + 1
}

/// Refuses keys that have no meaning, and the lack of one that is needed.
pub(crate) fn check_given(
    subject: &str,
    given: &[(&'static str, bool)],
    allowed: &[&str],
    needed: &[&str],
) -> Result<(), SceneFault> {
    for (key, is_given) in given {
        if *is_given && !allowed.contains(key) {
            let what = format!("{key} has no meaning for {subject}");
            return Err(SceneFault::new(
                what,
                format!("its keys are {}", allowed.join(", ")),
            ));
        }
        if !*is_given && needed.contains(key) {
            let what = format!("{subject} without {key}");
            return Err(SceneFault::new(what, format!("add {key}")));
        }
    }
    Ok(())
}

/// The nearest of some words, as the end of an error.
pub(crate) fn suggest(word: &str, known: &[String], otherwise: &str) -> String {
    let mut best: Option<(f64, &String)> = None;
    for candidate in known {
        let likeness = strsim::jaro_winkler(word, candidate);
        if best.is_none_or(|(most, _)| likeness > most) {
            best = Some((likeness, candidate));
        }
    }
    match best {
        Some((likeness, candidate)) if likeness > 0.7 => format!("did you mean \"{candidate}\"?"),
        _ if otherwise.is_empty() => format!("give {}", known.join(", ")),
        _ => otherwise.to_owned(),
    }
}
