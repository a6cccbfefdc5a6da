//! Turns a pot during a run: the stiffness of the slideway's drive falls, and the voltmeter shows the effect on the
//! velocity.

use std::error::Error;
use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::Machine;

fn main() -> Result<(), Box<dyn Error>> {
    let patch = Patch::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("patches/thesis/fig-8-16.json"))?;
    let circuit = Circuit::with_parameters(&patch, [("v_start", 1e-3), ("v_rate", 0.0)])?;
    let program = Program::new(&circuit)?;
    let mut machine = Machine::new(&program, 2e-5)?;
    println!("problem check: A1 {} V, M1 {:.3} V", machine.voltage("A1")?, machine.voltage("M1")?);

    for stiffness in [45e6, 30e6, 15e6] {
        machine.set_parameter("K", stiffness)?;
        let (mut least, mut most) = (f64::MAX, f64::MIN);
        for _ in 0..500 {
            machine.operate(1e-3)?;
            let velocity = machine.voltage("B3")?;
            (least, most) = (least.min(velocity), most.max(velocity));
        }
        machine.hold();
        println!("K = {:4.1} MN/m: velocity from {least:6.2} V to {most:6.2} V", stiffness / 1e6);
    }
    match machine.set_parameter("K", 500e6) {
        Err(error) => println!("rejected: {error}"),
        Ok(()) => println!("K = 500 MN/m was accepted"),
    }
    Ok(())
}
