//! The file of an unfinished picture.
//!
//! ```text
//! magic, with the layout's version   32 bytes
//! length of the facts                u64, little-endian, as are all numbers
//! facts                              JSON: [["seed", "0"], …]
//! words                              u64 or f64 each, as the picture's budget has them
//! SHA-256 of all before              32 bytes
//! ```

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::files::{Overwrite, RegularFile, write_new};
use crate::{Error, Result};

const MAGIC: [u8; 32] = *b"merlkit unfinished picture, 1\0\0\n";
const LENGTH: usize = 8;
const SHA256: usize = 32;
/// Facts are a few lines; more is no file of ours.
const MOST_FACTS: usize = 1 << 20;
/// What is shown of a fact that differs.
const SHOWN: usize = 80;

type Facts = Vec<(String, String)>;

/// Writes facts and words to `path`.
pub(super) fn write(path: &Path, facts: &Facts, words: &[u8], overwrite: Overwrite) -> Result<()> {
    // Strings always have JSON.
    let json = serde_json::to_vec(facts)
        .map_err(|e| Error::argument(e.to_string(), "give facts that are text"))?;
    if json.len() > MOST_FACTS {
        return Err(Error::argument(
            format!("{} bytes of facts about a picture", json.len()),
            format!("give at most {MOST_FACTS}: replace long texts by their checksums"),
        ));
    }
    let length = (json.len() as u64).to_le_bytes();
    let mut hash = Sha256::new();
    write_new(path, overwrite, |out| {
        for part in [&MAGIC[..], &length, &json, words] {
            hash.update(part);
            out.write_all(part)
                .map_err(|e| Error::io(path, "write", e))?;
        }
        out.write_all(&hash.finalize())
            .map_err(|e| Error::io(path, "write", e))
    })
}

/// The whole file, whose words are at most `most_words` bytes.
pub(super) fn read(path: &Path, most_words: u64) -> Result<Vec<u8>> {
    let around = (MAGIC.len() + LENGTH + MOST_FACTS + SHA256) as u64;
    let mut file = RegularFile::open(path)?;
    let mut magic = MAGIC;
    let there = file.len().min(MAGIC.len() as u64) as usize;
    file.read_at(0, &mut magic[..there])?;
    if there < MAGIC.len() || magic != MAGIC {
        return Err(Error::Unsupported {
            path: path.to_owned(),
            what: "a file that is not an unfinished picture of this version".into(),
            fix: "remove it, or give the picture another name".into(),
        });
    }
    if file.len() > most_words.saturating_add(around) {
        return Err(damaged(path, "at most as many numbers as the picture has"));
    }
    file.read_all(u64::MAX)
}

/// The words of a file that [`read`] gave, if it is whole and of a picture with these facts.
pub(super) fn check<'a>(path: &Path, bytes: &'a [u8], facts: &Facts) -> Result<&'a [u8]> {
    let (content, sum) = bytes
        .split_last_chunk::<SHA256>()
        .ok_or_else(|| damaged(path, "a checksum at its end"))?;
    if Sha256::digest(content)[..] != sum[..] {
        return Err(damaged(path, "bytes that agree with its checksum"));
    }
    let (length, rest) = content
        .get(MAGIC.len()..)
        .and_then(|rest| rest.split_first_chunk::<LENGTH>())
        .ok_or_else(|| damaged(path, "the length of its facts"))?;
    let (json, words) = usize::try_from(u64::from_le_bytes(*length))
        .ok()
        .and_then(|length| rest.split_at_checked(length))
        .ok_or_else(|| damaged(path, "its facts"))?;
    let stored: Facts =
        serde_json::from_slice(json).map_err(|_| damaged(path, "its facts as pairs"))?;
    let differences = differences(&stored, facts);
    if !differences.is_empty() {
        let what = format!(
            "{} is the unfinished picture of another command: {}",
            path.display(),
            differences.join("; ")
        );
        let fix = "repeat that command to continue, or remove the file to start again";
        return Err(Error::argument(what, fix));
    }
    if words.len() % 8 != 0 {
        return Err(damaged(path, "whole numbers of 64 bits"));
    }
    Ok(words)
}

/// The file is not what was written.
pub(super) fn damaged(path: &Path, expected: &str) -> Error {
    Error::invalid(
        path,
        0,
        expected,
        "others",
        "the file is damaged: remove it to start again",
    )
}

/// What differs, as "seed was 3, and is 4".
fn differences(stored: &Facts, now: &Facts) -> Vec<String> {
    let mut texts = Vec::new();
    for (name, value) in now {
        let before = find_fact(stored, name);
        if before != Some(value) {
            let before = before.map_or("not said".into(), |value| shorten(value));
            texts.push(format!("{name} was {before}, and is {}", shorten(value)));
        }
    }
    for (name, value) in stored {
        if find_fact(now, name).is_none() {
            let (name, value) = (shorten(name), shorten(value));
            texts.push(format!("{name} was {value}, and is not said"));
        }
    }
    texts
}

fn find_fact<'a>(facts: &'a Facts, name: &str) -> Option<&'a String> {
    let fact = facts.iter().find(|(n, _)| n == name);
    fact.map(|(_, value)| value)
}

/// One line, and no more than fits there.
fn shorten(text: &str) -> String {
    let line = text.escape_debug().to_string();
    match line.char_indices().nth(SHOWN) {
        None => line,
        Some((end, _)) => format!("{}…", &line[..end]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(pairs: &[(&str, &str)]) -> Facts {
        let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
        pairs.iter().map(owned).collect()
    }

    #[test]
    fn what_differs_is_named() {
        let stored = facts(&[("seed", "3"), ("light", "studio"), ("old", "1")]);
        assert!(differences(&stored, &stored).is_empty());
        let now = facts(&[("seed", "4"), ("light", "studio"), ("new", "2")]);
        assert_eq!(
            differences(&stored, &now),
            [
                "seed was 3, and is 4",
                "new was not said, and is 2",
                "old was 1, and is not said"
            ]
        );
        let long = |end: char| "x".repeat(2 * SHOWN) + &String::from(end);
        let (a, b) = (facts(&[("m", &long('a'))]), facts(&[("m", &long('b'))]));
        assert_eq!(differences(&a, &b).len(), 1);
        assert_eq!(shorten("a\nb\u{7}"), "a\\nb\\u{7}");
    }

    /// Files whose checksum is right and whose lengths are not.
    #[test]
    fn lengths_that_lie_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p");
        let now = facts(&[("seed", "3")]);
        let sealed = |length: u64, rest: &[u8]| {
            let mut bytes = MAGIC.to_vec();
            bytes.extend_from_slice(&length.to_le_bytes());
            bytes.extend_from_slice(rest);
            let sum = Sha256::digest(&bytes);
            bytes.extend_from_slice(&sum);
            bytes
        };
        let json = serde_json::to_vec(&now).unwrap();
        let whole = [&json[..], &[0; 16]].concat();
        let good = sealed(json.len() as u64, &whole);
        assert_eq!(check(&path, &good, &now).unwrap(), [0; 16]);
        for length in [0, 1, json.len() as u64 + 17, u64::MAX] {
            assert!(check(&path, &sealed(length, &whole), &now).is_err());
        }
        let odd = sealed(json.len() as u64, &whole[..whole.len() - 1]);
        assert!(check(&path, &odd, &now).is_err());
        std::fs::write(&path, &good).unwrap();
        assert_eq!(read(&path, 16).unwrap(), good);
        std::fs::File::options()
            .write(true)
            .open(&path)
            .unwrap()
            .set_len(1 << 40)
            .unwrap();
        assert!(read(&path, 16).is_err());
    }
}
