//! The missing force at every junction, as a sentence and as a JSON document.
//!
//! The force is estimated without the library, so it need not look like a named effect. The sentence describes the
//! most likely junction. If the evidence of other junctions is about as large, it names these as well.
//!
//! A force is the unknown input of a junction in the unit of its sum: newtons for a mass, a flow for a tank. It is a
//! series of values over time with standard errors. A curve over a quantity explains the same values by a function of
//! that quantity.

use serde::Serialize;

use crate::localise::localisation::{EstimatedInput, InputCurve, Localisation, indistinguishable_junctions};
use crate::report::values::{format_pure_number, percent_text};

/// The force that closes the gap at a junction, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LocalisationDocument {
    /// The integrator.
    pub junction: String,
    /// The unit of the force.
    pub unit: String,
    /// The share of the gap that the force closes, in squares.
    pub explains: f64,
    /// Logarithm of its marginal likelihood, above that of no force.
    pub evidence: f64,
    /// The effective count of free numbers of the force.
    pub numbers: f64,
    /// Whether the force is "smooth" or "rough", that is, may jump.
    pub likeness: &'static str,
    /// The signal or drive that explains the force best, or "time".
    pub best_against: String,
    /// The curve over that: value, force, standard error; null if it is time.
    pub curve: Option<Vec<[f64; 3]>>,
    /// The force over time, record by record.
    pub records: Vec<ForceDocument>,
    /// The force over every quantity that was tried.
    pub curves: Vec<CurveDocument>,
}

impl From<&Localisation> for LocalisationDocument {
    /// The best curve is copied to `curve`, so that a reader need not search `curves` for `best_against`.
    fn from(localisation: &Localisation) -> Self {
        LocalisationDocument {
            junction: localisation.junction.clone(),
            unit: localisation.unit.clone(),
            explains: localisation.explained_fraction,
            evidence: localisation.evidence,
            numbers: localisation.effective_parameters,
            likeness: localisation.prior.as_str(),
            best_against: localisation.best_regressor().to_owned(),
            curve: localisation.best_curve.map(|best| localisation.curves[best].points.clone()),
            records: localisation.inputs.iter().map(ForceDocument::from).collect(),
            curves: localisation.curves.iter().map(CurveDocument::from).collect(),
        }
    }
}

/// A force over the time of a record, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceDocument {
    /// The file of the record.
    pub data: String,
    /// From when to when the force acts, in seconds.
    pub windows: Vec<[f64; 2]>,
    /// Time in seconds, force, its standard error, and that if everything else were known.
    pub force: Vec<[f64; 4]>,
}

impl From<&EstimatedInput> for ForceDocument {
    /// Copies the force of one record.
    fn from(force: &EstimatedInput) -> Self {
        let EstimatedInput { data, points, windows } = force.clone();
        ForceDocument { data, windows, force: points }
    }
}

/// A force over a quantity, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveDocument {
    /// The quantity.
    pub against: String,
    /// Its unit.
    pub unit: String,
    /// The share of the gap that the curve closes in training, in squares.
    pub explains: f64,
    /// The same in the validation data, with the curve wired in; null if it cannot be wired in.
    #[serde(rename = "held_out")]
    pub validation_explains: Option<f64>,
    /// Logarithm of its marginal likelihood, above that of no force.
    pub evidence: f64,
    /// Value, force, standard error.
    pub curve: Vec<[f64; 3]>,
    /// The same while the quantity rises; null if both directions have the same curve.
    pub rising: Option<Vec<[f64; 3]>>,
    /// The same while it falls.
    pub falling: Option<Vec<[f64; 3]>>,
    /// Value and force at the knots of the force over time.
    pub scatter: Vec<[f64; 2]>,
}

impl From<&InputCurve> for CurveDocument {
    /// `rising` and `falling` are both null, or both lists.
    fn from(curve: &InputCurve) -> Self {
        let [rising, falling] =
            curve.by_direction.clone().map_or([None, None], |branches| branches.map(Some));
        CurveDocument {
            against: curve.regressor.clone(),
            unit: curve.unit.clone(),
            explains: curve.explained_fraction,
            validation_explains: curve.validation_fraction,
            evidence: curve.evidence,
            curve: curve.points.clone(),
            rising,
            falling,
            scatter: curve.scatter.clone(),
        }
    }
}

/// The junctions at which a force explains the gap best, when it acts, and on what it depends, as a sentence without
/// a full stop. `localisations` has the most likely junction first. None if it is empty.
///
/// Example: "the gap is best explained at IV, between t = 2 and 3.5 s, by a force that depends on v". Junctions whose
/// evidence is nearly as large are joined by "or".
pub fn localisation_sentence(localisations: &[Localisation]) -> Option<String> {
    let best = localisations.first()?;
    let nearest = indistinguishable_junctions(localisations);
    if nearest.is_empty() {
        let none = "no force over time at any junction explains the gap: it is too fast or too small to be found without a law";
        return Some(none.to_owned());
    }
    let ambiguity = if nearest.len() > 1 { ", which these data cannot distinguish" } else { "" };
    let dependence = match best.best_regressor() {
        "time" => "time only".to_owned(),
        signal => signal.to_owned(),
    };
    let (junctions, times) = (nearest.join(" or "), times_text(best));
    Some(format!(
        "the gap is best explained at {junctions}{ambiguity}{times}, by a force that depends on {dependence}"
    ))
}

/// The quantity on which a force depends, and what a curve over that quantity explains.
pub fn dependence_text(localisation: &Localisation) -> String {
    let share = localisation.best_curve.map(|best| {
        let explained = localisation.curves[best].explained_fraction;
        format!(", which explains {}", percent_text(100.0 * explained))
    });
    localisation.best_regressor().to_owned() + &share.unwrap_or_default()
}

/// The longest time for which a force acts, and the number of other times. Empty if it never stands out.
fn times_text(localisation: &Localisation) -> String {
    let windows: Vec<[f64; 2]> = localisation.windows().collect();
    let others = match windows.len() {
        0 | 1 => String::new(),
        2 => " and at another time".to_owned(),
        count => format!(" and at {} other times", count - 1),
    };
    let longest = windows.into_iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    longest.map_or_else(String::new, |[from, to]| {
        format!(", between t = {} and {} s{others}", format_pure_number(from), format_pure_number(to))
    })
}
