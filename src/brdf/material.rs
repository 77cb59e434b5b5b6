//! The BRDF of any material that can be named.

use std::sync::Arc;

use super::{Brdf, LookupRule, Measured};
use crate::bsdf::Rgl;
use crate::merl::Content;

/// A material's BRDF, by what its source holds.
#[derive(Clone, Debug)]
pub enum MaterialBrdf {
    /// A table and its lookup rule: isotropic.
    Table(Arc<Measured>),
    /// An anisotropic `.bsdf` file as it is.
    File(Arc<Rgl>),
}

impl MaterialBrdf {
    /// Reads a table by `rule`; a file has no use for it.
    pub fn new(content: Content, rule: LookupRule) -> Self {
        match content {
            Content::Table(table) => Self::Table(Arc::new(Measured::new(Arc::new(table), rule))),
            Content::File(rgl) => Self::File(Arc::from(rgl)),
        }
    }

    /// Behind the common interface.
    pub fn as_dyn(&self) -> &dyn Brdf {
        match self {
            Self::Table(brdf) => &**brdf,
            Self::File(brdf) => &**brdf,
        }
    }

    /// Behind the common interface, shared.
    pub fn shared(&self) -> Arc<dyn Brdf> {
        match self {
            Self::Table(brdf) => brdf.clone(),
            Self::File(brdf) => brdf.clone(),
        }
    }

    /// The rule its table is looked up by; `None` without a table.
    pub fn rule(&self) -> Option<LookupRule> {
        match self {
            Self::Table(brdf) => Some(brdf.rule()),
            Self::File(_) => None,
        }
    }

    /// Bytes of its tables in memory, counted.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Table(brdf) => brdf.table().bytes(),
            Self::File(brdf) => brdf.table_bytes(),
        }
    }
}
