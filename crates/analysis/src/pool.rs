//! Work done by several threads, and taken in its order.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::hint::black_box;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::spare::Seat;

/// After so long without a result whoever waits for it is told.
const TOLD_AFTER: Duration = Duration::from_secs(1);

/// Does the work of every index on so many threads, each with an object of its own that tells how many indices it does next, and
/// gives the results to `take` in the order of the indices, on this thread; nothing after every second that brought none. For
/// each thread, the fastest may be so many ahead of what was taken: what waits for a slow one stays in memory. Where the
/// system gives fewer threads, these do it all; where it gives none, this one. When `take` refuses, what has begun is
/// finished and the rest left.
pub fn in_order<W, T: Send, E>(
    indices: Range<u64>,
    ahead: u64,
    workers: Vec<W>,
    share: impl Fn(&W) -> u64 + Sync,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T> + Sync,
    mut take: impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E>
where
    W: Send,
{
    let window = ahead * workers.len() as u64;
    let (queue, count, workers) = (Queue::new(indices.clone(), window), workers.len(), Mutex::new(workers));
    let worker = || workers.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let run = || {
        let _guard = StopsOnPanic(&queue);
        let Some(mut worker) = worker() else { return };
        while let Some(some) = queue.next(share(&worker)) {
            queue.put(some.start, work(&mut worker, some));
        }
    };
    thread::scope(|scope| {
        let _guard = StopsOnPanic(&queue);
        let begins = |_: &usize| has_room() && thread::Builder::new().spawn_scoped(scope, run).is_ok();
        let begun = (0..count).take_while(begins).count();
        let outcome = match (begun == 0).then(worker).flatten() {
            Some(worker) => alone(indices, worker, &share, &work, &mut take),
            None => queue.drain(&mut take),
        };
        queue.stop();
        outcome
    })
}

/// The result of every item in their order, worked out on so many threads; those that have run out of items help the others
/// with what they do by [`spare::each`](crate::spare::each). `progress` is told how many are done.
pub fn each<I: Sync, T: Send>(
    items: &[I],
    threads: usize,
    work: impl Fn(&I) -> T + Sync,
    mut progress: impl FnMut(u64),
) -> Vec<T> {
    let (count, mut results) = (items.len() as u64, Vec::with_capacity(items.len()));
    let work = |seat: &mut Seat, some: Range<u64>| {
        let _seated = seat.take();
        some.map(|index| work(&items[index as usize])).collect()
    };
    let Ok(()) = in_order(
        0..count,
        count,
        Seat::several(threads.max(1)),
        |_| 1,
        work,
        |result| {
            results.extend(result);
            progress(results.len() as u64);
            Ok::<(), Infallible>(())
        },
    );
    results
}

/// Does it all on this thread.
fn alone<W, T, E>(
    mut left: Range<u64>,
    mut worker: W,
    share: &impl Fn(&W) -> u64,
    work: &impl Fn(&mut W, Range<u64>) -> Vec<T>,
    take: &mut impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E> {
    while !left.is_empty() {
        let some = cut(&mut left, share(&worker));
        work(&mut worker, some).into_iter().try_for_each(|result| take(Some(result)))?;
    }
    Ok(())
}

/// Takes so many indices from the beginning of others; all where there are fewer, and one at least.
fn cut(left: &mut Range<u64>, count: u64) -> Range<u64> {
    let some = left.start..left.end.min(left.start.saturating_add(count.max(1)));
    left.start = some.end;
    some
}

/// Bytes that stay free for the work of all threads: a process ends where it gets none.
const ROOM: usize = 1 << 28;

/// Whether one more thread leaves that much.
fn has_room() -> bool {
    let mut room = Vec::<u8>::new();
    // What nobody looks at would not be asked for.
    room.try_reserve_exact(ROOM).is_ok() && black_box(room).capacity() >= ROOM
}

/// Lets all others end where a thread breaks off: nothing waits for what does not come any more.
struct StopsOnPanic<'q, T>(&'q Queue<T>);

impl<T> Drop for StopsOnPanic<'_, T> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.stop();
        }
    }
}

/// What is still to be done, and what was done and not yet taken.
struct Queue<T> {
    state: Mutex<State<T>>,
    window: u64,
    /// Something was taken: there is room for more.
    room: Condvar,
    /// Something was done.
    done: Condvar,
}

struct State<T> {
    /// Indices to do.
    left: Range<u64>,
    /// Next index to take.
    due: u64,
    /// Results from `due` on.
    ready: VecDeque<Option<T>>,
    is_stopped: bool,
}

impl<T> Queue<T> {
    fn new(indices: Range<u64>, window: u64) -> Self {
        let due = indices.start;
        let state = State { left: indices, due, ready: VecDeque::new(), is_stopped: false };
        let (room, done) = (Condvar::new(), Condvar::new());
        Queue { state: Mutex::new(state), window, room, done }
    }

    /// A thread that broke off leaves the state as whole as it was.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// So many indices to do, as far as there are, once there is room for their results.
    fn next(&self, count: u64) -> Option<Range<u64>> {
        let count = count.min(self.window);
        let full = |state: &mut State<T>| {
            let end = state.left.end.min(state.left.start + count);
            !state.is_stopped && end > state.due + self.window
        };
        let mut state = self.room.wait_while(self.lock(), full).unwrap_or_else(PoisonError::into_inner);
        let is_over = state.is_stopped || state.left.is_empty();
        (!is_over).then(|| cut(&mut state.left, count))
    }

    /// Results of indices from one on.
    fn put(&self, first: u64, results: Vec<T>) {
        let mut state = self.lock();
        let place = (first - state.due) as usize;
        let end = state.ready.len().max(place + results.len());
        state.ready.resize_with(end, || None);
        for (ready, result) in state.ready.range_mut(place..).zip(results) {
            *ready = Some(result);
        }
        self.done.notify_one();
    }

    fn drain<E>(&self, take: &mut impl FnMut(Option<T>) -> Result<(), E>) -> Result<(), E> {
        while self.is_going_on() {
            take(self.first())?;
        }
        Ok(())
    }

    /// Whether a result is still to come.
    fn is_going_on(&self) -> bool {
        let state = self.lock();
        !state.is_stopped && state.due < state.left.end
    }

    /// The next result in order; nothing where it is not there after a while.
    fn first(&self) -> Option<T> {
        let is_missing =
            |state: &mut State<T>| !state.is_stopped && !matches!(state.ready.front(), Some(Some(_)));
        let waited = self.done.wait_timeout_while(self.lock(), TOLD_AFTER, is_missing);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let first = state.ready.front_mut()?.take()?;
        state.ready.pop_front();
        state.due += 1;
        self.room.notify_all();
        Some(first)
    }

    fn stop(&self) {
        self.lock().is_stopped = true;
        self.room.notify_all();
        self.done.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::sync::mpsc::Receiver;

    use super::*;

    const AHEAD: u64 = 64;

    /// What a thousand pieces of uneven work come to, so many at a time, and how far the fastest was ahead.
    fn thousand(threads: usize, share: u64) -> (Vec<u64>, u64) {
        let (taken, furthest) = (AtomicU64::new(0), AtomicU64::new(0));
        let mut results = Vec::new();
        let piece = |index: u64| {
            furthest.fetch_max(index - taken.load(Ordering::SeqCst).min(index), Ordering::SeqCst);
            (0..(index * 7919 % 97) * 100)
                .fold(index, |sum, number| std::hint::black_box(sum ^ number ^ number))
        };
        let work = |(): &mut (), some: Range<u64>| {
            assert!(some.end - some.start == share || some.end == 1000, "{some:?}");
            some.map(piece).collect()
        };
        let take = |result| {
            results.extend(result);
            taken.store(results.len() as u64, Ordering::SeqCst);
            Ok::<(), ()>(())
        };
        in_order(0..1000, AHEAD, vec![(); threads], |()| share, work, take).unwrap();
        (results, furthest.into_inner())
    }

    #[test]
    fn results_come_in_order_and_none_is_far_ahead() {
        for (threads, share) in [(1, 1), (2, 1), (7, 1), (1, 16), (2, 7), (7, 64)] {
            let (results, furthest) = thousand(threads, share);
            assert!(results.iter().copied().eq(0..1000), "{threads} threads");
            assert!(furthest <= AHEAD * threads as u64 + 1, "{furthest} with {threads} threads");
        }
    }

    /// The first piece waits until it was told that nothing has come.
    #[test]
    fn whoever_waits_is_told() {
        let (told, heard) = std::sync::mpsc::channel();
        let work = |heard: &mut Receiver<()>, some: Range<u64>| {
            if some.start == 0 {
                heard.recv().unwrap();
            }
            some.collect()
        };
        let mut taken = Vec::new();
        let take = |index: Option<u64>| {
            taken.push(index);
            if index.is_none() { told.send(()) } else { Ok(()) }
        };
        in_order(0..3, AHEAD, vec![heard], |_| 1, work, take).unwrap();
        assert!(taken.starts_with(&[None]) && taken.into_iter().flatten().eq(0..3));
    }

    #[test]
    fn a_refusal_ends_the_work() {
        let done = AtomicU64::new(0);
        let work = |(): &mut (), some: Range<u64>| {
            done.fetch_add(some.end - some.start, Ordering::SeqCst);
            some.collect()
        };
        let take = |index| if index == Some(10) { Err("full") } else { Ok(()) };
        assert_eq!(in_order(0..1_000_000, AHEAD, vec![(), ()], |()| 1, work, take), Err("full"));
        assert!(done.load(Ordering::SeqCst) <= 11 + 2 * AHEAD + 2);
        assert_eq!(in_order(5..5, AHEAD, vec![()], |()| 1, work, |_| Err("none is due")), Ok(()));
    }

    #[test]
    fn a_panic_ends_the_work() {
        let broken = |at: u64| move |index: u64| assert!(index != at, "{index}");
        let outcomes = [(10, u64::MAX), (u64::MAX, 10)].map(|(working, taking)| {
            let work =
                |(): &mut (), some: Range<u64>| some.inspect(|index| broken(working)(*index)).collect();
            let take = |index: Option<u64>| {
                index.into_iter().for_each(broken(taking));
                Ok::<(), ()>(())
            };
            std::panic::catch_unwind(|| in_order(0..1_000_000, AHEAD, vec![(), ()], |()| 1, work, take))
        });
        assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
    }
}
