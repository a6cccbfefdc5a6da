//! What a chain gives, told to people and to programs.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::table::Table;
use super::times::times_json;
use patchcord::instruments::{CriticalVelocity, Display, NoCriticalVelocity};
use patchcord::solve::RunSettings;
use patchcord::thesis::chain::{Advice, Chain, Origin, Outcome, Pot, Prediction, Simulation};
use patchcord::thesis::slideway::units::{KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, UM};

/// The chain, step by step.
pub(super) fn told(chain: &Chain) -> String {
    let notes: String = chain.notes.iter().map(|note| format!("note: {note}\n")).collect();
    let parts = [
        heading(chain),
        origins_table(&chain.origins),
        circuit_told(&chain.simulation),
        critical_told(chain),
        advice_told(chain),
        notes,
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

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
    Display::new("", 1.0).number(value)
}

fn with_unit(value: f64, unit: &str) -> String {
    Display::new(unit, value).text(value)
}

fn origins_table(origins: &[Origin]) -> String {
    let mut table = Table::new(["", "value", "from", "beside it"]);
    for origin in origins {
        let other = origin.other.as_ref().map(|other| match &other.value {
            Ok(value) => format!("{} by {}", with_unit(*value, origin.unit), other.from),
            Err(error) => format!("none by {}: {error}", other.from),
        });
        let value = with_unit(origin.value, origin.unit);
        table.row([origin.name.to_owned(), value, origin.from.clone(), other.unwrap_or_default()]);
    }
    table.text()
}

fn circuit_told(simulation: &Simulation) -> String {
    let mut table = Table::new(["pot", "setting", "formula"]);
    for Pot { name, setting, formula } in simulation.pots() {
        table.row([name, format!("{setting:.4}"), formula]);
    }
    let velocity = with_unit(simulation.velocity_per_volt(), "m/s");
    let scales = format!("Fig 8.16 with scale set B times {}: {velocity} a volt\n", simulation.multiple);
    scales + &table.text()
}

/// When velocity counts as oscillating, in a few words.
pub(super) fn criterion_told(simulation: &Simulation) -> String {
    let criterion = simulation.criterion;
    format!(
        "oscillating: more than {} within {}, command {}",
        with_unit(criterion.threshold, "m/s"),
        with_unit(criterion.window, "s"),
        with_unit(simulation.ramp.rate, "m/s2"),
    )
}

fn critical_told(chain: &Chain) -> String {
    let simulation = &chain.simulation;
    let mut table = Table::new(["critical velocity", "mm/s", ""]);
    let nearby = |side: fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>| {
        let [half, twice] = simulation.nearby.map(|critical| read(side(&critical)));
        format!("with half the threshold {half}, with twice {twice}")
    };
    let mut row = |name: &str, value: String, more: String| table.row([name.to_owned(), value, more]);
    row("run, command rising", read(simulation.critical.rising), nearby(|critical| critical.rising));
    row("run, command falling", read(simulation.critical.falling), nearby(|critical| critical.falling));
    for (name, prediction, more) in predictions(chain) {
        row(name, predicted(prediction), more);
    }
    let sticking = chain.predictions.sticking.as_ref();
    let swinging = sticking.map(|end| format!("it sticks below, at {} Hz", number(end.frequency / TAU)));
    let sticking = sticking.map(|end| end.velocity).map_err(Clone::clone);
    row("describing function with Tc", predicted(&sticking), swinging.unwrap_or_else(ToString::to_string));
    format!(
        "{}; known to {} mm/s at best\n{}",
        criterion_told(simulation),
        number(simulation.resolution() / MM_PER_S),
        table.text()
    )
}

/// What equations say, with a word on each.
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
    let told = all.into_iter().map(|(name, prediction, more)| (name, prediction, because(prediction, more)));
    told.collect()
}

fn advice_told(chain: &Chain) -> String {
    let headings = ["", "to lower it", "changed", "rising", "falling", "eq 93-9", "Routh-H.", "verdict"];
    let mut table = Table::new(headings);
    let (critical, predictions) = (chain.simulation.critical, &chain.predictions);
    table.row([
        String::new(),
        "as it is".to_owned(),
        String::new(),
        read(critical.rising),
        read(critical.falling),
        predicted(&predictions.printed),
        predicted(&predictions.stability),
        String::new(),
    ]);
    for advice in &chain.advice {
        table.row(advice_row(advice));
    }
    table.text()
}

fn advice_row(advice: &Advice) -> [String; 8] {
    let changed = format!("{} x {}", advice.quantity, number(advice.factor));
    let (letter, text, verdict) =
        (advice.letter.to_string(), advice.text.to_owned(), advice.verdict.told().to_owned());
    match &advice.outcome {
        Ok(Outcome { critical, printed, stability, .. }) => [
            letter,
            text,
            changed,
            read(critical.rising),
            read(critical.falling),
            predicted(printed),
            predicted(stability),
            verdict,
        ],
        Err(error) => {
            let none = String::new;
            [letter, text, changed, none(), none(), none(), none(), format!("{verdict}: {error}")]
        }
    }
}

/// A velocity that was read, in mm/s; where there is none, in a word why.
fn read(velocity: Result<f64, NoCriticalVelocity>) -> String {
    match velocity {
        Ok(velocity) => format!("{:.2}", velocity / MM_PER_S),
        Err(NoCriticalVelocity::Quiet) => "none".to_owned(),
        Err(NoCriticalVelocity::NotEnded(top)) => format!("above {:.2}", top / MM_PER_S),
        Err(NoCriticalVelocity::NotBegun) => "not begun".to_owned(),
        Err(error) => error.to_string(),
    }
}

fn predicted(prediction: &Prediction) -> String {
    prediction.as_ref().map_or_else(|_| "none".to_owned(), |velocity| format!("{:.2}", velocity / MM_PER_S))
}

/// The chain as one document, in SI units.
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
        "with_half_the_threshold": critical_json(&simulation.nearby[0]),
        "with_twice_the_threshold": critical_json(&simulation.nearby[1]),
        "resolution": simulation.resolution(),
        "predictions": predictions_json(chain),
        "advice": chain.advice.iter().map(advice_json).collect::<Value>(),
        "files": files,
    })
}

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

fn origin_json(origin: &Origin) -> Value {
    let other = origin.other.as_ref();
    let other = other.map(|other| with_reason(&other.value, json!({"from": other.from})));
    json!({
        "name": origin.name, "value": origin.value, "unit": origin.unit, "from": origin.from, "other": other,
    })
}

fn circuit_json(simulation: &Simulation) -> Value {
    let pot = |pot: &Pot| json!({"pot": pot.name, "setting": pot.setting, "formula": pot.formula});
    json!({
        "multiple": simulation.multiple,
        "velocity_per_volt": simulation.velocity_per_volt(),
        "pots": simulation.pots().iter().map(pot).collect::<Value>(),
    })
}

fn run_json(simulation: &Simulation) -> Value {
    let ramp = simulation.ramp;
    let mut run = RunSettings::of(&simulation.circuit).map_or(Value::Null, |settings| times_json(&settings));
    run["v_start"] = ramp.start.into();
    run["v_rate"] = ramp.rate.into();
    run["v_top"] = ramp.top().into();
    run
}

fn critical_json(critical: &CriticalVelocity) -> Value {
    let told = |velocity: &Result<f64, NoCriticalVelocity>| with_reason(velocity, json!({}));
    json!({"rising": told(&critical.rising), "falling": told(&critical.falling)})
}

fn predictions_json(chain: &Chain) -> Value {
    let predictions = &chain.predictions;
    let told = |prediction: &Prediction| with_reason(prediction, json!({}));
    let sticking = predictions.sticking.as_ref();
    json!({
        "eq_93_9_printed": told(&predictions.printed),
        "eq_93_9_derived": told(&predictions.derived),
        "eq_7_9": told(&predictions.fitted),
        "routh_hurwitz": told(&predictions.stability),
        "critical_slope": told(&predictions.critical_slope),
        "boundary_frequency": told(&predictions.boundary_frequency),
        "describing_function_without_memory": told(&predictions.without_memory),
        "sticking_ends": with_reason(&sticking.map(|end| end.velocity), json!({})),
        "sticking_frequency": with_reason(&sticking.map(|end| end.frequency), json!({})),
    })
}

fn advice_json(advice: &Advice) -> Value {
    let mut told = json!({
        "advice": advice.letter,
        "text": advice.text,
        "quantity": advice.quantity,
        "factor": advice.factor,
        "verdict": advice.verdict.told(),
    });
    match &advice.outcome {
        Ok(outcome) => {
            let parameters = outcome.parameters.named().into_iter();
            told["parameters"] = parameters.map(|(name, value)| (name.to_owned(), json!(value))).collect();
            told["critical_velocity"] = critical_json(&outcome.critical);
            told["eq_93_9_printed"] = with_reason(&outcome.printed, json!({}));
            told["routh_hurwitz"] = with_reason(&outcome.stability, json!({}));
        }
        Err(error) => told["error"] = error.clone().into(),
    }
    told
}

/// A number, or null and why there is none.
fn with_reason(value: &Result<f64, impl ToString>, mut told: Value) -> Value {
    match value {
        Ok(value) => told["value"] = (*value).into(),
        Err(error) => {
            told["value"] = Value::Null;
            told["because"] = error.to_string().into();
        }
    }
    told
}
