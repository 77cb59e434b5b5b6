//! MERL data (Matusik et al. 2003): binary files, the embedded materials, the decoded table and its lookup rules.

mod brdf;
mod cell_format;
mod cells;
mod decode;
pub(super) mod embedded;
mod half_cells;
mod hard;
mod header;
mod import;
mod lookup;
mod shared_exponent_cells;
mod table;
mod write;

use std::sync::Arc;

pub use crate::geometry::merl_axes::{THETA_D_BINS, THETA_H_BINS};
pub use brdf::MerlBrdf;
pub use cell_format::{CellFormat, RoundingError};
use decode::{check_file, load_with_access};
pub use decode::{decode_cells, load};
pub use embedded::{decode as decode_embedded, names as embedded_names};
pub use hard::HardCase;
pub use header::{Header, SCALE};
pub use import::{BinPoint, reciprocal_mean, tabulate_brdf};
pub(super) use import::{bin_is_upper, pair_of_angles, tabulate_pairs};
pub use lookup::{BinIndex, LookupRule};
pub use table::{Census, MerlTable};
pub use write::write;

use super::format::{MaterialFormat, Origin, TableReading};
use super::{Loaded, MaterialFacts};
use crate::geometry::Symmetry;
use crate::{Error, Result};

/// What every table is.
const FACTS: MaterialFacts = MaterialFacts {
    symmetry: Symmetry::Isotropic,
    has_table: true,
    has_own_sampler: false,
    has_mirror: false,
};

/// MERL binaries, which begin with their dimensions and no magic number.
pub(super) struct MerlBinary;

impl MaterialFormat for MerlBinary {
    fn recognises(&self, origin: &Origin) -> bool {
        matches!(origin, Origin::File(_))
    }

    fn facts(&self, origin: &Origin) -> Result<MaterialFacts> {
        check_file(origin.path())?;
        Ok(FACTS)
    }

    fn load(&self, origin: &Origin, reading: TableReading) -> Result<Loaded> {
        let (table, access) = load_with_access(origin.path(), reading.channels_apart)?;
        Ok(read_as(table, reading)?.with_file_access(access))
    }
}

/// The materials that are compiled in.
pub(super) struct EmbeddedNetworks;

impl MaterialFormat for EmbeddedNetworks {
    fn recognises(&self, origin: &Origin) -> bool {
        matches!(origin, Origin::Embedded(_))
    }

    fn facts(&self, _: &Origin) -> Result<MaterialFacts> {
        Ok(FACTS)
    }

    fn load(&self, origin: &Origin, reading: TableReading) -> Result<Loaded> {
        let name = origin.path().to_string_lossy();
        match decode_embedded(&name) {
            Some(table) => read_as(table, reading),
            None => Err(Error::argument(
                format!("no built-in material is called \"{name}\""),
                "choose one of `merlkit list`",
            )),
        }
    }
}

fn read_as(table: MerlTable, reading: TableReading) -> Result<Loaded> {
    let table = Arc::new(table.with_cell_format(reading.cell_format)?);
    Ok(Loaded::from_table(Arc::new(MerlBrdf::new(
        table,
        reading.rule,
    ))))
}
