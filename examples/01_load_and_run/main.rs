//! Loads the patch of Fig 8.16, sets a friction parameter, runs two seconds, reads and draws.

use std::error::Error;
use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::draw;
use patchcord::draw::plot::{Format, Size, render};
use patchcord::instruments::{self, Display};
use patchcord::ir::Program;
use patchcord::output::write_whole;
use patchcord::patch::Patch;
use patchcord::solve::{self, RunSettings};

fn main() -> Result<(), Box<dyn Error>> {
    let patch = Patch::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("patches/thesis/fig-8-16.json"))?;
    let circuit = Circuit::new(&patch, &[("VcL".to_owned(), 5.08e-3)])?;
    let program = Program::new(&circuit)?;
    let settings = RunSettings { every: 2e-4, ..RunSettings::of(&circuit)?.lasting(2.0) };
    let trace = solve::run(&program, &settings)?;

    for reading in instruments::readings(&trace) {
        let shown = Display::new(&reading.unit, reading.largest());
        println!(
            "{:<15} from {} to {}",
            reading.signal,
            shown.text(reading.least.value),
            shown.text(reading.most.value)
        );
    }
    let specs = circuit.picture_specs(["v_o"].into_iter());
    let picture = draw::picture(&trace, &specs[0], None)?;
    let file = std::env::temp_dir().join("velocity-profile.svg");
    write_whole(&file, &render(&[picture], Format::from_path(&file)?, Size::default())?)?;
    println!("wrote {}", file.display());
    Ok(())
}
