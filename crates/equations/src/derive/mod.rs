//! Derives the equations of a circuit from its program.

mod loops;
mod simplify;
mod system;
mod wiring;

pub(crate) use simplify::simplified;
pub(crate) use system::{Law, LawKind, ModeLaw, Source, System, TransitionLaw};
pub(crate) use wiring::{Options, derive, ranged};

#[cfg(test)]
mod tests;
