//! Time until the output velocity of the first 2 s is right to 1e-4 of its peak: every solver with its own settings, from
//! the quickest to the most careful, until it is.

use crate::clock::{Work, in_turns, three, told};
use crate::own::{self, BACKENDS, COMPARED, Fig816, Steps};
use crate::peers::{Peers, Program, Solved};
use crate::whole::{FIRST_RUN, ROUNDS, STEP};
use crate::{Outcome, page};
use patchcord::trace::Trace;

/// The error that has to be reached.
const WANTED: f64 = 1e-4;
/// Nobody waits longer than this for one more setting, in seconds; a short measurement waits less.
const PATIENCE: [f64; 2] = [30.0, 1.0];

type Solver<'a> = Box<dyn Fn(f64) -> Outcome<Solved> + 'a>;

/// A solver and the settings that it is tried with.
struct Entry<'a> {
    name: String,
    setting: &'static str,
    ladder: Vec<f64>,
    solved: Solver<'a>,
}

/// Equal steps, each about 1.1 times as fine as the one before.
fn steps() -> Vec<f64> {
    own::rungs().map(|parts| 1e-3 / f64::from(parts)).collect()
}

/// Tolerances of about half the one before, which makes steps of order 5 about 1.15 times as short.
fn tolerances() -> Vec<f64> {
    let decades = (2..=12).flat_map(|decade| [1.0, 0.5, 0.2].map(|share| share * 10f64.powi(-decade)));
    decades.collect()
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

/// The first setting that is right enough, or the last that was waited for, measured in turns with C.
fn row(peers: &Peers, entry: &Entry<'_>, reference: &[f64], patience: f64) -> Outcome<Vec<String>> {
    let (mut setting, mut error) = (f64::NAN, f64::INFINITY);
    for next in &entry.ladder {
        let solved = (entry.solved)(*next)?;
        (setting, error) = (*next, own::error(&solved.velocity, reference));
        if error <= WANTED || solved.seconds > patience {
            break;
        }
    }
    let c: Work<'_> = Box::new(|| peers.c_seconds("fig_8_16", COMPARED, STEP));
    let seconds = in_turns(ROUNDS, vec![c, Box::new(|| Ok((entry.solved)(setting)?.seconds))])?;
    Ok(vec![
        entry.name.clone(),
        format!("{} {}", entry.setting, three_digits(setting)),
        format!("{error:.1e}"),
        told(seconds[1]),
        three(seconds[1] / seconds[0]),
    ])
}

/// A setting as one would write it, to three digits.
fn three_digits(setting: f64) -> String {
    let text = format!("{setting:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

fn c_entries(peers: &Peers) -> Vec<Entry<'_>> {
    let entry = |name: &str, stem: &'static str, ladder| Entry {
        name: name.to_owned(),
        setting: "step",
        ladder,
        solved: Box::new(move |step| peers.c_solved(stem, step)),
    };
    vec![
        entry("C, kinks stepped over, at 20 µs", "fig_8_16", vec![STEP]),
        entry("C, kinks stepped over", "fig_8_16", steps()),
        entry("C, kinks located", "fig_8_16_located", steps()),
        entry("C, kinks located, as finely as the reference", "fig_8_16_located", vec![own::REFERENCE]),
    ]
}

fn own_entries(fig: &Fig816) -> Vec<Entry<'_>> {
    let entry = |name: String, setting, ladder, steps: fn(f64) -> Steps, chosen: own::Backend| Entry {
        name,
        setting,
        ladder,
        solved: Box::new(move |setting| own_solved(fig.run(&chosen.1(fig.compared(steps(setting)))))),
    };
    let afresh = |chosen: own::Backend| Entry {
        name: format!("patchcord, {}, {FIRST_RUN}", chosen.0),
        setting: "--step",
        ladder: steps(),
        solved: Box::new(move |setting| {
            own_solved(fig.run_afresh(&chosen.1(fig.compared(Steps::Equal(setting)))))
        }),
    };
    let of = |chosen: own::Backend| {
        let name = format!("patchcord, {}", chosen.0);
        vec![
            entry(name.clone(), "--step", steps(), Steps::Equal, chosen),
            afresh(chosen),
            entry(name.clone(), "--tol", tolerances(), Steps::Tolerance, chosen),
            entry(name, "--tol", vec![1e-9], Steps::Tolerance, chosen),
        ]
    };
    BACKENDS.into_iter().flat_map(of).collect()
}

fn own_solved(ran: Outcome<(f64, Trace)>) -> Outcome<Solved> {
    ran.map(|(seconds, trace)| Solved { seconds, velocity: own::velocity(&trace) })
}

/// Those of the libraries that are there.
fn library_entries(peers: &Peers) -> Vec<Entry<'_>> {
    let rows = AS_MANY_WOULD.iter().map(|row| (row, vec![1e-6]));
    let rows = rows.chain(LIBRARIES.iter().map(|row| (row, tolerances())));
    let ngspice = ("ngspice, trapezoidal", Program::Ngspice, "trap", "longest step");
    let there = rows.chain([(&ngspice, steps())]).filter(|((_, program, ..), _)| peers.has(*program));
    let entries = there.map(|(&(name, program, method, setting), ladder)| Entry {
        name: name.to_owned(),
        setting,
        ladder,
        solved: Box::new(move |setting| peers.solved(program, method, setting)),
    });
    entries.collect()
}

/// What it is called, the program, its method, and what its setting is called.
type Library = (&'static str, Program, &'static str, &'static str);

/// With the setting that comes to mind first.
const AS_MANY_WOULD: [Library; 2] = [
    ("ode_solvers Dopri5, as many would", Program::Crate, "dopri5", "rtol"),
    ("SciPy RK45, as many would", Program::Scipy, "RK45", "rtol"),
];

const LIBRARIES: [Library; 9] = [
    ("ode_solvers Dopri5", Program::Crate, "dopri5", "rtol"),
    ("ode_solvers Dopri5 with kinks by hand", Program::Crate, "located-dopri5", "rtol"),
    ("ode_solvers Dop853", Program::Crate, "dop853", "rtol"),
    ("SciPy RK45", Program::Scipy, "RK45", "rtol"),
    ("SciPy DOP853", Program::Scipy, "DOP853", "rtol"),
    ("SciPy LSODA", Program::Scipy, "LSODA", "rtol"),
    ("SciPy RK45 with kinks by hand", Program::Scipy, "located-RK45", "rtol"),
    ("SciPy DOP853 with kinks by hand", Program::Scipy, "located-DOP853", "rtol"),
    ("PathSim RKDP54, from blocks", Program::Pathsim, "RKDP54", "tolerance"),
];
