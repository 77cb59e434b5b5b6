//! The page itself, which is part of the program.

/// The page with an address for its script and one for its style.
pub(crate) const INDEX: &str = include_str!("../page/index.html");
/// The script.
pub(crate) const SCRIPT: &str = include_str!("../page/dist/explore.js");
/// The style.
pub(crate) const STYLE: &str = include_str!("../page/dist/explore.css");

/// What the page is allowed to do while it is served: its own script and style, and requests to this server.
pub(crate) const LIVE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
