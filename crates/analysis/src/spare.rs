//! Threads that have run out of work, lent to whoever else of the same pool begins several things: cores stand less idle while the
//! longest pieces of work are finished. What comes out does not depend on it.

use std::cell::RefCell;
use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::pool;

thread_local! {
    /// How many threads could help this one.
    static SPARE: RefCell<Arc<AtomicUsize>> = RefCell::default();
}

/// The place of a thread in a pool; whoever leaves it can help the others.
pub(crate) struct Seat(Arc<AtomicUsize>);

impl Seat {
    /// Places of a pool of so many threads, none of which has run out of work.
    pub fn several(count: usize) -> Vec<Seat> {
        let spare = Arc::<AtomicUsize>::default();
        (0..count).map(|_| Seat(spare.clone())).collect()
    }

    /// Sits down, until what is given back goes: this thread may ask those for help that have left.
    pub fn take(&self) -> Seated {
        Seated::with(self.0.clone())
    }
}

/// A thread that others may help; afterwards those may that could before.
pub(crate) struct Seated {
    before: Arc<AtomicUsize>,
}

impl Seated {
    fn with(spare: Arc<AtomicUsize>) -> Seated {
        Seated { before: SPARE.replace(spare) }
    }
}

impl Drop for Seated {
    fn drop(&mut self) {
        SPARE.set(mem::take(&mut self.before));
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::AcqRel);
    }
}

/// Does some work with so many threads at hand, this one among them.
pub fn with_threads<T>(threads: usize, work: impl FnOnce() -> T) -> T {
    let _seated = Seated::with(Arc::new(AtomicUsize::new(threads.saturating_sub(1))));
    work()
}

/// Threads that were lent, until they are given back.
struct Lent {
    from: Arc<AtomicUsize>,
    count: usize,
}

impl Lent {
    /// As many as are to be had, up to so many.
    fn most(count: usize) -> Lent {
        let from = SPARE.with_borrow(Arc::clone);
        let before =
            from.fetch_update(Ordering::AcqRel, Ordering::Acquire, |spare| Some(spare - spare.min(count)));
        let count = before.map_or(0, |spare| spare.min(count));
        Lent { from, count }
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        self.from.fetch_add(self.count, Ordering::AcqRel);
    }
}

/// The result for every number below a count, in their order, worked out on this thread and on those that have nothing else to do.
pub fn each<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let lent = Lent::most(count.saturating_sub(1));
    match lent.count {
        0 => (0..count).map(work).collect(),
        helping => pool::each(&(0..count).collect::<Vec<_>>(), 1 + helping, |number| work(*number), |_| ()),
    }
}

/// The same, so many numbers at a time, each result taken in order before more is worked out than these.
pub fn each_of<T: Send>(
    count: usize,
    at_once: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(T),
) {
    for first in (0..count).step_by(at_once.max(1)) {
        each(at_once.min(count - first), |place| work(first + place)).into_iter().for_each(&mut take);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::thread;
    use std::time::Duration;

    use super::*;

    /// On how many threads twelve pieces of work are done that take a while.
    fn threads_used() -> usize {
        let own = |number: usize| {
            thread::sleep(Duration::from_millis(5));
            (number, thread::current().id())
        };
        let done = each(12, own);
        assert!(done.iter().map(|own| own.0).eq(0..12));
        done.into_iter().map(|own| own.1).collect::<HashSet<_>>().len()
    }

    #[test]
    fn whoever_has_no_work_helps_and_goes_again() {
        assert_eq!(threads_used(), 1);
        assert_eq!(with_threads(3, || [threads_used(), threads_used()]), [3, 3]);
        assert_eq!(threads_used(), 1);
    }

    #[test]
    fn the_last_of_a_pool_is_helped_by_those_that_have_left() {
        let piece = |number: &u64| {
            thread::sleep(Duration::from_millis(100 * number));
            threads_used()
        };
        assert_eq!(pool::each(&[0, 1], 2, piece, |_| ())[1], 2);
        let nested = |_: usize| with_threads(1, threads_used);
        assert!(with_threads(2, || each(4, nested)).iter().all(|used| *used == 1));
    }
}
