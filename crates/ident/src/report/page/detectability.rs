//! The weakest effects that the data would have shown.

use crate::design::detectability::detection_limit::Limit;
use crate::effects::Library;
use crate::report::detection_limits::{limit_text, needs_text};
use crate::report::page::sheet::{escaped_text, table};
use crate::report::values::parameter_values_text;

pub(super) fn section(limits: &[Limit], library: &Library) -> String {
    let rows = limits.iter().map(|limit| {
        let from = limit_text(limit).unwrap_or_else(|| format!("not at all{}", needs_text(limit, library)));
        let (reads, with) = (limit.reads.join(", "), parameter_values_text(&limit.beside));
        let cells = [&limit.effect, &limit.junction, &reads, &limit.parameter, &from, &with];
        (false, cells.map(escaped_text).to_vec())
    });
    format!(
        "<section>\n<h2>What these data would have shown</h2>\n<p>The weakest of every effect that the first round would have found.</p>\n{}</section>\n",
        table(&["effect", "at", "reads", "parameter", "weakest that would have shown", "with"], rows)
    )
}
