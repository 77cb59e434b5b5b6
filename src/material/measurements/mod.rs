//! Measurements as people have them, lists of angles with values, grids of directions or arrays of numpy, and how they become MERL
//! tables.

mod array;
mod columns;
mod fill;
mod grid;
mod kind;
mod polarised;
mod scattered;
mod text;
mod utia;

pub use array::read_array;
pub use columns::AngleUnit;
pub use fill::fill_gaps;
pub use kind::MeasurementKind;
pub use scattered::Measurements;
