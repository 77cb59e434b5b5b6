//! The server: routes, bounds of what is worked on at once, and headers.

use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, Response, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::routing::{get, post};
use http_body_util::BodyExt;
use tokio::sync::{Semaphore, watch};

use crate::answer::Answer;
use crate::guard::Guard;
use crate::page::{INDEX, LIVE_POLICY, SCRIPT, STYLE};
use crate::refusal::Refusal;
use crate::session::Session;
use crate::upload::LARGEST_UPLOAD;

/// Answers that are computed at once.
const WORKERS: usize = 4;
/// Requests that are worked on or wait; further ones are refused.
const QUEUE: usize = 64;
/// A file must have arrived after this long.
const UPLOAD_TIME: Duration = Duration::from_secs(60);
/// Answers under way may take this long to finish once the server is to stop.
const GRACE: Duration = Duration::from_secs(2);

/// What every request needs.
struct Shared {
    session: Arc<Session>,
    guard: Guard,
    queue: Semaphore,
    workers: Semaphore,
    uploads: Semaphore,
}

/// All routes behind the guard; requests can be sent to it without a socket.
pub fn router(session: Arc<Session>, guard: Guard) -> Router {
    let shared = Arc::new(Shared {
        session,
        guard,
        queue: Semaphore::new(QUEUE),
        workers: Semaphore::new(WORKERS),
        uploads: Semaphore::new(1),
    });
    Router::new()
        .route("/", get(index))
        .route("/explore.js", get(script))
        .route("/explore.css", get(style))
        .route("/api/v1/materials", get(answer_key).post(receive_file))
        .route("/api/v1/meshes", post(receive_mesh))
        .route("/api/v1/{*rest}", get(answer_key))
        .fallback(nothing_here)
        .layer(from_fn_with_state(shared.clone(), guard_request))
        .with_state(shared)
}

async fn index() -> Response<Body> {
    respond(200, "text/html; charset=utf-8", INDEX)
}

async fn script() -> Response<Body> {
    respond(200, "text/javascript; charset=utf-8", SCRIPT)
}

async fn style() -> Response<Body> {
    respond(200, "text/css; charset=utf-8", STYLE)
}

async fn nothing_here() -> Response<Body> {
    refuse(Refusal::new(404, "there is nothing here"))
}

/// Lets requests through that the guard allows, and adds the headers that every answer has.
async fn guard_request(
    State(shared): State<Arc<Shared>>,
    request: Request,
    next: Next,
) -> Response<Body> {
    let mut response = match check(&shared.guard, &request) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refuse(refusal),
    };
    for (name, value) in [
        ("content-security-policy", LIVE_POLICY),
        ("x-content-type-options", "nosniff"),
        ("x-frame-options", "DENY"),
        ("referrer-policy", "no-referrer"),
        ("cross-origin-opener-policy", "same-origin"),
        ("cross-origin-resource-policy", "same-origin"),
        ("cache-control", "no-store"),
    ] {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

/// The host and the origin of every request, and the token of those that ask for data.
fn check(guard: &Guard, request: &Request) -> Result<(), Refusal> {
    guard.check_source(request.uri(), request.headers())?;
    match request.uri().path() {
        "/" | "/explore.js" | "/explore.css" => Ok(()),
        _ => guard.check_token(request.headers()),
    }
}

/// Computes the answer of a key on a thread for long work.
async fn answer_key(State(shared): State<Arc<Shared>>, request: Request) -> Response<Body> {
    let uri = request.uri();
    let key = uri.path_and_query().map_or("", |key| key.as_str());
    let key = key.trim_start_matches('/').to_owned();
    respond_with(work(&shared, move |session| session.answer(&key)).await)
}

/// Receives a file and registers it as a material.
async fn receive_file(State(shared): State<Arc<Shared>>, request: Request) -> Response<Body> {
    receive(&shared, request, Session::answer_upload).await
}

/// Receives a file and registers it as a mesh.
async fn receive_mesh(State(shared): State<Arc<Shared>>, request: Request) -> Response<Body> {
    receive(&shared, request, Session::answer_mesh_upload).await
}

/// Receives a file piece by piece, and answers with what is made of it and of the query.
async fn receive(
    shared: &Shared,
    request: Request,
    answer: fn(&Session, &str, &[u8]) -> Result<Answer, Refusal>,
) -> Response<Body> {
    let query = request.uri().query().unwrap_or("").to_owned();
    let Ok(_turn) = shared.uploads.try_acquire() else {
        let message = "another file is being sent; wait for its end";
        return refuse(Refusal::new(503, message));
    };
    let receiving = tokio::time::timeout(UPLOAD_TIME, collect_body(request));
    let bytes = match receiving.await {
        Ok(Ok(bytes)) => bytes,
        Ok(Err(refusal)) => return refuse(refusal),
        Err(_) => return refuse(Refusal::new(408, "the file took too long to arrive")),
    };
    let answering = work(shared, move |session| answer(session, &query, &bytes));
    respond_with(answering.await)
}

/// The body of a request, which is refused as soon as it is too long.
async fn collect_body(request: Request) -> Result<Vec<u8>, Refusal> {
    let announced = request.headers().get(header::CONTENT_LENGTH);
    let announced = announced.and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > LARGEST_UPLOAD as u64) {
        return Err(too_large());
    }
    let mut body = request.into_body();
    let mut bytes = Vec::new();
    while let Some(frame) = body.frame().await {
        let frame = frame.map_err(|e| Refusal::new(400, format!("the file is cut off: {e}")))?;
        let Some(piece) = frame.data_ref() else {
            continue;
        };
        if bytes.len() + piece.len() > LARGEST_UPLOAD {
            return Err(too_large());
        }
        bytes.extend_from_slice(piece);
    }
    Ok(bytes)
}

fn too_large() -> Refusal {
    let message = format!("the file has more than {LARGEST_UPLOAD} bytes");
    Refusal::new(413, message)
}

/// Runs `job` on a thread for long work, when its turn comes.
async fn work(
    shared: &Shared,
    job: impl FnOnce(&Session) -> Result<Answer, Refusal> + Send + 'static,
) -> Result<Answer, Refusal> {
    let Ok(_place) = shared.queue.try_acquire() else {
        let message = format!("{QUEUE} requests are being worked on; ask again later");
        return Err(Refusal::new(503, message));
    };
    let Ok(_worker) = shared.workers.acquire().await else {
        return Err(Refusal::new(503, "the server stops"));
    };
    let session = shared.session.clone();
    match tokio::task::spawn_blocking(move || job(&session)).await {
        Ok(answer) => answer,
        Err(_) => {
            let message = "the answer could not be computed; report this";
            Err(Refusal::new(500, message))
        }
    }
}

fn respond_with(answer: Result<Answer, Refusal>) -> Response<Body> {
    match answer {
        Ok(answer) => {
            let media_type = answer.kind.media_type();
            respond(200, media_type, answer.bytes.to_vec())
        }
        Err(refusal) => refuse(refusal),
    }
}

fn refuse(refusal: Refusal) -> Response<Body> {
    let text = format!("{}\n", refusal.message);
    respond(refusal.status, "text/plain; charset=utf-8", text)
}

fn respond(status: u16, media_type: &'static str, body: impl Into<Body>) -> Response<Body> {
    let mut response = Response::new(body.into());
    let internal = StatusCode::INTERNAL_SERVER_ERROR;
    *response.status_mut() = StatusCode::from_u16(status).unwrap_or(internal);
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    response
}

/// Ends a running [`Explorer`] from another thread.
#[derive(Clone)]
pub struct Stopper(Arc<watch::Sender<bool>>);

impl Stopper {
    /// Answers under way may still finish, within two seconds.
    pub fn stop(&self) {
        self.0.send_replace(true);
    }

    async fn wait(self) {
        // The sender is part of this, so that there is always something to wait for.
        let _ = self.0.subscribe().wait_for(|stopped| *stopped).await;
    }
}

/// A server on a port of this machine that no other machine reaches.
pub struct Explorer {
    listener: TcpListener,
    guard: Guard,
    session: Arc<Session>,
    stopper: Stopper,
}

impl Explorer {
    /// Takes `port` of 127.0.0.1, or any free one if it is 0.
    ///
    /// # Errors
    /// [`merlkit::Error::Argument`] if the port is taken.
    pub fn bind(session: Session, port: u16) -> merlkit::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|e| {
            merlkit::Error::argument(
                format!("cannot listen on port {port} of 127.0.0.1: {e}"),
                "choose another port, or --port 0 for any",
            )
        })?;
        let address = listener.local_addr().map_err(network_error)?;
        Ok(Self {
            listener,
            guard: Guard::new(address.port())?,
            session: Arc::new(session),
            stopper: Stopper(Arc::new(watch::Sender::new(false))),
        })
    }

    /// The page's address with its token.
    pub fn address(&self) -> String {
        self.guard.address()
    }

    /// What ends [`Self::run`].
    pub fn stopper(&self) -> Stopper {
        self.stopper.clone()
    }

    /// Serves until it is stopped.
    ///
    /// # Errors
    /// Those of the network.
    pub fn run(self) -> merlkit::Result<()> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .max_blocking_threads(2 * WORKERS)
            .enable_all()
            .build()
            .map_err(network_error)?;
        let session = self.session.clone();
        let outcome = runtime.block_on(self.serve());
        // Work that nobody waits for any more ends with the process. It may hold the session, so that the files go here.
        runtime.shutdown_background();
        session.uploads.remove();
        outcome
    }

    async fn serve(self) -> merlkit::Result<()> {
        self.listener.set_nonblocking(true).map_err(network_error)?;
        let listener = tokio::net::TcpListener::from_std(self.listener).map_err(network_error)?;
        // The browser takes longer to start than the table of the first view to load.
        let session = self.session.clone();
        tokio::task::spawn_blocking(move || session.prepare_first_view());
        let serving = axum::serve(listener, router(self.session, self.guard))
            .with_graceful_shutdown(self.stopper.clone().wait());
        tokio::select! {
            outcome = serving.into_future() => outcome.map_err(network_error),
            () = end_of_grace(self.stopper) => Ok(()),
        }
    }
}

/// The moment at which nobody waits for answers under way any more.
async fn end_of_grace(stopper: Stopper) {
    stopper.wait().await;
    tokio::time::sleep(GRACE).await;
}

fn network_error(error: std::io::Error) -> merlkit::Error {
    merlkit::Error::io(Path::new("127.0.0.1"), "serve the page on", error)
}

/// Opens an address in the system's browser, and doesn't wait for it.
///
/// # Errors
/// [`merlkit::Error::Argument`] if there is none.
pub fn open_in_browser(address: &str) -> merlkit::Result<()> {
    open::that_detached(address).map_err(|e| {
        merlkit::Error::argument(
            format!("no browser opens: {e}"),
            "open the address yourself, and pass --no-open",
        )
    })
}
