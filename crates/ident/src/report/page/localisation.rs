//! Where and when something is missing: junctions beside each other, and the force at the best of them.

use crate::localise::force::{Curve, Force, Whereabouts};
use crate::report::localisation::localisation_sentence;
use crate::report::page::sheet::{bar, pictures, table};
use crate::search::outcome::Outcome;
use crate::statistics::descriptive::{NORMAL_95, ends};
use patchcord_analysis::instruments::{Display, number};
use patchcord_draw::html::escaped;
use patchcord_draw::plot::{Axis, Channel, Picture, PlotError};

/// The section; nothing where nothing is missing.
pub(super) fn section(outcome: &Outcome) -> Result<String, PlotError> {
    let found = &outcome.whereabouts;
    let Some((best, sentence)) = found.first().zip(localisation_sentence(found)) else {
        return Ok(String::new());
    };
    let drawn = over_time(best).chain(ranked(best).map(|curve| over_quantity(best, curve)));
    Ok(format!(
        "<section>\n<h2>Where and when something is missing</h2>\n<p class=\"reading\">{}.</p>\n\
         <p>At each junction a force was looked for that closes the gap of the patch as it is, beside everything that is fitted. Junctions are ranked by \
         <i>evidence</i>: the logarithm of how much likelier the force makes the data. Two within 10 of each other cannot be told apart.</p>\n\
         {}{}{}{}{}</section>\n",
        escaped(&capitalised(&sentence)),
        junctions(found),
        curves(best),
        pictures(drawn)?,
        setting(best),
        wired(outcome, best)
    ))
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// The junctions, the most likely first.
fn junctions(found: &[Whereabouts]) -> String {
    let rows = found.iter().enumerate().map(|(rank, own)| {
        let cells = vec![
            escaped(&own.junction),
            escaped(&own.unit),
            bar(own.explains),
            percent(own.explains),
            number(own.evidence),
            number(own.effective),
            escaped(own.best_against()),
        ];
        (rank == 0, cells)
    });
    table(&["at", "unit", "closes of the gap", "", "evidence", "numbers it comes to", "goes with"], rows)
}

/// The curves of a junction, that which the force goes with first.
fn ranked(found: &Whereabouts) -> impl Iterator<Item = &Curve> {
    let is_best = |place: &usize| found.best == Some(*place);
    let others = (0..found.curves.len()).filter(move |place| !is_best(place));
    found.best.into_iter().chain(others).map(|place| &found.curves[place])
}

fn curves(found: &Whereabouts) -> String {
    let rows = ranked(found).map(|curve| {
        let cells = vec![
            escaped(&curve.against),
            escaped(&curve.unit),
            percent(curve.explains),
            curve.held_out.map_or_else(String::new, percent),
            number(curve.evidence),
            if curve.by_direction.is_some() { "its direction, too".to_owned() } else { String::new() },
        ];
        (curve.against == found.best_against(), cells)
    });
    let headings =
        ["the same force over", "unit", "closes of the gap", "of that held back", "evidence", "goes with"];
    table(&headings, rows)
}

/// The force as the setting of a function generator, where it goes with something.
fn setting(found: &Whereabouts) -> String {
    let Some(curve) = found.best.map(|best| &found.curves[best]) else { return String::new() };
    let rows = curve.points.iter().map(|point| (false, point.map(number).to_vec()));
    let units = [&curve.unit, &found.unit, &found.unit].map(|unit| escaped(unit));
    let named = [curve.against.as_str(), "force", "standard error"].into_iter().zip(&units);
    let headings: Vec<String> = named.map(|(name, unit)| format!("{}, {unit}", escaped(name))).collect();
    format!(
        "<details><summary>The curve in numbers</summary>\n{}</details>\n",
        table(&headings.iter().map(String::as_str).collect::<Vec<_>>(), rows)
    )
}

/// Where the force stands in a patch.
fn wired(outcome: &Outcome, best: &Whereabouts) -> String {
    if outcome.unnamed().is_none() {
        return String::new();
    }
    let how = match best.wired() {
        Some(_) => "as a function generator",
        None => "as a table over time",
    };
    format!("<p>The patch with this force, {how}, is <a href=\"recovered.json\">recovered.json</a>.</p>\n")
}

/// The force over time, a picture for every file.
fn over_time(found: &Whereabouts) -> impl Iterator<Item = Picture> {
    found.forces.chunk_by(|one, next| one.data == next.data).map(|forces| {
        let reading = |[time, force, error, _]: [f64; 4]| [time, force, error];
        // The pen is lifted between records.
        let between = [f64::NAN; 3];
        let own =
            |force: &Force| force.points.iter().copied().map(reading).chain([between]).collect::<Vec<_>>();
        let points: Vec<[f64; 3]> = forces.iter().flat_map(own).collect();
        let graph = Graph::new(["t", "s"], found, &points);
        let force = Channel { errors: graph.errors(&points), ..graph.line("force", &points) };
        let spans =
            forces.iter().flat_map(|force| &force.windows).map(|span| span.map(|at| graph.across.value(at)));
        Picture {
            spans: spans.collect(),
            channels: vec![force],
            note: Some("band: where it lies in 95 of 100 cases; darker: when it acts".to_owned()),
            ..graph.picture(format!("force at {} over time, {}", found.junction, forces[0].data))
        }
    })
}

/// The force over a quantity.
fn over_quantity(found: &Whereabouts, curve: &Curve) -> Picture {
    let mut branches: Vec<(&str, &[[f64; 3]])> = match &curve.by_direction {
        Some([rising, falling]) => vec![("rising", rising), ("falling", falling)],
        None => Vec::new(),
    };
    // What was wired in does not know directions.
    if branches.is_empty() || curve.held_out.is_some() {
        branches.push(("curve", &curve.points));
    }
    let all: Vec<[f64; 3]> = branches.iter().flat_map(|(_, points)| points.iter().copied()).collect();
    let scatter: Vec<[f64; 3]> = curve.scatter.iter().map(|[value, force]| [*value, *force, 0.0]).collect();
    let graph = Graph::new([&curve.against, &curve.unit], found, &[all, scatter.clone()].concat());
    let drawn = branches.into_iter().map(|(name, points)| Channel {
        errors: graph.errors(points),
        ..Channel { dots: true, ..graph.line(name, points) }
    });
    let behind = Channel { dots: true, faint: true, ..graph.line("force over time", &scatter) };
    let goes = if curve.against == found.best_against() { "the force goes with it: " } else { "" };
    let held = match curve.held_out {
        None => String::new(),
        Some(share) if share < 0.0 => ", and widens that held back".to_owned(),
        Some(share) => format!(", and {} of that held back", percent(share)),
    };
    Picture {
        channels: drawn.chain([behind]).collect(),
        note: Some(format!("{goes}the curve closes {} of the gap{held}", percent(curve.explains))),
        ..graph.picture(format!("force at {} over {}", found.junction, curve.against))
    }
}

/// The axes of a force, and how numbers are shown on them.
struct Graph {
    horizontal: Axis,
    vertical: Axis,
    across: Display,
    up: Display,
}

/// Errors further from the forces than this share of what these range over leave the picture.
const ROOM: f64 = 0.5;

impl Graph {
    /// Of values of a quantity, forces and their standard errors.
    fn new([name, unit]: [&str; 2], found: &Whereabouts, points: &[[f64; 3]]) -> Graph {
        let largest = |column: usize| {
            let there = points.iter().map(|point| point[column].abs()).filter(|value| value.is_finite());
            there.fold(0.0, f64::max)
        };
        let (across, up) = (Display::new(unit, largest(0)), Display::new(&found.unit, largest(1)));
        let [low, high] = ends(points.iter().map(|point| point[1]));
        let room = ROOM * (high - low);
        let reached = points.iter().flat_map(|[_, force, error]| {
            let error = NORMAL_95 * error;
            [(force - error).max(low - room), (force + error).min(high + room)]
        });
        let horizontal = points.iter().map(|point| across.value(point[0]));
        Graph {
            horizontal: Axis::snug(name, &across.unit, horizontal, Axis::ACROSS),
            vertical: Axis::fit("force", &up.unit, reached.map(|force| up.value(force)), Axis::UP),
            across,
            up,
        }
    }

    fn line(&self, name: &str, points: &[[f64; 3]]) -> Channel {
        let place = |[value, force, _]: &[f64; 3]| (self.across.value(*value), self.up.value(*force));
        Channel::line(name, points.iter().map(place).collect())
    }

    /// How far forces are off in 95 of 100 cases.
    fn errors(&self, points: &[[f64; 3]]) -> Vec<f64> {
        points.iter().map(|[_, _, error]| self.up.value(NORMAL_95 * error)).collect()
    }

    fn picture(&self, title: String) -> Picture {
        Picture::new(title, self.horizontal.clone(), self.vertical.clone())
    }
}
