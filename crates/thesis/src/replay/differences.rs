//! The page that tells what the differences depend on: the figures that have a table of numbers behind them.

use super::figures::{Drawn, Figure};

/// What the numbers are read with.
pub(super) const READ_WITH: &str = "Noise is a number drawn every 5 ms and added to the velocity command. A swing counts as oscillation above the \
                                    threshold, peak to peak within 0.04 s. \"Goes on\" is oscillation that had not ended where the command turned, \
                                    \"quiet\" none at all. At 0.02 mm/s rms the noise by itself swings the table by about 0.25 mm/s: \
                                    readings above that threshold then tell of the noise.";

const HEAD: &str = "# What the differences depend on

Some statements of the study the ideal circuit does not bear out. Here is how large each difference is, and what moves it: the rate and the
direction of the command, the noise on it, the threshold, and the settings of the circuit.

`patchcord replay difference-1 --plot d.png` draws the first; this page is written from the same runs (`PATCHCORD_BLESS=1 cargo test -p patchcord replay`).
";

/// The page, from figures of which those that have a table stand on it.
pub fn differences<'a>(figures: impl IntoIterator<Item = (&'a Figure, &'a Drawn)>) -> String {
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
    format!("{HEAD}\n{READ_WITH}\n{}", sections.collect::<String>())
}
