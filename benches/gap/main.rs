//! The gap search on data in which an effect is hidden: what it names, and how often that is right.
//!
//!     cargo bench --bench gap                 the whole: 1000 cases, written to docs/hidden-effects.md
//!     cargo bench --bench gap -- 60           the first 60
//!     cargo bench --bench gap -- 41-90/7 -v   every seventh of some, each told with what was tried
//!
//! The cases are made by the program in benches/hidden, which a C compiler makes first.

mod hidden;
mod judged;
mod page;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use hidden::Hidden;
use judged::Judged;
use patchcord::gap::effect::Library;

type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The seed of the cases that docs/hidden-effects.md tells of.
const SEED: u64 = 7;
/// How many there are.
const CASES: usize = 1000;

/// What is asked for.
struct Asked {
    first: usize,
    last: usize,
    every: usize,
    seed: u64,
    verbose: bool,
}

fn asked() -> Outcome<Asked> {
    let mut asked = Asked { first: 1, last: CASES, every: 1, seed: SEED, verbose: false };
    for word in std::env::args().skip(1).filter(|word| word != "--bench") {
        match word.strip_prefix("seed=") {
            Some(seed) => asked.seed = seed.parse()?,
            None if word == "-v" => asked.verbose = true,
            None => {
                let (range, every) = word.split_once('/').unwrap_or((&word, "1"));
                let (first, last) = range.split_once('-').unwrap_or(("1", range));
                asked = Asked {
                    first: first.parse()?,
                    last: last.parse()?,
                    every: every.parse::<usize>()?.max(1),
                    ..asked
                };
            }
        }
    }
    Ok(asked)
}

fn main() -> Outcome<()> {
    let asked = asked()?;
    let hidden = Hidden::made(asked.seed, asked.last)?;
    let library = Library::shipped();
    let judged = all(&asked, &hidden, &library)?;
    let page = page::page(&judged);
    println!("{page}");
    if judged.len() == CASES && asked.seed == SEED {
        std::fs::write("docs/hidden-effects.md", page)?;
    }
    Ok(())
}

/// Searches every case, one on each core, and takes them in their order.
fn all(asked: &Asked, hidden: &Hidden, library: &Library) -> Outcome<Vec<Judged>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(asked.first);
    let (tell, told) = mpsc::channel();
    let mut judged: Vec<Judged> = Vec::new();
    thread::scope(|scope| {
        for _ in 0..cores {
            let (tell, next) = (tell.clone(), &next);
            scope.spawn(move || {
                loop {
                    let number = next.fetch_add(asked.every, Ordering::Relaxed);
                    if number > asked.last || tell.send(Judged::of(number, hidden, library)).is_err() {
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
            judged.push(one);
        }
        Ok::<_, Box<dyn std::error::Error + Send + Sync>>(())
    })?;
    judged.sort_by_key(|one| one.number);
    Ok(judged)
}
