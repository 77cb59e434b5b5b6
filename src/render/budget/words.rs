//! Numbers as 64-bit words, for pictures that are stored unfinished: every bit comes back.

use glam::DVec3;

/// Collects words.
#[derive(Default)]
pub(super) struct WordWriter {
    bytes: Vec<u8>,
}

impl WordWriter {
    /// Room for `words` words is taken at once.
    pub(super) fn with_capacity(words: usize) -> Self {
        Self {
            bytes: Vec::with_capacity(8 * words),
        }
    }

    pub(super) fn count(&mut self, count: u64) {
        self.bytes.extend_from_slice(&count.to_le_bytes());
    }

    pub(super) fn number(&mut self, number: f64) {
        self.count(number.to_bits());
    }

    pub(super) fn vector(&mut self, vector: DVec3) {
        for number in vector.to_array() {
            self.number(number);
        }
    }

    /// The words, little-endian.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Gives the words back, in order; `None` after the last.
pub(super) struct WordReader<'a> {
    words: std::slice::Iter<'a, [u8; 8]>,
}

impl<'a> WordReader<'a> {
    /// Bytes that are no whole word at the end are left out.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            words: bytes.as_chunks::<8>().0.iter(),
        }
    }

    pub(super) fn count(&mut self) -> Option<u64> {
        self.words.next().map(|word| u64::from_le_bytes(*word))
    }

    /// A finite number; `None` for others too.
    pub(super) fn number(&mut self) -> Option<f64> {
        self.count()
            .map(f64::from_bits)
            .filter(|number| number.is_finite())
    }

    /// Three finite numbers.
    pub(super) fn vector(&mut self) -> Option<DVec3> {
        Some(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    /// Whether no word is left.
    pub(super) fn is_at_end(&self) -> bool {
        self.words.len() == 0
    }
}
