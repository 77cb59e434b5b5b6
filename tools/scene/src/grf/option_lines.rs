//! The lines of an option file: a known key and its values in each.

use merlkit::Result;

use super::tokens::fault_in_line;
use super::words::GrfFault;
use crate::scene_fault::suggest;

/// The largest number that is a count of pixels or table entries.
pub(super) const MOST_COUNT: u64 = 1 << 20;

/// The keys, with what their values are.
const KEYS: [(&str, &str); 34] = [
    ("BPT_SCENE", "a file"),
    ("BPT_IMAGE_RESOLUTION", "two whole numbers"),
    ("BPT_OUTPUT_IMAGE", "a file"),
    ("BPT_VIEWER", "three numbers"),
    ("BPT_VLOOK", "three numbers"),
    ("BPT_PIXEL_RADIAL", "true or false"),
    ("BPT_PIXEL_RANDOM", "true or false"),
    ("BPT_BACKGROUND", "three numbers"),
    ("BPT_EM_BACKGROUND", "a file"),
    ("BPT_PIXEL_SAMPLERES", "two whole numbers"),
    ("BPT_RE_NSECRAYSROOT", "a whole number"),
    ("BPT_DEPTH", "a whole number"),
    ("BPT_PDF_NAME", "a word"),
    ("BPT_PDF_LOBEEXPONENT", "a number"),
    ("BPT_PDF_ANISONU", "a number"),
    ("BPT_PDF_ANISONV", "a number"),
    ("BPT_PDF_MEMSTAT", "true or false"),
    ("BPT_QT_PRECOMPUTED", "a whole number"),
    ("BPT_QT_ANISOTROPIC", "a whole number"),
    ("BPT_QT_AVGNMAX", "a number"),
    ("BPT_QT_IMGRES", "a whole number"),
    ("BPT_QT_RELEASE", "true or false"),
    ("BPT_PDF_FACTORS_RESU", "two whole numbers"),
    ("BPT_PDF_FACTORS_RESP", "two whole numbers"),
    ("BPT_PDF_FACTORS_JK", "two whole numbers"),
    ("BPT_PDF_FACTORS_HALF", "true or false"),
    ("BPT_PDF_FACTORS_FILE", "a file"),
    ("BPT_PDF_CDF_RES", "two whole numbers"),
    ("BPT_PDF_CDF_COMPRESS", "true or false"),
    ("BPT_RAYCASTING", "true or false"),
    ("BPT_DISPLAYWINDOW", "true or false"),
    ("BPT_CHRONO_SAMPLING", "true or false"),
    ("BPT_CHRONO_RENDERING", "true or false"),
    ("BPT_CHRONO_PREBUILD", "true or false"),
];

/// What is wrong, and in which line.
pub(super) type LineFault = (usize, GrfFault);

/// The lines of a file, each with a known key.
pub(super) struct OptionLines<'a> {
    lines: Vec<OptionLine<'a>>,
}

#[derive(Clone, Copy)]
pub(super) struct OptionLine<'a> {
    pub(super) number: usize,
    /// As [`KEYS`] writes it.
    key: &'static str,
    /// What its values are.
    kind: &'static str,
    value: &'a str,
}

impl<'a> OptionLine<'a> {
    pub(super) fn fault(&self, fix: impl Into<String>) -> LineFault {
        let shown: String = self.value.chars().take(40).collect();
        (self.number, (format!("{} {shown}", self.key), fix.into()))
    }

    fn misread(&self) -> LineFault {
        self.fault(format!("give {}", self.kind))
    }

    /// Exactly `N` finite numbers.
    pub(super) fn numbers<const N: usize>(&self) -> core::result::Result<[f64; N], LineFault> {
        let mut numbers = [0.0; N];
        let mut words = self.value.split_whitespace();
        for number in &mut numbers {
            let word: Option<f64> = words.next().and_then(|word| word.parse().ok());
            *number = word
                .filter(|x| x.is_finite())
                .ok_or_else(|| self.misread())?;
        }
        match words.next() {
            None => Ok(numbers),
            Some(_) => Err(self.misread()),
        }
    }

    /// Exactly `N` whole numbers from 1 to `most`.
    pub(super) fn counts<const N: usize>(
        &self,
        most: u64,
    ) -> core::result::Result<[u64; N], LineFault> {
        let mut counts = [0; N];
        for (count, number) in counts.iter_mut().zip(self.numbers::<N>()?) {
            if number.fract() != 0.0 || !(1.0..=most as f64).contains(&number) {
                return Err(self.fault(format!("give {} from 1 to {most}", self.kind)));
            }
            *count = number as u64;
        }
        Ok(counts)
    }

    pub(super) fn flag(&self) -> core::result::Result<bool, LineFault> {
        match self.value.to_ascii_lowercase().as_str() {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(self.misread()),
        }
    }

    pub(super) fn words(&self) -> core::result::Result<&'a str, LineFault> {
        match self.value.is_empty() {
            false => Ok(self.value),
            true => Err(self.misread()),
        }
    }
}

impl<'a> OptionLines<'a> {
    pub(super) fn parse(name: &str, text: &'a str) -> Result<Self> {
        let mut lines: Vec<OptionLine<'a>> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let line = line.split("//").next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            let (word, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let known = KEYS.iter().find(|(key, _)| key.eq_ignore_ascii_case(word));
            let Some((key, kind)) = known else {
                let shown: String = word.chars().take(40).collect();
                let keys: Vec<String> = KEYS.iter().map(|(key, _)| (*key).to_owned()).collect();
                let fix = suggest(
                    &shown.to_ascii_uppercase(),
                    &keys,
                    "docs/grf.md lists the keys",
                );
                let what = format!("there is no key {shown}");
                return Err(fault_in_line(name, i + 1, &what, &fix));
            };
            if lines.iter().any(|before| before.key == *key) {
                let what = format!("{key} is given twice");
                return Err(fault_in_line(name, i + 1, &what, "give it once"));
            }
            lines.push(OptionLine {
                number: i + 1,
                key,
                kind,
                value: value.trim(),
            });
        }
        Ok(Self { lines })
    }

    pub(super) fn find(&self, key: &str) -> Option<&OptionLine<'a>> {
        self.lines.iter().find(|line| line.key == key)
    }

    /// A flag; false where it is not given.
    pub(super) fn flag(&self, key: &str) -> core::result::Result<bool, LineFault> {
        self.find(key).map_or(Ok(false), OptionLine::flag)
    }

    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
    ) -> core::result::Result<Option<[f64; N]>, LineFault> {
        self.find(key).map(OptionLine::numbers).transpose()
    }

    /// Counts, or what they are where nothing is said.
    pub(super) fn counts_or<const N: usize>(
        &self,
        key: &str,
        default: [u64; N],
    ) -> core::result::Result<[u64; N], LineFault> {
        let given = self.find(key).map(|line| line.counts(MOST_COUNT));
        given.unwrap_or(Ok(default))
    }
}
