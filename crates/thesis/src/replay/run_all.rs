//! Draws figures and examines claims on several threads.
//!
//! The results keep the order of the input and do not depend on the number of threads. The first error in that order
//! ends the replay.

use super::checks::CheckError;
use super::claim::Claim;
use super::examined_claim::ExaminedClaim;
use super::figures::{DrawnFigure, Figure, FigureError};
use patchcord_analysis::parallel;

/// The reason why a replay ends early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A claim cannot be examined.
    #[error("claim {id}: {error}")]
    Claim {
        /// The identifier of the claim.
        id: String,
        /// The error of its check.
        error: CheckError,
    },
}

/// One item of work.
enum WorkItem<'a> {
    /// A figure to draw.
    Figure(&'static Figure),
    /// A claim to examine.
    Claim(&'a Claim),
}

/// The result of one item of work.
enum ItemResult {
    /// A drawn figure.
    Figure(DrawnFigure),
    /// An examined claim.
    Claim(Box<ExaminedClaim>),
}

/// Draws the figures and examines the claims, and returns both in their order. `progress` receives the number of
/// finished items and the number of all items.
///
/// # Errors
/// If a figure cannot be drawn, or a claim cannot be examined. The first such error is returned.
///
/// # Examples
///
/// One figure and its claims, on two threads:
///
/// ```
/// use patchcord_thesis::replay::{figures, ledger, run_all};
///
/// let figure = figures().find(|figure| figure.id == "fig-2-02").ok_or("a figure of the thesis")?;
/// let claims: Vec<_> = ledger()?.into_iter().filter(|claim| figure.is_related_to(claim)).collect();
/// let mut finished = 0;
/// let (drawn, examined) = run_all(&[figure], &claims, 2, |done, _| finished = done)?;
/// assert_eq!((drawn.len(), examined.len()), (1, claims.len()));
/// assert_eq!(finished, 1 + claims.len() as u64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_all(
    figures: &[&'static Figure],
    claims: &[Claim],
    threads: usize,
    mut progress: impl FnMut(u64, u64) + Send,
) -> Result<(Vec<DrawnFigure>, Vec<ExaminedClaim>), ReplayError> {
    let figures = figures.iter().map(|figure| WorkItem::Figure(figure));
    let items: Vec<_> = figures.chain(claims.iter().map(WorkItem::Claim)).collect();
    let all = items.len() as u64;
    let work = || parallel::map(&items, WorkItem::run, |done| progress(done, all));
    let outcomes = parallel::with_threads(threads, work);
    let (mut drawn, mut examined) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome? {
            ItemResult::Figure(figure) => drawn.push(figure),
            ItemResult::Claim(claim) => examined.push(*claim),
        }
    }
    Ok((drawn, examined))
}

impl WorkItem<'_> {
    /// Draws the figure, or examines the claim and adds its identifier to an error.
    fn run(&self) -> Result<ItemResult, ReplayError> {
        match self {
            WorkItem::Figure(figure) => Ok(ItemResult::Figure(figure.draw()?)),
            WorkItem::Claim(claim) => {
                let examined = ExaminedClaim::new(claim);
                let with_id = |error| ReplayError::Claim { id: claim.id.clone(), error };
                Ok(ItemResult::Claim(Box::new(examined.map_err(with_id)?)))
            }
        }
    }
}
