//! The page that tells what the differences depend on: the figures that have a table of numbers behind them.

use super::figures::{Drawn, Figure};

const HEAD: &str = "# What the differences depend on

Some statements of the study the ideal circuit does not bear out. Here is how large each difference is, and what moves it: the rate and the
direction of the command, the noise on it, the threshold above which a swing counts as oscillation (peak to peak within 0.04 s), and the
settings of the circuit. Noise is a number drawn every 5 ms and added to the velocity command. *Goes on* is oscillation that had not ended where
the command turned, *quiet* none at all.

`patchcord replay difference-1 --plot d.png` draws the first; this page is written from the same runs (`PATCHCORD_BLESS=1 cargo test --test cli replay`).
";

/// Why it is so, where the numbers do not tell by themselves.
const REASONS: &[(&str, &str)] = &[
    (
        "difference-1",
        "Small motions grow below the velocity of least friction and die away above it, at any rate: falling commands find it, later the less \
         there is to grow from. A large swing is another matter. It dips below that velocity in every cycle, where falling friction feeds it, and \
         lives on beside steady sliding; the smaller VcL is beside the swing, the further. A slower ramp ends nearer, but not at VcL.",
    ),
    (
        "difference-2",
        "Routh-Hurwitz has the slope go with K nearly as the square of the natural frequency does; ramps add their overrun, which is larger for \
         soft drives. Nothing that was varied here makes the slope nearly independent of K.",
    ),
    (
        "difference-3",
        "Small motions cannot tell where the lag stands: the slope of the square is all they meet. Large ones can: the square of a late velocity is \
         not the late square. So the place of the lag moves the rising critical velocity where swings are large beside VcL, and hardly the falling one.",
    ),
    (
        "difference-4",
        "Amplitudes of velocity go with 1/sqrt(K), in the describing function, in Table T9-6 and in the run alike; \"about 50 %\" is a generous word for \
         the root of 2.",
    ),
    (
        "fig-9-01",
        "A ramp goes on while oscillation dies away, and so ends it beyond the boundary of small motions, at a lower slope; the longer the time constant, \
         the lower the critical velocity and the larger the share that is overrun. That lowers the exponent. A larger threshold calls oscillation ended sooner: \
         with 1 mm/s the study's rate nearly gives the study's law.",
    ),
];

/// The page, from figures of which those that have a table stand on it.
pub fn differences<'a>(figures: impl IntoIterator<Item = (&'a Figure, &'a Drawn)>) -> String {
    let sections = figures.into_iter().filter_map(|(figure, drawn)| {
        let table = drawn.table.as_ref()?;
        let reason = REASONS.iter().find(|(id, _)| *id == figure.id).map_or("", |(_, reason)| reason);
        let (heading, place, commands) = (figure.heading(), figure.place, drawn.commands.join("`, `"));
        Some(format!(
            "\n## {heading}\n\n{place}. In short: {}.\n\n{reason}\n\n{}\n{}; `{commands}`.\n",
            drawn.reading,
            table.markdown(),
            drawn.settings
        ))
    });
    HEAD.to_owned() + &sections.collect::<String>()
}
