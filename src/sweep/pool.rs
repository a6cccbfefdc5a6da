//! Work done by several threads, and taken in its order.

use std::collections::VecDeque;
use std::hint::black_box;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Does the work of every index on so many threads, each with an object of its own, and gives the results to `take` in
/// the order of the indices, on this thread. For each thread, the fastest may be so many ahead of what was taken: what waits
/// for a slow one stays in memory. Where the system gives fewer threads, these do it all; where it gives none,
/// this one. When `take` refuses a result, what has begun is finished and the rest left.
pub(super) fn in_order<W, T: Send, E>(
    indices: Range<u64>,
    ahead: u64,
    workers: Vec<W>,
    work: impl Fn(&mut W, u64) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E>,
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
        while let Some(index) = queue.next() {
            queue.put(index, work(&mut worker, index));
        }
    };
    thread::scope(|scope| {
        let _guard = StopsOnPanic(&queue);
        let begins = |_: &usize| has_room() && thread::Builder::new().spawn_scoped(scope, run).is_ok();
        let begun = (0..count).take_while(begins).count();
        let outcome = match (begun == 0).then(worker).flatten() {
            Some(mut worker) => indices.into_iter().try_for_each(|index| take(work(&mut worker, index))),
            None => queue.drain(&mut take),
        };
        queue.stop();
        outcome
    })
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
    end: u64,
    /// Something was taken: there is room for more.
    room: Condvar,
    /// Something was done.
    done: Condvar,
}

struct State<T> {
    /// Next index to do.
    next: u64,
    /// Next index to take.
    due: u64,
    /// Results from `due` on.
    ready: VecDeque<Option<T>>,
    is_stopped: bool,
}

impl<T> Queue<T> {
    fn new(indices: Range<u64>, window: u64) -> Self {
        let state =
            State { next: indices.start, due: indices.start, ready: VecDeque::new(), is_stopped: false };
        let (room, done) = (Condvar::new(), Condvar::new());
        Queue { state: Mutex::new(state), window, end: indices.end, room, done }
    }

    /// A thread that broke off leaves the state as whole as it was.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An index to do, once there is room for its result.
    fn next(&self) -> Option<u64> {
        let full = |state: &mut State<T>| !state.is_stopped && state.next >= state.due + self.window;
        let mut state = self.room.wait_while(self.lock(), full).unwrap_or_else(PoisonError::into_inner);
        if state.is_stopped || state.next >= self.end {
            return None;
        }
        state.next += 1;
        Some(state.next - 1)
    }

    fn put(&self, index: u64, result: T) {
        let mut state = self.lock();
        let place = (index - state.due) as usize;
        if state.ready.len() <= place {
            state.ready.resize_with(place + 1, || None);
        }
        state.ready[place] = Some(result);
        self.done.notify_one();
    }

    fn drain<E>(&self, take: &mut impl FnMut(T) -> Result<(), E>) -> Result<(), E> {
        while let Some(result) = self.first() {
            take(result)?;
        }
        Ok(())
    }

    /// The next result in order, once it is there.
    fn first(&self) -> Option<T> {
        let is_missing = |state: &mut State<T>| {
            !state.is_stopped && state.due < self.end && !matches!(state.ready.front(), Some(Some(_)))
        };
        let mut state = self.done.wait_while(self.lock(), is_missing).unwrap_or_else(PoisonError::into_inner);
        let first = state.ready.pop_front().flatten()?;
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
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    const AHEAD: u64 = 64;

    /// What a thousand pieces of uneven work come to, and how far the fastest was ahead.
    fn thousand(threads: usize) -> (Vec<u64>, u64) {
        let (taken, furthest) = (AtomicU64::new(0), AtomicU64::new(0));
        let mut results = Vec::new();
        let work = |mine: &mut u64, index: u64| {
            *mine += 1;
            furthest.fetch_max(index - taken.load(Ordering::SeqCst).min(index), Ordering::SeqCst);
            (0..(index * 7919 % 97) * 100)
                .fold(index, |sum, number| std::hint::black_box(sum ^ number ^ number))
        };
        let take = |result| {
            results.push(result);
            taken.fetch_add(1, Ordering::SeqCst);
            Ok::<(), ()>(())
        };
        in_order(0..1000, AHEAD, vec![0; threads], work, take).unwrap();
        (results, furthest.into_inner())
    }

    #[test]
    fn results_come_in_order_and_none_is_far_ahead() {
        for threads in [1, 2, 7] {
            let (results, furthest) = thousand(threads);
            assert!(results.iter().copied().eq(0..1000), "{threads} threads");
            assert!(furthest <= AHEAD * threads as u64 + 1, "{furthest} with {threads} threads");
        }
    }

    #[test]
    fn a_refusal_ends_the_work() {
        let done = AtomicU64::new(0);
        let work = |(): &mut (), index| {
            done.fetch_add(1, Ordering::SeqCst);
            index
        };
        let take = |index| if index == 10 { Err("full") } else { Ok(()) };
        assert_eq!(in_order(0..1_000_000, AHEAD, vec![(), ()], work, take), Err("full"));
        assert!(done.load(Ordering::SeqCst) <= 11 + 2 * AHEAD + 2);
        assert_eq!(in_order(5..5, AHEAD, vec![()], work, |_| Err("none is due")), Ok(()));
    }

    #[test]
    fn a_panic_ends_the_work() {
        let broken = |at: u64| move |index: u64| assert!(index != at, "{index}");
        let outcomes = [(10, u64::MAX), (u64::MAX, 10)].map(|(working, taking)| {
            let work = |(): &mut (), index| {
                broken(working)(index);
                index
            };
            let take = |index| {
                broken(taking)(index);
                Ok::<(), ()>(())
            };
            std::panic::catch_unwind(|| in_order(0..1_000_000, AHEAD, vec![(), ()], work, take))
        });
        assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
    }
}
