//! Finds the muzzle velocity that hits a target: a hybrid run of eight shots, each corrected by the landing of the one
//! before.

use std::error::Error;

use patchcord::circuit::Circuit;
use patchcord::document::Report;
use patchcord::draw;
use patchcord::draw::plot::{Format, Size, render};
use patchcord::ir::Program;
use patchcord::output::write_atomic;
use patchcord::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord::solve::{self, Phase, RunSettings};
use patchcord::trace::PhaseKind;

fn main() -> Result<(), Box<dyn Error>> {
    let circuit = Circuit::new(&cannon()?)?;
    let program = Program::new(&circuit)?;
    let shot = vec![
        Phase::InitialCondition,
        Phase::operate_until(10.0, "K1", Some("released")),
        // Without air the range is proportional to the square of the velocity.
        Phase::set_by("v0", "v0 * sqrt(target / x)")?,
    ];
    let phases = vec![Phase::Repeat { times: 8, phases: shot }];
    let trace = solve::run(&program, &RunSettings::of(&circuit)?.with_phases(phases))?;

    let x = trace.values("x").ok_or("x is recorded")?;
    for record in &trace.phase_records {
        if let PhaseKind::Set(values) = &record.phase {
            // The last sample before the change is the landing.
            let landed = x[record.sample - 1];
            println!(
                "landed after {:.4} s at {landed:9.5} m: {} m/s for the next shot",
                record.begin, values[0].value
            );
        }
    }
    let specs = circuit.picture_specs(["y"]);
    let picture = draw::picture(&trace, &specs[0], None, &[])?;
    let file = std::env::temp_dir().join("shots.svg");
    write_atomic(&file, &render(&[picture], Format::from_path(&file)?, Size::default())?)?;
    println!("wrote {}", file.display());
    Ok(())
}

/// The patch of the shot: x'' = -c x', y'' = -g - c y', at 1 V per m and per m/s.
///
/// A1 and A3 are the negative velocities, A2 and A4 the position. K1 drops out when y falls to 0.
fn cannon() -> Result<Patch, Box<Report>> {
    let drag = |from: &str| ElementBuilder::new("pot").cord("in", from).set("setting", "c");
    let velocity = || ElementBuilder::new("integrator").set("initial", "-v0 / velocity / sqrt(2)");
    let landing = ElementBuilder::new("relay").set("pull_in", 0.01).set("drop_out", 0);
    let landing = landing.cord("in", "A4").cord("on", "+100").cord("off", "ground");
    PatchBuilder::new("Shots at a target 60 m away")
        .parameter("v0", 25.0, "m/s", [1.0, 90.0])
        .parameter("target", 60.0, "m", [1.0, 90.0])
        .parameter("c", 0.2, "1/s", [0.0, 1.0])
        .scale("velocity", 1.0, "m/s")
        .scale("length", 1.0, "m")
        .element("A1", velocity().cords("x1", ["P1"]))
        .element("A2", ElementBuilder::new("integrator").cords("x1", ["A1"]))
        .element("A3", velocity().cords("x1", ["P3", "PG"]))
        .element("A4", ElementBuilder::new("integrator").cords("x1", ["A3"]))
        .element("P1", drag("A1"))
        .element("P3", drag("A3"))
        .element("PG", ElementBuilder::new("pot").cord("in", "-100").set("setting", 0.0981))
        .element("K1", landing)
        .signal("x", "A2", "length", 1.0)
        .signal("y", "A4", "length", 1.0)
        .run(10.0, 1e-3)
        .picture("Shots at a target 60 m away", "x", ["y"])
        .build()
}
