//! The JSON document of a linear analysis. Its numbers are not rounded.

use serde::Serialize;

use super::linear_report::{Analysis, stability_text};
use patchcord::ir::{Port, StateHold, StateTerm};
use patchcord::linear::{FrequencyResponse, Root, fastest_state};

/// The keys of the document without those that all commands on a patch share.
#[derive(Serialize)]
pub(super) struct LinearDocument<'a> {
    operating_point: OperatingPointDocument<'a>,
    /// Rows of numbers in 1/s.
    state_matrix: Vec<Vec<f64>>,
    /// None if `no_roots` has the reason.
    roots: Option<Vec<RootDocument>>,
    no_roots: Option<String>,
    response: Option<ResponseDocument<'a>>,
}

/// The point about which the circuit is linearised. The last three lists have names.
#[derive(Serialize)]
struct OperatingPointDocument<'a> {
    #[serde(rename = "told")]
    instant: &'a str,
    equilibrium: bool,
    states: Vec<StateDocument<'a>>,
    signals: Vec<SignalDocument<'a>>,
    overloaded: &'a [String],
    kinks: &'a [String],
    moving: &'a [String],
}

/// A state with its rate in V/s. `held` is "limit", "brake" (a brake, a stop or a reset) or null.
#[derive(Serialize)]
struct StateDocument<'a> {
    name: &'a str,
    volts: f64,
    rate: f64,
    held: Option<&'static str>,
}

/// A signal with its value in `unit`.
#[derive(Serialize)]
struct SignalDocument<'a> {
    name: &'a str,
    value: f64,
    unit: &'a str,
}

/// A root or a conjugate pair: real and imaginary part in 1/s, natural frequency in rad/s and in Hz.
#[derive(Serialize)]
struct RootDocument {
    real: f64,
    imaginary: f64,
    #[serde(rename = "times")]
    multiplicity: usize,
    natural_frequency: f64,
    hertz: f64,
    damping: Option<f64>,
    time_constant: Option<f64>,
    stability: &'static str,
}

/// A frequency response. A point is a list in the order of `columns`. `by` is the drive that moves both signals, if one
/// was used.
#[derive(Serialize)]
struct ResponseDocument<'a> {
    from: &'a str,
    to: &'a str,
    by: Option<&'a str>,
    unit: &'a str,
    columns: [&'static str; 3],
    points: Vec<[f64; 3]>,
}

impl<'a> LinearDocument<'a> {
    /// The document of an analysis.
    pub(super) fn of(analysis: &'a Analysis<'_>) -> Self {
        let model = analysis.model;
        let named = model.outputs.iter().filter(|port| port.is_named);
        LinearDocument {
            operating_point: OperatingPointDocument {
                instant: &analysis.instant,
                equilibrium: fastest_state(model).is_none() && model.moving.is_empty(),
                states: model.states.iter().map(StateDocument::of).collect(),
                signals: named.map(SignalDocument::of).collect(),
                overloaded: &model.overloaded,
                kinks: &model.kinks,
                moving: &model.moving,
            },
            state_matrix: model.state_matrix(),
            roots: analysis.roots.as_ref().ok().map(|roots| roots.iter().map(RootDocument::of).collect()),
            no_roots: analysis.roots.as_ref().err().map(ToString::to_string),
            response: analysis.response.as_ref().map(ResponseDocument::of),
        }
    }
}

impl<'a> StateDocument<'a> {
    fn of(state: &'a StateTerm) -> Self {
        let held = state.hold.map(|hold| match hold {
            StateHold::Limit => "limit",
            StateHold::Brake => "brake",
        });
        StateDocument { name: &state.name, volts: state.volts, rate: state.rate, held }
    }
}

impl<'a> SignalDocument<'a> {
    fn of(port: &'a Port) -> Self {
        SignalDocument { name: &port.name, value: port.volts * port.per_volt, unit: &port.unit }
    }
}

impl RootDocument {
    fn of(root: &Root) -> Self {
        RootDocument {
            real: root.real,
            imaginary: root.imaginary,
            multiplicity: root.multiplicity,
            natural_frequency: root.natural_frequency(),
            hertz: root.hertz(),
            damping: root.damping(),
            time_constant: root.time_constant(),
            stability: stability_text(root.stability()),
        }
    }
}

impl<'a> ResponseDocument<'a> {
    fn of(response: &'a FrequencyResponse) -> Self {
        let points = response.points.iter().map(|point| [point.frequency, point.ratio, point.phase]);
        ResponseDocument {
            from: &response.input,
            to: &response.output,
            by: response.by.as_deref(),
            unit: &response.unit,
            columns: ["frequency in Hz", "ratio", "phase in rad"],
            points: points.collect(),
        }
    }
}
