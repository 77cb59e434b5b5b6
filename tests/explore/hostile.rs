//! Requests that nobody means well with: each has an answer, none has a panic, and none takes long.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderName, HeaderValue, Method, Request, StatusCode, Uri};
use merlkit::points::Stream;
use merlkit_explore::{Guard, router};
use tower::ServiceExt;

use crate::read::session;

/// The port that hosts and origins are checked against; nothing listens there.
const PORT: u16 = 7777;

/// Requests that are well formed.
const KEYS: [&str; 18] = [
    "/api/v1/materials",
    "/api/v1/table?material=0",
    "/api/v1/runtime?material=0",
    "/api/v1/lobe?material=0&theta=45&phi=0&rows=9&columns=12",
    "/api/v1/albedo?material=0&theta=45&phi=10",
    "/api/v1/draws?material=0&sampler=cosine&theta=45&phi=0&count=16&seed=1",
    "/api/v1/draws?material=1&sampler=lobe%3Acosine&theta=45&phi=0&count=16&seed=1",
    "/api/v1/draws?material=0&sampler=half-vector%3Atables%3D2,rows%3D4&theta=5&phi=0&count=16&seed=1",
    "/api/v1/environment?name=uniform",
    "/api/v1/environment-draws?name=uniform&material=0&strategy=ris&theta=45&phi=0&keep=16&candidates=4&seed=1",
    "/api/v1/formula?text=lambert%3Areflectance%3D0.5",
    "/api/v1/mesh?mesh=0",
    "/api/v1/meshes?name=a.obj",
    "/api/v1/grid?material=0",
    "/api/v1/slice?material=1&phi_h=10&phi_d=20",
    "/api/v1/fit?material=9&model=ggx",
    "/",
    "/explore.js",
];

/// What is put into requests.
const PIECES: [&str; 24] = [
    "..%2F..%2Fetc%2Fpasswd",
    "%00",
    "%",
    "%FF%FE",
    "&",
    "?",
    "#",
    "=",
    "/",
    "//",
    "NaN",
    "inf",
    "-1",
    "1e999",
    "99999999999999999999",
    "0x10",
    "+",
    "%2B",
    "material=1",
    "&theta=90",
    "\u{fc}",
    "a,b:c",
    "%0d%0aSet-Cookie:a",
    ";",
];

/// A router with two formulas, and its token.
fn server() -> (Router, String) {
    let session = session(&["lambert:reflectance=0.5", "phong"]);
    let guard = Guard::new(PORT).unwrap();
    let token = guard.token().to_owned();
    (router(Arc::new(session), guard), token)
}

fn runtime() -> tokio::runtime::Runtime {
    let mut builder = tokio::runtime::Builder::new_multi_thread();
    builder.worker_threads(1).enable_all().build().unwrap()
}

/// A request with all that the guard asks for.
fn allowed(method: Method, uri: Uri, token: &str, body: Body) -> Request<Body> {
    let mut request = Request::new(body);
    *request.method_mut() = method;
    *request.uri_mut() = uri;
    let host = HeaderValue::from_str(&format!("127.0.0.1:{PORT}")).unwrap();
    request.headers_mut().insert("host", host);
    let token = HeaderValue::from_str(token).unwrap();
    request.headers_mut().insert("x-merlkit-token", token);
    request
}

/// The status of a request, which must come within 30 seconds.
async fn status(router: &Router, request: Request<Body>) -> StatusCode {
    let shown = format!("{} {}", request.method(), request.uri());
    let answering = tokio::time::timeout(Duration::from_secs(30), router.clone().oneshot(request));
    match answering.await {
        Ok(Ok(response)) => response.status(),
        Ok(Err(never)) => match never {},
        Err(_) => panic!("{shown} hangs"),
    }
}

/// A number below `end`.
fn below(random: &mut Stream, end: usize) -> usize {
    (random.next_u64() % end as u64) as usize
}

/// Changes a request's address at one to three places.
fn mutate(random: &mut Stream, text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=below(random, 3) {
        let position = below(random, bytes.len() + 1);
        match below(random, 4) {
            0 if position < bytes.len() => bytes[position] = random.next_u64() as u8,
            1 => bytes.truncate(position.max(1)),
            2 if position < bytes.len() => _ = bytes.remove(position),
            _ => {
                let piece = PIECES[below(random, PIECES.len())];
                bytes.splice(position..position, piece.bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A mutated request; `None` for an address that no HTTP request can have.
fn mutated_request(random: &mut Stream, token: &str) -> Option<Request<Body>> {
    let key = KEYS[below(random, KEYS.len())];
    let text = mutate(random, key);
    let uri: Uri = text.parse().ok()?;
    let method = match below(random, 12) {
        0 => Method::POST,
        1 => Method::HEAD,
        2 => Method::DELETE,
        3 => Method::OPTIONS,
        _ => Method::GET,
    };
    let body: Vec<u8> = (0..below(random, 200))
        .map(|_| random.next_u64() as u8)
        .collect();
    let mut request = allowed(method, uri, token, Body::from(body));
    if below(random, 8) == 0 {
        let name = [
            "host",
            "origin",
            "x-merlkit-token",
            "content-length",
            "sec-fetch-site",
        ][below(random, 5)];
        let value = mutate(random, &format!("127.0.0.1:{PORT}"));
        let value = HeaderValue::from_bytes(value.as_bytes()).ok()?;
        request
            .headers_mut()
            .append(HeaderName::from_static(name), value);
    }
    Some(request)
}

#[test]
fn mutated_requests_have_answers() {
    let (router, token) = server();
    let mut random = Stream::new(20);
    let mut counts = std::collections::BTreeMap::new();
    runtime().block_on(async {
        let begun = Instant::now();
        let mut sent = 0;
        while sent < 3000 {
            let Some(request) = mutated_request(&mut random, &token) else {
                continue;
            };
            let shown = format!("{} {}", request.method(), request.uri());
            let status = status(&router, request).await;
            assert_ne!(status, StatusCode::INTERNAL_SERVER_ERROR, "{shown}");
            *counts.entry(status.as_u16()).or_insert(0) += 1;
            sent += 1;
        }
        assert!(begun.elapsed() < Duration::from_secs(300));
    });
    // The mutations reach behind the guard and the parser, and both refuse.
    for status in [200, 400, 403, 404, 405] {
        assert!(counts.get(&status).is_some_and(|&n| n > 20), "{counts:?}");
    }
}

#[test]
fn files_are_refused_while_they_arrive() {
    let (router, token) = server();
    let uri = Uri::from_static("/api/v1/materials?name=a.binary");
    let endless = futures_util::stream::repeat_with(|| Ok::<_, std::io::Error>(vec![0u8; 1 << 20]));
    runtime().block_on(async {
        let request = allowed(
            Method::POST,
            uri.clone(),
            &token,
            Body::from_stream(endless),
        );
        assert_eq!(status(&router, request).await, 413);
        let mut request = allowed(Method::POST, uri.clone(), &token, Body::empty());
        let length = HeaderValue::from_static("64000001");
        request.headers_mut().insert("content-length", length);
        assert_eq!(status(&router, request).await, 413);
        // MERL's dimensions without the cells, a tensor file that ends, and a fit, which names formulas.
        let mut merl = Vec::new();
        for side in [90i32, 90, 180] {
            merl.extend(side.to_le_bytes());
        }
        let bsdf = b"tensor_file\0\x01\0\xff\xff\xff\xff".to_vec();
        let fit = b"{\"merlkit\": \"0\", \"kind\": \"fit\"}".to_vec();
        let endless = futures_util::stream::repeat_with(|| {
            Ok::<_, std::io::Error>(b"v 0 0 0\n".repeat(1 << 17))
        });
        let meshes = Uri::from_static("/api/v1/meshes?name=a.obj");
        let request = allowed(Method::POST, meshes, &token, Body::from_stream(endless));
        assert_eq!(status(&router, request).await, 413);
        for bytes in [merl, bsdf, fit, Vec::new()] {
            let request = allowed(Method::POST, uri.clone(), &token, Body::from(bytes));
            assert_eq!(status(&router, request).await, 400);
        }
    });
}

#[test]
fn costly_requests_are_refused() {
    let (router, token) = server();
    runtime().block_on(async {
        for key in [
            "draws?material=0&sampler=cosine&theta=45&phi=0&count=1000001&seed=1",
            "draws?material=0&sampler=cosine&theta=90&phi=0&count=1&seed=1",
            "draws?material=0&sampler=half-vector%3Atables%3D1024&theta=45&phi=0&count=1&seed=1",
            "draws?material=0&sampler=adaptive-disc%3An-max%3D1.000001&theta=45&phi=0&count=1&seed=1",
            "lobe?material=0&theta=45&phi=0&rows=4096&columns=4096",
            "lobe?material=0&theta=45&phi=0&rows=0&columns=4",
            "slice?material=0&phi_h=nan&phi_d=0",
            "slice?material=0&phi_h=0&phi_d=361",
            "mesh?mesh=-1",
            "disc?material=0&theta=45&n_max=1.0000001",
            "environment-draws?name=uniform&material=0&strategy=ris&theta=45&phi=0&keep=16&candidates=65&seed=1",
            "fit?material=0&model=ggx%2Bggx%2Bggx%2Bggx%2Bggx",
        ] {
            let uri: Uri = format!("/api/v1/{key}").parse().unwrap();
            let request = allowed(Method::GET, uri, &token, Body::empty());
            assert_eq!(status(&router, request).await, 400, "{key}");
        }
        let long = format!("/api/v1/formula?text={}", "a".repeat(5000));
        let request = allowed(Method::GET, long.parse().unwrap(), &token, Body::empty());
        assert_eq!(status(&router, request).await, 400);
    });
}
