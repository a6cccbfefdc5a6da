//! Builds the patch of a damped oscillator in Rust, runs it, and compares it with the closed solution.

use std::error::Error;

use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::{ElementBuilder, PatchBuilder};
use patchcord::solve::{self, RunSettings};

fn main() -> Result<(), Box<dyn Error>> {
    // x'' = -wn^2 x - 2 zeta wn x'. One volt is 1 mm of x and of x' / wn, so both integrators have the rate wn.
    let patch = PatchBuilder::new("damped oscillator")
        .machine("solartron-1451")
        .parameter("wn", 8.0, "rad/s", [1.0, 10.0])
        .parameter("zeta", 0.1, "1", [0.0, 0.5])
        .scale("position", 1.0, "mm")
        .element("A1", ElementBuilder::new("integrator").cords("x10", ["P1", "P2"]).set("initial", 0))
        .element("A2", ElementBuilder::new("integrator").cords("x10", ["P3"]).set("initial", -50))
        .element("B1", ElementBuilder::new("summer").cords("x1", ["A2"]))
        .element("P1", ElementBuilder::new("pot").cord("in", "B1").set("setting", "wn / 10"))
        .element("P2", ElementBuilder::new("pot").cord("in", "A1").set("setting", "2 * zeta * wn / 10"))
        .element("P3", ElementBuilder::new("pot").cord("in", "A1").set("setting", "wn / 10"))
        .signal("x", "B1", "position", 1.0)
        .run(2.0, 1e-3)
        .record(["x"])
        .build()?;
    print!("{}", patch.text());

    let circuit = Circuit::new(&patch)?;
    let program = Program::new(&circuit)?;
    let trace = solve::run(&program, &RunSettings::of(&circuit)?)?;
    let x = trace.values("x").ok_or("x is recorded")?;
    let largest = trace.time.iter().zip(&x).map(|(t, x)| (x - closed_solution(*t)).abs()).fold(0.0, f64::max);
    println!("largest difference from the closed solution: {largest:.1e} mm of 50 mm");
    Ok(())
}

/// Position in mm at a time in s, released at rest from 50 mm, with wn = 8 rad/s and zeta = 0.1.
fn closed_solution(t: f64) -> f64 {
    let (wn, zeta) = (8.0, 0.1);
    let damped: f64 = wn * f64::sqrt(1.0 - zeta * zeta);
    50.0 * (-zeta * wn * t).exp() * ((damped * t).cos() + zeta * wn / damped * (damped * t).sin())
}
