//! Fig 8.16 with the crate `ode_solvers`.
//!
//! `fig-8-16 method=dopri5 setting=1e-8 for=2 out=FILE` prints the duration of solving in s and writes v_o every 1 ms.
//! The setting is the absolute and relative tolerance.

mod located;

use std::time::Instant;
use std::{env, fs, process};

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, System, Vector3};

/// Acceleration by the spring in m/s2, velocity in mm/s, memory.
type State = Vector3<f64>;

/// The equations of ../slideway.h with branches at the kinks.
struct Slideway;

/// Parameters of the run in SI units, as in ../slideway.h.
const MASS: f64 = 433.0;
const STIFFNESS: f64 = 45e6;
const VISCOUS: f64 = 10.7e3;
const SOLID: f64 = 771.0;
const VCL: f64 = 2.54e-3;
const TC: f64 = 0.0065;
const V_RATE: f64 = 1.2e-3;
/// One mm/s in m/s. It scales the velocity to the order of 1.
const MM: f64 = 1e-3;
/// Interval of the recorded samples in s.
const EVERY: f64 = 1e-3;

impl System<f64, State> for Slideway {
    fn system(&self, time: f64, state: &State, rates: &mut State) {
        let (spring, velocity, memory) = (state[0], state[1] * MM, state[2].max(0.0));
        let level = SOLID / MASS * (memory * memory);
        let dead_zone = if spring > level {
            spring - level
        } else if spring < -level {
            spring + level
        } else {
            0.0
        };
        let share = 1.0 - (velocity.abs() / VCL).min(1.0);
        rates[0] = STIFFNESS / MASS * (V_RATE * time - velocity);
        rates[1] = (dead_zone - VISCOUS / MASS * velocity) / MM;
        rates[2] = (share - state[2]) / TC;
    }
}

/// The velocity v_o in m/s every 1 ms, by a method with a tolerance.
fn solve(method: &str, tolerance: f64, duration: f64) -> Vec<f64> {
    let rest = State::new(0.0, 0.0, 1.0);
    macro_rules! with {
        ($solver:ident, $defaults:expr) => {{
            // The defaults of the crate, except for the number of steps and the stiffness test, which kinks mislead.
            let (safety, damping, (least, most)) = $defaults;
            let mut solver = $solver::from_param(
                Slideway, 0.0, duration, EVERY, rest, tolerance, tolerance, safety, damping, least, most, duration, 0.0,
                u32::MAX, u32::MAX, OutputType::Dense,
            );
            solver.integrate().expect("the solver must reach the end");
            solver.y_out().iter().map(|state| state[1] * MM).collect()
        }};
    }
    match method {
        "dopri5" => with!(Dopri5, (0.9, 0.04, (0.2, 10.0))),
        "located-dopri5" => located::solve(tolerance, duration),
        "dop853" => with!(Dop853, (0.9, 0.0, (0.333, 6.0))),
        _ => {
            eprintln!("{method}: one of dopri5, dop853, located-dopri5");
            process::exit(2)
        }
    }
}

fn main() {
    let words: Vec<String> = env::args().skip(1).collect();
    let word = |key: &str| {
        words.iter().find_map(|word| word.strip_prefix(key)).unwrap_or_else(|| panic!("{key} is missing"))
    };
    let (tolerance, duration) = (word("setting=").parse().unwrap(), word("for=").parse().unwrap());
    // The first run warms up.
    solve(word("method="), tolerance, duration);
    let start = Instant::now();
    let velocities = solve(word("method="), tolerance, duration);
    let seconds = start.elapsed().as_secs_f64();
    let bytes: Vec<u8> = velocities.iter().flat_map(|velocity| velocity.to_ne_bytes()).collect();
    fs::write(word("out="), bytes).unwrap();
    println!("{{\"seconds\": {seconds:.9}}}");
}
