//! Who may ask: the page that was opened with the token, on this machine, and no other page or program.

use axum::http::{HeaderMap, HeaderName, Uri, header};
use subtle::ConstantTimeEq;

use crate::refusal::Refusal;

/// The header with the token.
const TOKEN: HeaderName = HeaderName::from_static("x-merlkit-token");
/// What browsers say of the page that a request comes from.
const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
/// Random bytes of a token.
const TOKEN_BYTES: usize = 32;

/// Knows the server's port and token.
#[derive(Clone)]
pub struct Guard {
    /// `127.0.0.1:PORT` and `localhost:PORT`.
    hosts: [String; 2],
    token: String,
}

impl Guard {
    /// A guard for a server on `port`, with a token that the system draws.
    ///
    /// # Errors
    /// [`merlkit::Error::Argument`] if the system has no random numbers.
    pub fn new(port: u16) -> merlkit::Result<Self> {
        let mut random = [0u8; TOKEN_BYTES];
        getrandom::fill(&mut random).map_err(|e| {
            merlkit::Error::argument(
                format!("the system gives no random numbers for a token: {e}"),
                "write the page to a file with --export",
            )
        })?;
        let token = random.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self {
            hosts: ["127.0.0.1", "localhost"].map(|host| format!("{host}:{port}")),
            token,
        })
    }

    /// The token, in hexadecimal.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// The page's address. The token lies behind `#`, which browsers send to nobody.
    pub fn address(&self) -> String {
        format!("http://{}/#token={}", self.hosts[0], self.token)
    }

    /// Refuses requests that name another host, as those of a name that was pointed at this machine do, and those of other pages.
    ///
    /// # Errors
    /// A [`Refusal`] of status 403.
    pub(crate) fn check_source(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let mut hosts = headers.get_all(header::HOST).iter();
        let host = hosts.next().and_then(|host| host.to_str().ok());
        if hosts.next().is_some() || !host.is_some_and(|host| self.is_own_host(host)) {
            return Err(forbid("the request names another host"));
        }
        if let Some(authority) = uri.authority()
            && !self.is_own_host(authority.as_str())
        {
            return Err(forbid("the request's address names another host"));
        }
        for origin in headers.get_all(header::ORIGIN) {
            let origin = origin.to_str().ok();
            let host = origin.and_then(|origin| origin.strip_prefix("http://"));
            if !host.is_some_and(|host| self.is_own_host(host)) {
                return Err(forbid("the request comes from another page"));
            }
        }
        for site in headers.get_all(FETCH_SITE) {
            if site != "same-origin" && site != "none" {
                return Err(forbid("the request comes from another page"));
            }
        }
        Ok(())
    }

    fn is_own_host(&self, host: &str) -> bool {
        self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host))
    }

    /// Refuses requests without the token, in a time that doesn't depend on where it differs.
    ///
    /// # Errors
    /// A [`Refusal`] of status 403.
    pub(crate) fn check_token(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let mut tokens = headers.get_all(TOKEN).iter();
        let given = tokens.next().map(|token| token.as_bytes());
        let given = given.unwrap_or_default();
        let is_equal = bool::from(given.ct_eq(self.token.as_bytes()));
        if is_equal && tokens.next().is_none() {
            return Ok(());
        }
        Err(forbid(
            "the token is missing or wrong; open the address that merlkit explore printed",
        ))
    }
}

fn forbid(message: &str) -> Refusal {
    Refusal::new(403, message)
}
