//! patchcord beside its peers on Fig 8.16, and how its cost grows: `cargo bench --bench performance` measures and writes the
//! tables of docs/performance.md; `-- --quick` prints a short form and writes nothing, `-- sweep` measures that table alone.

mod accuracy;
mod clock;
#[path = "../../crates/core/tests/common/mod.rs"]
mod common;
mod elements;
#[path = "../../crates/core/tests/known/mod.rs"]
mod known;
mod lanes;
mod own;
mod page;
mod peers;
mod problems;
mod startup;
mod threads;
mod throughput;
mod whole;

use std::env;
use std::error::Error;

/// Nothing here is recovered from: what is not installed is skipped, everything else ends the measurement.
type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let (options, chosen): (Vec<_>, Vec<_>) = env::args().skip(1).partition(|word| word.starts_with('-'));
    let quick = options.iter().any(|option| option == "--quick");
    let peers = peers::Peers::built()?;
    let fig = own::Fig816::read();
    let parts: [(&str, &dyn Fn() -> Outcome<String>); 9] = [
        ("machine", &|| Ok(peers.versions())),
        ("whole", &|| whole::table(&peers, &fig)),
        ("accuracy", &|| accuracy::table(&peers, &fig, quick)),
        ("sweep", &|| throughput::table(&peers, &fig, quick)),
        ("lanes", &|| lanes::table(&fig, quick)),
        ("elements", &|| elements::table(quick)),
        ("record", &|| whole::records(&fig)),
        ("problems", &problems::table),
        ("startup", &startup::table),
    ];
    for (name, table) in
        parts.into_iter().filter(|(name, _)| chosen.is_empty() || chosen.iter().any(|word| word == name))
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
