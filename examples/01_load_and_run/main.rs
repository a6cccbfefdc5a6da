//! Loads the patch of Fig 8.16, sets a friction parameter, runs two seconds, prints the range of each signal and draws
//! a picture.

use std::error::Error;
use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::draw;
use patchcord::draw::plot::{Format, Size, render};
use patchcord::format::QuantityFormat;
use patchcord::instruments::{self};
use patchcord::ir::Program;
use patchcord::output::write_atomic;
use patchcord::patch::Patch;
use patchcord::solve::{self, RunSettings};

fn main() -> Result<(), Box<dyn Error>> {
    let patch = Patch::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("patches/thesis/fig-8-16.json"))?;
    let circuit = Circuit::with_parameters(&patch, [("VcL", 5.08e-3)])?;
    let program = Program::new(&circuit)?;
    let settings = RunSettings::of(&circuit)?.with_duration(2.0).with_sample_interval(2e-4);
    let trace = solve::run(&program, &settings)?;

    for reading in instruments::readings(&trace) {
        let format = QuantityFormat::new(&reading.unit, reading.largest());
        println!(
            "{:<15} from {} to {}",
            reading.signal,
            format.text(reading.least.value),
            format.text(reading.most.value)
        );
    }
    // The first picture of the patch that shows the output velocity.
    let specs = circuit.picture_specs(["v_o"]);
    let picture = draw::picture(&trace, &specs[0], None, &[])?;
    let file = std::env::temp_dir().join("velocity-profile.svg");
    write_atomic(&file, &render(&[picture], Format::from_path(&file)?, Size::default())?)?;
    println!("wrote {}", file.display());
    Ok(())
}
