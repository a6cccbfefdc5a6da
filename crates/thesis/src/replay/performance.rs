//! Figures drawn and claims examined on several threads, in an order that does not depend on them.

use super::checks::CheckError;
use super::claim::Claim;
use super::examined::Examined;
use super::figures::{Drawn, Figure, FigureError};
use patchcord_analysis::pool;

/// Why a replay ends early.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A figure that cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A claim that cannot be examined.
    #[error("claim {id}: {error}")]
    Claim {
        /// Which.
        id: String,
        /// Why.
        error: CheckError,
    },
}

/// One thing to be done.
enum Piece<'a> {
    Figure(&'static Figure),
    Claim(&'a Claim),
}

enum Outcome {
    Figure(Drawn),
    Claim(Box<Examined>),
}

/// The figures drawn and the claims examined, both in their order. `progress` is told how many of how many are done.
///
/// # Errors
/// The first figure that cannot be drawn, or claim that cannot be examined.
pub fn perform(
    figures: &[&'static Figure],
    claims: &[Claim],
    threads: usize,
    mut progress: impl FnMut(u64, u64),
) -> Result<(Vec<Drawn>, Vec<Examined>), ReplayError> {
    let figures = figures.iter().map(|figure| Piece::Figure(figure));
    let pieces: Vec<_> = figures.chain(claims.iter().map(Piece::Claim)).collect();
    let all = pieces.len() as u64;
    let outcomes = pool::each(&pieces, threads, Piece::done, |done| progress(done, all));
    let (mut drawn, mut examined) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome? {
            Outcome::Figure(figure) => drawn.push(figure),
            Outcome::Claim(claim) => examined.push(*claim),
        }
    }
    Ok((drawn, examined))
}

impl Piece<'_> {
    fn done(&self) -> Result<Outcome, ReplayError> {
        match self {
            Piece::Figure(figure) => Ok(Outcome::Figure(figure.draw()?)),
            Piece::Claim(claim) => {
                let examined = Examined::of(claim);
                let told = |error| ReplayError::Claim { id: claim.id.clone(), error };
                Ok(Outcome::Claim(Box::new(examined.map_err(told)?)))
            }
        }
    }
}
