//! What the sections of a page are made of: numbers, tables, pictures.

use crate::fit::estimate::Fitted;
use crate::fit::fitted_model::Stage;
use crate::report::values::{error_text, estimate_text, interval_text, owner, undetermined_sentence};
use crate::search::outcome::Outcome;
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;
use patchcord_draw::plot;
use patchcord_draw::plot::{Format, Picture, PlotError, Size};

/// The size of a picture.
const SIZE: Size = Size { width: 900, height: 420 };

/// What is left, rms over the noise.
pub(super) fn over_noise(fitted: &Fitted) -> String {
    number(fitted.over_noise())
}

pub(super) fn escaped_text(text: impl AsRef<str>) -> String {
    escaped(text.as_ref())
}

/// A table of rows under headings; cells that are numbers stand to the right.
pub(super) fn table(headings: &[&str], rows: impl Iterator<Item = (bool, Vec<String>)>) -> String {
    let head: String = headings.iter().map(|heading| format!("<th>{heading}")).collect();
    let cell = |text: &String| {
        let class = if text.parse::<f64>().is_ok() { " class=\"number\"" } else { "" };
        format!("<td{class}>{text}")
    };
    let row = |(is_first, cells): (bool, Vec<String>)| {
        let class = if is_first { " class=\"first\"" } else { "" };
        format!("<tr{class}>{}</tr>\n", cells.iter().map(cell).collect::<String>())
    };
    format!("<table class=\"narrow\">\n<tr>{head}</tr>\n{}</table>\n", rows.map(row).collect::<String>())
}

/// A bar of a length between nothing and everything.
pub(super) fn bar(share: f64) -> String {
    let percent = 100.0 * share.clamp(0.0, 1.0);
    format!("<span class=\"lane\"><span class=\"bar\" style=\"width:{percent:.1}%\"></span></span>")
}

/// The parameters of a stage as they were fitted, and what each belongs to.
pub(super) fn parameters(outcome: &Outcome, stage: &Stage) -> String {
    let rows = stage.version.fit.iter().enumerate().map(|(place, name)| {
        let known = stage.version.patch().parameters.get(name);
        let (unit, what) = known.map_or(("1", ""), |own| (own.unit.text(), own.description.as_str()));
        let value = estimate_text(stage, place);
        let (error, interval) = (error_text(stage, place), interval_text(stage.known(place)));
        (false, [name, &value, &error, &interval, unit, what, &owner(outcome, name)].map(escaped).into())
    });
    let untold = undetermined_sentence(stage).map(|own| format!("<p>{}</p>\n", escaped(&own)));
    let headings = ["fitted", "value", "standard error", "95 %", "unit", "what it is", "of"];
    table(&headings, rows) + &untold.unwrap_or_default()
}

/// Pictures side by side, as far as there is room.
pub(super) fn pictures(pictures: impl IntoIterator<Item = Picture>) -> Result<String, PlotError> {
    let mut text = "<div class=\"pictures\">\n".to_owned();
    for picture in pictures {
        let drawn = plot::render(&[picture], Format::Svg, SIZE)?;
        let drawn = String::from_utf8_lossy(&drawn);
        let from = drawn.find("<svg").unwrap_or_default();
        text += "<figure>";
        text += &drawn[from..].replacen("<svg", "<svg class=\"picture\"", 1);
        text += "</figure>\n";
    }
    Ok(text + "</div>\n")
}
