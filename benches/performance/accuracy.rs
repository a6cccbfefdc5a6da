//! Time until the output velocity of the first 2 s is right to 1e-4 of its peak: every solver with its own settings, from
//! the quickest to the most careful, until it is.

use crate::Outcome;
use crate::clock::{in_turns, three, told};
use crate::own::{self, BACKENDS, COMPARED, Fig816, Steps};
use crate::page;
use crate::peers::{Peers, Program, Solved};
use crate::whole::STEP;

/// The error that has to be reached.
const WANTED: f64 = 1e-4;
/// Nobody waits longer than this for one more setting, in seconds; a short measurement waits less.
const PATIENCE: [f64; 2] = [30.0, 1.0];

const TOLERANCES: &[f64] = &[1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];

type Solver<'a> = Box<dyn Fn(f64) -> Outcome<Solved> + 'a>;

/// A solver and the settings that it is tried with.
struct Entry<'a> {
    name: String,
    setting: &'static str,
    ladder: &'static [f64],
    solved: Solver<'a>,
}

pub fn table(peers: &Peers, fig: &Fig816, quick: bool) -> Outcome<String> {
    let reference = fig.reference()?;
    let mut rows = Vec::new();
    for entry in c_entries(peers).into_iter().chain(own_entries(fig)).chain(library_entries(peers)) {
        eprintln!("  {}", entry.name);
        rows.push(row(peers, &entry, &reference, PATIENCE[usize::from(quick)])?);
    }
    Ok(page::table(&["", "setting", "error", "time", "times C"], &rows))
}

/// The first setting that is right enough, or the last that was waited for.
fn row(peers: &Peers, entry: &Entry<'_>, reference: &[f64], patience: f64) -> Outcome<Vec<String>> {
    let mut told_row = Vec::new();
    for setting in entry.ladder {
        let solved = (entry.solved)(*setting)?;
        let error = own::error(&solved.velocity, reference);
        let right = error <= WANTED;
        let seconds = if solved.seconds < 1.0 {
            let c = || peers.c_seconds("fig_8_16", COMPARED, STEP);
            in_turns(if right { 5 } else { 1 }, c, || Ok((entry.solved)(*setting)?.seconds))?
        } else {
            [peers.c_seconds("fig_8_16", COMPARED, STEP)?, solved.seconds]
        };
        told_row = vec![
            entry.name.clone(),
            format!("{} {setting:e}", entry.setting),
            format!("{error:.1e}"),
            told(seconds[1]),
            three(seconds[1] / seconds[0]),
        ];
        if right || entry.ladder.len() > 1 && solved.seconds > patience {
            break;
        }
    }
    Ok(told_row)
}

fn c_entries(peers: &Peers) -> Vec<Entry<'_>> {
    let entry = |name: &str, stem: &'static str, ladder| Entry {
        name: name.to_owned(),
        setting: "step",
        ladder,
        solved: Box::new(move |step| peers.c_solved(stem, step)),
    };
    vec![
        entry("C, kinks stepped over, at 20 µs", "fig_8_16", &[STEP]),
        entry("C, kinks stepped over", "fig_8_16", &[1e-5, 5e-6, 4e-6, 2e-6, 1e-6, 5e-7]),
        entry("C, kinks located", "fig_8_16_located", &[2e-4, 1e-4, 5e-5]),
        entry("C, kinks located, as finely as the reference", "fig_8_16_located", &[own::REFERENCE]),
    ]
}

fn own_entries(fig: &Fig816) -> Vec<Entry<'_>> {
    let entry = |name: String, setting, ladder, steps: fn(f64) -> Steps, chosen: own::Backend| Entry {
        name,
        setting,
        ladder,
        solved: Box::new(move |setting| {
            let (seconds, trace) = fig.run(&chosen.1(fig.compared(steps(setting))))?;
            Ok(Solved { seconds, velocity: own::velocity(&trace) })
        }),
    };
    let of = |chosen: own::Backend| {
        let name = format!("patchcord, {}", chosen.0);
        vec![
            entry(name.clone(), "--step", &[2e-4, 1e-4, 5e-5], Steps::Equal, chosen),
            entry(name.clone(), "--tol", TOLERANCES, Steps::Tolerance, chosen),
            entry(name, "--tol", &[1e-9], Steps::Tolerance, chosen),
        ]
    };
    BACKENDS.into_iter().flat_map(of).collect()
}

fn library_entries(peers: &Peers) -> Vec<Entry<'_>> {
    let entry = |name: &str, program, method: &'static str, setting, ladder| Entry {
        name: name.to_owned(),
        setting,
        ladder,
        solved: Box::new(move |setting| peers.solved(program, method, setting)),
    };
    let tolerance = "rtol";
    let mut entries = Vec::new();
    if peers.crate_built {
        entries.push(entry(
            "ode_solvers Dopri5, as many would",
            Program::Crate,
            "dopri5",
            tolerance,
            &[1e-6],
        ));
        entries.push(entry("ode_solvers Dopri5", Program::Crate, "dopri5", tolerance, TOLERANCES));
        entries.push(entry(
            "ode_solvers Dopri5 with kinks by hand",
            Program::Crate,
            "located-dopri5",
            tolerance,
            TOLERANCES,
        ));
        entries.push(entry("ode_solvers Dop853", Program::Crate, "dop853", tolerance, TOLERANCES));
    }
    if peers.scipy {
        entries.push(entry("SciPy RK45, as many would", Program::Scipy, "RK45", tolerance, &[1e-6]));
        for method in ["RK45", "DOP853", "LSODA"] {
            entries.push(entry(&format!("SciPy {method}"), Program::Scipy, method, tolerance, TOLERANCES));
        }
        entries.push(entry(
            "SciPy RK45 with kinks by hand",
            Program::Scipy,
            "located-RK45",
            tolerance,
            TOLERANCES,
        ));
        entries.push(entry(
            "SciPy DOP853 with kinks by hand",
            Program::Scipy,
            "located-DOP853",
            tolerance,
            TOLERANCES,
        ));
    }
    if peers.pathsim {
        entries.push(entry(
            "PathSim RKDP54, from blocks",
            Program::Pathsim,
            "RKDP54",
            "tolerance",
            TOLERANCES,
        ));
    }
    if peers.ngspice {
        let steps: &[f64] = &[2e-5, 1e-5, 5e-6, 2e-6, 1e-6];
        entries.push(entry("ngspice, trapezoidal", Program::Ngspice, "trap", "longest step", steps));
    }
    entries
}
