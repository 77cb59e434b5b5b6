//! The materials of a session. They are called by numbers; no request names a file.

use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use merlkit::material::analytic::ModelFacts;
use merlkit::material::{Material, MaterialFacts, Origin};

use crate::refusal::Refusal;

/// More materials are not registered.
const MOST_MATERIALS: usize = 4096;

/// A material and what is known of it without its values.
pub(crate) struct Registered {
    /// Its number.
    pub id: usize,
    /// Its name, for people.
    pub name: String,
    /// What it is loaded from.
    pub material: Material,
    /// What can be asked of it.
    pub facts: MaterialFacts,
    /// Whether a request brought it.
    pub uploaded: bool,
    /// What its users should know, once it is loaded.
    pub notes: OnceLock<Vec<String>>,
}

impl Registered {
    /// One word for where its values come from.
    pub fn kind(&self) -> &'static str {
        match self.material.origin() {
            Origin::Formula(_) => "formula",
            _ if self.facts.has_table => "merl",
            _ if self.facts.has_own_sampler => "rgl",
            _ => "fit",
        }
    }

    /// The name of a formula's model; `None` for a sum of formulas and for other materials.
    pub fn model(&self) -> Option<&'static str> {
        match self.material.origin() {
            Origin::Formula(text) => ModelFacts::parse(text).ok().map(|model| model.name),
            _ => None,
        }
    }

    /// What `merlkit` takes as MATERIAL for it; `None` for what a request brought, which has no path.
    pub fn text(&self) -> Option<String> {
        match self.material.origin() {
            _ if self.uploaded => None,
            Origin::Formula(text) | Origin::Embedded(text) => Some(text.clone()),
            Origin::File(path) => Some(path.display().to_string()),
        }
    }
}

/// All materials, in the order of their numbers. None is ever removed, so that a number means one material.
#[derive(Default)]
pub(crate) struct Registry(RwLock<Vec<Arc<Registered>>>);

impl Registry {
    /// Adds a material called `name`, or returns the one that is there already if it is no upload.
    pub fn register(
        &self,
        name: &str,
        material: Material,
        uploaded: bool,
    ) -> Result<Arc<Registered>, Refusal> {
        let facts = material.facts()?;
        let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = all.iter().find(|known| known.material == material) {
            return Ok(known.clone());
        }
        if all.len() >= MOST_MATERIALS {
            let message = format!("there are {MOST_MATERIALS} materials already; start again");
            return Err(Refusal::new(503, message));
        }
        let registered = Arc::new(Registered {
            id: all.len(),
            name: name.to_owned(),
            material,
            facts,
            uploaded,
            notes: OnceLock::new(),
        });
        all.push(registered.clone());
        Ok(registered)
    }

    /// The material of a number.
    pub fn find(&self, id: usize) -> Result<Arc<Registered>, Refusal> {
        let all = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let found = all.get(id).cloned();
        found.ok_or_else(|| Refusal::missing(format!("there is no material {id}")))
    }

    /// All of them.
    pub fn all(&self) -> Vec<Arc<Registered>> {
        let all = self.0.read().unwrap_or_else(PoisonError::into_inner);
        all.clone()
    }
}
