//! Draws figures and examines claims on several threads.
//!
//! The results keep the order of the input and do not depend on the number of threads. A figure is worked on together
//! with its claims, so that its results can be shown before later figures are drawn. The first error ends the replay.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::checks::CheckError;
use super::claim::Claim;
use super::examined_claim::ExaminedClaim;
use super::figures::{DrawnFigure, Figure, FigureError};
use super::gallery::GalleryFigure;
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
    /// A claim to examine, and its index among all claims.
    Claim(usize, &'a Claim),
}

/// The result of one item of work.
enum ItemResult {
    /// A drawn figure.
    Figure(DrawnFigure),
    /// An examined claim, and its index among all claims.
    Claim(usize, Box<ExaminedClaim>),
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
    progress: impl FnMut(u64, u64),
) -> Result<(Vec<DrawnFigure>, Vec<ExaminedClaim>), ReplayError> {
    run_each(figures, claims, threads, progress, |_| Ok(()))
}

/// Draws the figures and examines the claims like [`run_all`], and passes each figure to `finish` as soon as it is
/// drawn, its claims are examined, and all earlier figures are finished.
///
/// `progress` and `finish` are called on the calling thread.
///
/// # Errors
/// If a figure cannot be drawn, or a claim cannot be examined. The first error of `finish`. In all cases earlier
/// figures are finished.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::{ReplayError, figures, run_each};
///
/// let figures: Vec<_> = figures().filter(|figure| figure.id.starts_with("fig-2-")).collect();
/// let mut finished = Vec::new();
/// run_each(&figures, &[], 2, |_, _| (), |entry| {
///     finished.push(entry.figure.id);
///     Ok::<(), ReplayError>(())
/// })?;
/// assert_eq!(finished, ["fig-2-02", "fig-2-03"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_each<E: From<ReplayError>>(
    figures: &[&'static Figure],
    claims: &[Claim],
    threads: usize,
    mut progress: impl FnMut(u64, u64),
    mut finish: impl FnMut(&GalleryFigure<'_>) -> Result<(), E>,
) -> Result<(Vec<DrawnFigure>, Vec<ExaminedClaim>), E> {
    let (items, ends) = plan(figures, claims);
    let (all, done) = (items.len() as u64, AtomicU64::new(0));
    progress(0, all);
    let work = |_: &mut (), indices: Range<u64>| -> Vec<Result<ItemResult, ReplayError>> {
        let run = |index: u64| {
            let result = items[index as usize].run();
            done.fetch_add(1, Ordering::Relaxed);
            result
        };
        indices.map(run).collect()
    };
    let mut results = Results { figures, drawn: Vec::new(), examined: vec![None; claims.len()], count: 0 };
    let mut finished = 0;
    let take = |result: Option<Result<ItemResult, ReplayError>>| -> Result<(), E> {
        progress(done.load(Ordering::Relaxed), all);
        let Some(result) = result else { return Ok(()) };
        results.add(result?);
        if ends.get(finished) == Some(&results.count) {
            finish(&results.figure(finished))?;
            finished += 1;
        }
        Ok(())
    };
    let workers = vec![(); WORKERS_PER_THREAD * threads.max(1)];
    parallel::run_in_order(0..all, all.max(1), threads, workers, |_| 1, work, take)?;
    Ok((results.drawn, results.examined.into_iter().flatten().collect()))
}

/// Work items per thread that are started. While the results of one are taken, the thread continues with the other.
const WORKERS_PER_THREAD: usize = 2;

/// The items of work in their order, and for each figure the number of items after which it is finished.
///
/// The claims of a figure follow it, unless an earlier figure has them too. Claims without a figure are last.
fn plan<'a>(figures: &[&'static Figure], claims: &'a [Claim]) -> (Vec<WorkItem<'a>>, Vec<usize>) {
    let (mut items, mut ends) = (Vec::new(), Vec::new());
    let mut remaining: Vec<(usize, &Claim)> = claims.iter().enumerate().collect();
    for figure in figures {
        items.push(WorkItem::Figure(figure));
        let (related, others): (Vec<_>, Vec<_>) =
            remaining.into_iter().partition(|(_, claim)| figure.is_related_to(claim));
        items.extend(related.into_iter().map(|(index, claim)| WorkItem::Claim(index, claim)));
        remaining = others;
        ends.push(items.len());
    }
    items.extend(remaining.into_iter().map(|(index, claim)| WorkItem::Claim(index, claim)));
    (items, ends)
}

/// The results so far.
struct Results<'f> {
    /// All figures.
    figures: &'f [&'static Figure],
    /// The drawn figures, in their order.
    drawn: Vec<DrawnFigure>,
    /// The examined claims by their index; `None` if a claim is not examined yet.
    examined: Vec<Option<ExaminedClaim>>,
    /// The number of results.
    count: usize,
}

impl Results<'_> {
    /// Adds a result. Figures are added in their order.
    fn add(&mut self, result: ItemResult) {
        self.count += 1;
        match result {
            ItemResult::Figure(figure) => self.drawn.push(figure),
            ItemResult::Claim(index, claim) => self.examined[index] = Some(*claim),
        }
    }

    /// Returns a drawn figure with its examined claims.
    fn figure(&self, index: usize) -> GalleryFigure<'_> {
        GalleryFigure::new(self.figures[index], &self.drawn[index], self.examined.iter().flatten())
    }
}

impl WorkItem<'_> {
    /// Draws the figure, or examines the claim and adds its identifier to an error.
    fn run(&self) -> Result<ItemResult, ReplayError> {
        match self {
            WorkItem::Figure(figure) => Ok(ItemResult::Figure(figure.draw()?)),
            WorkItem::Claim(index, claim) => {
                let examined = ExaminedClaim::new(claim);
                let with_id = |error| ReplayError::Claim { id: claim.id.clone(), error };
                Ok(ItemResult::Claim(*index, Box::new(examined.map_err(with_id)?)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::{figures, ledger};

    /// The figures of chapter 2, and the first claims of that chapter in the opposite order.
    fn chapter_2() -> (Vec<&'static Figure>, Vec<Claim>) {
        let mut claims: Vec<Claim> =
            ledger().unwrap().into_iter().filter(|claim| claim.id.starts_with("2-00")).collect();
        claims.reverse();
        (figures().filter(|figure| figure.chapter() == "Chapter 2").collect(), claims)
    }

    /// The identifiers of claims.
    fn claim_ids(claims: &[&ExaminedClaim]) -> Vec<String> {
        claims.iter().map(|row| row.claim.id.clone()).collect()
    }

    #[test]
    fn each_figure_is_finished_with_all_of_its_claims() {
        let (figures, claims) = chapter_2();
        let mut finished = Vec::new();
        let outcome = run_each(
            &figures,
            &claims,
            2,
            |_, _| (),
            |entry| {
                finished.push((entry.figure.id, claim_ids(&entry.claims)));
                Ok::<(), ReplayError>(())
            },
        );
        let (drawn, examined) = outcome.unwrap();
        let of_all = figures.iter().zip(&drawn).map(|(figure, drawn)| {
            (figure.id, claim_ids(&GalleryFigure::new(figure, drawn, &examined).claims))
        });
        assert_eq!(finished, of_all.collect::<Vec<_>>());
        assert!(finished.iter().any(|(_, ids)| !ids.is_empty()));
        let order: Vec<&str> = claims.iter().map(|claim| claim.id.as_str()).collect();
        assert_eq!(claim_ids(&examined.iter().collect::<Vec<_>>()), order);
    }

    #[test]
    fn an_error_ends_the_replay_after_the_earlier_figures() {
        let (figures, claims) = chapter_2();
        assert!(figures.len() > 1);
        let mut finished = 0;
        let outcome = run_each(
            &figures,
            &claims,
            2,
            |_, _| (),
            |entry| {
                finished += 1;
                Err(ReplayError::from(FigureError { id: entry.figure.id, problem: "disk full".into() }))
            },
        );
        let error = outcome.unwrap_err();
        assert_eq!((error.to_string(), finished), (format!("{}: disk full", figures[0].id), 1));
    }
}
