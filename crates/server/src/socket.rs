//! The WebSocket of a page: it passes requests to the session and answers back.
//!
//! A request is a text message. Its answer is a text message, and a binary message if there is a frame. Only then the
//! next request is read, so a page that sends more than the session can do has to wait.

use std::time::Duration;

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, close_code};
use patchcord_panel::Answer;
use tokio::time::timeout;

use crate::session_thread::SessionThread;

/// How long the server waits until a page has closed its end of the connection.
const CLOSING_TIME: Duration = Duration::from_secs(2);

/// Answers the requests of a page, until it closes the connection or makes a mistake.
pub(crate) async fn serve(mut socket: WebSocket, mut session: SessionThread, silence: Duration) {
    let end = answer_all(&mut socket, &mut session, silence).await;
    // The session ends first, because a page may take its time to close the connection.
    drop(session);
    if let Some(frame) = end {
        close(socket, frame).await;
    }
}

/// Answers requests. Returns why the server closes the connection; `None` if the page has closed it.
async fn answer_all(
    socket: &mut WebSocket,
    session: &mut SessionThread,
    silence: Duration,
) -> Option<CloseFrame> {
    loop {
        let text = match timeout(silence, socket.recv()).await {
            Ok(Some(Ok(Message::Text(text)))) => text,
            // The next read answers the message that closes the connection, and finds its end.
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Close(_)))) => continue,
            Ok(None) => return None,
            Ok(Some(Ok(Message::Binary(_)))) => return Some(unsupported()),
            Ok(Some(Err(_))) => return Some(invalid()),
            Err(_) => return Some(silent()),
        };
        let Some(answer) = session.request(text.as_str().to_owned()).await else { return Some(stopped()) };
        if !matches!(timeout(silence, send(socket, answer)).await, Ok(Ok(()))) {
            return None;
        }
    }
}

/// Sends an answer.
async fn send(socket: &mut WebSocket, answer: Answer) -> Result<(), axum::Error> {
    socket.send(Message::Text(answer.text.into())).await?;
    match answer.frame {
        Some(frame) => socket.send(Message::Binary(frame.into())).await,
        None => Ok(()),
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

/// The reason if there are as many sessions as permitted.
pub(crate) fn too_many(sessions: usize) -> CloseFrame {
    let reason =
        format!("{sessions} panels are open, which is the most: close another one, then reload this page");
    CloseFrame { code: close_code::AGAIN, reason: reason.into() }
}

/// The reason if a session cannot begin or has ended by a fault of the program.
pub(crate) fn stopped() -> CloseFrame {
    fixed(close_code::ERROR, "the session stopped by a fault of the program: reload this page")
}

/// The reason if a page sent nothing for a long time.
fn silent() -> CloseFrame {
    fixed(close_code::AWAY, "the panel was not in use: reload this page to continue")
}

/// The reason if a message could not be read.
fn invalid() -> CloseFrame {
    fixed(close_code::POLICY, "a message to the session was too large or not valid")
}

/// The reason if a message is not a request.
fn unsupported() -> CloseFrame {
    fixed(close_code::UNSUPPORTED, "a request must be a text message")
}

/// A reason without numbers.
fn fixed(code: u16, reason: &'static str) -> CloseFrame {
    CloseFrame { code, reason: Utf8Bytes::from_static(reason) }
}
