//! MERL data (Matusik et al. 2003): files, the embedded materials and the decoded table.

mod brdf;
mod decode;
pub(super) mod embedded;
mod hard;
mod header;
mod import;
mod lookup;
mod table;
mod write;

pub use crate::geometry::merl_axes::{THETA_D_BINS, THETA_H_BINS};
pub use brdf::{LookupRule, MerlBrdf};
pub use decode::{decode_cells, load, load_mapped};
pub use embedded::{decode as decode_embedded, names as embedded_names};
pub use hard::HardCase;
pub use header::Header;

pub use import::{BinPoint, import_bsdf};
pub use lookup::BinIndex;
pub use table::{Census, MerlTable};
pub use write::write;

/// Factors from a file's raw values to f_r in sr⁻¹, for red, green and blue.
pub const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
