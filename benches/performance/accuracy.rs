//! The table of the time that each solver needs for an error of at most 1e-4.
//!
//! The error is that of the output velocity over the first 2 s, as a share of its peak. Each solver tries its own
//! settings, from coarse to fine, until one is accurate enough.

use crate::backends::{self, BACKENDS, BackendChoice, COMPARED, Fig816, Steps};
use crate::peers::{Peers, Program, Solved};
use crate::timing::{Work, format_digits, format_seconds, in_turns};
use crate::whole_run::{FIRST_RUN, ROUNDS, STEP};
use crate::{Outcome, page};
use patchcord::trace::Trace;

/// The largest permitted error, as a share of the peak velocity.
const MAX_ERROR: f64 = 1e-4;
/// No finer setting is tried after a run that took longer than this, in s: in the full and in the quick measurement.
const TIME_LIMITS: [f64; 2] = [30.0, 1.0];

/// A solver: it maps a setting to the solution and its duration.
type Solver<'a> = Box<dyn Fn(f64) -> Outcome<Solved> + 'a>;

/// A row of the table: a solver and its settings.
struct SolverEntry<'a> {
    name: String,
    /// Name of the setting, such as "rtol".
    setting: &'static str,
    /// The tried values, from coarse to fine.
    settings: Vec<f64>,
    solve: Solver<'a>,
}

/// The tried equal steps in s, each about 1.1 times as fine as the one before.
fn steps() -> Vec<f64> {
    backends::steps_per_millisecond().map(|count| 1e-3 / f64::from(count)).collect()
}

/// The tried tolerances 1e-2, 5e-3, 2e-3, 1e-3 ... Each makes the steps of a method of order 5 about 1.15 times as
/// short.
fn tolerances() -> Vec<f64> {
    let tolerances = (2..=12).flat_map(|decade| [1.0, 0.5, 0.2].map(|share| share * 10f64.powi(-decade)));
    tolerances.collect()
}

/// The table.
pub(crate) fn table(peers: &Peers, fig: &Fig816, quick: bool) -> Outcome<String> {
    let reference = fig.reference()?;
    let mut rows = Vec::new();
    for entry in c_entries(peers).into_iter().chain(patchcord_entries(fig)).chain(library_entries(peers)) {
        eprintln!("  {}", entry.name);
        rows.push(row(peers, &entry, &reference, TIME_LIMITS[usize::from(quick)])?);
    }
    Ok(page::table(&["", "setting", "error", "time", "times C"], &rows))
}

/// The row of the first setting that is accurate enough, or of the last one within the time limit. Its time is measured
/// in turns with C.
fn row(peers: &Peers, entry: &SolverEntry<'_>, reference: &[f64], time_limit: f64) -> Outcome<Vec<String>> {
    let (mut setting, mut error) = (f64::NAN, f64::INFINITY);
    for next in &entry.settings {
        let solved = (entry.solve)(*next)?;
        (setting, error) = (*next, backends::error(&solved.velocity, reference));
        if error <= MAX_ERROR || solved.seconds > time_limit {
            break;
        }
    }
    let c: Work<'_> = Box::new(|| peers.c_seconds("fig_8_16", COMPARED, STEP));
    let seconds = in_turns(ROUNDS, vec![c, Box::new(|| Ok((entry.solve)(setting)?.seconds))])?;
    Ok(vec![
        entry.name.clone(),
        format!("{} {}", entry.setting, three_digits(setting)),
        format!("{error:.1e}"),
        format_seconds(seconds[1]),
        format_digits(seconds[1] / seconds[0]),
    ])
}

/// A setting with at most three digits, such as "2e-5".
fn three_digits(setting: f64) -> String {
    let text = format!("{setting:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// The entries of the C programs.
fn c_entries(peers: &Peers) -> Vec<SolverEntry<'_>> {
    let entry = |name: &str, stem: &'static str, settings| SolverEntry {
        name: name.to_owned(),
        setting: "step",
        settings,
        solve: Box::new(move |step| peers.solve_in_c(stem, step)),
    };
    vec![
        entry("C, kinks stepped over, at 20 µs", "fig_8_16", vec![STEP]),
        entry("C, kinks stepped over", "fig_8_16", steps()),
        entry("C, kinks located", "fig_8_16_located", steps()),
        entry(
            "C, kinks located, with the step of the reference",
            "fig_8_16_located",
            vec![backends::REFERENCE_STEP],
        ),
    ]
}

/// The entries of patchcord: equal steps and tolerances on every backend.
fn patchcord_entries(fig: &Fig816) -> Vec<SolverEntry<'_>> {
    let entry =
        |name: String, setting, settings, steps: fn(f64) -> Steps, backend: BackendChoice| SolverEntry {
            name,
            setting,
            settings,
            solve: Box::new(move |setting| {
                solved(fig.run(&backend.1(fig.compared_settings(steps(setting)))))
            }),
        };
    let first_run = |backend: BackendChoice| SolverEntry {
        name: format!("patchcord, {}, {FIRST_RUN}", backend.0),
        setting: "--step",
        settings: steps(),
        solve: Box::new(move |setting| {
            solved(fig.run_first(&backend.1(fig.compared_settings(Steps::Equal(setting)))))
        }),
    };
    let entries = |backend: BackendChoice| {
        let name = format!("patchcord, {}", backend.0);
        vec![
            entry(name.clone(), "--step", steps(), Steps::Equal, backend),
            first_run(backend),
            entry(name.clone(), "--tol", tolerances(), Steps::Tolerance, backend),
            entry(name, "--tol", vec![1e-9], Steps::Tolerance, backend),
        ]
    };
    BACKENDS.into_iter().flat_map(entries).collect()
}

/// The solution of a run of patchcord.
fn solved(run: Outcome<(f64, Trace)>) -> Outcome<Solved> {
    run.map(|(seconds, trace)| Solved { seconds, velocity: backends::velocity(&trace) })
}

/// The entries of the installed libraries.
fn library_entries(peers: &Peers) -> Vec<SolverEntry<'_>> {
    let rows = USUAL_SETTINGS.iter().map(|row| (row, vec![1e-6]));
    let rows = rows.chain(LIBRARIES.iter().map(|row| (row, tolerances())));
    let ngspice = ("ngspice, trapezoidal", Program::Ngspice, "trap", "longest step");
    let installed = rows.chain([(&ngspice, steps())]).filter(|((_, program, ..), _)| peers.has(*program));
    let entries = installed.map(|(&(name, program, method, setting), settings)| SolverEntry {
        name: name.to_owned(),
        setting,
        settings,
        solve: Box::new(move |setting| peers.solve(program, method, setting)),
    });
    entries.collect()
}

/// A library: its label, the program that calls it, the method, and the name of the setting.
type Library = (&'static str, Program, &'static str, &'static str);

/// Solvers with the tolerance 1e-6, which many users would choose.
const USUAL_SETTINGS: [Library; 2] = [
    ("ode_solvers Dopri5, as many would", Program::Crate, "dopri5", "rtol"),
    ("SciPy RK45, as many would", Program::Scipy, "RK45", "rtol"),
];

/// Solvers with all tolerances in turn.
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
