//! What a key is answered with: JSON, the bytes of a file, or a JSON header with arrays.
//!
//! Arrays are little-endian. Eight bytes `MKXPLOR1` come first, then the length of the JSON as u32, then the JSON itself with blanks
//! behind it, so that the arrays begin at a multiple of 8 bytes. Each array is filled up to such a multiple.

use std::sync::Arc;

use serde_json::{Map, Value, json};

use crate::refusal::Refusal;

/// The first bytes of an answer with arrays.
const MAGIC: &[u8; 8] = b"MKXPLOR1";
/// Arrays begin at multiples of this many bytes.
const ALIGNMENT: usize = 8;

/// How an answer's bytes are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContentKind {
    /// JSON.
    Json,
    /// A JSON header and arrays, or a file of the run-time format.
    Binary,
}

impl ContentKind {
    /// The media type of HTTP.
    pub fn media_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Binary => "application/octet-stream",
        }
    }
}

/// The answer of a key. Copies have the bytes in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What the bytes are.
    pub kind: ContentKind,
    /// The bytes.
    pub bytes: Arc<[u8]>,
}

impl Answer {
    /// JSON.
    pub(crate) fn json(value: &impl serde::Serialize) -> Result<Self, Refusal> {
        let bytes = serde_json::to_vec(value)
            .map_err(|e| Refusal::new(500, format!("the answer is no JSON: {e}")))?;
        Ok(Self {
            kind: ContentKind::Json,
            bytes: bytes.into(),
        })
    }

    /// The bytes of a file.
    pub(crate) fn file(bytes: Vec<u8>) -> Self {
        Self {
            kind: ContentKind::Binary,
            bytes: bytes.into(),
        }
    }
}

/// Arrays with a JSON header, which [`Self::finish`] puts together.
pub(crate) struct ArrayAnswer {
    members: Map<String, Value>,
    listed: Vec<Value>,
    body: Vec<u8>,
}

impl ArrayAnswer {
    /// An answer without arrays, whose JSON has `members`, which must be an object.
    pub fn new(members: Value) -> Self {
        let members = match members {
            Value::Object(members) => members,
            _ => Map::new(),
        };
        Self {
            members,
            listed: Vec::new(),
            body: Vec::new(),
        }
    }

    /// Adds an array of f32.
    pub fn push_f32(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        self.list(name, "f32", shape);
        self.body.reserve(4 * values.len() + ALIGNMENT);
        for value in values {
            self.body.extend(value.to_le_bytes());
        }
        fill_up(&mut self.body, 0);
    }

    /// Adds an array of u16.
    pub fn push_u16(&mut self, name: &str, shape: &[usize], values: &[u16]) {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        self.list(name, "u16", shape);
        self.body.reserve(2 * values.len() + ALIGNMENT);
        for value in values {
            self.body.extend(value.to_le_bytes());
        }
        fill_up(&mut self.body, 0);
    }

    /// Adds an array of u32.
    pub fn push_u32(&mut self, name: &str, shape: &[usize], values: &[u32]) {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        self.list(name, "u32", shape);
        self.body.reserve(4 * values.len() + ALIGNMENT);
        for value in values {
            self.body.extend(value.to_le_bytes());
        }
        fill_up(&mut self.body, 0);
    }

    fn list(&mut self, name: &str, kind: &str, shape: &[usize]) {
        let entry = json!({ "name": name, "type": kind, "shape": shape });
        self.listed.push(entry);
    }

    /// The header and all arrays.
    pub fn finish(mut self) -> Answer {
        self.members
            .insert("arrays".into(), Value::Array(self.listed));
        let mut text = Value::Object(self.members).to_string().into_bytes();
        // The JSON begins behind the magic number and its own length.
        while !(MAGIC.len() + 4 + text.len()).is_multiple_of(ALIGNMENT) {
            text.push(b' ');
        }
        let mut bytes = Vec::with_capacity(MAGIC.len() + 4 + text.len() + self.body.len());
        bytes.extend(MAGIC);
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text);
        bytes.extend(self.body);
        Answer {
            kind: ContentKind::Binary,
            bytes: bytes.into(),
        }
    }
}

/// Adds `filler` up to a multiple of [`ALIGNMENT`].
fn fill_up(bytes: &mut Vec<u8>, filler: u8) {
    let full = bytes.len().next_multiple_of(ALIGNMENT);
    bytes.resize(full, filler);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_array_begins_at_a_multiple_of_eight() {
        let mut answer = ArrayAnswer::new(json!({ "theta": 45.0 }));
        answer.push_f32("a", &[3], &[1.0, 2.0, 3.0]);
        answer.push_u32("b", &[1, 1], &[7]);
        let bytes = answer.finish().bytes;
        assert_eq!(&bytes[..8], MAGIC);
        let length = u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize;
        assert!((12 + length).is_multiple_of(8));
        let header: Value = serde_json::from_slice(&bytes[12..12 + length]).unwrap();
        assert_eq!(header["theta"], 45.0);
        assert_eq!(header["arrays"][1]["shape"], json!([1, 1]));
        let arrays = &bytes[12 + length..];
        assert_eq!(arrays.len(), 24);
        assert_eq!(arrays[4..8], 2f32.to_le_bytes());
        assert_eq!(arrays[16..20], 7u32.to_le_bytes());
    }
}
