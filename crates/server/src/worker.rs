//! A thread that carries out the requests of a page, because this takes from milliseconds to minutes.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use axum::extract::ws::Message;
use tokio::sync::OwnedSemaphorePermit;
use tokio::sync::mpsc;

/// The stack of a worker: that of the main thread of a command on most systems.
const STACK_BYTES: usize = 8 << 20;

/// What carries out requests. It stays on the thread of its worker.
pub(crate) trait Engine {
    /// Carries out a request, and emits the messages of its answer.
    fn answer(&mut self, request: &str, emit: &mut (dyn FnMut(Part) + Send));
}

/// A message of an answer.
pub(crate) struct Part {
    /// The message.
    pub message: Message,
    /// Whether the answer is complete with it.
    pub is_last: bool,
}

/// An engine on a thread of its own, until this is dropped.
pub(crate) struct Worker {
    /// To the thread.
    requests: mpsc::Sender<String>,
    /// From the thread.
    parts: mpsc::Receiver<Part>,
    /// Becomes true when nobody waits for an answer.
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts a worker. `begin` makes the engine on its thread. The engine gets a flag that becomes true when its answer
    /// is no longer needed. The worker keeps `slot` until its thread ends.
    ///
    /// # Errors
    /// If the system has no further thread.
    pub(crate) fn start<E: Engine>(
        slot: OwnedSemaphorePermit,
        begin: impl FnOnce(Arc<AtomicBool>) -> E + Send + 'static,
    ) -> io::Result<Self> {
        let (requests, received) = mpsc::channel(1);
        let (emitted, parts) = mpsc::channel(1);
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&cancel);
        let work = move || {
            // Declared before the engine, so dropped after it.
            let _slot = slot;
            answer_all(begin(flag), received, &emitted);
        };
        thread::Builder::new().name("worker".to_owned()).stack_size(STACK_BYTES).spawn(work)?;
        Ok(Worker { requests, parts, cancel })
    }

    /// Begins a request; `None` if the thread has ended by a fault of the program. The answer of the request before must
    /// be complete.
    pub(crate) async fn begin(&self, request: String) -> Option<()> {
        self.requests.send(request).await.ok()
    }

    /// The next message of the answer; `None` if the thread has ended by a fault of the program. If this is cancelled,
    /// no message is lost.
    pub(crate) async fn part(&mut self) -> Option<Part> {
        self.parts.recv().await
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

/// Answers requests until nobody can send them.
fn answer_all(mut engine: impl Engine, mut requests: mpsc::Receiver<String>, parts: &mpsc::Sender<Part>) {
    while let Some(request) = requests.blocking_recv() {
        engine.answer(&request, &mut |part| {
            // Without a receiver there is no sender of requests either, so the loop ends.
            let _ = parts.blocking_send(part);
        });
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::sync::Semaphore;
    use tokio::time::timeout;

    use super::*;

    /// The longest time that a test waits.
    const PATIENCE: Duration = Duration::from_secs(20);

    /// Counts until nobody waits for it. With the request "emit", it emits each number.
    struct Counter {
        /// The flag of the worker.
        cancel: Arc<AtomicBool>,
    }

    impl Engine for Counter {
        fn answer(&mut self, request: &str, emit: &mut (dyn FnMut(Part) + Send)) {
            let mut count = 0;
            while !self.cancel.load(Ordering::Relaxed) {
                if request == "emit" {
                    emit(Part { message: Message::Text(count.to_string().into()), is_last: false });
                }
                count += 1;
            }
        }
    }

    /// Runs a future of a test.
    fn run<T>(future: impl Future<Output = T>) -> T {
        tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap().block_on(future)
    }

    /// A worker that counts, and its only slot.
    fn counter() -> (Worker, Arc<Semaphore>) {
        let slots = Arc::new(Semaphore::new(1));
        let slot = Arc::clone(&slots).try_acquire_owned().unwrap();
        (Worker::start(slot, |cancel| Counter { cancel }).unwrap(), slots)
    }

    #[test]
    fn messages_arrive_before_the_answer_is_complete() {
        let (mut worker, _slots) = counter();
        run(async {
            worker.begin("emit".to_owned()).await.unwrap();
            for expected in ["0", "1", "2"] {
                let part = worker.part().await.unwrap();
                assert_eq!((part.message.to_text().unwrap(), part.is_last), (expected, false));
            }
        });
    }

    #[test]
    fn a_dropped_worker_ends_its_request_and_frees_its_slot() {
        for request in ["count", "emit"] {
            let (worker, slots) = counter();
            run(async {
                worker.begin(request.to_owned()).await.unwrap();
                drop(worker);
                // A thread that waits for the receiver of a message ends, too.
                assert!(timeout(PATIENCE, slots.acquire()).await.is_ok(), "{request}");
            });
        }
    }

    /// An engine with a fault.
    struct Faulty;

    impl Engine for Faulty {
        fn answer(&mut self, _: &str, _: &mut (dyn FnMut(Part) + Send)) {
            panic!("no voltage");
        }
    }

    #[test]
    fn a_fault_of_the_program_ends_the_answer() {
        let slot = Arc::new(Semaphore::new(1)).try_acquire_owned().unwrap();
        let mut worker = Worker::start(slot, |_| Faulty).unwrap();
        run(async {
            assert_eq!(worker.begin(String::new()).await, Some(()));
            assert!(worker.part().await.is_none());
            assert_eq!(worker.begin(String::new()).await, None);
        });
    }
}
