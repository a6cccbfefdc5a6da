//! Where and when something is missing, in words and as a document.

use serde::Serialize;

use crate::localise::force::{Curve, Force, Whereabouts, nearest};
use patchcord_analysis::instruments::Display;

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

impl From<&Whereabouts> for LocalisationDocument {
    fn from(found: &Whereabouts) -> Self {
        LocalisationDocument {
            junction: found.junction.clone(),
            unit: found.unit.clone(),
            explains: found.explains,
            evidence: found.evidence,
            numbers: found.effective,
            likeness: found.likeness.as_str(),
            best_against: found.best_against().to_owned(),
            curve: found.best.map(|best| found.curves[best].points.clone()),
            records: found.forces.iter().map(ForceDocument::from).collect(),
            curves: found.curves.iter().map(CurveDocument::from).collect(),
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

impl From<&Force> for ForceDocument {
    fn from(force: &Force) -> Self {
        let Force { data, points, windows } = force.clone();
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
    /// The same on the data held back, with the curve wired in; null if it cannot be.
    pub held_out: Option<f64>,
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

impl From<&Curve> for CurveDocument {
    fn from(curve: &Curve) -> Self {
        let [rising, falling] =
            [0, 1].map(|place| curve.by_direction.as_ref().map(|both| both[place].clone()));
        CurveDocument {
            against: curve.against.clone(),
            unit: curve.unit.clone(),
            explains: curve.explains,
            held_out: curve.held_out,
            evidence: curve.evidence,
            curve: curve.points.clone(),
            rising,
            falling,
            scatter: curve.scatter.clone(),
        }
    }
}

/// Where the gap is best explained, when, and by what force, in words; `found` has the most likely junction first.
pub fn localisation_sentence(found: &[Whereabouts]) -> Option<String> {
    let best = found.first()?;
    let near = nearest(found);
    if near.is_empty() {
        let few = "no force over time at any junction explains the gap: it is too fast, or too small, to be found without a law";
        return Some(few.to_owned());
    }
    let apart = if near.len() > 1 { ", which these data cannot tell apart" } else { "" };
    let against = match best.best_against() {
        "time" => "that goes with time alone".to_owned(),
        signal => format!("of {signal}"),
    };
    let (at, when) = (near.join(" or "), when(best));
    Some(format!("the gap is best explained at {at}{apart}{when}, as a force {against}"))
}

/// The longest time for which a force acts, and how many others there are, in words.
fn when(found: &Whereabouts) -> String {
    let windows: Vec<[f64; 2]> = found.windows().collect();
    let others = match windows.len() {
        0 | 1 => String::new(),
        2 => " and at another time".to_owned(),
        count => format!(" and at {} other times", count - 1),
    };
    let longest = windows.into_iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    let told = |time: f64| Display::new("", 1.0).number(time);
    longest.map_or_else(String::new, |[from, to]| {
        format!(", between t = {} and {} s{others}", told(from), told(to))
    })
}
