//! `.bsdf` files: measured materials as Mitsuba 3 and pbrt-v4 read them (Dupuy & Jakob 2018, the RGL database).
//!
//! A file tabulates f_r·cosθᵢ for some given directions over a square of half vectors, and a density to draw half vectors by.
//! It is evaluated and sampled as it is, isotropic or not.

mod brdf;
mod coordinates;
mod file;
mod sampler;
mod spectrum;
mod tabulate;
mod tensors;
mod warp;

use std::sync::Arc;

pub use brdf::RglBrdf;
pub(super) use file::VISIBLE;
pub use file::{BsdfFile, Colour};
pub(super) use spectrum::colour_weights;
pub use tabulate::{BsdfSize, tabulate};
pub(super) use tensors::{F32, FieldList, U16};
pub use tensors::{Tensor, looks_like_bsdf};

use super::format::{MaterialFormat, Origin, TableReading};
use super::{Loaded, MaterialFacts};
use crate::Result;

/// Files that begin as a `.bsdf` file does.
pub(super) struct RglFormat;

impl MaterialFormat for RglFormat {
    fn recognises(&self, origin: &Origin) -> bool {
        matches!(origin, Origin::File(path) if looks_like_bsdf(path))
    }

    fn facts(&self, origin: &Origin) -> Result<MaterialFacts> {
        Ok(MaterialFacts {
            symmetry: BsdfFile::open(origin.path())?.symmetry(),
            has_table: false,
            has_own_sampler: true,
            has_mirror: false,
        })
    }

    fn load(&self, origin: &Origin, _: TableReading) -> Result<Loaded> {
        let file = BsdfFile::open(origin.path())?;
        let notes = file.notes.clone();
        let rgl = Arc::new(RglBrdf::new(file));
        Ok(Loaded::from_brdf(rgl.clone())
            .with_bytes(rgl.table_bytes())
            .with_own_sampler(rgl)
            .with_notes(notes)
            .with_reading("values of the file"))
    }
}
