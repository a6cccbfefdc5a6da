//! Plain lines about the progress of long work, for standard error that is not a terminal.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Prints a line after each interval until it is dropped. Work that is shorter than the interval prints nothing.
///
/// A thread prints the lines, so that they also appear while the work reports nothing.
pub(super) struct PlainLines {
    /// The thread ends when this is dropped.
    stop: Option<Sender<()>>,
    /// The thread. None if the system provides none; then no line is printed.
    thread: Option<JoinHandle<()>>,
}

impl PlainLines {
    /// Calls `print` after each interval.
    pub(super) fn every(interval: Duration, mut print: impl FnMut() + Send + 'static) -> Self {
        let (stop, stopped) = mpsc::channel::<()>();
        let print_until_stopped = move || {
            while stopped.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                print();
            }
        };
        PlainLines { stop: Some(stop), thread: thread::Builder::new().spawn(print_until_stopped).ok() }
    }
}

impl Drop for PlainLines {
    /// Waits until the thread has ended, so that no line follows the result of the work.
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_printed_until_the_work_ends() {
        let (sender, printed) = mpsc::channel();
        let lines = PlainLines::every(Duration::from_millis(1), move || {
            let _ = sender.send(());
        });
        for _ in 0..3 {
            assert!(printed.recv_timeout(Duration::from_secs(60)).is_ok());
        }
        drop(lines);
        printed.try_iter().for_each(drop);
        assert_eq!(printed.try_recv(), Err(mpsc::TryRecvError::Disconnected), "the thread has ended");
    }

    #[test]
    fn short_work_prints_no_line_and_does_not_wait() {
        let (sender, printed) = mpsc::channel();
        drop(PlainLines::every(Duration::from_secs(3600), move || {
            let _ = sender.send(());
        }));
        assert!(printed.recv().is_err());
    }
}
