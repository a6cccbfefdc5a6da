//! Chapter 7: single ridges, and ranges of ridges (7.2).
//!
//! Two crossed ridges touch as Hertz contacts until the metal flows. A range is a set of ridges whose crests fall on
//! both sides of its middle. Sums over its contacts give area, overlap and number of contacts by load.

use std::f64::consts::FRAC_PI_2;

use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{Grid, PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::asperities::{AsperityRange, ContactLaws, RangeContact};
use crate::slideway::crossing::Crossing;
use crate::slideway::joint::STUDY_PRESSURE;
use crate::slideway::material::Material;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_MM2, MM, UM, UM2};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-04",
        place: "7.2, eq 10-7 ... 31-7",
        title: "two crossed ridges under a load",
        claims: &["7-015", "7-017", "7-019", "7-020"],
        draw: table_of_ridges,
    },
    Figure {
        id: "fig-7-05",
        place: "7.2, eq 26-7",
        title: "overlap of two crossed ridges",
        claims: &["7-017", "7-021", "7-028", "7-029", "7-030"],
        draw: overlap_of_ridges,
    },
    Figure {
        id: "fig-7-06",
        place: "7.2, eq 32-7",
        title: "a range of ridges, and where two ranges touch",
        claims: &["7-031.a", "7-031.b", "7-031.c", "7-033", "7-061", "7-062.a"],
        draw: range_of_ridges,
    },
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

/// The two cross angles of the study, in degrees.
const ANGLES: [f64; 2] = [90.0, 30.0];

/// Two ground ridges of grade 17 iron that cross at an angle in degrees.
fn crossing(degrees: f64) -> Result<Crossing, SlidewayError> {
    Crossing::new(&Ridge::GROUND, &Material::GRADE_17_IRON, degrees.to_radians())
}

/// The settings of the figures of single ridges.
const RIDGES: &str = "ridges of grade 17 iron, B = 50 µm, Z = 2.5 µm";

/// Fig 7.4: overlap, pressures and semi-axes of the contact by load, as a table with the printed factors.
fn table_of_ridges(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut rows = vec![words([
        "cross angle",
        "overlap",
        "peak pressure",
        "mean pressure",
        "longer semi-axis",
        "shorter",
    ])];
    rows.push(words(["β", "h, mm", "p₀, kgf/mm²", "p, kgf/mm²", "a, mm", "b, mm"]));
    for (degrees, printed) in PRINTED {
        let pair = crossing(degrees)?;
        let (major, minor) = pair.semi_axes(KGF)?;
        rows.push(vec![
            format!("{degrees}°"),
            law(pair.overlap(KGF)? / MM, 5),
            law(pair.peak_pressure(KGF)? / KGF_PER_MM2, 0),
            law(pair.mean_pressure(KGF)? / KGF_PER_MM2, 0),
            law(major / MM, 4),
            law(minor / MM, 4),
        ]);
        rows.push(words(printed));
    }
    let mut sketch = Sketch::new(&figure.heading(), 316.0);
    sketch.table((16.0, 90.0), &rows);
    sketch.text("W in kgf; elastic, as two Hertz contacts", (16.0, 296.0));
    let [square, oblique] = [crossing(90.0)?, crossing(30.0)?];
    let less = 1.0 - oblique.overlap(KGF)? / square.overlap(KGF)?;
    let (major, minor) = oblique.semi_axes(KGF)?;
    let reading = format!(
        "at 30 degrees the overlap is {:.0} % less than at 90 degrees, and the contact is {:.1} times as long as wide",
        100.0 * less,
        major / minor
    );
    Ok(sketch.finish(RIDGES, reading))
}

/// Converts words to a row of the table.
fn words<const COUNT: usize>(words: [&str; COUNT]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

/// The rows of the printed table, by cross angle in degrees.
const PRINTED: [(f64, [&str; 6]); 2] = [
    (90.0, ["printed", "0.00297", "850", "567", "0.0237", "0.0237"]),
    (30.0, ["printed", "0.00244", "631", "420", "0.0647", "0.0117"]),
];

/// Formats a law in the cube root of the load.
///
/// Under load, overlap, semi-axes and pressures of an elastic contact are all proportional to W^(1/3).
fn law(factor: f64, decimals: usize) -> String {
    format!("{factor:.decimals$} W^(1/3)")
}

/// Fig 7.5: overlap by load, elastic, with the points where the metal flows.
///
/// The points are the yield overlaps, 0.46 and 0.51 um (claims 7-029 and 7-030).
fn overlap_of_ridges(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("load W", "kgf"), ("overlap h", "µm"));
    let (mut flowing, mut texts) = (Vec::new(), Vec::new());
    for degrees in ANGLES {
        let pair = crossing(degrees)?;
        let points = sample_curve(linspace(0.0, 1.0, 101).map(|part| 0.02 * part.powi(3)), |load| {
            Ok(pair.overlap(load * KGF)? / UM)
        })?;
        graph = graph.line(format!("ridges cross at {degrees}°"), points);
        let (load, overlap) = (pair.yield_load() / KGF, pair.yield_overlap() / UM);
        flowing.push((load, overlap));
        texts.push(format!("{overlap:.2} µm and {load:.4} kgf at {degrees} degrees"));
    }
    let graph = graph
        .dots("peak pressure 132 kgf/mm²: metal flows", flowing)
        .note("the curves are elastic throughout; the points of 0.1 % proof stress are lost with the figure");
    Ok(DrawnFigure::from_theory(
        vec![graph.picture()],
        RIDGES,
        format!("the metal flows at {}", texts.join(", ")),
    ))
}

/// Fig 7.6: the section of a range, and the contacts of two ranges under 0.65 kgf.
fn range_of_ridges(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let range = AsperityRange::of_study()?;
    let pressed = range.under(STUDY_PRESSURE * CM2)?;
    let mut sketch = Sketch::new(&figure.heading(), 800.0);
    section(&mut sketch);
    contacts(&mut sketch, &range, pressed.overlap)?;
    let reading = format!(
        "under 0.65 kgf the ranges overlap by {:.3} µm and touch in {:.0} places with a total area of {:.0} µm²",
        pressed.overlap / UM,
        pressed.contacts,
        pressed.area / UM2
    );
    Ok(sketch.finish(format!("{RIDGES}, hT = 0.03 µm, levels 2 hT apart"), reading))
}

/// Draws (a): the middle of a range. The fall of its crests is drawn ten times as steep as it is.
fn section(sketch: &mut Sketch) {
    let (wide, high, fall) = (80.0, 110.0, 13.0);
    let grid = Grid { origin: (450.0, 215.0), scale: (wide, 1.0) };
    let crest = |index: i32| high - fall * f64::from(index.abs());
    let mut outline = vec![grid.at(-4.5, 0.0)];
    for index in -4..=4 {
        outline.push(grid.at(f64::from(index), crest(index)));
        outline.push(grid.at(f64::from(index) + 0.5, 0.0));
    }
    let base = [grid.at(4.5, -24.0), grid.at(-4.5, -24.0)];
    let body: Vec<PixelPoint> = outline.iter().copied().chain(base).collect();
    sketch.body(&body);
    sketch.dashed(grid.at(-4.5, crest(4) - 0.5 * fall), grid.at(0.0, high));
    sketch.dashed(grid.at(0.0, high), grid.at(4.5, crest(4) - 0.5 * fall));
    sketch.dashed(grid.at(0.0, high), grid.at(3.4, high));
    sketch.span(grid.at(3.0, high), grid.at(3.0, crest(3)), "3 hT");
    sketch.span(grid.at(-3.5, -36.0), grid.at(-2.5, -36.0), "");
    sketch.centred("B = 50 µm", grid.at(-3.0, -54.0));
    sketch.span(grid.at(-4.7, 0.0), grid.at(-4.7, high), "");
    sketch.text_before("Z", grid.at(-4.8, high / 2.0));
    sketch.text("(a) the middle of a range, heights stretched, its fall hT tenfold more", (16.0, 68.0));
}

/// The factor by which contacts are drawn wider than they are.
const WIDENED: f64 = 2.5;

/// Draws (b): the contacts of two ranges at an overlap in m, seen from above.
fn contacts(sketch: &mut Sketch, range: &AsperityRange, overlap: f64) -> Result<(), BoxError> {
    let flows = range.crossing.yield_overlap();
    let ridge = Ridge::GROUND;
    let grid = Grid { origin: (450.0, 545.0), scale: (0.33 / UM, 0.33 / UM) };
    let most = (overlap / range.step) as i32;
    let pairs = (-most..=most).flat_map(|row| (-most..=most).map(move |column| (row, column)));
    for (row, column) in pairs {
        let left = overlap - f64::from(row.abs() + column.abs()) * range.step;
        if left <= 0.0 {
            continue;
        }
        // The square rests on a corner: half its area is the square of its half diagonal.
        let half = WIDENED * (ridge.overlap_area(left, FRAC_PI_2)? / 2.0).sqrt();
        let (x, y) = (f64::from(column) * ridge.width, f64::from(row) * ridge.width);
        let corners = [(half, 0.0), (0.0, half), (-half, 0.0), (0.0, -half)];
        let ink = if left > flows { Ink::Voltage } else { Ink::Signal };
        sketch.area(&grid.all(corners.map(|(right, up)| (x + right, y + up))), ink);
    }
    let [from, to] =
        [grid.at(9.0 * ridge.width, 12.0 * ridge.width), grid.at(13.0 * ridge.width, 12.0 * ridge.width)];
    sketch.span(from, to, "200 µm");
    sketch.text(
        &format!("(b) contacts under 0.65 kgf, drawn {WIDENED} times as wide as they are"),
        (16.0, 320.0),
    );
    sketch.coloured("elastic", (16.0, 346.0), Ink::Signal);
    sketch.coloured("flowing: overlap above 0.46 µm", (16.0, 368.0), Ink::Voltage);
    Ok(())
}

/// Levels of the sums that are plotted; the last one is at about 8 kgf.
const LEVELS: std::ops::RangeInclusive<u32> = 1..=25;

/// Number of levels that a load of 1 kgf flattens (7.2).
const FLATTENED: u32 = 7;

/// A quantity of a loaded range, in the units of the study.
type RangeQuantity = fn(&RangeContact) -> f64;

/// Returns load in kgf and a quantity at each level, for the first loading.
fn sums(quantity: RangeQuantity) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_study()?;
    LEVELS
        .map(|level| range.at_level(level).map(|pressed| (pressed.load / KGF, quantity(&pressed))))
        .collect()
}

/// Returns the same points for a second loading, up to the first load of 1 kgf.
fn sums_again(quantity: RangeQuantity) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_study()?;
    let levels = LEVELS.map(|level| range.reloaded(FLATTENED, f64::from(level) * range.step));
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
    let (first, again) = (ContactLaws::PRINTED.area, PowerLaw::new(10500.0, 0.74));
    let graph = by_load(figure, "real area of contact Ac", "µm²")
        .dots("first loading, sums", sums(area)?)
        .line("Ac = 10460 WT^0.82 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", sums_again(area)?)
        .line("Ac = 10500 WT^0.74 (44-7)", printed(again, 1e-4, 1.0));
    let at =
        |load: f64| -> Result<f64, BoxError> { Ok(AsperityRange::of_study()?.under(load * KGF)?.area / UM2) };
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
    let (first, again) = (ContactLaws::PRINTED.overlap, PowerLaw::new(0.53, 0.22));
    let graph = by_load(figure, "overlap hd", "µm")
        .y_range(0.05, 2.0)
        .dots("first loading, sums", sums(overlap)?)
        .line("hd = 0.92 WT^0.22 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", sums_again(overlap)?)
        .line("hd = 0.53 WT^0.22 (43-7)", printed(again, 1e-4, 1.0));
    let range = AsperityRange::of_study()?;
    let slope = PowerLaw::fit(&sums_again(overlap)?)?;
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
    let at = AsperityRange::of_study()?.under(KGF)?.contacts;
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
        let range = AsperityRange { crossing: crossing(degrees)?, step: AsperityRange::of_study()?.step };
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
    use super::super::reading;

    #[test]
    fn readings_agree_with_the_text() {
        assert!(reading("fig-7-04").contains("18 % less"));
        assert!(reading("fig-7-05").contains("0.46 µm") && reading("fig-7-05").contains("0.51 µm"));
        assert!(reading("fig-7-06").contains("overlap by 0.817 µm"), "{}", reading("fig-7-06"));
        assert!(reading("fig-7-08").contains("0.92 by the law"), "{}", reading("fig-7-08"));
    }
}
