//! The gap search on data in which an effect is hidden: which effects it names, and how often that is right.
//!
//!     cargo bench --bench gap                 all 1000 cases. Each result is appended to docs/hidden-effects.jsonl, so that
//!                                             an interrupted run continues. A complete file is discarded first. At the end
//!                                             docs/hidden-effects.md is written.
//!     cargo bench --bench gap -- page         writes docs/hidden-effects.md from the results so far, without a search
//!     cargo bench --bench gap -- 60           the cases 1 ... 60
//!     cargo bench --bench gap -- 41-90/7 -v   every seventh case of 41 ... 90, each with its search log
//!     cargo bench --bench gap -- 18,37        these two cases
//!     cargo bench --bench gap -- 1-1000/40 threads=2
//!                                             every fortieth case, each on two threads. Cases run in parallel on all cores.
//!     cargo bench --bench gap -- 60 in=FILE   the results are kept in FILE, and the cases in it are not searched again
//!
//! The program in benches/hidden makes the cases. It is compiled first, so a C compiler is needed.

mod case_result;
mod hidden_cases;
mod journal;
mod page;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use case_result::CaseResult;
use hidden_cases::HiddenCases;
use journal::Journal;
use patchcord::{Library, output};

/// Any error ends the benchmark. Errors cross threads, so they are Send and Sync.
type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The seed of the cases of docs/hidden-effects.md.
const SEED: u64 = 7;
/// The number of cases of docs/hidden-effects.md.
const CASES: usize = 1000;
/// The page with the success rates.
const PAGE: &str = "docs/hidden-effects.md";
/// The journal of the page's cases.
const JOURNAL: &str = "docs/hidden-effects.jsonl";

/// The options of the command line.
struct Options {
    /// Numbers of the cases to search.
    numbers: Vec<usize>,
    seed: u64,
    /// Print the search log of each case.
    verbose: bool,
    /// Threads per case. The page states the time of a case on one thread, so it is written only with 1.
    threads: usize,
    /// Path of the journal. `None` if the results are not kept.
    journal: Option<PathBuf>,
    /// Write the page without a search.
    only_page: bool,
}

impl Options {
    /// Whether docs/hidden-effects.md is written: only with the page's seed and journal, and one thread per case.
    fn writes_page(&self) -> bool {
        self.seed == SEED && self.threads == 1 && self.journal.as_deref() == Some(Path::new(JOURNAL))
    }
}

/// Reads the command line. Without numbers all cases of the page are searched.
fn options() -> Outcome<Options> {
    let mut options = Options {
        numbers: Vec::new(),
        seed: SEED,
        verbose: false,
        threads: 1,
        journal: None,
        only_page: false,
    };
    for word in std::env::args().skip(1).filter(|word| word != "--bench") {
        match word.split_once('=') {
            Some(("seed", seed)) => options.seed = seed.parse()?,
            Some(("threads", threads)) => options.threads = threads.parse::<usize>()?.max(1),
            Some(("in", file)) => options.journal = Some(file.into()),
            _ if word == "-v" => options.verbose = true,
            _ if word == "page" => options.only_page = true,
            _ => options.numbers.extend(numbers(&word)?),
        }
    }
    if options.numbers.is_empty() {
        options.numbers = (1..=CASES).collect();
        if options.seed == SEED && options.threads == 1 {
            options.journal.get_or_insert_with(|| JOURNAL.into());
        }
    }
    Ok(options)
}

/// The case numbers of "60" (1 ... 60), "41-90", "41-90/7" (every seventh) or "18,37".
fn numbers(word: &str) -> Outcome<Vec<usize>> {
    if word.contains(',') {
        return Ok(word.split(',').map(str::parse).collect::<Result<_, _>>()?);
    }
    let (range, every) = word.split_once('/').unwrap_or((word, "1"));
    let (first, last) = range.split_once('-').unwrap_or(("1", range));
    let numbers =
        (first.parse()?..=last.parse()?).step_by(every.parse::<usize>()?.max(1)).collect::<Vec<_>>();
    if numbers.is_empty() { Err(format!("{word} contains no case").into()) } else { Ok(numbers) }
}

fn main() -> Outcome<()> {
    let options = options()?;
    let last = options.numbers.iter().copied().max().unwrap_or_default();
    let cases = HiddenCases::make(options.seed, last)?;
    let mut journal = Journal::read(options.journal.as_deref(), &cases)?;
    if !options.only_page {
        if options.writes_page() && journal.results.len() == CASES {
            journal.clear()?;
        }
        search(&options, &cases, &mut journal)?;
    }
    journal.results.sort_by_key(|result| result.number);
    let page = page::page(&journal.results, CASES, options.threads);
    println!("{page}");
    if options.writes_page() {
        output::write_atomic(Path::new(JOURNAL), journal.text().as_bytes())?;
        output::write_atomic(Path::new(PAGE), page.as_bytes())?;
    }
    Ok(())
}

/// Searches every case that is not in the journal. Cases run in parallel, as many as there are cores for.
fn search(options: &Options, cases: &HiddenCases, journal: &mut Journal) -> Outcome<()> {
    let library = Library::shipped();
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let is_new = |number: &usize| journal.results.iter().all(|result| result.number != *number);
    let numbers: Vec<usize> = options.numbers.iter().copied().filter(is_new).collect();
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..(cores / options.threads).max(1) {
            let (sender, next, numbers, library) = (sender.clone(), &next, &numbers, &library);
            let threads = options.threads;
            scope.spawn(move || {
                while let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if sender.send(CaseResult::search(*number, cases, library, threads)).is_err() {
                        return;
                    }
                }
            });
        }
        // The loop below ends when the last worker has dropped its sender.
        drop(sender);
        for result in receiver {
            let result = result?;
            println!("{}", result.line());
            if options.verbose {
                println!("{}", result.search_log);
            }
            journal.add(result)?;
        }
        Ok(())
    })
}
