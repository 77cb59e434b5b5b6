//! A material in memory: what every command, sampler and renderer works on.

use std::fmt;
use std::sync::Arc;

use super::MaterialFacts;
use super::merl::{LookupRule, MerlBrdf};
use super::rgl::RglBrdf;
use crate::brdf::Brdf;
use crate::direction_sampler::DirectionSampler;
use crate::geometry::Symmetry;
use crate::{Error, Result};

/// A loaded material: its BRDF, and what only some kinds of material have.
#[derive(Clone)]
pub struct Loaded {
    brdf: Arc<dyn Brdf>,
    table: Option<Arc<MerlBrdf>>,
    own_sampler: Option<Arc<dyn DirectionSampler>>,
    bytes: usize,
}

impl Loaded {
    /// A MERL table with its lookup rule.
    pub fn from_table(measured: Arc<MerlBrdf>) -> Self {
        Self {
            bytes: measured.table().bytes(),
            brdf: measured.clone(),
            table: Some(measured),
            own_sampler: None,
        }
    }

    /// A `.bsdf` file, evaluated and sampled as it is.
    pub fn from_rgl(rgl: Arc<RglBrdf>) -> Self {
        Self {
            bytes: rgl.table_bytes(),
            brdf: rgl.clone(),
            table: None,
            own_sampler: Some(rgl),
        }
    }

    /// Any BRDF without tables.
    pub fn from_brdf(brdf: Arc<dyn Brdf>) -> Self {
        Self {
            brdf,
            table: None,
            own_sampler: None,
            bytes: 0,
        }
    }

    /// Its BRDF.
    pub fn brdf(&self) -> &Arc<dyn Brdf> {
        &self.brdf
    }

    /// Which azimuths of `wo` stand for all others.
    pub fn symmetry(&self) -> Symmetry {
        self.brdf.symmetry()
    }

    /// What it is, apart from its values.
    pub fn facts(&self) -> MaterialFacts {
        MaterialFacts {
            symmetry: self.symmetry(),
            has_table: self.table.is_some(),
            has_own_sampler: self.own_sampler.is_some(),
        }
    }

    /// The MERL table that it is, with its lookup rule; `None` for other kinds of material.
    pub fn table(&self) -> Option<&Arc<MerlBrdf>> {
        self.table.as_ref()
    }

    /// The MERL table, for `purpose`, which can't do without: "the adaptive disc".
    ///
    /// # Errors
    /// [`Error::Argument`] for a material that is no MERL table.
    pub fn require_table(&self, purpose: &str) -> Result<&Arc<MerlBrdf>> {
        self.table.as_ref().ok_or_else(|| {
            Error::argument(
                format!("{purpose} needs a MERL table, and this material is not one"),
                "name a MERL binary or an embedded material, or make a table with `merlkit import`",
            )
        })
    }

    /// The sampler that its source itself holds, if it does.
    pub fn own_sampler(&self) -> Option<&Arc<dyn DirectionSampler>> {
        self.own_sampler.as_ref()
    }

    /// The rule its table is looked up by; `None` without a table.
    pub fn rule(&self) -> Option<LookupRule> {
        self.table.as_ref().map(|table| table.rule())
    }

    /// Bytes of its tables in memory, counted.
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

impl fmt::Debug for Loaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Loaded")
            .field("table", &self.table.is_some())
            .field("own_sampler", &self.own_sampler.is_some())
            .field("bytes", &self.bytes)
            .finish_non_exhaustive()
    }
}
