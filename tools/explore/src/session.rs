//! What all requests have in common: the materials, and what was loaded, built and answered so far, within bounds of memory.

use std::sync::Arc;

use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::{Sampler, SamplerSpec};
use quick_cache::Weighter;
use quick_cache::sync::Cache;

use crate::answer::Answer;
use crate::meshes::Meshes;
use crate::refusal::Refusal;
use crate::registry::{Registered, Registry};
use crate::upload::Uploads;

/// Bytes of the tables of loaded materials that are kept.
const LOADED_BYTES: u64 = 256 << 20;
/// Bytes of the tables of samplers that are kept.
const SAMPLER_BYTES: u64 = 256 << 20;
/// Bytes of answers that are kept.
const ANSWER_BYTES: u64 = 256 << 20;
/// What an entry takes apart from its tables.
const ENTRY_BYTES: u64 = 4096;
/// Few entries are expected, so that the caches are not cut into parts with a bound each.
const EXPECTED_ENTRIES: usize = 16;

/// Weights of what is kept, in bytes.
#[derive(Clone)]
pub(crate) struct ByteWeights;

impl Weighter<usize, Loaded> for ByteWeights {
    fn weight(&self, _: &usize, loaded: &Loaded) -> u64 {
        ENTRY_BYTES + loaded.bytes() as u64
    }
}

impl Weighter<(usize, String), Sampler> for ByteWeights {
    fn weight(&self, _: &(usize, String), sampler: &Sampler) -> u64 {
        ENTRY_BYTES + sampler.bytes() as u64
    }
}

impl Weighter<String, Answer> for ByteWeights {
    fn weight(&self, key: &String, answer: &Answer) -> u64 {
        ENTRY_BYTES + (key.len() + answer.bytes.len()) as u64
    }
}

/// The materials of a page, and what was computed for it. Requests on many threads use it at once, and what two of them ask for is
/// computed once.
pub struct Session {
    rule: LookupRule,
    pub(crate) registry: Registry,
    pub(crate) uploads: Uploads,
    pub(crate) meshes: Meshes,
    loaded: Cache<usize, Loaded, ByteWeights>,
    samplers: Cache<(usize, String), Sampler, ByteWeights>,
    pub(crate) answers: Cache<String, Answer, ByteWeights>,
}

impl Session {
    /// A session that shows `materials`, whose tables are looked up by `rule`. Their values are loaded when they are asked for.
    ///
    /// # Errors
    /// Those of [`Material::facts`].
    pub fn new(materials: &[Material], rule: LookupRule) -> merlkit::Result<Self> {
        let session = Self {
            rule,
            registry: Registry::default(),
            uploads: Uploads::default(),
            meshes: Meshes::default(),
            loaded: Cache::with_weighter(EXPECTED_ENTRIES, LOADED_BYTES, ByteWeights),
            samplers: Cache::with_weighter(EXPECTED_ENTRIES, SAMPLER_BYTES, ByteWeights),
            answers: Cache::with_weighter(EXPECTED_ENTRIES, ANSWER_BYTES, ByteWeights),
        };
        for material in materials {
            let registered = session
                .registry
                .register(material.name(), material.clone(), false);
            registered.map_err(|refusal| {
                merlkit::Error::argument(refusal.message, "leave the material out")
            })?;
        }
        Ok(session)
    }

    /// How tables are looked up.
    pub(crate) fn rule(&self) -> LookupRule {
        self.rule
    }

    /// The material of a number, loaded.
    pub(crate) fn load(&self, id: usize) -> Result<(Arc<Registered>, Loaded), Refusal> {
        let registered = self.registry.find(id)?;
        let loaded = self
            .loaded
            .get_or_insert_with(&id, || load_material(&registered, self.rule))?;
        Ok((registered, loaded))
    }

    /// A sampler of a material, built.
    pub(crate) fn build(&self, id: usize, spec: &SamplerSpec) -> Result<Sampler, Refusal> {
        let (_, loaded) = self.load(id)?;
        let key = (id, spec.to_string());
        let built = self
            .samplers
            .get_or_insert_with(&key, || spec.build(&loaded).map_err(Refusal::from))?;
        Ok(built)
    }
}

fn load_material(registered: &Registered, rule: LookupRule) -> Result<Loaded, Refusal> {
    let loaded = registered.material.load(rule)?;
    // Another thread may have noted the same before.
    let _ = registered.notes.set(loaded.notes().to_vec());
    Ok(loaded)
}
