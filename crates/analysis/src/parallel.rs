//! Parallel work on rayon, with results in the order of the work items.
//!
//! [`with_threads`] provides the threads. [`map`] and its relatives use them at any depth of calls, and run on the
//! calling thread if there are none. [`try_map`] ends at the first error. [`run_in_order`] is for long work whose
//! results are written while it continues. No result depends on the number of threads.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::Range;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// If no result arrives for this long, `take` is called with None, so that it can report progress.
const WAIT: Duration = Duration::from_secs(1);

/// Bytes of stack per thread. A thread that waits for a nested [`map`] may begin other items on the same stack.
const STACK_SIZE: usize = 16 << 20;

/// A pool of at most `threads` threads, or as many as the system provides; None if it provides none.
fn pool(threads: usize) -> Option<ThreadPool> {
    let build =
        |count: usize| ThreadPoolBuilder::new().num_threads(count).stack_size(STACK_SIZE).build().ok();
    std::iter::successors(Some(threads.max(1)), |count| Some(count / 2))
        .take_while(|count| *count > 0)
        .find_map(build)
}

/// Runs `work` on a pool of `threads` threads. The functions of this module that `work` calls share these threads.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::parallel::{map_indices, with_threads};
///
/// let squares = with_threads(2, || map_indices(4, |index| index * index));
/// assert_eq!(squares, [0, 1, 4, 9]);
/// ```
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match pool(threads) {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// The results of `work` for all items, in order. `progress` receives the number of completed items after each one.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::parallel::{map, with_threads};
///
/// let mut completed = Vec::new();
/// let doubled = with_threads(2, || map(&[1_u64, 2, 3], |number| number * 2, |count| completed.push(count)));
/// assert_eq!((doubled, completed), (vec![2, 4, 6], vec![1, 2, 3]));
/// ```
pub fn map<I: Sync, T: Send>(
    items: &[I],
    work: impl Fn(&I) -> T + Sync,
    mut progress: impl FnMut(u64) + Send,
) -> Vec<T> {
    let Ok(results) = try_map(items, |item| Ok::<T, Infallible>(work(item)), |count, _, _| progress(count));
    results
}

/// Like [`map`], for work that may fail. `progress` receives the number of completed items, the last completed item
/// and its result.
///
/// # Errors
/// If the work fails for an item. No further work begins then. If it fails for several items, the error is one of
/// theirs.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::parallel::try_map;
///
/// let mut halves = Vec::new();
/// let half = |number: &u64| if number % 2 == 0 { Ok(number / 2) } else { Err(format!("{number} is odd")) };
/// let result = try_map(&[2, 4, 5, 6], half, |_, _, half| halves.push(*half));
/// assert_eq!((result, halves), (Err("5 is odd".to_owned()), vec![1, 2]));
/// ```
pub fn try_map<I: Sync, T: Send, E: Send>(
    items: &[I],
    work: impl Fn(&I) -> Result<T, E> + Sync,
    progress: impl FnMut(u64, &I, &T) + Send,
) -> Result<Vec<T>, E> {
    let progress = Mutex::new((0, progress));
    let counted = |index: usize| {
        let item = &items[index];
        let result = work(item)?;
        let (done, progress) = &mut *progress.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        progress(*done, item, &result);
        Ok(result)
    };
    try_map_indices(items.len(), counted)
}

/// The results of `work` for all indices below `count`, in order. The work begins in this order too, so long work
/// should have the first indices: then no thread waits for it at the end.
///
/// # Examples
///
/// Without [`with_threads`] the work is done on the calling thread:
///
/// ```
/// use patchcord_analysis::parallel::map_indices;
///
/// assert_eq!(map_indices(3, |index| 10 * index), [0, 10, 20]);
/// ```
pub fn map_indices<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let Ok(results) = try_map_indices(count, |index| Ok::<T, Infallible>(work(index)));
    results
}

/// Like [`map_indices`], for work that may fail.
///
/// # Errors
/// As for [`try_map`].
fn try_map_indices<T: Send, E: Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    if rayon::current_thread_index().is_none() {
        return (0..count).map(work).collect();
    }
    // A bridge hands out the indices one by one. A parallel range would be split in halves.
    let numbered = (0..count).par_bridge().map(|index| Ok((index, work(index)?)));
    let mut results = numbered.collect::<Result<Vec<(usize, T)>, E>>()?;
    results.sort_unstable_by_key(|(index, _)| *index);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// Like [`map_indices`], in batches of `batch` indices. Passes the results of a batch to `take`, in order, before the
/// next batch starts. This limits the memory for results.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::parallel::map_in_batches;
///
/// let mut taken = Vec::new();
/// map_in_batches(5, 2, |index| 10 * index, |result| taken.push(result));
/// assert_eq!(taken, [0, 10, 20, 30, 40]);
/// ```
pub fn map_in_batches<T: Send>(
    count: usize,
    batch: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(T),
) {
    for first in (0..count).step_by(batch.max(1)) {
        map_indices(batch.min(count - first), |offset| work(first + offset)).into_iter().for_each(&mut take);
    }
}

/// Runs `work` for every index on `threads` threads and passes the results to `take` in index order on the calling
/// thread.
///
/// A batch of indices is processed with one of the `workers`, which only one batch uses at a time. With more workers
/// than threads, a thread need not wait until `take` has received its last batch. `batch_size(&worker)` is the number
/// of indices in its next batch. `take` receives None after every second without a result. At most `max_waiting`
/// results per worker wait for a slower one, which limits memory.
///
/// # Errors
/// The first error of `take`. Work in progress is then completed, and the rest is skipped.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::parallel::run_in_order;
///
/// let mut taken: Vec<u64> = Vec::new();
/// let work = |_: &mut (), batch: std::ops::Range<u64>| batch.map(|index| 10 * index).collect();
/// let take = |result: Option<u64>| {
///     taken.extend(result);
///     Ok::<(), String>(())
/// };
/// run_in_order(0..5, 64, 2, vec![(), ()], |_| 1, work, take)?;
/// assert_eq!(taken, [0, 10, 20, 30, 40]);
/// # Ok::<(), String>(())
/// ```
pub fn run_in_order<W: Send, T: Send, E>(
    indices: Range<u64>,
    max_waiting: u64,
    threads: usize,
    mut workers: Vec<W>,
    batch_size: impl Fn(&W) -> u64,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T> + Sync,
    mut take: impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E> {
    let window = max_waiting * workers.len() as u64;
    let Some(pool) = pool(threads) else { return run_alone(indices, workers, batch_size, work, take) };
    let (sender, receiver) = mpsc::channel();
    let work = &work;
    pool.in_place_scope(|scope| {
        let (mut remaining, mut next, mut ready) = (indices.clone(), indices.start, BTreeMap::new());
        while next < indices.end {
            while !remaining.is_empty() {
                let Some(worker) = workers.pop() else { break };
                let count = batch_size(&worker).clamp(1, window);
                if remaining.end.min(remaining.start + count) > next + window {
                    workers.push(worker);
                    break;
                }
                let (batch, sender) = (split_front(&mut remaining, count), sender.clone());
                scope.spawn(move |_| send_results(worker, batch, work, &sender));
            }
            match receiver.recv_timeout(WAIT) {
                Ok((first, worker, Ok(results))) => {
                    workers.push(worker);
                    ready.extend((first..).zip(results));
                }
                Ok((.., Err(panicked))) => panic::resume_unwind(panicked),
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => take(None)?,
            }
            while let Some(result) = ready.remove(&next) {
                next += 1;
                take(Some(result))?;
            }
        }
        Ok(())
    })
}

/// Runs a batch with a worker. Sends the first index, the worker, and the results or the panic.
fn send_results<W, T>(
    mut worker: W,
    batch: Range<u64>,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T>,
    sender: &Sender<(u64, W, std::thread::Result<Vec<T>>)>,
) {
    let first = batch.start;
    let results = panic::catch_unwind(AssertUnwindSafe(|| work(&mut worker, batch)));
    // The receiver is dropped only if `take` failed.
    let _ = sender.send((first, worker, results));
}

/// Runs all work on the calling thread, with one of the workers.
fn run_alone<W, T, E>(
    mut remaining: Range<u64>,
    workers: Vec<W>,
    batch_size: impl Fn(&W) -> u64,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T>,
    mut take: impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E> {
    for mut worker in workers.into_iter().take(1) {
        while !remaining.is_empty() {
            let batch = split_front(&mut remaining, batch_size(&worker));
            work(&mut worker, batch).into_iter().try_for_each(|result| take(Some(result)))?;
        }
    }
    Ok(())
}

/// Removes the first `count` indices, at least one, from a range and returns them. Returns all if there are fewer.
fn split_front(remaining: &mut Range<u64>, count: u64) -> Range<u64> {
    let front = remaining.start..remaining.end.min(remaining.start.saturating_add(count.max(1)));
    remaining.start = front.end;
    front
}

#[cfg(test)]
mod tests;
