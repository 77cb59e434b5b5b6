//! BRDFs given by a formula.

mod lambert;

pub use lambert::Lambert;
