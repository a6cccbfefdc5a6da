//! Formats the page docs/differences.md, which shows what the differences from the thesis depend on.
//!
//! Only figures with a table of numbers are on the page. A section holds the place in the text, the reading of the
//! figure, an explanation, the table, and the command that repeats the runs.

use super::figures::{DrawnFigure, Figure};

/// Explains noise, threshold and the words in the tables. The page and the gallery print it.
pub(super) const READING_NOTE: &str = "Noise is a random number that is added to the velocity command; a new one is \
     drawn every 5 ms. A swing counts as oscillation if it exceeds the threshold, peak to peak within 0.04 s. \
     \"continues\": oscillation has not ended where the command turns. \"quiet\": there is no oscillation. Noise of \
     0.02 mm/s rms alone moves the table by about 0.25 mm/s. With that noise, readings at a threshold of 0.25 mm/s \
     are readings of the noise.";

/// The beginning of the page.
const HEAD: &str = "# What the differences depend on

The ideal circuit contradicts some statements of the thesis. This page lists the size of each difference and what it
depends on: the rate and the direction of the command, the noise on it, the threshold, and the settings of the circuit.

`patchcord replay difference-1 --plot d.png` draws figure D1. This page is generated from the same runs
(`PATCHCORD_BLESS=1 cargo test --tests -- --ignored replay`).
";

/// Returns the page in Markdown, with a section for each figure that has a table. Figures keep their order.
///
/// # Examples
///
/// Figure D1 takes some seconds to draw:
///
/// ```no_run
/// use patchcord_thesis::replay::{differences_page, figures};
///
/// let figure = figures().find(|figure| figure.id == "difference-1").ok_or("a figure of the thesis")?;
/// let drawn = figure.draw()?;
/// println!("{}", differences_page([(figure, &drawn)]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn differences_page<'a>(figures: impl IntoIterator<Item = (&'a Figure, &'a DrawnFigure)>) -> String {
    let sections = figures.into_iter().filter_map(|(figure, drawn)| {
        let table = drawn.table.as_ref()?;
        let (heading, place, commands) = (figure.heading(), figure.place, drawn.commands.join("`, `"));
        Some(format!(
            "\n## {heading}\n\n{place}. In short: {}.\n\n{}\n\n{}\n{}; `{commands}`.\n",
            drawn.reading,
            table.reason,
            table.markdown(),
            drawn.settings
        ))
    });
    format!("{HEAD}\n{READING_NOTE}\n{}", sections.collect::<String>())
}
