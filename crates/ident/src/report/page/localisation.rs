//! The section on the missing force: all junctions, and the force at the most likely one.
//!
//! Pictures show the force over time with its 95 % interval, and as a curve over each quantity that may explain it.
//! If the verdict is an unknown effect, the section links to the patch with the force as a function generator or
//! table.

use crate::localise::localisation::{EstimatedInput, InputCurve, Localisation};
use crate::report::localisation::localisation_sentence;
use crate::report::page::html_parts::{bar, pictures, table};
use crate::report::values::{QuantityFormat, format_pure_number, percent_text};
use crate::search::outcome::Outcome;
use crate::statistics::descriptive::{NORMAL_95, extremes};
use maud::{Markup, Render, html};
use patchcord_draw::plot::{Axis, Channel, Picture, PlotError};

/// Tables and pictures of the missing force. Empty if no force was estimated.
pub(super) fn section(outcome: &Outcome) -> Result<Markup, PlotError> {
    let localisations = &outcome.localisations;
    let Some((best, sentence)) = localisations.first().zip(localisation_sentence(localisations)) else {
        return Ok(Markup::default());
    };
    let drawn = time_pictures(best).chain(ranked_curves(best).map(|curve| curve_picture(best, curve)));
    Ok(html! {
        section {
            h2 { "Where and when a force is missing" }
            p.reading { (capitalised(&sentence)) "." }
            "\n"
            (explanation())
            (junction_table(localisations))
            (curve_table(best))
            (pictures(drawn)?)
            (point_table(best))
            (recovered_text(outcome, best))
        }
        "\n"
    })
}

/// How the force was estimated, and what evidence is.
fn explanation() -> Markup {
    html! {
        p {
            "At each junction, a force over time was estimated together with all fitted parameters so that it \
            explains the gap of the original patch. Junctions are ranked by " i { "evidence" } ": the logarithm \
            of the factor by which the force makes the data more likely. The data cannot distinguish two \
            junctions whose evidence differs by less than 10."
        }
        "\n"
    }
}

/// The text with its first letter in upper case.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// A share of the gap as a percentage: 0.5 becomes "50 %". Negative shares occur in the validation data.
fn share_text(share: f64) -> String {
    percent_text(100.0 * share)
}

/// The table of all junctions, the most likely first.
fn junction_table(localisations: &[Localisation]) -> Markup {
    let rows = localisations.iter().enumerate().map(|(rank, localisation)| {
        let cells = vec![
            localisation.junction.render(),
            localisation.unit.render(),
            bar(localisation.explained_fraction),
            share_text(localisation.explained_fraction).render(),
            format_pure_number(localisation.evidence).render(),
            format_pure_number(localisation.effective_parameters).render(),
            localisation.best_regressor().render(),
        ];
        (rank == 0, cells)
    });
    table(&["at", "unit", "explains of the gap", "", "evidence", "effective parameters", "depends on"], rows)
}

/// The curves of a junction. The one on which the force depends is first.
fn ranked_curves(localisation: &Localisation) -> impl Iterator<Item = &InputCurve> {
    let is_best = |index: &usize| localisation.best_curve == Some(*index);
    let others = (0..localisation.curves.len()).filter(move |index| !is_best(index));
    localisation.best_curve.into_iter().chain(others).map(|index| &localisation.curves[index])
}

/// The table of all quantities over which the force was tried as a curve.
fn curve_table(localisation: &Localisation) -> Markup {
    let rows = ranked_curves(localisation).map(|curve| {
        let cells = vec![
            curve.regressor.clone(),
            curve.unit.clone(),
            share_text(curve.explained_fraction),
            curve.validation_fraction.map_or_else(String::new, share_text),
            format_pure_number(curve.evidence),
            if curve.by_direction.is_some() { "direction as well".to_owned() } else { String::new() },
        ];
        (curve.regressor == localisation.best_regressor(), cells)
    });
    let headings = [
        "force as a curve over",
        "unit",
        "explains of the gap",
        "in the validation data",
        "evidence",
        "depends on",
    ];
    table(&headings, rows)
}

/// The points of the best curve, for a function generator. Empty if the force depends on time only.
fn point_table(localisation: &Localisation) -> Markup {
    let Some(curve) = localisation.best_curve.map(|best| &localisation.curves[best]) else {
        return Markup::default();
    };
    let rows = curve.points.iter().map(|point| (false, point.map(format_pure_number).to_vec()));
    let units = [&curve.unit, &localisation.unit, &localisation.unit];
    let columns = [curve.regressor.as_str(), "force", "standard error"].into_iter().zip(units);
    let headings: Vec<String> = columns.map(|(name, unit)| format!("{name}, {unit}")).collect();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    html! {
        details {
            summary { "Points of the curve" }
            (table(&headings, rows))
        }
        "\n"
    }
}

/// A link to the patch with the force. Empty unless the verdict is an unknown effect.
fn recovered_text(outcome: &Outcome, best: &Localisation) -> Markup {
    let form = match best.wired_curve() {
        Some(_) => "as a function generator",
        None => "as a table over time",
    };
    html! {
        @if outcome.unknown_force().is_some() {
            p { "The patch with this force, " (form) ", is " a href="recovered.json" { "recovered.json" } "." }
            "\n"
        }
    }
}

/// The force over time, one picture per file.
///
/// Records of the same file share a picture. Spans mark the times at which the force acts.
fn time_pictures(localisation: &Localisation) -> impl Iterator<Item = Picture> {
    localisation.inputs.chunk_by(|one, next| one.data == next.data).map(|forces| {
        let with_error = |[time, force, error, _]: [f64; 4]| [time, force, error];
        // A point that is not a number lifts the pen between records.
        let gap = [f64::NAN; 3];
        let record_points = |force: &EstimatedInput| {
            force.points.iter().copied().map(with_error).chain([gap]).collect::<Vec<_>>()
        };
        let points: Vec<[f64; 3]> = forces.iter().flat_map(record_points).collect();
        let graph = ForceGraph::new(["t", "s"], localisation, &points);
        let force = Channel { errors: graph.errors(&points), ..graph.line("force", &points) };
        let spans = forces
            .iter()
            .flat_map(|force| &force.windows)
            .map(|window| window.map(|time| graph.across.value(time)));
        Picture {
            spans: spans.collect(),
            channels: vec![force],
            note: Some("band: 95 % interval; darker: times at which the force acts".to_owned()),
            ..graph.picture(format!("force at {} over time, {}", localisation.junction, forces[0].data))
        }
    })
}

/// The force as a curve over a quantity, with the force over time as faint dots.
///
/// The curve for both directions is drawn if the directions do not differ, or if it was wired in for the validation
/// data.
fn curve_picture(localisation: &Localisation, curve: &InputCurve) -> Picture {
    let mut branches: Vec<(&str, &[[f64; 3]])> = match &curve.by_direction {
        Some([rising, falling]) => vec![("rising", rising), ("falling", falling)],
        None => Vec::new(),
    };
    // The curve that was wired in for the validation data is the same in both directions.
    if branches.is_empty() || curve.validation_fraction.is_some() {
        branches.push(("curve", &curve.points));
    }
    let all: Vec<[f64; 3]> = branches.iter().flat_map(|(_, points)| points.iter().copied()).collect();
    let scatter: Vec<[f64; 3]> = curve.scatter.iter().map(|[value, force]| [*value, *force, 0.0]).collect();
    let graph =
        ForceGraph::new([&curve.regressor, &curve.unit], localisation, &[all, scatter.clone()].concat());
    let drawn = branches.into_iter().map(|(name, points)| Channel {
        errors: graph.errors(points),
        ..Channel { dots: true, ..graph.line(name, points) }
    });
    let background = Channel { dots: true, faint: true, ..graph.line("force over time", &scatter) };
    let dependence =
        if curve.regressor == localisation.best_regressor() { "the force depends on it: " } else { "" };
    let validation = match curve.validation_fraction {
        None => String::new(),
        Some(share) if share < 0.0 => ", and increases it in the validation data".to_owned(),
        Some(share) => format!(", and {} in the validation data", share_text(share)),
    };
    Picture {
        channels: drawn.chain([background]).collect(),
        note: Some(format!(
            "{dependence}the curve explains {} of the gap{validation}",
            share_text(curve.explained_fraction)
        )),
        ..graph.picture(format!("force at {} over {}", localisation.junction, curve.regressor))
    }
}

/// The axes of a picture of a force, and the formats of their numbers.
struct ForceGraph {
    /// The axis of the quantity or of time.
    horizontal: Axis,
    /// The axis of the force.
    vertical: Axis,
    /// Format and unit prefix of the horizontal axis.
    across: QuantityFormat,
    /// Format and unit prefix of the vertical axis.
    up: QuantityFormat,
}

/// Margin of the vertical axis for error bands, as a fraction of the range of the forces. Larger errors leave the
/// picture.
const ERROR_MARGIN: f64 = 0.5;

impl ForceGraph {
    /// Axes for points with a value of the quantity, a force and its standard error.
    fn new([name, unit]: [&str; 2], localisation: &Localisation, points: &[[f64; 3]]) -> ForceGraph {
        let largest = |column: usize| {
            let finite = points.iter().map(|point| point[column].abs()).filter(|value| value.is_finite());
            finite.fold(0.0, f64::max)
        };
        let (across, up) =
            (QuantityFormat::new(unit, largest(0)), QuantityFormat::new(&localisation.unit, largest(1)));
        let [low, high] = extremes(points.iter().map(|point| point[1]));
        let margin = ERROR_MARGIN * (high - low);
        let extent = points.iter().flat_map(|[_, force, error]| {
            let error = NORMAL_95 * error;
            [(force - error).max(low - margin), (force + error).min(high + margin)]
        });
        let horizontal = points.iter().map(|point| across.value(point[0]));
        ForceGraph {
            horizontal: Axis::fit_tight(name, &across.unit, horizontal, Axis::HORIZONTAL_DIVISIONS),
            vertical: Axis::fit(
                "force",
                &up.unit,
                extent.map(|force| up.value(force)),
                Axis::VERTICAL_DIVISIONS,
            ),
            across,
            up,
        }
    }

    /// A channel through the points, in the units of the axes.
    fn line(&self, name: &str, points: &[[f64; 3]]) -> Channel {
        let scaled = |[value, force, _]: &[f64; 3]| (self.across.value(*value), self.up.value(*force));
        Channel::line(name, points.iter().map(scaled).collect())
    }

    /// Half the width of the 95 % interval of every point, in the unit of the vertical axis.
    fn errors(&self, points: &[[f64; 3]]) -> Vec<f64> {
        points.iter().map(|[_, _, error]| self.up.value(NORMAL_95 * error)).collect()
    }

    /// An empty picture with these axes and a title.
    fn picture(&self, title: String) -> Picture {
        Picture::new(title, self.horizontal.clone(), self.vertical.clone())
    }
}
