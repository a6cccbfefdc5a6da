//! Accepts connections and serves each of them, for a limited time.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{sleep, timeout};

use crate::limits::Limits;

/// The largest header of a request in bytes.
const HEADER_BYTES: usize = 32 << 10;

/// The pause after the system could not accept a connection, such as with too many open files.
const PAUSE: Duration = Duration::from_millis(100);

/// Accepts connections. It does not end.
pub(crate) async fn accept(listener: TcpListener, router: Router, limits: Limits) {
    let places = Arc::new(Semaphore::new(limits.connections));
    // The semaphore is never closed.
    while let Ok(place) = Arc::clone(&places).acquire_owned().await {
        match listener.accept().await {
            Ok((stream, _)) => {
                tokio::spawn(serve(stream, router.clone(), limits.clone(), place));
            }
            Err(_) => sleep(PAUSE).await,
        }
    }
}

/// Answers the requests of a connection, until it ends, becomes a WebSocket or has lasted too long. It keeps `_place`
/// until then.
async fn serve(stream: TcpStream, router: Router, limits: Limits, _place: OwnedSemaphorePermit) {
    // An answer of a session is two messages. The second one must not wait until the first one has arrived.
    let _ = stream.set_nodelay(true);
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.header)
        .max_buf_size(HEADER_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    // A fault of a connection concerns its client only.
    let _ = timeout(limits.connection, connection).await;
}
