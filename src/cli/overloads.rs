//! Formats overloads as text and as JSON.

use serde::Serialize;

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

/// An overload for `--json`: time in seconds, peak in volts.
#[derive(Serialize)]
pub(super) struct OverloadDocument<'a> {
    element: &'a str,
    #[serde(rename = "t")]
    time: f64,
    peak: f64,
    caused_by: Option<&'a str>,
}

impl<'a> OverloadDocument<'a> {
    /// The documents of several overloads, in the same order.
    pub(super) fn all(overloads: &'a [Overload]) -> Vec<Self> {
        let document = |overload: &'a Overload| OverloadDocument {
            element: &overload.element,
            time: overload.time,
            peak: overload.peak,
            caused_by: overload.caused_by.as_deref(),
        };
        overloads.iter().map(document).collect()
    }
}
