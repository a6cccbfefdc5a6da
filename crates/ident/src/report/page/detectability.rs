//! The section on detection limits.
//!
//! The section answers which effects the data exclude: an effect with a limit would have been found above it. An effect
//! without a limit needs other data, which the table names.

use crate::design::detectability::detection_limit::DetectionLimit;
use crate::effects::Library;
use crate::report::detection_limits::{limit_text, needs_text};
use crate::report::page::html_parts::table;
use crate::report::values::parameter_values_text;
use maud::{Markup, html};

/// The table of detection limits, one row per effect and site.
pub(super) fn section(limits: &[DetectionLimit], library: &Library) -> Markup {
    let rows = limits.iter().map(|limit| {
        let value =
            limit_text(limit).unwrap_or_else(|| format!("not detectable{}", needs_text(limit, library)));
        let (reads, with) = (limit.reads.join(", "), parameter_values_text(&limit.other_parameters));
        let cells = [&limit.effect, &limit.site, &reads, &limit.parameter, &value, &with];
        (false, cells.map(String::clone).to_vec())
    });
    html! {
        section {
            h2 { "Detection limits" }
            p { "The smallest strength of each effect that the first round would have detected." }
            "\n"
            (table(&["effect", "at", "reads", "parameter", "smallest detectable", "with"], rows))
        }
        "\n"
    }
}
