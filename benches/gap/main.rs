//! The gap search on data in which an effect is hidden: what it names, and how often that is right.
//!
//!     cargo bench --bench gap                 the whole: 1000 cases, each as it is found written to docs/hidden-effects.jsonl, where a
//!                                             search that was broken off goes on (where the file has all of them it begins anew), and
//!                                             in the end all of them to docs/hidden-effects.md
//!     cargo bench --bench gap -- page         docs/hidden-effects.md of what has been found so far
//!     cargo bench --bench gap -- 60           the first 60
//!     cargo bench --bench gap -- 41-90/7 -v   every seventh of some, each told with what was tried
//!     cargo bench --bench gap -- 18,37        these
//!     cargo bench --bench gap -- 1-1000/40 threads=2
//!                                             every fortieth on two threads, so many at a time as there are cores for
//!     cargo bench --bench gap -- 60 in=FILE   what is found is kept in a file as well, and what stands there is not sought again
//!
//! The cases are made by the program in benches/hidden, which a C compiler makes first.

mod hidden;
mod journal;
mod judged;
mod page;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use hidden::Hidden;
use journal::Journal;
use judged::Judged;
use patchcord::ident::effects::Library;
use patchcord::output;

type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The seed of the cases that docs/hidden-effects.md tells of.
const SEED: u64 = 7;
/// How many there are.
const CASES: usize = 1000;
/// What it tells,
const PAGE: &str = "docs/hidden-effects.md";
/// and the cases of which it tells, a line each.
const JOURNAL: &str = "docs/hidden-effects.jsonl";

/// What is asked for.
struct Asked {
    numbers: Vec<usize>,
    seed: u64,
    verbose: bool,
    /// How many threads work on each case: one where the page is to be written, which tells of the time that this takes.
    threads: usize,
    journal: Option<PathBuf>,
    /// Whether nothing is searched.
    only_page: bool,
}

impl Asked {
    /// Whether the page is to be written: that of all cases.
    fn writes(&self) -> bool {
        self.seed == SEED && self.threads == 1 && self.journal.as_deref() == Some(Path::new(JOURNAL))
    }
}

fn asked() -> Outcome<Asked> {
    let mut asked = Asked {
        numbers: Vec::new(),
        seed: SEED,
        verbose: false,
        threads: 1,
        journal: None,
        only_page: false,
    };
    for word in std::env::args().skip(1).filter(|word| word != "--bench") {
        match word.split_once('=') {
            Some(("seed", seed)) => asked.seed = seed.parse()?,
            Some(("threads", threads)) => asked.threads = threads.parse::<usize>()?.max(1),
            Some(("in", file)) => asked.journal = Some(file.into()),
            _ if word == "-v" => asked.verbose = true,
            _ if word == "page" => asked.only_page = true,
            _ => asked.numbers.extend(numbers(&word)?),
        }
    }
    if asked.numbers.is_empty() {
        asked.numbers = (1..=CASES).collect();
        if asked.seed == SEED && asked.threads == 1 {
            asked.journal.get_or_insert_with(|| JOURNAL.into());
        }
    }
    Ok(asked)
}

/// So many from the first on, or from one to another, or every so manieth of them, or some by their numbers.
fn numbers(word: &str) -> Outcome<Vec<usize>> {
    if word.contains(',') {
        return Ok(word.split(',').map(str::parse).collect::<Result<_, _>>()?);
    }
    let (range, every) = word.split_once('/').unwrap_or((word, "1"));
    let (first, last) = range.split_once('-').unwrap_or(("1", range));
    let numbers =
        (first.parse()?..=last.parse()?).step_by(every.parse::<usize>()?.max(1)).collect::<Vec<_>>();
    if numbers.is_empty() { Err(format!("{word} names no case").into()) } else { Ok(numbers) }
}

fn main() -> Outcome<()> {
    let asked = asked()?;
    let hidden = Hidden::made(asked.seed, asked.numbers.iter().copied().max().unwrap_or_default())?;
    let mut journal = Journal::read(asked.journal.as_deref(), &hidden)?;
    if !asked.only_page {
        if asked.writes() && journal.judged.len() == CASES {
            journal.begin_anew()?;
        }
        search(&asked, &hidden, &mut journal)?;
    }
    journal.judged.sort_by_key(|one| one.number);
    let page = page::page(&journal.judged, CASES, asked.threads);
    println!("{page}");
    if asked.writes() {
        output::write_whole(Path::new(JOURNAL), journal.text().as_bytes())?;
        output::write_whole(Path::new(PAGE), page.as_bytes())?;
    }
    Ok(())
}

/// Searches every case that the journal does not have, so many at a time as there are cores for.
fn search(asked: &Asked, hidden: &Hidden, journal: &mut Journal) -> Outcome<()> {
    let library = Library::shipped();
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let is_new = |number: &usize| journal.judged.iter().all(|one| one.number != *number);
    let numbers: Vec<usize> = asked.numbers.iter().copied().filter(is_new).collect();
    let next = AtomicUsize::new(0);
    let (tell, told) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..(cores / asked.threads).max(1) {
            let (tell, next, numbers, library) = (tell.clone(), &next, &numbers, &library);
            let threads = asked.threads;
            scope.spawn(move || {
                while let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if tell.send(Judged::of(*number, hidden, library, threads)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(tell);
        for one in told {
            let one = one?;
            println!("{}", one.line());
            if asked.verbose {
                println!("{}", one.tried);
            }
            journal.add(one)?;
        }
        Ok(())
    })
}
