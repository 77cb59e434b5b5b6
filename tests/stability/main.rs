//! Ugly data and extreme directions: a right answer or a clear error.

mod crossing;
mod degenerate;
