//! What `patchcord linearise` tells people and programs.

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::Display;
use patchcord::ir::{Hold, Port, StateSpace, StateTerm};
use patchcord::linear::{LinearError, Response, ResponsePoint, Root, Stability, fastest};

/// What was found at an operating point.
pub(super) struct Analysis<'m> {
    pub model: &'m StateSpace,
    /// When the machine stood there.
    pub instant: String,
    /// The characteristic roots, or why there are none.
    pub roots: Result<Vec<Root>, LinearError>,
    pub response: Option<Response>,
}

/// A matrix of more states than this is told by what is not 0 in it.
const WIDEST: usize = 8;
/// More states than this are left to `--json`.
const MOST_TOLD: usize = 40;
/// A table of a response tells so many frequencies a decade.
const PER_DECADE: f64 = 3.0;

pub(super) fn told(analysis: &Analysis<'_>) -> String {
    let model = analysis.model;
    let mut text = format!("operating point {}: {}\n", analysis.instant, standing(model));
    text += &format!("\n{}", states_table(&model.states));
    text += &format!("\n{}", signals_table(&model.outputs));
    text += &caveats(model);
    text += &format!("\n{}", matrix_told(model));
    text += &roots_told(&analysis.roots);
    text += &analysis.response.as_ref().map(|response| response_told(response, analysis)).unwrap_or_default();
    text
}

/// Whether the point is an equilibrium.
fn standing(model: &StateSpace) -> String {
    match fastest(model) {
        None if model.moving.is_empty() => "an equilibrium".to_owned(),
        None => format!("all rates are 0, but {} moves", model.moving.join(", ")),
        Some(state) => format!("no equilibrium, {} moves by {} V/s", state.name, number(state.rate)),
    }
}

fn states_table(states: &[StateTerm]) -> String {
    let mut table = Table::new(["state", "V", "V/s", ""]);
    for state in states.iter().take(MOST_TOLD) {
        let hold = state.hold.map_or("", |hold| match hold {
            Hold::Limit => "held at its limit",
            Hold::Brake => "held by its brake or stop",
        });
        table.row([state.name.clone(), number(state.volts), number(state.rate), hold.to_owned()]);
    }
    if states.is_empty() {
        return "there is no integrator and no lag: nothing moves by itself\n".to_owned();
    }
    table.text() + &more(states.len())
}

fn signals_table(ports: &[Port]) -> String {
    let mut table = Table::new(["signal", "value", "unit"]);
    for port in ports.iter().filter(|port| port.is_named) {
        let value = port.volts * port.per_volt;
        let shown = Display::new(&port.unit, value);
        table.row([port.name.clone(), shown.number(value), shown.unit.clone()]);
    }
    table.text()
}

/// What does not take part in small motions.
fn caveats(model: &StateSpace) -> String {
    let mut text = String::new();
    let mut tell = |names: Vec<&str>, what: &str| {
        if !names.is_empty() {
            text += &format!("\n{}: {what}\n", names.join(", "));
        }
    };
    let held = model.states.iter().filter(|state| state.hold.is_some());
    tell(held.map(|state| state.name.as_str()).collect(), "held where it is, and left out of the roots");
    tell(
        model.overloaded.iter().map(String::as_str).collect(),
        "asked for more than 100 V: nothing small comes through",
    );
    let kinks: Vec<&str> = model.kinks.iter().map(String::as_str).collect();
    tell(kinks, "the point is on a kink along it: derivatives by it are those towards higher voltages");
    text
}

fn matrix_told(model: &StateSpace) -> String {
    let names = || model.states.iter().map(|state| state.name.clone());
    let matrix = model.state_matrix();
    if model.states.is_empty() {
        return String::new();
    }
    if model.states.len() <= WIDEST {
        let mut table = Table::with(["1/s".to_owned()].into_iter().chain(names()).collect::<Vec<_>>());
        for (name, row) in names().zip(matrix.row_iter()) {
            table.row([name].into_iter().chain(row.iter().map(|slope| number(*slope))).collect::<Vec<_>>());
        }
        return format!("state matrix, d(rate of the row) / d(state of the column)\n{}", table.text());
    }
    let mut table = Table::new(["rate of", "by the states, 1/s"]);
    for (name, row) in names().zip(matrix.row_iter()).take(MOST_TOLD) {
        let terms = row.iter().zip(names()).filter(|(slope, _)| **slope != 0.0);
        let terms: Vec<_> = terms.map(|(slope, by)| format!("{by} {}", number(*slope))).collect();
        table.row([name, terms.join(", ")]);
    }
    format!("state matrix, without its zeros\n{}{}", table.text(), more(model.states.len()))
}

fn more(count: usize) -> String {
    match count.saturating_sub(MOST_TOLD) {
        0 => String::new(),
        left => format!("and {left} more: --json tells all\n"),
    }
}

fn roots_told(roots: &Result<Vec<Root>, LinearError>) -> String {
    let roots = match roots {
        Ok(roots) => roots,
        Err(error) => return format!("\n{error}\n"),
    };
    let mut table =
        Table::new(["root, 1/s", "times", "rad/s", "Hz", "damping ratio", "time constant, s", ""]);
    for root in roots.iter().take(MOST_TOLD) {
        let given = |value: Option<f64>| value.map(number).unwrap_or_default();
        table.row([
            root_told(root),
            root.times.to_string(),
            number(root.natural_frequency()),
            number(root.hertz()),
            given(root.damping()),
            given(root.time_constant()),
            word(root.stability()).to_owned(),
        ]);
    }
    format!("\n{}{}{}", table.text(), more(roots.len()), verdict(roots))
}

fn root_told(root: &Root) -> String {
    match root.imaginary {
        0.0 => number(root.real),
        imaginary => format!("{} ± {} j", number(root.real), number(imaginary)),
    }
}

fn word(stability: Stability) -> &'static str {
    match stability {
        Stability::Stable => "stable",
        Stability::Neutral => "neutral",
        Stability::Unstable => "unstable",
    }
}

/// What grows.
fn verdict(roots: &[Root]) -> String {
    let growing: Vec<_> =
        roots.iter().filter(|root| root.stability() == Stability::Unstable).map(root_told).collect();
    if growing.is_empty() { String::new() } else { format!("unstable: {}\n", growing.join("; ")) }
}

/// A few frequencies a decade, both ends of the band, and the natural frequencies within it.
fn response_told(response: &Response, analysis: &Analysis<'_>) -> String {
    let unit = if response.unit.is_empty() { "ratio".to_owned() } else { response.unit.clone() };
    let mut table = Table::with(["Hz", &unit, "dB", "degrees"].map(str::to_owned));
    let natural: Vec<f64> = analysis.roots.iter().flatten().map(Root::hertz).collect();
    let last = response.points.last().map(|point| point.frequency);
    let mut next = 0.0;
    for point in &response.points {
        let is_next = point.frequency >= next;
        if is_next || Some(point.frequency) == last || natural.contains(&point.frequency) {
            table.row([
                number(point.frequency),
                number(point.ratio),
                format!("{:.2}", point.decibels()),
                format!("{:.2}", point.phase.to_degrees() + 0.0),
            ]);
        }
        if is_next {
            next = point.frequency * 10f64.powf(1.0 / PER_DECADE) * (1.0 - 1e-9);
        }
    }
    format!("\n{}\n{}\n", response.title(), table.text())
}

fn number(value: f64) -> String {
    Display::new("", 0.0).number(value)
}

pub(super) fn json(analysis: &Analysis<'_>) -> Value {
    let model = analysis.model;
    let roots = analysis.roots.as_ref().map(|roots| roots.iter().map(root_json).collect::<Value>());
    json!({
        "operating_point": {
            "told": analysis.instant,
            "equilibrium": fastest(model).is_none() && model.moving.is_empty(),
            "states": model.states.iter().map(state_json).collect::<Value>(),
            "signals": model.outputs.iter().filter(|port| port.is_named).map(signal_json).collect::<Value>(),
            "overloaded": model.overloaded,
            "kinks": model.kinks,
            "moving": model.moving,
        },
        "state_matrix": model.state_matrix().row_iter()
            .map(|row| row.iter().copied().collect::<Value>()).collect::<Value>(),
        "roots": roots.as_ref().ok(),
        "no_roots": roots.as_ref().err().map(ToString::to_string),
        "response": analysis.response.as_ref().map(response_json),
    })
}

fn state_json(state: &StateTerm) -> Value {
    let held = state.hold.map(|hold| match hold {
        Hold::Limit => "limit",
        Hold::Brake => "brake",
    });
    json!({"name": state.name, "volts": state.volts, "rate": state.rate, "held": held})
}

fn signal_json(port: &Port) -> Value {
    json!({"name": port.name, "value": port.volts * port.per_volt, "unit": port.unit})
}

fn root_json(root: &Root) -> Value {
    json!({
        "real": root.real,
        "imaginary": root.imaginary,
        "times": root.times,
        "natural_frequency": root.natural_frequency(),
        "hertz": root.hertz(),
        "damping": root.damping(),
        "time_constant": root.time_constant(),
        "stability": word(root.stability()),
    })
}

fn response_json(response: &Response) -> Value {
    let point = |point: &ResponsePoint| json!([point.frequency, point.ratio, point.phase]);
    json!({
        "from": response.input,
        "to": response.output,
        "by": response.by,
        "unit": response.unit,
        "columns": ["frequency in Hz", "ratio", "phase in rad"],
        "points": response.points.iter().map(point).collect::<Value>(),
    })
}
