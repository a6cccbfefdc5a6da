//! Threads that have run out of work, lent to whoever else of the same pool has several things to do: no core stands idle while
//! the longest piece of work is finished. What comes out does not depend on it.

use std::cell::RefCell;
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

    /// Sits down: this thread may ask those for help that have left.
    pub fn take(&self) {
        SPARE.with_borrow_mut(|own| own.clone_from(&self.0));
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::AcqRel);
    }
}

/// Does some work with so many threads at hand, this one among them.
pub fn with_threads<T>(threads: usize, work: impl FnOnce() -> T) -> T {
    let spare = Arc::new(AtomicUsize::new(threads.saturating_sub(1)));
    let before = SPARE.replace(spare);
    let done = work();
    SPARE.set(before);
    done
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::thread;
    use std::time::Duration;

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
