//! Reads answers as a page does.

use std::collections::BTreeMap;

use merlkit::{LookupRule, Material};
use merlkit_explore::Session;
use serde_json::Value;

/// An answer with arrays: its JSON, and the words of each array by its name.
pub struct Arrays {
    pub members: Value,
    words: BTreeMap<String, Vec<u32>>,
}

impl Arrays {
    /// Reads an answer, whose arrays must fill it exactly.
    pub fn read(bytes: &[u8]) -> Self {
        assert_eq!(&bytes[..8], b"MKXPLOR1");
        let length = u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize;
        let members: Value = serde_json::from_slice(&bytes[12..12 + length]).unwrap();
        let mut words = BTreeMap::new();
        let mut offset = 12 + length;
        for array in members["arrays"].as_array().unwrap() {
            assert!(offset.is_multiple_of(8));
            let shape = array["shape"].as_array().unwrap();
            let mut count = 1;
            for side in shape {
                count *= side.as_u64().unwrap() as usize;
            }
            let size = if array["type"] == "u16" { 2 } else { 4 };
            let mut read = Vec::with_capacity(count);
            for word in bytes[offset..offset + size * count].chunks_exact(size) {
                let mut four = [0; 4];
                four[..size].copy_from_slice(word);
                read.push(u32::from_le_bytes(four));
            }
            words.insert(array["name"].as_str().unwrap().to_owned(), read);
            offset = (offset + size * count).next_multiple_of(8);
        }
        assert_eq!(offset, bytes.len());
        Self { members, words }
    }

    /// The bits of an array.
    pub fn bits(&self, name: &str) -> &[u32] {
        &self.words[name]
    }

    /// An array of f32.
    pub fn floats(&self, name: &str) -> Vec<f32> {
        self.bits(name).iter().map(|&b| f32::from_bits(b)).collect()
    }
}

/// A session of materials by their arguments.
pub fn session(arguments: &[&str]) -> Session {
    let mut materials = Vec::new();
    for argument in arguments {
        materials.push(Material::resolve(argument).unwrap());
    }
    Session::new(&materials, LookupRule::Floor).unwrap()
}

/// The arrays of a key.
pub fn ask(session: &Session, key: &str) -> Arrays {
    match session.answer(key) {
        Ok(answer) => Arrays::read(&answer.bytes),
        Err(refusal) => panic!("{key}: {refusal}"),
    }
}

/// The JSON of a key.
pub fn ask_json(session: &Session, key: &str) -> Value {
    match session.answer(key) {
        Ok(answer) => serde_json::from_slice(&answer.bytes).unwrap(),
        Err(refusal) => panic!("{key}: {refusal}"),
    }
}
