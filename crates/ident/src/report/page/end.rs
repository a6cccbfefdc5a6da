//! Before and after.

use crate::report::Report;
use crate::report::fit_quality::steps_sentence;
use crate::report::page::courses::pictures;
use crate::report::page::sheet::{over_noise, parameters, table};
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;
use patchcord_draw::plot::PlotError;

pub(super) fn section(report: &Report<'_>) -> Result<String, PlotError> {
    let (base, last) = (&report.outcome.base, report.outcome.told());
    let mut text = "<section>\n<h2>Before and after</h2>\n".to_owned();
    let rows = [("before", base), ("after", last)].map(|(what, stage)| {
        let cells = [over_noise(&stage.train), over_noise(&stage.test), number(stage.colour)];
        (false, [what.to_owned()].into_iter().chain(cells).collect())
    });
    text += &table(
        &["gap over noise, rms", "training", "held back", "distance from white, in standard deviations"],
        rows.into_iter(),
    );
    let fineness = &report.outcome.fineness;
    let fine = fineness.is_enough().then(|| steps_sentence(fineness));
    let notes = fine.into_iter().chain(report.doubts());
    text.extend(notes.map(|own| format!("<p>{}</p>\n", escaped(&own))));
    if report.outcome.verdict.has_names() {
        text += &parameters(report.outcome, last);
        // After one round the same pictures stand there.
        if report.outcome.rounds.iter().filter(|round| round.taken).count() > 1 {
            text += &pictures(report, &[("before", base), ("after", last)])?;
        }
        text += "<p>The patch with what was missing is <a href=\"augmented.json\">augmented.json</a>: \
                 <code>patchcord run augmented.json</code> runs it, <code>patchcord draw augmented.json --plot augmented.svg</code> draws it.</p>\n";
    }
    Ok(text + "</section>\n")
}
