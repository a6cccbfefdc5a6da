//! The addresses of the server and their answers.

use std::io;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use axum::Router;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{WebSocket, WebSocketUpgrade};
use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use patchcord_compare::{Comparison, ComparisonOptions};
use patchcord_panel::pages::PAGES;
use patchcord_panel::patches::{DATA, PATCHES, gallery};
use patchcord_panel::{Session, SessionOptions};
use tokio::sync::OwnedSemaphorePermit;

use crate::headers::secure;
use crate::host::Host;
use crate::reasons::{stopped, too_many};
use crate::service::Purpose;
use crate::socket::{self, close};
use crate::worker::Worker;

/// The page at the address of the server.
const FIRST_PAGE: &str = "index.html";

/// The type of text without markup.
const PLAIN_TEXT: &str = "text/plain; charset=utf-8";

/// The type of documents.
const JSON: &str = "application/json";

/// The type of tables.
const CSV: &str = "text/csv; charset=utf-8";

/// The address of the folder of the shipped patches and their data, below that of the server.
const PATCH_FOLDER: &str = "patches/";

/// The document of the gallery, which reads every shipped patch once.
static GALLERY: LazyLock<String> = LazyLock::new(|| gallery().to_string());

/// All addresses.
pub(crate) fn router(host: Arc<Host>) -> Router {
    Router::new()
        .route("/host.json", get(host_document))
        .route("/gallery.json", get(gallery_document))
        .route("/patch", get(patch))
        .route(
            "/session",
            get(|state, upgrade, uri, headers| connect(Purpose::Session, state, upgrade, uri, headers)),
        )
        .route(
            "/compare",
            get(|state, upgrade, uri, headers| connect(Purpose::Comparison, state, upgrade, uri, headers)),
        )
        .fallback(page)
        .layer(middleware::from_fn_with_state(Arc::clone(&host), guard))
        .with_state(host)
}

/// Refuses requests that name another server, and adds headers to all responses.
async fn guard(State(host): State<Arc<Host>>, request: Request, next: Next) -> Response {
    let name = single(request.headers(), header::HOST).filter(|name| host.names.has(name));
    let name = name.map(str::to_owned);
    let mut response = match name {
        Some(_) => next.run(request).await,
        None => refusal(StatusCode::FORBIDDEN, "the header Host does not name this server"),
    };
    secure(response.headers_mut(), name.as_deref());
    response
}

/// The value of a header that is there once; otherwise `None`.
fn single(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    if values.next().is_some() { None } else { first.to_str().ok() }
}

/// A response that is a message.
fn refusal(status: StatusCode, message: &'static str) -> Response {
    (status, [(header::CONTENT_TYPE, PLAIN_TEXT)], message).into_response()
}

/// The response to a request without the token.
fn refusal_without_token() -> Response {
    let message = "the token is missing or wrong: use the address that patchcord panel has printed";
    refusal(StatusCode::FORBIDDEN, message)
}

/// A page of the panel, a shipped patch or its data, by the exact path.
async fn page(method: Method, uri: Uri) -> Response {
    if method != Method::GET && method != Method::HEAD {
        return refusal(StatusCode::METHOD_NOT_ALLOWED, "pages can only be read");
    }
    let path = uri.path().strip_prefix('/').unwrap_or_default();
    let path = if path.is_empty() { FIRST_PAGE } else { path };
    if let Some(page) = PAGES.iter().find(|page| page.path == path) {
        return ([(header::CONTENT_TYPE, page.kind())], page.content()).into_response();
    }
    match path.strip_prefix(PATCH_FOLDER).and_then(shipped) {
        Some((kind, text)) => ([(header::CONTENT_TYPE, kind)], text).into_response(),
        None => refusal(StatusCode::NOT_FOUND, "there is no such page"),
    }
}

/// The type and the text of a shipped patch, or of its data.
fn shipped(path: &str) -> Option<(&'static str, &'static str)> {
    let patch = PATCHES.iter().find(|patch| patch.path == path).map(|patch| (JSON, patch.text));
    patch.or_else(|| DATA.iter().find(|data| data.path == path).map(|data| (CSV, data.text)))
}

/// The list of the shipped patches.
async fn gallery_document() -> Response {
    ([(header::CONTENT_TYPE, JSON)], GALLERY.as_str()).into_response()
}

/// What the page has to know about its host.
async fn host_document(State(host): State<Arc<Host>>) -> Response {
    let patch = host.patch.as_ref().map(|patch| patch.name.as_str());
    let document = serde_json::json!({ "host": "server", "patch": patch });
    ([(header::CONTENT_TYPE, JSON)], document.to_string()).into_response()
}

/// The text of the patch that the panel opens first.
async fn patch(State(host): State<Arc<Host>>, uri: Uri) -> Response {
    if !host.token.is_in(uri.query()) {
        return refusal_without_token();
    }
    match &host.patch {
        Some(patch) => ([(header::CONTENT_TYPE, PLAIN_TEXT)], patch.text.clone()).into_response(),
        None => refusal(StatusCode::NOT_FOUND, "the panel was started without a patch"),
    }
}

/// A WebSocket.
async fn connect(
    purpose: Purpose,
    State(host): State<Arc<Host>>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
    uri: Uri,
    headers: HeaderMap,
) -> Response {
    if !is_from_own_page(&headers) {
        return refusal(StatusCode::FORBIDDEN, "only the page of the panel may open a WebSocket");
    }
    if !host.token.is_in(uri.query()) {
        return refusal_without_token();
    }
    match upgrade {
        Ok(upgrade) => {
            let size = host.service(purpose).message;
            let upgrade = upgrade.max_message_size(size).max_frame_size(size);
            upgrade.on_upgrade(move |socket| run(host, purpose, socket))
        }
        Err(rejection) => rejection.into_response(),
    }
}

/// Whether the header `Origin` names the server as the header `Host` does. Browsers add it to every WebSocket.
fn is_from_own_page(headers: &HeaderMap) -> bool {
    let origin = single(headers, header::ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
    match (origin, single(headers, header::HOST)) {
        (Some(origin), Some(host)) => origin.eq_ignore_ascii_case(host),
        _ => false,
    }
}

/// Runs a worker until its page closes the connection, unless there are too many.
async fn run(host: Arc<Host>, purpose: Purpose, socket: WebSocket) {
    let service = host.service(purpose);
    let Ok(slot) = Arc::clone(&service.slots).try_acquire_owned() else {
        return close(socket, too_many(service)).await;
    };
    // Without a session there is no panel, so a comparison does not keep the server running.
    let _browser = (purpose == Purpose::Session).then(|| host.browsers.open());
    match start(purpose, host.folder.clone(), slot) {
        Ok(worker) => socket::serve(socket, worker, service).await,
        Err(_) => close(socket, stopped(purpose)).await,
    }
}

/// Starts a worker. Tables of its patches are read below `folder`.
///
/// # Errors
/// If the system has no further thread.
fn start(purpose: Purpose, folder: PathBuf, slot: OwnedSemaphorePermit) -> io::Result<Worker> {
    let folder = Some(folder);
    match purpose {
        Purpose::Session => Worker::start(slot, |_| Session::new(SessionOptions { folder })),
        Purpose::Comparison => Worker::start(slot, |cancel| {
            Comparison::new(ComparisonOptions { folder, cancel, ..ComparisonOptions::default() })
        }),
    }
}
