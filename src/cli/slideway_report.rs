//! Formats the prediction for a slideway as text and as JSON.
//!
//! The text is for reading: velocities in mm/s, four digits, tables. The JSON document has full precision and SI units.
//! Its keys are, in order:
//!
//! * `ok`, `title`, `notes`: warnings for the reader, a list of texts
//! * `inputs`, `parameters`, `circuit`, `run`: what was simulated
//! * `criterion`: `threshold` in m/s and `window` in s
//! * `critical_velocity`, `with_half_the_threshold`, `with_twice_the_threshold`: `rising` and `falling`, in m/s
//! * `resolution`: the change of the command within a window in m/s, which limits the accuracy of the run
//! * `predictions`, `advice`, `files`
//!
//! A value that may be missing is an object: `{"value": 0.0067}`, or `{"value": null, "because": "..."}`.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::table::Table;
use super::times::times_json;
use patchcord::format::{QuantityFormat, format_quantity};
use patchcord::instruments::{CriticalVelocity, NoCriticalVelocity};
use patchcord::solve::RunSettings;
use patchcord::thesis::chain::{Advice, AdviceOutcome, Chain, Origin, PotSetting, Prediction, Simulation};
use patchcord::thesis::slideway::units::{KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, UM};

/// The report as text: inputs, parameters, circuit, critical velocities, advice, notes.
pub(super) fn text(chain: &Chain) -> String {
    let notes: String = chain.notes.iter().map(|note| format!("note: {note}\n")).collect();
    let parts = [
        heading(chain),
        origins_table(&chain.origins),
        circuit_text(&chain.simulation),
        critical_text(chain),
        advice_text(chain),
        notes,
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// The title of the inputs, and the four quantities that follow from them: pressure, KLP, slope and lift.
fn heading(chain: &Chain) -> String {
    let design = &chain.design;
    format!(
        "{}\nPw {} kgf/cm2, KLP {} kgf/mm2, tan {}, Ho + hd {} um\n",
        chain.inputs.title(),
        number(chain.inputs.pressure() / KGF_PER_CM2),
        number(design.interface.polar / KGF_PER_MM2),
        number(design.interface.flank),
        number(design.lift / UM),
    )
}

/// A number to four digits.
pub(super) fn number(value: f64) -> String {
    QuantityFormat::new("", 1.0).number(value)
}

/// The table of the circuit's parameters with their sources.
///
/// Columns: name of the parameter, value with unit, law, and the value by another law if there is one.
fn origins_table(origins: &[Origin]) -> String {
    let mut table = Table::new(["", "value", "from", "alternative"]);
    for origin in origins {
        let other = origin.other.as_ref().map(|other| match &other.value {
            Ok(value) => format!("{} by {}", format_quantity(*value, origin.unit), other.from),
            Err(error) => format!("none by {}: {error}", other.from),
        });
        let value = format_quantity(origin.value, origin.unit);
        table.row([origin.name.to_owned(), value, origin.from.clone(), other.unwrap_or_default()]);
    }
    table.text()
}

/// The table of pots and the scales.
///
/// Settings have four decimals. `multiple` is 1 if the motion fits the scales of the study.
fn circuit_text(simulation: &Simulation) -> String {
    let mut table = Table::new(["pot", "setting", "formula"]);
    for PotSetting { name, setting, formula } in simulation.pots() {
        table.row([name, format!("{setting:.4}"), formula]);
    }
    let velocity = format_quantity(simulation.velocity_per_volt(), "m/s");
    let scales = format!("Fig 8.16 with scale set B times {}: {velocity} per volt\n", simulation.multiple);
    scales + &table.text()
}

/// The oscillation criterion and the rate of the command in one line.
pub(super) fn criterion_text(simulation: &Simulation) -> String {
    let criterion = simulation.criterion;
    format!(
        "oscillating: more than {} within {}, command {}",
        format_quantity(criterion.threshold, "m/s"),
        format_quantity(criterion.window, "s"),
        format_quantity(simulation.ramp.rate, "m/s2"),
    )
}

/// The table of critical velocities: simulated, and predicted by each equation.
///
/// The third column has the numbers with other thresholds, the slope and frequency of an equation, or the reason why it
/// gives none.
fn critical_text(chain: &Chain) -> String {
    let simulation = &chain.simulation;
    let mut table = Table::new(["critical velocity", "mm/s", ""]);
    let nearby = |side: fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>| {
        let [half, twice] = simulation.nearby_thresholds.map(|critical| velocity_text(side(&critical)));
        format!("with half the threshold {half}, with twice {twice}")
    };
    let mut row = |name: &str, value: String, more: String| table.row([name.to_owned(), value, more]);
    row("run, command rising", velocity_text(simulation.critical.rising), nearby(|critical| critical.rising));
    row(
        "run, command falling",
        velocity_text(simulation.critical.falling),
        nearby(|critical| critical.falling),
    );
    for (name, prediction, more) in predictions(chain) {
        row(name, prediction_text(prediction), more);
    }
    let sticking = chain.predictions.sticking.as_ref();
    let swinging = sticking.map(|end| format!("below it sticks, at {} Hz", number(end.frequency / TAU)));
    let sticking = sticking.map(|end| end.velocity).map_err(Clone::clone);
    row(
        "describing function with Tc",
        prediction_text(&sticking),
        swinging.unwrap_or_else(ToString::to_string),
    );
    format!(
        "{}; resolution {} mm/s\n{}",
        criterion_text(simulation),
        number(simulation.resolution() / MM_PER_S),
        table.text()
    )
}

/// The predictions by equations, each with its name and a remark or the reason why it fails.
///
/// Slopes are in N s/mm and frequencies in Hz. Equations that give no velocity keep their row, with the reason.
fn predictions(chain: &Chain) -> Vec<(&'static str, &Prediction, String)> {
    let predictions = &chain.predictions;
    let because = |prediction: &Prediction, more: String| match prediction {
        Ok(_) => more,
        Err(error) => error.to_string(),
    };
    let slope = predictions.critical_slope.as_ref().map_or(f64::NAN, |slope| slope * 1e-3);
    let frequency = predictions.boundary_frequency.as_ref().map_or(f64::NAN, |w| w / TAU);
    let small = format!("Cn {} N s/mm, {} Hz", number(slope), number(frequency));
    let all = [
        ("eq 93-9 as printed", &predictions.printed, String::new()),
        ("eq 93-9 rederived", &predictions.derived, String::new()),
        ("eq 7-9, the study's simulation", &predictions.fitted, String::new()),
        ("Routh-Hurwitz", &predictions.stability, small),
        ("describing function without Tc", &predictions.without_memory, "Cn = f".to_owned()),
    ];
    let rows = all.into_iter().map(|(name, prediction, more)| (name, prediction, because(prediction, more)));
    rows.collect()
}

/// The table of advice, with critical velocities before and after each change.
///
/// Rows are the rules a ... g of section 9.5. The first row is the slideway without a change.
fn advice_text(chain: &Chain) -> String {
    let headings = ["", "to lower it", "changed", "rising", "falling", "eq 93-9", "Routh-H.", "verdict"];
    let mut table = Table::new(headings);
    let (critical, predictions) = (chain.simulation.critical, &chain.predictions);
    table.row([
        String::new(),
        "unchanged".to_owned(),
        String::new(),
        velocity_text(critical.rising),
        velocity_text(critical.falling),
        prediction_text(&predictions.printed),
        prediction_text(&predictions.stability),
        String::new(),
    ]);
    for advice in &chain.advice {
        table.row(advice_row(advice));
    }
    table.text()
}

/// One row of the table of advice.
fn advice_row(advice: &Advice) -> [String; 8] {
    let changed = format!("{} x {}", advice.quantity, number(advice.factor));
    let (letter, text, verdict) =
        (advice.letter.to_string(), advice.text.to_owned(), advice.verdict.as_str().to_owned());
    match &advice.outcome {
        Ok(AdviceOutcome { critical, printed, stability, .. }) => [
            letter,
            text,
            changed,
            velocity_text(critical.rising),
            velocity_text(critical.falling),
            prediction_text(printed),
            prediction_text(stability),
            verdict,
        ],
        Err(error) => {
            let none = String::new;
            [letter, text, changed, none(), none(), none(), none(), format!("{verdict}: {error}")]
        }
    }
}

/// A simulated critical velocity in mm/s, or in few words why there is none.
///
/// "above 12.70" means that oscillation had not ended at the largest command.
fn velocity_text(velocity: Result<f64, NoCriticalVelocity>) -> String {
    match velocity {
        Ok(velocity) => format!("{:.2}", velocity / MM_PER_S),
        Err(NoCriticalVelocity::NoOscillation) => "none".to_owned(),
        Err(NoCriticalVelocity::NotEnded(top)) => format!("above {:.2}", top / MM_PER_S),
        Err(NoCriticalVelocity::NotBegun) => "not begun".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// A predicted critical velocity in mm/s, or "none".
fn prediction_text(prediction: &Prediction) -> String {
    prediction.as_ref().map_or_else(|_| "none".to_owned(), |velocity| format!("{:.2}", velocity / MM_PER_S))
}

/// The report as JSON, in SI units.
pub(super) fn json(chain: &Chain, files: Value) -> Value {
    let simulation = &chain.simulation;
    json!({
        "ok": true,
        "title": chain.inputs.title(),
        "notes": chain.notes,
        "inputs": inputs_json(chain),
        "parameters": chain.origins.iter().map(origin_json).collect::<Value>(),
        "circuit": circuit_json(simulation),
        "run": run_json(simulation),
        "criterion": {"threshold": simulation.criterion.threshold, "window": simulation.criterion.window},
        "critical_velocity": critical_json(&simulation.critical),
        "with_half_the_threshold": critical_json(&simulation.nearby_thresholds[0]),
        "with_twice_the_threshold": critical_json(&simulation.nearby_thresholds[1]),
        "resolution": simulation.resolution(),
        "predictions": predictions_json(chain),
        "advice": chain.advice.iter().map(advice_json).collect::<Value>(),
        "files": files,
    })
}

/// `viscosity` in Pa s, `polar`, `weight` in N, `area` in m2, `stiffness` in N/m, `ridge_width` and `ridge_height` in
/// m. What follows from them: `pressure` and `KLP` in Pa, `tan` of the flank, `lift` in m.
fn inputs_json(chain: &Chain) -> Value {
    let (inputs, design) = (&chain.inputs, &chain.design);
    json!({
        "viscosity": inputs.viscosity,
        "polar": inputs.polar,
        "weight": inputs.weight,
        "area": inputs.area,
        "stiffness": inputs.stiffness,
        "ridge_width": inputs.ridge.width,
        "ridge_height": inputs.ridge.height,
        "pressure": inputs.pressure(),
        "KLP": design.interface.polar,
        "tan": design.interface.flank,
        "lift": design.lift,
    })
}

/// `name`, `value`, `unit`, `from`, and `other`: null, or a value with the law `from` which it comes.
fn origin_json(origin: &Origin) -> Value {
    let other = origin.other.as_ref();
    let other = other.map(|other| value_json(&other.value, json!({"from": other.from})));
    json!({
        "name": origin.name, "value": origin.value, "unit": origin.unit, "from": origin.from, "other": other,
    })
}

/// `multiple` of the scales, `velocity_per_volt` in m/s, and `pots`: a list of `pot`, `setting` and `formula`.
fn circuit_json(simulation: &Simulation) -> Value {
    let pot = |pot: &PotSetting| json!({"pot": pot.name, "setting": pot.setting, "formula": pot.formula});
    json!({
        "multiple": simulation.multiple,
        "velocity_per_volt": simulation.velocity_per_volt(),
        "pots": simulation.pots().iter().map(pot).collect::<Value>(),
    })
}

/// Keys of the times of a run (`for`, `step`, `tolerance`, `every`), and `v_start`, `v_rate`, `v_top` of the command in
/// m/s and m/s2.
fn run_json(simulation: &Simulation) -> Value {
    let ramp = simulation.ramp;
    let mut run = RunSettings::of(&simulation.circuit).map_or(Value::Null, |settings| times_json(&settings));
    run["v_start"] = ramp.start.into();
    run["v_rate"] = ramp.rate.into();
    run["v_top"] = ramp.top().into();
    run
}

/// `rising` is the command at which oscillation ends, `falling` the one at which it begins again.
fn critical_json(critical: &CriticalVelocity) -> Value {
    let value = |velocity: &Result<f64, NoCriticalVelocity>| value_json(velocity, json!({}));
    json!({"rising": value(&critical.rising), "falling": value(&critical.falling)})
}

/// Critical velocities in m/s by equation, and `critical_slope` in N s/m, `boundary_frequency` and `sticking_frequency`
/// in rad/s.
fn predictions_json(chain: &Chain) -> Value {
    let predictions = &chain.predictions;
    let value = |prediction: &Prediction| value_json(prediction, json!({}));
    let sticking = predictions.sticking.as_ref();
    json!({
        "eq_93_9_printed": value(&predictions.printed),
        "eq_93_9_derived": value(&predictions.derived),
        "eq_7_9": value(&predictions.fitted),
        "routh_hurwitz": value(&predictions.stability),
        "critical_slope": value_json(&predictions.critical_slope, json!({})),
        "boundary_frequency": value_json(&predictions.boundary_frequency, json!({})),
        "describing_function_without_memory": value(&predictions.without_memory),
        "sticking_ends": value_json(&sticking.map(|end| end.velocity), json!({})),
        "sticking_frequency": value_json(&sticking.map(|end| end.frequency), json!({})),
    })
}

/// `advice` is the letter of the rule, `factor` the change of `quantity`. If the changed slideway cannot be simulated,
/// `error` replaces the results.
fn advice_json(advice: &Advice) -> Value {
    let mut document = json!({
        "advice": advice.letter,
        "text": advice.text,
        "quantity": advice.quantity,
        "factor": advice.factor,
        "verdict": advice.verdict.as_str(),
    });
    match &advice.outcome {
        Ok(outcome) => {
            let parameters = outcome.parameters.named().into_iter();
            document["parameters"] =
                parameters.map(|(name, value)| (name.to_owned(), json!(value))).collect();
            document["critical_velocity"] = critical_json(&outcome.critical);
            document["eq_93_9_printed"] = value_json(&outcome.printed, json!({}));
            document["routh_hurwitz"] = value_json(&outcome.stability, json!({}));
        }
        Err(error) => document["error"] = error.clone().into(),
    }
    document
}

/// Adds a number to a JSON object, or null and the reason.
fn value_json(value: &Result<f64, impl ToString>, mut object: Value) -> Value {
    match value {
        Ok(value) => object["value"] = (*value).into(),
        Err(error) => {
            object["value"] = Value::Null;
            object["because"] = error.to_string().into();
        }
    }
    object
}
