//! What an effect must gain to be more than chance.

/// What an effect is measured by, and has to come to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bar {
    /// The variance of what counts as noise, in squares of the noise of the data,
    pub(crate) noise: f64,
    /// and how many samples it remembers.
    pub(crate) memory: f64,
    /// The score that is asked for.
    pub(crate) needed: f64,
}

impl Bar {
    /// That of so many trials where all is explained but white noise.
    pub(crate) fn of_noise(trials: usize) -> Bar {
        Bar { noise: 1.0, memory: 1.0, needed: needed(trials) }
    }

    /// The variance of the noise for each sample that does not remember the one before.
    pub(crate) fn variance(&self) -> f64 {
        self.noise * self.memory
    }
}

/// The score that the best must have to be more than chance,
const CHANCE: f64 = 4.0;
/// and what the logarithm of the number of trials adds: the best of many is better by chance, too.
const TRIED: f64 = 2.0;
/// What is held back must be explained better by so many standard errors.
pub(crate) const CONFIRMED: f64 = 2.0;

/// A rival is behind the best trial if the data held back say so by this many standard errors.
pub(crate) const APART: f64 = 2.5;

/// The score that the best of so many must have.
pub(crate) fn needed(trials: usize) -> f64 {
    CHANCE + TRIED * libm::log(trials.max(1) as f64)
}
