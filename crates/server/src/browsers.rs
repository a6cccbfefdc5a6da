//! The number of open panels, so that the server can stop after the last one.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;
use tokio::time::timeout;

/// The open panels of a server.
pub(crate) struct Browsers {
    /// Their number.
    count: watch::Sender<Count>,
}

/// How many panels there are and were.
#[derive(Default)]
struct Count {
    /// Whether a panel was ever open.
    any: bool,
    /// How many are open.
    open: usize,
}

/// An open panel. It is closed when this is dropped.
pub(crate) struct Browser(Arc<Browsers>);

impl Browsers {
    /// No panels.
    pub(crate) fn new() -> Self {
        Browsers { count: watch::Sender::new(Count::default()) }
    }

    /// Counts a panel.
    pub(crate) fn open(self: &Arc<Self>) -> Browser {
        self.count.send_modify(|count| *count = Count { any: true, open: count.open + 1 });
        Browser(Arc::clone(self))
    }

    /// Waits until there was a panel, and there has been none for `pause`: a page that is loaded again has none for a
    /// moment.
    pub(crate) async fn all_closed(&self, pause: Duration) {
        // Waiting fails only without a sender, and `self` has one.
        let mut count = self.count.subscribe();
        let _ = count.wait_for(|count| count.any).await;
        loop {
            let _ = count.wait_for(|count| count.open == 0).await;
            if timeout(pause, count.wait_for(|count| count.open > 0)).await.is_err() {
                return;
            }
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.0.count.send_modify(|count| count.open -= 1);
    }
}
