//! The addresses of the server and their answers.

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
use patchcord_panel::pages::PAGES;
use patchcord_panel::patches::{PATCHES, gallery};

use crate::headers::secure;
use crate::host::Host;
use crate::session_thread::SessionThread;
use crate::socket::{self, close, stopped, too_many};

/// The page at the address of the server.
const FIRST_PAGE: &str = "index.html";

/// The type of text without markup.
const PLAIN_TEXT: &str = "text/plain; charset=utf-8";

/// The type of documents.
const JSON: &str = "application/json";

/// The address of the folder of the shipped patches, below that of the server.
const PATCH_FOLDER: &str = "patches/";

/// The document of the gallery, which reads every shipped patch once.
static GALLERY: LazyLock<String> = LazyLock::new(|| gallery().to_string());

/// All addresses.
pub(crate) fn router(host: Arc<Host>) -> Router {
    Router::new()
        .route("/host.json", get(host_document))
        .route("/gallery.json", get(gallery_document))
        .route("/patch", get(patch))
        .route("/session", get(session))
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

/// A page of the panel or a shipped patch, by its exact path.
async fn page(method: Method, uri: Uri) -> Response {
    if method != Method::GET && method != Method::HEAD {
        return refusal(StatusCode::METHOD_NOT_ALLOWED, "pages can only be read");
    }
    let path = uri.path().strip_prefix('/').unwrap_or_default();
    let path = if path.is_empty() { FIRST_PAGE } else { path };
    if let Some(page) = PAGES.iter().find(|page| page.path == path) {
        return ([(header::CONTENT_TYPE, page.kind())], page.content()).into_response();
    }
    let name = path.strip_prefix(PATCH_FOLDER);
    match PATCHES.iter().find(|patch| Some(patch.path) == name) {
        Some(patch) => ([(header::CONTENT_TYPE, JSON)], patch.text).into_response(),
        None => refusal(StatusCode::NOT_FOUND, "there is no such page"),
    }
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

/// The WebSocket of a session.
async fn session(
    State(host): State<Arc<Host>>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
    uri: Uri,
    headers: HeaderMap,
) -> Response {
    if !is_from_own_page(&headers) {
        return refusal(StatusCode::FORBIDDEN, "only the page of the panel may begin a session");
    }
    if !host.token.is_in(uri.query()) {
        return refusal_without_token();
    }
    match upgrade {
        Ok(upgrade) => {
            let upgrade = upgrade.max_message_size(host.limits.message).max_frame_size(host.limits.message);
            upgrade.on_upgrade(move |socket| run_session(host, socket))
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

/// Runs a session until its page is closed, unless there are too many.
async fn run_session(host: Arc<Host>, socket: WebSocket) {
    let Ok(slot) = Arc::clone(&host.slots).try_acquire_owned() else {
        return close(socket, too_many(host.limits.sessions)).await;
    };
    let _browser = host.browsers.open();
    match SessionThread::start(host.folder.clone(), slot) {
        Ok(session) => socket::serve(socket, session, host.limits.silence).await,
        Err(_) => close(socket, stopped()).await,
    }
}
