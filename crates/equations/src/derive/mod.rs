//! Derives the equations of a circuit from its program.

mod loops;
mod nested_delays;
mod ramps;
mod simplify;
mod system;
mod wiring;

pub(crate) use ramps::{ramps, without_unnamed_ramps};
pub(crate) use simplify::simplified;
pub(crate) use system::{BrakeLaw, Law, LawKind, ModeLaw, Source, System, TransitionLaw};
pub(crate) use wiring::{Options, Wiring, derive, is_nonnegative, ranged};

#[cfg(test)]
mod tests;
