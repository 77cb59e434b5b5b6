//! Suggestions for misspelt words.

/// The `count` words that are most alike to `word`, the most alike first.
pub(super) fn nearest_words<'a>(word: &str, known: &[&'a str], count: usize) -> Vec<&'a str> {
    let word = word.to_lowercase();
    let mut ranked: Vec<(f64, &str)> = Vec::with_capacity(known.len());
    for name in known {
        ranked.push((strsim::jaro_winkler(&word, &name.to_lowercase()), name));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    ranked.truncate(count);
    ranked.iter().map(|(_, name)| *name).collect()
}
