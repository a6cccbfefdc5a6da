//! Time and accuracy of patchcord and of other programs on Fig 8.16, and the growth of cost with size.
//!
//! `cargo bench --bench performance` measures all tables of docs/performance.md and writes them. `-- --quick` prints a
//! short form and writes no file. `-- sweep` measures only the table with that name.

mod accuracy;
mod backends;
#[path = "../../crates/core/tests/common/mod.rs"]
mod common;
mod elements;
#[path = "../../crates/core/tests/known_problems/mod.rs"]
mod known_problems;
mod lanes;
mod page;
mod peers;
mod problems;
mod startup;
mod threads;
mod throughput;
mod timing;
mod whole_run;

use std::env;
use std::error::Error;

/// Any error ends the benchmark. A peer that is not installed is not an error; its rows are omitted.
type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let (options, chosen): (Vec<_>, Vec<_>) = env::args().skip(1).partition(|word| word.starts_with('-'));
    let quick = options.iter().any(|option| option == "--quick");
    let peers = peers::Peers::build()?;
    let fig = backends::Fig816::read();
    let tables: [(&str, &dyn Fn() -> Outcome<String>); 9] = [
        ("machine", &|| Ok(peers.versions())),
        ("whole", &|| whole_run::table(&peers, &fig)),
        ("accuracy", &|| accuracy::table(&peers, &fig, quick)),
        ("sweep", &|| throughput::table(&peers, &fig, quick)),
        ("lanes", &|| lanes::table(&fig, quick)),
        ("elements", &|| elements::table(quick)),
        ("record", &|| whole_run::record_table(&fig)),
        ("problems", &problems::table),
        ("startup", &startup::table),
    ];
    for (name, table) in
        tables.into_iter().filter(|(name, _)| chosen.is_empty() || chosen.iter().any(|chosen| chosen == name))
    {
        eprintln!("measuring: {name}");
        let text = table()?;
        println!("{text}");
        if !quick {
            page::replace(name, &text)?;
        }
    }
    Ok(())
}
