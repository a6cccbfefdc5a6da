//! Rounds in words.

use std::collections::HashSet;

use crate::data::measured::plural;
use crate::search::outcome::Outcome;
use crate::search::round::Round;
use patchcord_analysis::instruments::number;

impl Outcome {
    /// What a round came to, in words, which effects that stood beside it were dropped later, and why what it took has no name.
    pub fn round_told(&self, round: &Round) -> String {
        let is_kept = |own: &str| self.effects.iter().any(|effect| effect.named() == own);
        let dropped = round.beside.iter().filter(|own| !is_kept(own));
        let dropped: String = dropped.map(|own| format!(" Later {own} was dropped.")).collect();
        let is_nameless = round.taken && !self.verdict.has_names();
        let nameless =
            if is_nameless { " It is not named: what is left in the end is too much." } else { "" };
        round.sentence() + &dropped + nameless
    }
}

impl Round {
    /// How many effects were tried, and in how many ways: places, forms, and what they read there.
    pub fn tried_told(&self) -> String {
        let effects: HashSet<&str> =
            self.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
        let [effects, ways] =
            [(effects.len(), "effect"), (self.trials.len(), "way")].map(|(n, noun)| plural(n, noun));
        format!("{effects} tried in {ways}")
    }

    /// What it came to, in words.
    pub fn sentence(&self) -> String {
        let Some(best) = self.trials.first() else { return "nothing fits".to_owned() };
        let held = format!(
            "on the data held back it lowers the sum of squares by {} times that of the noise (95 %: {})",
            number(self.confirmed.sum),
            self.confirmed.interval().map(number).join(" ... ")
        );
        let beside = match self.beside.is_empty() {
            true => String::new(),
            false => format!("Beside {}, ", self.beside.join(" and ")),
        };
        let score = format!("{beside}{} is the best, with a score of {}", best.named(), number(best.score));
        match (self.taken, self.tied) {
            (true, 1) => format!("{score}; {held}. It is taken."),
            (true, 2) => {
                format!("{score}; {held}. It is taken, although the data cannot tell it from another.")
            }
            (true, tied) => format!(
                "{score}; {held}. It is taken, although the data cannot tell it from {} others.",
                tied - 1
            ),
            (false, _) if best.score <= self.needed => {
                format!(
                    "{score}, which is less than the {} that so many trials ask for. None is taken.",
                    number(self.needed)
                )
            }
            (false, _) if !self.closes_enough() => format!(
                "{score}; but it closes only {} % of what is left, and what it leaves is no noise. None is taken.",
                number(100.0 * self.closed())
            ),
            (false, _) => format!("{score}; but {held}, which is no evidence. None is taken."),
        }
    }
}
