//! Formats overloads as text and as JSON.

use serde_json::{Value, json};

use patchcord::trace::Overload;

/// An overload in one line. `order` is its position among those of its run, from 0.
pub(super) fn overload_text(order: usize, overload: &Overload) -> String {
    let Overload { element, time, peak, caused_by } = overload;
    let cause = match caused_by {
        Some(cause) => format!("caused by {cause}"),
        None if order == 0 => "first".to_owned(),
        None => "not caused by an earlier one".to_owned(),
    };
    format!("overload: {element} at t = {time:.6} s, needs {peak:.1} V ({cause})")
}

/// An overload for `--json`.
pub(super) fn overload_json(overload: &Overload) -> Value {
    json!({
        "element": overload.element,
        "t": overload.time,
        "peak": overload.peak,
        "caused_by": overload.caused_by,
    })
}
