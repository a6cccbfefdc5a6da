//! Formats the prediction for a slideway as text: velocities in mm/s, four digits, tables.

use std::f64::consts::TAU;

use super::table::Table;
use patchcord::format::{format_pure_number, format_quantity};
use patchcord::instruments::{CriticalVelocity, CriticalVelocityError};
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
        "{}\nPw {} kgf/cm2, KLP {} kgf/mm2, tan {}, Ho + hd {} µm\n",
        chain.inputs.title(),
        format_pure_number(chain.inputs.pressure() / KGF_PER_CM2),
        format_pure_number(design.interface.polar / KGF_PER_MM2),
        format_pure_number(design.interface.flank),
        format_pure_number(design.lift / UM),
    )
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
/// Settings have four decimals. `multiple` is 1 if the motion fits the scales of the thesis.
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
    let nearby = |side: fn(&CriticalVelocity) -> Result<f64, CriticalVelocityError>| {
        let [half, twice] = simulation.nearby_thresholds.map(|critical| velocity_text(side(&critical)));
        format!("with half the threshold {half}, with twice {twice}")
    };
    let mut row = |name: &str, value: String, remark: String| table.row([name.to_owned(), value, remark]);
    row("run, command rising", velocity_text(simulation.critical.rising), nearby(|critical| critical.rising));
    row(
        "run, command falling",
        velocity_text(simulation.critical.falling),
        nearby(|critical| critical.falling),
    );
    for (name, prediction, remark) in predictions(chain) {
        row(name, prediction_text(prediction), remark);
    }
    let sticking = chain.predictions.sticking.as_ref();
    let remark =
        sticking.map(|end| format!("below it sticks, at {} Hz", format_pure_number(end.frequency / TAU)));
    let sticking = sticking.map(|end| end.velocity).map_err(Clone::clone);
    row(
        "describing function with Tc",
        prediction_text(&sticking),
        remark.unwrap_or_else(ToString::to_string),
    );
    format!(
        "{}; resolution {} mm/s\n{}",
        criterion_text(simulation),
        format_pure_number(simulation.resolution() / MM_PER_S),
        table.text()
    )
}

/// The predictions by equations, each with its name and a remark or the reason why it fails.
///
/// Slopes are in N s/mm and frequencies in Hz. Equations that give no velocity keep their row, with the reason.
fn predictions(chain: &Chain) -> Vec<(&'static str, &Prediction, String)> {
    let predictions = &chain.predictions;
    let remark = |prediction: &Prediction, remark: String| match prediction {
        Ok(_) => remark,
        Err(error) => error.to_string(),
    };
    let slope = predictions.critical_slope.as_ref().map_or(f64::NAN, |slope| slope * 1e-3);
    let frequency = predictions.boundary_frequency.as_ref().map_or(f64::NAN, |w| w / TAU);
    let small = format!("Cn {} N s/mm, {} Hz", format_pure_number(slope), format_pure_number(frequency));
    let all = [
        ("eq 93-9 as printed", &predictions.printed, String::new()),
        ("eq 93-9 rederived", &predictions.derived, String::new()),
        ("eq 7-9, the thesis's simulation", &predictions.fitted, String::new()),
        ("Routh-Hurwitz", &predictions.stability, small),
        ("describing function without Tc", &predictions.without_memory, "Cn = f".to_owned()),
    ];
    let rows = all.into_iter().map(|(name, prediction, text)| (name, prediction, remark(prediction, text)));
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
    let changed = format!("{} x {}", advice.quantity, format_pure_number(advice.factor));
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
fn velocity_text(velocity: Result<f64, CriticalVelocityError>) -> String {
    match velocity {
        Ok(velocity) => format!("{:.2}", velocity / MM_PER_S),
        Err(CriticalVelocityError::NoOscillation) => "none".to_owned(),
        Err(CriticalVelocityError::NotEnded(top)) => format!("above {:.2}", top / MM_PER_S),
        Err(CriticalVelocityError::NotBegun) => "not begun".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// A predicted critical velocity in mm/s, or "none".
fn prediction_text(prediction: &Prediction) -> String {
    prediction.as_ref().map_or_else(|_| "none".to_owned(), |velocity| format!("{:.2}", velocity / MM_PER_S))
}
