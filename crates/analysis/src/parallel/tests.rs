//! Unit tests of `parallel`.

use std::collections::HashSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::thread;

use super::*;

const MAX_WAITING: u64 = 64;

/// The results of a thousand pieces of uneven work, and the largest number of results that waited for a slower one.
fn thousand(threads: usize, batch_size: u64) -> (Vec<u64>, u64) {
    let (taken, furthest) = (AtomicU64::new(0), AtomicU64::new(0));
    let mut results = Vec::new();
    let piece = |index: u64| {
        furthest.fetch_max(index - taken.load(Ordering::SeqCst).min(index), Ordering::SeqCst);
        (0..(index * 7919 % 97) * 100).fold(index, |sum, number| std::hint::black_box(sum ^ number ^ number))
    };
    let work = |(): &mut (), batch: Range<u64>| {
        assert!(batch.end - batch.start == batch_size || batch.end == 1000, "{batch:?}");
        batch.map(piece).collect()
    };
    let take = |result| {
        results.extend(result);
        taken.store(results.len() as u64, Ordering::SeqCst);
        Ok::<(), ()>(())
    };
    run_in_order(0..1000, MAX_WAITING, threads, vec![(); threads], |()| batch_size, work, take).unwrap();
    (results, furthest.into_inner())
}

#[test]
fn results_are_in_order_and_the_window_is_kept() {
    for (threads, batch_size) in [(1, 1), (2, 1), (7, 1), (1, 16), (2, 7), (7, 64)] {
        let (results, furthest) = thousand(threads, batch_size);
        assert!(results.iter().copied().eq(0..1000), "{threads} threads");
        assert!(furthest <= MAX_WAITING * threads as u64 + 1, "{furthest} with {threads} threads");
    }
}

/// The first piece of work waits until `take` was called without a result.
#[test]
fn take_is_called_while_no_result_is_ready() {
    let (sender, receiver) = std::sync::mpsc::channel();
    let work = |receiver: &mut Receiver<()>, batch: Range<u64>| {
        if batch.start == 0 {
            receiver.recv().unwrap();
        }
        batch.collect()
    };
    let mut taken = Vec::new();
    let take = |index: Option<u64>| {
        taken.push(index);
        if index.is_none() { sender.send(()) } else { Ok(()) }
    };
    run_in_order(0..3, MAX_WAITING, 1, vec![receiver], |_| 1, work, take).unwrap();
    assert!(taken.starts_with(&[None]) && taken.into_iter().flatten().eq(0..3));
}

#[test]
fn an_error_of_take_ends_the_work() {
    let done = AtomicU64::new(0);
    let work = |(): &mut (), batch: Range<u64>| {
        done.fetch_add(batch.end - batch.start, Ordering::SeqCst);
        batch.collect()
    };
    let take = |index| if index == Some(10) { Err("full") } else { Ok(()) };
    assert_eq!(run_in_order(0..1_000_000, MAX_WAITING, 2, vec![(), ()], |()| 1, work, take), Err("full"));
    assert!(done.load(Ordering::SeqCst) <= 11 + 2 * MAX_WAITING + 2);
    assert_eq!(run_in_order(5..5, MAX_WAITING, 1, vec![()], |()| 1, work, |_| Err("none is due")), Ok(()));
}

#[test]
fn a_panic_ends_the_work() {
    let broken = |at: u64| move |index: u64| assert!(index != at, "{index}");
    let outcomes = [(10, u64::MAX), (u64::MAX, 10)].map(|(working, taking)| {
        let work = |(): &mut (), batch: Range<u64>| batch.inspect(|index| broken(working)(*index)).collect();
        let take = |index: Option<u64>| {
            index.into_iter().for_each(broken(taking));
            Ok::<(), ()>(())
        };
        std::panic::catch_unwind(|| {
            run_in_order(0..1_000_000, MAX_WAITING, 2, vec![(), ()], |()| 1, work, take)
        })
    });
    assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
}

/// The number of threads that take part in twelve slow pieces of work.
fn threads_used() -> usize {
    let piece = |number: usize| {
        thread::sleep(Duration::from_millis(5));
        (number, thread::current().id())
    };
    let done = map_indices(12, piece);
    assert!(done.iter().map(|piece| piece.0).eq(0..12));
    done.into_iter().map(|piece| piece.1).collect::<HashSet<_>>().len()
}

#[test]
fn only_with_threads_provides_threads() {
    assert_eq!(threads_used(), 1);
    assert_eq!(with_threads(3, || [threads_used(), threads_used()]), [3, 3]);
    assert_eq!(with_threads(0, threads_used), 1);
    assert!(
        with_threads(2, || map_indices(4, |_| with_threads(1, threads_used))).iter().all(|used| *used == 1)
    );
}

#[test]
fn idle_threads_help_with_nested_work() {
    let piece = |number: &u64| {
        thread::sleep(Duration::from_millis(100 * number));
        threads_used()
    };
    assert_eq!(with_threads(2, || map(&[0, 1], piece, |_| ()))[1], 2);
}

#[test]
fn progress_counts_the_items() {
    let mut seen = Vec::new();
    let squares = with_threads(4, || map(&[1, 2, 3, 4, 5], |number| number * number, |done| seen.push(done)));
    assert_eq!((squares, seen), (vec![1, 4, 9, 16, 25], vec![1, 2, 3, 4, 5]));
}

/// Of a thousand items on two threads, the fourth fails. Only the items that have begun by then are completed.
#[test]
fn no_work_begins_after_an_error() {
    let items: Vec<u64> = (0..1000).collect();
    let begun = AtomicU64::new(0);
    let work = |item: &u64| {
        begun.fetch_add(1, Ordering::SeqCst);
        if *item == 3 {
            return Err("the fourth item");
        }
        thread::sleep(Duration::from_millis(2));
        Ok(())
    };
    let mut completed = 0;
    let result = with_threads(2, || try_map(&items, work, |count, _, ()| completed = count));
    assert_eq!(result, Err("the fourth item"));
    let begun = begun.into_inner();
    assert!(begun < 20 && completed < begun, "{begun} begun, {completed} completed");
}

#[test]
fn progress_receives_every_item_with_its_result() {
    let mut squares = Vec::new();
    let square = |number: &u64| Ok::<u64, ()>(number * number);
    let note = |_, item: &u64, square: &u64| squares.push((*item, *square));
    let results = with_threads(2, || try_map(&[3, 1, 2], square, note));
    assert_eq!(results, Ok(vec![9, 1, 4]));
    squares.sort_unstable();
    assert_eq!(squares, [(1, 1), (2, 4), (3, 9)]);
}
