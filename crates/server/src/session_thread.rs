//! A session on a thread of its own, because it computes for milliseconds at a time.

use std::io;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use patchcord_panel::{Answer, Session, SessionOptions};
use tokio::sync::OwnedSemaphorePermit;
use tokio::sync::mpsc;

/// How long a session may compute for one request. At 60 frames per second, a frame then leaves time for the page.
const WORKING_TIME: Duration = Duration::from_millis(12);

/// The stack of a session: that of the main thread of a command on most systems.
const STACK_BYTES: usize = 8 << 20;

/// A session that answers requests until this is dropped.
pub(crate) struct SessionThread {
    /// To the thread.
    requests: mpsc::Sender<String>,
    /// From the thread.
    answers: mpsc::Receiver<Answer>,
}

impl SessionThread {
    /// Starts a session. Tables of its patches are read below `folder`. It keeps `slot` until it has ended.
    ///
    /// # Errors
    /// If the system has no further thread.
    pub(crate) fn start(folder: PathBuf, slot: OwnedSemaphorePermit) -> io::Result<Self> {
        let (requests, received) = mpsc::channel(1);
        let (answered, answers) = mpsc::channel(1);
        let work = move || {
            // Declared before the session, so dropped after it.
            let _slot = slot;
            answer_all(Session::new(SessionOptions { folder: Some(folder) }), received, &answered);
        };
        thread::Builder::new().name("session".to_owned()).stack_size(STACK_BYTES).spawn(work)?;
        Ok(SessionThread { requests, answers })
    }

    /// The answer to a request; `None` if the session has ended by a fault of the program.
    pub(crate) async fn request(&mut self, text: String) -> Option<Answer> {
        self.requests.send(text).await.ok()?;
        self.answers.recv().await
    }
}

/// Answers requests until nobody can send them or read the answers.
fn answer_all(mut session: Session, mut requests: mpsc::Receiver<String>, answers: &mpsc::Sender<Answer>) {
    while let Some(text) = requests.blocking_recv() {
        let started = Instant::now();
        let answer = session.request(&text, &mut || started.elapsed() >= WORKING_TIME);
        if answers.blocking_send(answer).is_err() {
            return;
        }
    }
}
