//! The engines of workers: a session of the panel, and a comparison with measured data.

use std::time::{Duration, Instant};

use axum::extract::ws::Message;
use patchcord_compare::Comparison;
use patchcord_panel::{Answer, Session};

use crate::worker::{Engine, Part};

/// How long a session may compute for one request. At 60 frames per second, a frame then leaves time for the page.
const WORKING_TIME: Duration = Duration::from_millis(12);

/// The answer is a text, and a frame if there is one.
impl Engine for Session {
    fn answer(&mut self, request: &str, emit: &mut (dyn FnMut(Part) + Send)) {
        let started = Instant::now();
        let Answer { text, frame } = self.request(request, &mut || started.elapsed() >= WORKING_TIME);
        emit(Part { message: Message::Text(text.into()), is_last: frame.is_none() });
        if let Some(frame) = frame {
            emit(Part { message: Message::Binary(frame.into()), is_last: true });
        }
    }
}

/// The answer is any number of partial responses, and the final one.
impl Engine for Comparison {
    fn answer(&mut self, request: &str, emit: &mut (dyn FnMut(Part) + Send)) {
        let mut report = |text: &str| emit(Part { message: Message::Text(text.into()), is_last: false });
        let text = self.request(request, &mut report);
        emit(Part { message: Message::Text(text.into()), is_last: true });
    }
}
