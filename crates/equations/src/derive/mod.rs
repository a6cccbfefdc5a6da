//! Derives the equations of a circuit from its program.

mod loops;
mod simplify;
mod system;
mod wiring;

pub(crate) use simplify::simplified;
<<<<<<< HEAD
pub(crate) use system::{Law, LawKind, ModeLaw, Source, System, TransitionLaw, interpolated};
pub(crate) use wiring::{Options, derive};
=======
pub(crate) use system::{Law, LawKind, ModeLaw, Source, System, TransitionLaw};
pub(crate) use wiring::{Options, derive, is_nonnegative, ranged};
>>>>>>> eq-static

#[cfg(test)]
mod tests;
