//! Overloads as they are told.

use serde_json::{Value, json};

use patchcord::trace::Overload;

/// An overload in a line; `order` is its place among those of its run.
pub(super) fn overload_told(order: usize, overload: &Overload) -> String {
    let Overload { element, time, peak, caused_by } = overload;
    let cause = match caused_by {
        Some(cause) => format!("caused by {cause}"),
        None if order == 0 => "first".to_owned(),
        None => "caused by none of those before".to_owned(),
    };
    format!("overload: {element} at t = {time:.6} s, asked for {peak:.1} V ({cause})")
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
