//! The WebSocket of a page: it passes requests to a worker and the messages of its answers back.
//!
//! A request is a text message, and requests are answered in order. While the worker carries out a request, the next
//! ones are read ahead, so that the end of the connection is noticed. A page that sends more than the worker can do has
//! to wait.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;

use axum::extract::ws::{CloseFrame, Message, WebSocket};
use tokio::time::timeout;

use crate::reasons::{invalid, silent, stopped, unsupported};
use crate::service::Service;
use crate::worker::Worker;

/// How long the server waits until a page has closed its end of the connection.
const CLOSING_TIME: Duration = Duration::from_secs(2);

/// Largest number of requests that are read ahead.
const MAX_AHEAD: usize = 64;

/// Why a connection ends: the reason for the page, or `None` if the page has closed it.
type Ending = Option<CloseFrame>;

/// Answers the requests of a page, until it closes the connection or makes a mistake.
pub(crate) async fn serve(mut socket: WebSocket, mut worker: Worker, service: &Service) {
    let Err(ending) = answer_all(&mut socket, &mut worker, service).await;
    // The worker ends first, because a page may take its time to close the connection.
    drop(worker);
    if let Some(frame) = ending {
        close(socket, frame).await;
    }
}

/// Answers requests.
///
/// # Errors
/// Whenever the connection ends.
async fn answer_all(
    socket: &mut WebSocket,
    worker: &mut Worker,
    service: &Service,
) -> Result<Infallible, Ending> {
    let mut ahead: VecDeque<String> = VecDeque::new();
    loop {
        let Some(request) = ahead.pop_front() else {
            let arrived = timeout(service.silence, socket.recv()).await;
            ahead.extend(request_in(arrived.map_err(|_| Some(silent(service.purpose)))?)?);
            continue;
        };
        worker.begin(request).await.ok_or_else(|| Some(stopped(service.purpose)))?;
        pass_answer(socket, worker, &mut ahead, service).await?;
    }
}

/// Sends the messages of an answer, each as soon as it is there. Meanwhile it reads requests ahead. The worker may take
/// as long as it needs, but the page has to read.
///
/// # Errors
/// If the connection ends.
async fn pass_answer(
    socket: &mut WebSocket,
    worker: &mut Worker,
    ahead: &mut VecDeque<String>,
    service: &Service,
) -> Result<(), Ending> {
    loop {
        let part = tokio::select! {
            biased;
            arrived = socket.recv(), if has_room(ahead, service.message) => {
                ahead.extend(request_in(arrived)?);
                continue;
            }
            part = worker.part() => part.ok_or_else(|| Some(stopped(service.purpose)))?,
        };
        if !matches!(timeout(service.silence, socket.send(part.message)).await, Ok(Ok(()))) {
            return Err(None);
        }
        if part.is_last {
            return Ok(());
        }
    }
}

/// Whether a further request may be read ahead: together they have at most the size of two largest messages.
fn has_room(ahead: &VecDeque<String>, largest: usize) -> bool {
    ahead.len() < MAX_AHEAD && ahead.iter().map(String::len).sum::<usize>() < largest
}

/// The request in what arrived; `None` if it is a message of the connection itself.
///
/// # Errors
/// If the connection ends.
fn request_in(arrived: Option<Result<Message, axum::Error>>) -> Result<Option<String>, Ending> {
    match arrived {
        Some(Ok(Message::Text(text))) => Ok(Some(text.as_str().to_owned())),
        // The next read answers the message that closes the connection, and finds its end.
        Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Close(_))) => Ok(None),
        Some(Ok(Message::Binary(_))) => Err(Some(unsupported())),
        Some(Err(_)) => Err(Some(invalid())),
        None => Err(None),
    }
}

/// Closes a connection with a reason, which the page shows.
pub(crate) async fn close(mut socket: WebSocket, frame: CloseFrame) {
    let closing = async {
        if socket.send(Message::Close(Some(frame))).await.is_ok() {
            // If the connection ended with unread messages, the page would not get the reason.
            while let Some(Ok(_)) = socket.recv().await {}
        }
    };
    // A page that does not answer loses the connection.
    let _ = timeout(CLOSING_TIME, closing).await;
}
