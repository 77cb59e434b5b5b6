//! Scenes in GRF, the format of the thesis's renderer (its appendix A). docs/grf.md has the grammar and what was chosen where the
//! thesis leaves it open.

mod attributes;
mod blocks;
mod convert;
mod meshes;
mod option_lines;
mod options;
mod scope;
mod selection;
mod tokens;
mod tree;
mod values;
mod words;

pub(crate) use convert::read_grf;
pub use options::OptionFile;
