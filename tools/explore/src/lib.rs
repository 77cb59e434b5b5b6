//! The page of `merlkit explore`, which shows a BRDF and its samplers in a browser, and the server behind it.
//!
//! The page asks for *keys*: paths with a query, such as `api/v1/albedo?material=0&theta=45&phi=0`. [`Session::answer`] computes
//! the answer of a key. The [`Explorer`] serves keys to a browser on the same machine, and [`StoredPage`] writes a page that holds
//! the answers of a grid of keys itself.
//!
//! `docs/explore.md` describes the keys, the formats of the answers, and what keeps other pages and programs out.
#![deny(unsafe_code)]
#![warn(missing_docs)]
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::exit)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod affordable;
mod answer;
mod disc;
mod draws;
mod endpoints;
mod environment;
mod fit;
mod grid;
mod guard;
mod materials;
mod meshes;
mod page;
mod query;
mod refusal;
mod registry;
mod server;
mod session;
mod stored;
mod table;
mod upload;
mod values;

pub use answer::{Answer, ContentKind};
pub use guard::Guard;
pub use refusal::Refusal;
pub use server::{Explorer, Stopper, open_in_browser, router};
pub use session::Session;
pub use stored::StoredPage;
