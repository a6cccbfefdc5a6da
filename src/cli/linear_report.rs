//! Formats a linear analysis as text.
//!
//! The text lists states, signals, matrix, roots and response at one operating point. Rates are in volts per second,
//! so entries of the state matrix are in 1/s. Long tables are shortened; the JSON document (`linear_document`) is not.

use super::table::{Table, decimals};
use patchcord::format::QuantityFormat;
use patchcord::ir::{Port, StateHold, StateSpace, StateTerm};
use patchcord::linear::{FrequencyResponse, LinearError, Root, Stability, fastest_state};

/// The results of a linear analysis.
pub(super) struct Analysis<'m> {
    /// The linear model at the operating point.
    pub model: &'m StateSpace,
    /// The operating point in words: "at t = 2 s".
    pub instant: String,
    /// The characteristic roots, or why they cannot be computed.
    pub roots: Result<Vec<Root>, LinearError>,
    /// The frequency response if it is requested.
    pub response: Option<FrequencyResponse>,
}

/// The largest number of states for which the whole state matrix is printed. Larger matrices are printed without zeros.
const MAX_MATRIX: usize = 8;
/// The largest number of rows in a table of states.
const MAX_ROWS: usize = 40;
/// The number of frequencies per decade in the table of a response.
const ROWS_PER_DECADE: f64 = 3.0;

/// The report as text.
pub(super) fn text(analysis: &Analysis<'_>) -> String {
    let model = analysis.model;
    let mut text = format!("operating point {}: {}\n", analysis.instant, equilibrium_text(model));
    text += &format!("\n{}", states_table(&model.states));
    text += &format!("\n{}", signals_table(&model.outputs));
    text += &caveats(model);
    text += &format!("\n{}", matrix_text(model));
    text += &roots_text(&analysis.roots);
    text += &analysis.response.as_ref().map(|response| response_text(response, analysis)).unwrap_or_default();
    text
}

/// Whether the point is an equilibrium, and what changes otherwise.
///
/// A state that changes fastest is named. A drive can move although all rates are 0.
fn equilibrium_text(model: &StateSpace) -> String {
    match fastest_state(model) {
        None if model.moving.is_empty() => "an equilibrium".to_owned(),
        None => format!("all rates are 0, but {} moves", model.moving.join(", ")),
        Some(state) => format!("no equilibrium, {} changes by {} V/s", state.name, number(state.rate)),
    }
}

/// The table of states.
///
/// Held states do not move, whatever drives them, and are not part of the roots.
fn states_table(states: &[StateTerm]) -> String {
    let mut table = Table::new(["state", "V", "V/s", ""]);
    for state in states.iter().take(MAX_ROWS) {
        let hold = state.hold.map_or("", |hold| match hold {
            StateHold::Limit => "held at its limit",
            StateHold::Brake => "held by its brake, stop or reset",
        });
        table.row([state.name.clone(), number(state.volts), number(state.rate), hold.to_owned()]);
    }
    if states.is_empty() {
        return "the patch has no state: it has no integrator and no lag\n".to_owned();
    }
    table.text() + &omitted_text(states.len())
}

/// The table of signals.
fn signals_table(ports: &[Port]) -> String {
    let mut table = Table::new(["signal", "value", "unit"]);
    for port in ports.iter().filter(|port| port.is_named) {
        let value = port.volts * port.per_volt;
        let format = QuantityFormat::new(&port.unit, value);
        table.row([port.name.clone(), format.number(value), format.unit.clone()]);
    }
    table.text()
}

/// Notes on states and elements for which the linear model is limited.
///
/// A line each for held states, overloaded amplifiers and elements at a kink, if there are any.
fn caveats(model: &StateSpace) -> String {
    let mut text = String::new();
    let mut note = |names: Vec<&str>, what: &str| {
        if !names.is_empty() {
            text += &format!("\n{}: {what}\n", names.join(", "));
        }
    };
    let held = model.states.iter().filter(|state| state.hold.is_some());
    note(held.map(|state| state.name.as_str()).collect(), "held, omitted from the roots");
    note(model.overloaded.iter().map(String::as_str).collect(), "overloaded, small changes do not pass");
    let kinks: Vec<&str> = model.kinks.iter().map(String::as_str).collect();
    note(kinks, "at a kink, derivatives are those towards higher voltages");
    text
}

/// The state matrix.
///
/// A large matrix is printed row by row as a list of its terms.
fn matrix_text(model: &StateSpace) -> String {
    let names = || model.states.iter().map(|state| state.name.clone());
    let matrix = model.state_matrix();
    if model.states.is_empty() {
        return String::new();
    }
    if model.states.len() <= MAX_MATRIX {
        let mut table = Table::with(["1/s".to_owned()].into_iter().chain(names()).collect::<Vec<_>>());
        for (name, row) in names().zip(&matrix) {
            table.row([name].into_iter().chain(row.iter().map(|slope| number(*slope))).collect::<Vec<_>>());
        }
        return format!("state matrix, d(rate of the row) / d(state of the column)\n{}", table.text());
    }
    let mut table = Table::new(["rate of", "by the states, 1/s"]);
    for (name, row) in names().zip(&matrix).take(MAX_ROWS) {
        let terms = row.iter().zip(names()).filter(|(slope, _)| **slope != 0.0);
        let terms: Vec<_> = terms.map(|(slope, by)| format!("{by} {}", number(*slope))).collect();
        table.row([name, terms.join(", ")]);
    }
    format!("state matrix, without its zeros\n{}{}", table.text(), omitted_text(model.states.len()))
}

/// A line with the number of omitted rows; empty if there are none.
fn omitted_text(count: usize) -> String {
    match count.saturating_sub(MAX_ROWS) {
        0 => String::new(),
        omitted => format!("and {omitted} more: see --json\n"),
    }
}

/// The table of roots, and those that are unstable.
///
/// A pair of complex roots is one row. The frequency is the undamped natural frequency, the modulus of the root.
fn roots_text(roots: &Result<Vec<Root>, LinearError>) -> String {
    let roots = match roots {
        Ok(roots) => roots,
        Err(error) => return format!("\n{error}\n"),
    };
    let mut table =
        Table::new(["root, 1/s", "times", "rad/s", "Hz", "damping ratio", "time constant, s", ""]);
    for root in roots.iter().take(MAX_ROWS) {
        let optional = |value: Option<f64>| value.map(number).unwrap_or_default();
        table.row([
            root_text(root),
            root.multiplicity.to_string(),
            number(root.natural_frequency()),
            number(root.hertz()),
            optional(root.damping()),
            optional(root.time_constant()),
            stability_text(root.stability()).to_owned(),
        ]);
    }
    format!("\n{}{}{}", table.text(), omitted_text(roots.len()), unstable_text(roots))
}

/// "-0.5 ± 31.4 j".
fn root_text(root: &Root) -> String {
    match root.imaginary {
        0.0 => number(root.real),
        imaginary => format!("{} ± {} j", number(root.real), number(imaginary)),
    }
}

/// The stability for tables and for the JSON key `stability`.
pub(super) fn stability_text(stability: Stability) -> &'static str {
    match stability {
        Stability::Stable => "stable",
        Stability::Neutral => "neutral",
        Stability::Unstable => "unstable",
    }
}

/// The unstable roots; empty if there are none.
fn unstable_text(roots: &[Root]) -> String {
    let growing: Vec<_> =
        roots.iter().filter(|root| root.stability() == Stability::Unstable).map(root_text).collect();
    if growing.is_empty() { String::new() } else { format!("unstable: {}\n", growing.join("; ")) }
}

/// The table of the response: a few frequencies per decade, both limits of the band, and the natural frequencies in it.
///
/// Each natural frequency has a row, so that the resonances are in the table.
fn response_text(response: &FrequencyResponse, analysis: &Analysis<'_>) -> String {
    let unit = if response.unit.is_empty() { "ratio".to_owned() } else { response.unit.clone() };
    let mut table = Table::with(["Hz", &unit, "dB", "degrees"].map(str::to_owned));
    let natural: Vec<f64> = analysis.roots.iter().flatten().map(Root::hertz).collect();
    let last = response.points.last().map(|point| point.frequency);
    let mut next = 0.0;
    for point in &response.points {
        let is_next = point.frequency >= next;
        if is_next || Some(point.frequency) == last || natural.contains(&point.frequency) {
            // A ratio of 0 has neither decibels nor a phase.
            let is_zero = !point.decibels().is_finite();
            let or_none = |value: f64| if is_zero { "-".to_owned() } else { decimals(value, 2) };
            let (decibels, degrees) = (or_none(point.decibels()), or_none(point.phase.to_degrees()));
            table.row([number(point.frequency), number(point.ratio), decibels, degrees]);
        }
        if is_next {
            next = point.frequency * 10f64.powf(1.0 / ROWS_PER_DECADE) * (1.0 - 1e-9);
        }
    }
    format!("\n{}\n{}\n", response.title(), table.text())
}

/// A number to four digits, without a prefix. Small numbers are not rounded to 0, because an entry of the matrix may be
/// small only in its unit.
fn number(value: f64) -> String {
    QuantityFormat::new("", 0.0).number(value)
}
