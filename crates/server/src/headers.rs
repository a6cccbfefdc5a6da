//! The headers of all responses, which restrict what a browser does with them.

use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};

/// The headers that do not depend on the request.
const FIXED: [(&str, &str); 5] = [
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cache-control", "no-store"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
];

/// The policy of a response that is not a page of the panel.
const NOTHING: &str = "default-src 'none'";

/// Adds the headers to a response. `host` is the permitted name by which the request named the server; `None` if the
/// request is refused because it has none.
pub(crate) fn secure(headers: &mut HeaderMap, host: Option<&str>) {
    for (name, value) in FIXED {
        headers.insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    let policy = host.and_then(|host| HeaderValue::from_str(&policy(host)).ok());
    headers.insert(header::CONTENT_SECURITY_POLICY, policy.unwrap_or(HeaderValue::from_static(NOTHING)));
}

/// The content security policy of a page: everything comes from the server itself. Not all browsers regard a WebSocket
/// to the same server as their own, so it is named.
fn policy(host: &str) -> String {
    format!(
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self' ws://{host}; worker-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; \
         frame-ancestors 'none'"
    )
}
