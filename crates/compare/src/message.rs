//! Messages about faults, as texts for a page.
//!
//! A page has no terminal, so every finding is one line: the message, its place in words, and the advice.

use patchcord_core::document::{Diagnostic, Report, format_number};
use patchcord_core::trace::Overload;
use patchcord_ident::{ExperimentError, ModelError, Record};

use crate::limits::MAX_FINDINGS;

/// Largest number of characters of an excerpt that says where a finding is.
const MAX_EXCERPT: usize = 40;

/// The findings about a patch, a line each.
pub(crate) fn patch_message(report: &Report) -> String {
    let place = |finding: &Diagnostic| match finding.span {
        Some(span) => format!(" ({}, line {})", report.file, report.line_and_column(span.start).0),
        None => String::new(),
    };
    texts(report, place).join("\n")
}

/// The findings about an experiment or about data, a text each. The user has not seen the text of the experiment, so the
/// place is a quotation and not a line.
pub(crate) fn experiment_texts(report: &Report) -> Vec<String> {
    let place = |finding: &Diagnostic| {
        let excerpt = finding.span.and_then(|span| report.text.get(span.start..span.end));
        let excerpt = excerpt.filter(|text| !text.is_empty() && text.chars().nth(MAX_EXCERPT).is_none());
        excerpt.map_or_else(String::new, |text| format!(" (at {text})"))
    };
    texts(report, place)
}

/// The faults of an experiment, of its patch and of its data, a line each.
pub(crate) fn experiment_message(error: &ExperimentError) -> String {
    match error {
        ExperimentError::Invalid { experiment, patch } => {
            let patch = patch.iter().map(|report| patch_message(report));
            experiment_texts(experiment).into_iter().chain(patch).collect::<Vec<_>>().join("\n")
        }
        error => error.to_string(),
    }
}

/// The fault of a patch that cannot be run along the records, or the cancellation of a fit or a search.
pub(crate) fn model_message(error: &ModelError) -> String {
    match error {
        ModelError::Patch(report) => patch_message(report),
        error => error.to_string(),
    }
}

/// The message about an amplifier that is overloaded in a run along a record.
pub(crate) fn overload_message(record: &Record, overload: &Overload) -> String {
    let demand = overload.peak().map(|peak| format!(" with a demanded output of {} V", format_number(peak)));
    format!(
        "with {}, the amplifier {} overloads at t = {} s{}: turn the parameters back, or change its scale so that \
         one volt represents more",
        record.name,
        overload.element,
        format_number(record.begin + overload.time),
        demand.unwrap_or_default()
    )
}

/// The findings of a report, a text each: message, place, advice. If there are too many, the last text counts them.
fn texts(report: &Report, place: impl Fn(&Diagnostic) -> String) -> Vec<String> {
    let text = |finding: &Diagnostic| format!("{}{}: {}", finding.message, place(finding), finding.advice());
    let shown = report.findings.iter().take(MAX_FINDINGS).map(text);
    let hidden = report.findings.len().saturating_sub(MAX_FINDINGS);
    shown.chain((hidden > 0).then(|| format!("and {hidden} more"))).collect()
}

#[cfg(test)]
mod tests {
    use patchcord_core::document::{Code, Span};

    use super::*;

    #[test]
    fn a_finding_has_its_place_in_words() {
        let text = "{\n  \"kin\": 1\n}";
        let finding = Diagnostic::at(Code::UNKNOWN_KEY, Span { start: 4, end: 9 }, "no such key");
        let finding = finding.hint("did you mean \"kind\"?");
        let report = Report::new("a.json", text, vec![finding]);
        assert_eq!(patch_message(&report), "no such key (a.json, line 2): did you mean \"kind\"?");
        assert_eq!(experiment_texts(&report), ["no such key (at \"kin\"): did you mean \"kind\"?"]);
    }

    #[test]
    fn many_findings_are_counted() {
        let finding = || Diagnostic::without_span(Code::UNKNOWN_KEY, "no such key").hint("remove it");
        let report = Report::new("a.json", "", (0..MAX_FINDINGS + 3).map(|_| finding()).collect());
        let texts = experiment_texts(&report);
        assert_eq!((texts.len(), texts.last().map(String::as_str)), (MAX_FINDINGS + 1, Some("and 3 more")));
        assert_eq!(texts[0], "no such key: remove it");
    }
}
