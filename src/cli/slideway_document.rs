//! The JSON document of the prediction for a slideway, with full precision and in SI units.

use indexmap::IndexMap;
use serde::Serialize;

use super::times::TimesDocument;
use patchcord::instruments::CriticalVelocity;
use patchcord::solve::RunSettings;
use patchcord::thesis::chain::{Advice, AdviceOutcome, Chain, Origin, PotSetting, Prediction, Simulation};

/// The document. Critical velocities are in m/s. `resolution` is the change of the command within a window, in m/s; it
/// limits the accuracy of the run.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    ok: bool,
    title: String,
    /// Warnings for the reader.
    notes: &'a [String],
    inputs: InputsDocument,
    parameters: Vec<OriginDocument<'a>>,
    circuit: CircuitDocument,
    run: RunDocument,
    criterion: CriterionDocument,
    critical_velocity: CriticalDocument,
    with_half_the_threshold: CriticalDocument,
    with_twice_the_threshold: CriticalDocument,
    resolution: f64,
    predictions: PredictionsDocument,
    advice: Vec<AdviceDocument<'a>>,
    files: Vec<String>,
}

/// A value that may be missing: `{"value": 0.0067}`, or `{"value": null, "because": "..."}`. `from` is the law that
/// gives the value, if it is named.
#[derive(Serialize)]
struct ValueDocument {
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<&'static str>,
    value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    because: Option<String>,
}

/// The inputs: viscosity in Pa s, weight in N, area in m2, stiffness in N/m, ridges in m. Four quantities follow from
/// them: pressure and `KLP` in Pa, the tangent of the flank, and the lift in m.
#[derive(Serialize)]
struct InputsDocument {
    viscosity: f64,
    polar: bool,
    weight: f64,
    area: f64,
    stiffness: f64,
    ridge_width: f64,
    ridge_height: f64,
    pressure: f64,
    #[serde(rename = "KLP")]
    interface_polar: f64,
    #[serde(rename = "tan")]
    flank: f64,
    lift: f64,
}

/// A parameter of the circuit with the law that gives it, and its value by another law if there is one.
#[derive(Serialize)]
struct OriginDocument<'a> {
    name: &'static str,
    value: f64,
    unit: &'static str,
    from: &'a str,
    other: Option<ValueDocument>,
}

/// The circuit: `multiple` of the scales, velocity in m/s per volt, and the pots.
#[derive(Serialize)]
struct CircuitDocument {
    multiple: f64,
    velocity_per_volt: f64,
    pots: Vec<PotDocument>,
}

/// A pot with its setting.
#[derive(Serialize)]
struct PotDocument {
    #[serde(rename = "pot")]
    name: String,
    setting: f64,
    formula: String,
}

/// The times of the run, and the start, the rate and the largest value of the command in m/s and m/s2.
#[derive(Serialize)]
struct RunDocument {
    #[serde(flatten)]
    times: Option<TimesDocument>,
    v_start: f64,
    v_rate: f64,
    v_top: f64,
}

/// The criterion of oscillation: threshold in m/s, window in s.
#[derive(Serialize)]
struct CriterionDocument {
    threshold: f64,
    window: f64,
}

/// The command at which oscillation ends while it rises, and begins again while it falls.
#[derive(Serialize)]
struct CriticalDocument {
    rising: ValueDocument,
    falling: ValueDocument,
}

/// Critical velocities by equation in m/s. The slope is in N s/m, the frequencies are in rad/s.
#[derive(Serialize)]
struct PredictionsDocument {
    eq_93_9_printed: ValueDocument,
    eq_93_9_derived: ValueDocument,
    eq_7_9: ValueDocument,
    routh_hurwitz: ValueDocument,
    critical_slope: ValueDocument,
    boundary_frequency: ValueDocument,
    describing_function_without_memory: ValueDocument,
    sticking_ends: ValueDocument,
    sticking_frequency: ValueDocument,
}

/// A piece of advice. `factor` is the change of `quantity`. If the changed slideway cannot be simulated, `error`
/// replaces the results.
#[derive(Serialize)]
struct AdviceDocument<'a> {
    #[serde(rename = "advice")]
    letter: char,
    text: &'static str,
    quantity: &'static str,
    factor: f64,
    verdict: &'static str,
    #[serde(flatten)]
    outcome: Option<OutcomeDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// The results for the changed slideway: the parameters of the circuit by name, and the critical velocities.
#[derive(Serialize)]
struct OutcomeDocument {
    parameters: IndexMap<&'static str, f64>,
    critical_velocity: CriticalDocument,
    eq_93_9_printed: ValueDocument,
    routh_hurwitz: ValueDocument,
}

impl<'a> Document<'a> {
    /// The document of a chain and the written files.
    pub(super) fn new(chain: &'a Chain, files: Vec<String>) -> Self {
        let simulation = &chain.simulation;
        let [half, twice] = simulation.nearby_thresholds.each_ref().map(CriticalDocument::of);
        Document {
            ok: true,
            title: chain.inputs.title(),
            notes: &chain.notes,
            inputs: InputsDocument::of(chain),
            parameters: chain.origins.iter().map(OriginDocument::of).collect(),
            circuit: CircuitDocument::of(simulation),
            run: RunDocument::of(simulation),
            criterion: CriterionDocument {
                threshold: simulation.criterion.threshold,
                window: simulation.criterion.window,
            },
            critical_velocity: CriticalDocument::of(&simulation.critical),
            with_half_the_threshold: half,
            with_twice_the_threshold: twice,
            resolution: simulation.resolution(),
            predictions: PredictionsDocument::of(chain),
            advice: chain.advice.iter().map(AdviceDocument::of).collect(),
            files,
        }
    }
}

impl ValueDocument {
    /// The value, or null and the reason.
    fn of(value: Result<f64, impl ToString>) -> Self {
        let because = value.as_ref().err().map(ToString::to_string);
        ValueDocument { from: None, value: value.ok(), because }
    }

    fn of_prediction(prediction: &Prediction) -> Self {
        ValueDocument::of(prediction.as_ref().copied())
    }
}

impl InputsDocument {
    fn of(chain: &Chain) -> Self {
        let (inputs, design) = (&chain.inputs, &chain.design);
        InputsDocument {
            viscosity: inputs.viscosity,
            polar: inputs.polar,
            weight: inputs.weight,
            area: inputs.area,
            stiffness: inputs.stiffness,
            ridge_width: inputs.ridge.width,
            ridge_height: inputs.ridge.height,
            pressure: inputs.pressure(),
            interface_polar: design.interface.polar,
            flank: design.interface.flank,
            lift: design.lift,
        }
    }
}

impl<'a> OriginDocument<'a> {
    fn of(origin: &'a Origin) -> Self {
        let other = origin.other.as_ref().map(|other| {
            let value = ValueDocument::of_prediction(&other.value);
            ValueDocument { from: Some(other.from), ..value }
        });
        OriginDocument {
            name: origin.name,
            value: origin.value,
            unit: origin.unit,
            from: &origin.from,
            other,
        }
    }
}

impl CircuitDocument {
    fn of(simulation: &Simulation) -> Self {
        let pot = |PotSetting { name, setting, formula }| PotDocument { name, setting, formula };
        CircuitDocument {
            multiple: simulation.multiple,
            velocity_per_volt: simulation.velocity_per_volt(),
            pots: simulation.pots().into_iter().map(pot).collect(),
        }
    }
}

impl RunDocument {
    fn of(simulation: &Simulation) -> Self {
        let ramp = simulation.ramp;
        let settings = RunSettings::of(&simulation.circuit).ok();
        RunDocument {
            times: settings.as_ref().map(TimesDocument::of),
            v_start: ramp.start,
            v_rate: ramp.rate,
            v_top: ramp.top(),
        }
    }
}

impl CriticalDocument {
    fn of(critical: &CriticalVelocity) -> Self {
        let CriticalVelocity { rising, falling } = *critical;
        CriticalDocument { rising: ValueDocument::of(rising), falling: ValueDocument::of(falling) }
    }
}

impl PredictionsDocument {
    fn of(chain: &Chain) -> Self {
        let predictions = &chain.predictions;
        let sticking = predictions.sticking.as_ref();
        let value = ValueDocument::of_prediction;
        PredictionsDocument {
            eq_93_9_printed: value(&predictions.printed),
            eq_93_9_derived: value(&predictions.derived),
            eq_7_9: value(&predictions.fitted),
            routh_hurwitz: value(&predictions.stability),
            critical_slope: value(&predictions.critical_slope),
            boundary_frequency: value(&predictions.boundary_frequency),
            describing_function_without_memory: value(&predictions.without_memory),
            sticking_ends: ValueDocument::of(sticking.map(|end| end.velocity)),
            sticking_frequency: ValueDocument::of(sticking.map(|end| end.frequency)),
        }
    }
}

impl<'a> AdviceDocument<'a> {
    fn of(advice: &'a Advice) -> Self {
        AdviceDocument {
            letter: advice.letter,
            text: advice.text,
            quantity: advice.quantity,
            factor: advice.factor,
            verdict: advice.verdict.as_str(),
            outcome: advice.outcome.as_ref().ok().map(OutcomeDocument::of),
            error: advice.outcome.as_ref().err().map(String::as_str),
        }
    }
}

impl OutcomeDocument {
    fn of(outcome: &AdviceOutcome) -> Self {
        OutcomeDocument {
            parameters: outcome.parameters.named().into_iter().collect(),
            critical_velocity: CriticalDocument::of(&outcome.critical),
            eq_93_9_printed: ValueDocument::of_prediction(&outcome.printed),
            routh_hurwitz: ValueDocument::of_prediction(&outcome.stability),
        }
    }
}
