//! Writes answers.

use std::mem::{Discriminant, discriminant};

use super::Answer;
use crate::event::{Event, MachineState, Response};

/// Removes those of the first `known` events that a later one of the same kind replaces, so that an answer has each
/// large event once. Refusals and parameters do not replace each other.
pub(super) fn drop_replaced(events: &mut Vec<Event>, known: usize) {
    let is_replaceable = |event: &&Event| !matches!(event, Event::Refused { .. } | Event::Parameter { .. });
    let newer: Vec<Discriminant<Event>> =
        events[known..].iter().filter(is_replaceable).map(discriminant).collect();
    let mut index = 0;
    events.retain(|event| {
        index += 1;
        index > known || !newer.contains(&discriminant(event))
    });
}

/// Whether a client has to know a new state of the machine. Time advances in frames.
pub(super) fn differs(known: &MachineState, state: &MachineState) -> bool {
    *known != MachineState { time: known.time, ..state.clone() }
}

/// The answer to a request.
pub(super) fn answer(id: Option<u64>, events: Vec<Event>, frame: Option<Vec<u8>>) -> Answer {
    let response = Response { id, events, frame: frame.is_some() };
    // All keys are texts and all numbers are finite or null, so this cannot fail.
    let text = serde_json::to_string(&response).unwrap_or_default();
    Answer { text, frame }
}
