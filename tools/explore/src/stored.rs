//! A page that holds its answers itself, in one file.

/// The keys that an exported page holds, and how it is written.
pub struct StoredPage;
