//! The building blocks of sections: tables and pictures as HTML.

use crate::fit::fitted_model::FittedModel;
use crate::report::values::{error_text, estimate_text, interval_text, owner, undetermined_sentence};
use crate::search::outcome::Outcome;
use maud::{Markup, PreEscaped, Render, html};
use patchcord_draw::plot;
use patchcord_draw::plot::{Format, Picture, PlotError, Size};

/// The size of a picture in pixels. Two pictures fit on a wide screen.
const PICTURE_SIZE: Size = Size { width: 900, height: 420 };

/// A table. A row with `true` is highlighted. Cells are texts or HTML.
pub(super) fn table<C: Render>(headings: &[&str], rows: impl Iterator<Item = (bool, Vec<C>)>) -> Markup {
    html! {
        table.narrow {
            tr { @for heading in headings { th { (heading) } } }
            "\n"
            @for (is_highlighted, cells) in rows {
                tr class=[is_highlighted.then_some("first")] { @for cell in &cells { (table_cell(cell)) } }
                "\n"
            }
        }
        "\n"
    }
}

/// A cell of a table. A number is aligned right.
fn table_cell(content: &impl Render) -> Markup {
    let content = content.render();
    let class = content.0.parse::<f64>().is_ok().then_some("number");
    html! { td class=[class] { (content) } }
}

/// A bar whose length is a fraction of the cell. The fraction is limited to 0 ... 1.
///
/// The style sheet draws the lane and the bar; only the width is set here.
pub(super) fn bar(fraction: f64) -> Markup {
    let percent = 100.0 * fraction.clamp(0.0, 1.0);
    html! {
        span.lane { span.bar style=(format!("width:{percent:.1}%")) {} }
    }
}

/// The fitted parameters of a model with their intervals and owners, and a sentence on undetermined ones.
pub(super) fn parameter_table(outcome: &Outcome, model: &FittedModel) -> Markup {
    let rows = model.variant.fit.iter().enumerate().map(|(index, name)| {
        let parameter = model.variant.patch().parameters.get(name);
        let (unit, description) =
            parameter.map_or(("1", ""), |known| (known.unit.text(), known.description.as_str()));
        let value = estimate_text(model, index);
        let (error, interval) = (error_text(model, index), interval_text(model.uncertainty(index)));
        let owner = owner(outcome, name);
        (false, [name, &value, &error, &interval, unit, description, &owner].map(str::to_owned).to_vec())
    });
    let headings = ["fitted", "value", "standard error", "95 %", "unit", "description", "of"];
    html! {
        (table(&headings, rows))
        @if let Some(sentence) = undetermined_sentence(model) { p { (sentence) } "\n" }
    }
}

/// Pictures as SVG figures. The style sheet places them side by side if the window is wide enough.
///
/// # Errors
/// If a picture cannot be drawn.
pub(super) fn pictures(pictures: impl IntoIterator<Item = Picture>) -> Result<Markup, PlotError> {
    Ok(html! {
        div.pictures {
            @for picture in pictures { figure { (svg(picture)?) } "\n" }
        }
        "\n"
    })
}

/// A picture as an SVG element.
///
/// The XML header in front of the element is removed, because the picture is part of an HTML page.
fn svg(picture: Picture) -> Result<Markup, PlotError> {
    let drawn = plot::render(&[picture], Format::Svg, PICTURE_SIZE)?;
    let drawn = String::from_utf8_lossy(&drawn);
    let start = drawn.find("<svg").unwrap_or_default();
    Ok(PreEscaped(drawn[start..].replacen("<svg", "<svg class=\"picture\"", 1)))
}
