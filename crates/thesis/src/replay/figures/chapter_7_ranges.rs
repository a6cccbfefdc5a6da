//! Chapter 7: sums over the contacts of a range of ridges (7.2).
//!
//! The sums give area, overlap and number of contacts by load, for a first and for a second loading.

use super::chapter_7_ridges::{ANGLES, crossing};
use super::graph::{geomspace, sample_curve};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::asperities::{AsperityRange, ContactLaws, RangeContact};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{KGF, UM, UM2};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-07",
        place: "7.2, eq 34-7, 44-7",
        title: "real area of contact of a range",
        claims: &[
            "7-033", "7-039.a", "7-039.b", "7-039.c", "7-043.a", "7-046", "7-058.a", "7-058.b", "7-059",
        ],
        draw: area_of_range,
    },
    Figure {
        id: "fig-7-08",
        place: "7.2, eq 35-7, 43-7",
        title: "overlap of two ranges",
        claims: &["7-038.a", "7-038.b", "7-057.a", "7-057.b"],
        draw: overlap_of_range,
    },
    Figure {
        id: "fig-7-09",
        place: "7.2, eq 32-7",
        title: "number of contacts of a range",
        claims: &["7-040.a", "7-040.b", "7-040.c", "7-047", "7-048"],
        draw: contacts_of_range,
    },
    Figure {
        id: "fig-7-10",
        place: "7.2, eq 41-7, 45-7",
        title: "penetration by load, with measurements",
        claims: &[],
        draw: penetration,
    },
];

/// Levels of the sums that are plotted; the last one is at about 8 kgf.
const LEVELS: std::ops::RangeInclusive<u32> = 1..=25;

/// Number of levels that a load of 1 kgf flattens (7.2).
const FLATTENED_LEVELS: u32 = 7;

/// A quantity of a loaded range, in the units of the thesis.
type RangeQuantity = fn(&RangeContact) -> f64;

/// Returns load in kgf and a quantity at each level, for the first loading.
fn sums(quantity: RangeQuantity) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_thesis()?;
    LEVELS
        .map(|level| range.at_level(level).map(|pressed| (pressed.load / KGF, quantity(&pressed))))
        .collect()
}

/// Returns the same points for a second loading, up to the first load of 1 kgf.
fn reloaded_sums(quantity: RangeQuantity) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_thesis()?;
    let levels = LEVELS.map(|level| range.reloaded(FLATTENED_LEVELS, f64::from(level) * range.step));
    let all = levels.collect::<Result<Vec<_>, _>>()?;
    Ok(all
        .iter()
        .map(|pressed| (pressed.load / KGF, quantity(pressed)))
        .take_while(|at| at.0 <= 1.0)
        .collect())
}

/// Returns the line of a printed law between two loads in kgf.
fn printed(law: PowerLaw, low: f64, high: f64) -> Vec<(f64, f64)> {
    geomspace(low, high, 2).map(|load| (load, law.at(load))).collect()
}

/// Makes a graph against the load of a range, with logarithmic axes.
fn by_load(figure: &Figure, label: &str, unit: &str) -> Graph {
    Graph::new(&figure.heading(), ("load of a range WT", "kgf"), (label, unit)).logarithmic(true, true)
}

/// The settings of the figures of sums.
const SUMS: &str = "sums over levels 2 hT = 0.06 µm apart, ridges at right angles, elastic up to an overlap of 0.46 \
     µm and flowing above it";

/// Fig 7.7: real area of contact by load, first and second loading.
///
/// The printed law fits the elastic part only. From 0.06 kgf on the highest contacts yield, and the sums are above it
/// (claim 7-039.c).
fn area_of_range(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let area: RangeQuantity = |pressed| pressed.area / UM2;
    let (first, second) = (ContactLaws::PRINTED.area, PowerLaw::new(10500.0, 0.74));
    let graph = by_load(figure, "real area of contact Ac", "µm²")
        .dots("first loading, sums", sums(area)?)
        .line("Ac = 10460 WT^0.82 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", reloaded_sums(area)?)
        .line("Ac = 10500 WT^0.74 (44-7)", printed(second, 1e-4, 1.0));
    let at = |load: f64| -> Result<f64, BoxError> {
        Ok(AsperityRange::of_thesis()?.under(load * KGF)?.area / UM2)
    };
    let reading = format!(
        "the sums give {:.0} µm² at 0.01 kgf and {:.0} at 1 kgf, the printed law {:.0} and {:.0}; it is the law of \
         the elastic part",
        at(0.01)?,
        at(1.0)?,
        first.at(0.01),
        first.at(1.0)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SUMS, reading))
}

/// Fig 7.8: overlap by load, first and second loading.
///
/// The line of the second loading is drawn parallel to the first in the text; it is not a fit (claim 7-057).
fn overlap_of_range(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let overlap: RangeQuantity = |pressed| pressed.overlap / UM;
    let (first, second) = (ContactLaws::PRINTED.overlap, PowerLaw::new(0.53, 0.22));
    let graph = by_load(figure, "overlap hd", "µm")
        .y_range(0.05, 2.0)
        .dots("first loading, sums", sums(overlap)?)
        .line("hd = 0.92 WT^0.22 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", reloaded_sums(overlap)?)
        .line("hd = 0.53 WT^0.22 (43-7)", printed(second, 1e-4, 1.0));
    let range = AsperityRange::of_thesis()?;
    let slope = PowerLaw::fit(&reloaded_sums(overlap)?)?;
    let reading = format!(
        "at 1 kgf the overlap is {:.3} µm by the sums, {:.2} by the law; on a second loading it is proportional to \
         WT^{:.2}, steeper than the line, which is drawn parallel to the first",
        range.under(KGF)?.overlap / UM,
        first.at(1.0),
        slope.exponent
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SUMS, reading))
}

/// Fig 7.9: number of contacts by load.
///
/// The sums rise level by level: 1, 5, 13, 25 contacts.
fn contacts_of_range(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let contacts: RangeQuantity = |pressed| pressed.contacts;
    let law = ContactLaws::PRINTED.contacts;
    let graph = by_load(figure, "contacts Nc", "")
        .y_range(1.0, 2000.0)
        .dots("sums", sums(contacts)?)
        .line("Nc = 520 WT^0.5 (T7.1)", printed(law, 1e-5, 10.0));
    let at = AsperityRange::of_thesis()?.under(KGF)?.contacts;
    let reading = format!(
        "at 1 kgf there are {at:.0} contacts by the sums, {:.0} by the law, which fits smaller loads",
        law.at(1.0)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SUMS, reading))
}

/// Fig 7.10: penetration by pressure for both cross angles, with the measured law (41-7).
fn penetration(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("pressure Pw", "kgf/cm²"), ("penetration hd", "µm"))
        .logarithmic(true, true)
        .x_range(0.01, 10.0)
        .y_range(0.05, 2.0);
    let mut depths = Vec::new();
    for degrees in ANGLES {
        let range = AsperityRange { crossing: crossing(degrees)?, step: AsperityRange::of_thesis()?.step };
        let points =
            sample_curve(geomspace(0.01, 8.0, 60), |load| Ok(range.under(load * KGF)?.overlap / UM))?;
        graph = graph.line(format!("a range per cm², ridges at {degrees}°"), points);
        depths.push(range.under(KGF)?.overlap / UM);
    }
    let measured = PowerLaw::new(0.65, 0.45);
    let graph = graph.line("measured by others: 0.65 Pw^0.45 (41-7)", printed(measured, 0.01, 10.0));
    let reading = format!(
        "at 1 kgf/cm² the penetration is {:.2} and {:.2} µm, measured {:.2}; it is slightly smaller at 30 degrees; \
         the measured line is twice as steep",
        depths[0],
        depths[1],
        measured.at(1.0)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SUMS, reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-08", "0.92 by the law");
    }
}
