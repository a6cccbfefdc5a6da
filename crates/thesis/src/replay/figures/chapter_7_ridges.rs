//! Chapter 7: ridges, and ranges of them (7.2).

use std::f64::consts::FRAC_PI_2;

use super::graph::{by_ratio, curve, evenly};
use super::sketch::{Grid, Place, Sketch};
use super::{Drawn, Figure, Graph};
use crate::replay::recipe::Problem;
use crate::slideway::SlidewayError;
use crate::slideway::asperities::{AsperityRange, ContactLaws, Pressed};
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
        title: "penetration by load, beside measurements",
        claims: &[],
        draw: penetration,
    },
];

/// Both cross angles that the study works out, in degrees.
const ANGLES: [f64; 2] = [90.0, 30.0];

fn crossing(degrees: f64) -> Result<Crossing, SlidewayError> {
    Crossing::new(&Ridge::GROUND, &Material::GRADE_17_IRON, degrees.to_radians())
}

const RIDGES: &str = "ridges of grade 17 iron, B = 50 µm, Z = 2.5 µm";

fn table_of_ridges(figure: &Figure) -> Result<Drawn, Problem> {
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
        "at 30 degrees the overlap is {:.0} % less than at 90, and the contact {:.1} times as long as wide",
        100.0 * less,
        major / minor
    );
    Ok(sketch.drawn(RIDGES, reading))
}

fn words<const COUNT: usize>(words: [&str; COUNT]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

/// The table as it is printed, by cross angle in degrees.
const PRINTED: [(f64, [&str; 6]); 2] = [
    (90.0, ["printed", "0.00297", "850", "567", "0.0237", "0.0237"]),
    (30.0, ["printed", "0.00244", "631", "420", "0.0647", "0.0117"]),
];

/// A factor of the cube root of the load.
fn law(factor: f64, decimals: usize) -> String {
    format!("{factor:.decimals$} W^(1/3)")
}

fn overlap_of_ridges(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("load W", "kgf"), ("overlap h", "µm"));
    let (mut flowing, mut told) = (Vec::new(), Vec::new());
    for degrees in ANGLES {
        let pair = crossing(degrees)?;
        let points = curve(evenly(0.0, 1.0, 101).map(|part| 0.02 * part.powi(3)), |load| {
            Ok(pair.overlap(load * KGF)? / UM)
        })?;
        graph = graph.line(format!("ridges cross at {degrees}°"), points);
        let (load, overlap) = (pair.yield_load() / KGF, pair.yield_overlap() / UM);
        flowing.push((load, overlap));
        told.push(format!("{overlap:.2} µm and {load:.4} kgf at {degrees} degrees"));
    }
    let graph = graph
        .dots("peak pressure 132 kgf/mm²: metal flows", flowing)
        .note("elastic all the way; the points of 0.1 % proof stress are lost with the figure");
    Ok(Drawn::of_theory(vec![graph.picture()], RIDGES, format!("metal flows at {}", told.join(", "))))
}

fn range_of_ridges(figure: &Figure) -> Result<Drawn, Problem> {
    let range = AsperityRange::of_study()?;
    let pressed = range.under(STUDY_PRESSURE * CM2)?;
    let mut sketch = Sketch::new(&figure.heading(), 800.0);
    section(&mut sketch);
    contacts(&mut sketch, &range, pressed.overlap)?;
    let reading = format!(
        "under 0.65 kgf the ranges overlap by {:.3} µm and touch in {:.0} places, {:.0} µm² together",
        pressed.overlap / UM,
        pressed.contacts,
        pressed.area / UM2
    );
    Ok(sketch.drawn(format!("{RIDGES}, hT = 0.03 µm, levels 2 hT apart"), reading))
}

/// (a): the middle of a range. The fall is drawn ten times as steep as it is.
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
    let body: Vec<Place> = outline.iter().copied().chain(base).collect();
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

/// How much wider contacts are drawn than they are.
const WIDENED: f64 = 2.5;

/// (b): where two ranges touch at an overlap in m, seen from above.
fn contacts(sketch: &mut Sketch, range: &AsperityRange, overlap: f64) -> Result<(), Problem> {
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
        // The square stands on its corner: half its area is that of its half diagonal squared.
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

/// Levels of the sums that are shown: up to 8 kgf.
const LEVELS: std::ops::RangeInclusive<u32> = 1..=25;

/// Levels that an overload of 1 kgf flattens (7.2).
const FLATTENED: u32 = 7;

/// What is read by load: kgf and a number in the units of the study.
type Reading = fn(&Pressed) -> f64;

fn sums(reading: Reading) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_study()?;
    LEVELS.map(|level| range.at_level(level).map(|pressed| (pressed.load / KGF, reading(&pressed)))).collect()
}

/// The same when loaded again, up to the load of 1 kgf that came before.
fn sums_again(reading: Reading) -> Result<Vec<(f64, f64)>, SlidewayError> {
    let range = AsperityRange::of_study()?;
    let levels = LEVELS.map(|level| range.reloaded(FLATTENED, f64::from(level) * range.step));
    let all = levels.collect::<Result<Vec<_>, _>>()?;
    Ok(all
        .iter()
        .map(|pressed| (pressed.load / KGF, reading(pressed)))
        .take_while(|at| at.0 <= 1.0)
        .collect())
}

/// A printed law over the loads that are shown.
fn printed(law: PowerLaw, low: f64, high: f64) -> Vec<(f64, f64)> {
    by_ratio(low, high, 2).map(|load| (load, law.at(load))).collect()
}

fn by_load(figure: &Figure, label: &str, unit: &str) -> Graph {
    Graph::new(&figure.heading(), ("load of a range WT", "kgf"), (label, unit)).logarithmic(true, true)
}

const SUMS: &str =
    "sums over levels 2 hT = 0.06 µm apart, ridges at right angles, elastic up to 0.46 µm and flowing beyond";

fn area_of_range(figure: &Figure) -> Result<Drawn, Problem> {
    let area: Reading = |pressed| pressed.area / UM2;
    let (first, again) = (ContactLaws::PRINTED.area, PowerLaw::new(10500.0, 0.74));
    let graph = by_load(figure, "real area of contact Ac", "µm²")
        .dots("first loading, sums", sums(area)?)
        .line("Ac = 10460 WT^0.82 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", sums_again(area)?)
        .line("Ac = 10500 WT^0.74 (44-7)", printed(again, 1e-4, 1.0));
    let at =
        |load: f64| -> Result<f64, Problem> { Ok(AsperityRange::of_study()?.under(load * KGF)?.area / UM2) };
    let reading = format!(
        "the sums give {:.0} µm² at 0.01 kgf and {:.0} at 1 kgf, the printed law {:.0} and {:.0}: it is that of the elastic part",
        at(0.01)?,
        at(1.0)?,
        first.at(0.01),
        first.at(1.0)
    );
    Ok(Drawn::of_theory(vec![graph.picture()], SUMS, reading))
}

fn overlap_of_range(figure: &Figure) -> Result<Drawn, Problem> {
    let overlap: Reading = |pressed| pressed.overlap / UM;
    let (first, again) = (ContactLaws::PRINTED.overlap, PowerLaw::new(0.53, 0.22));
    let graph = by_load(figure, "overlap hd", "µm")
        .up(0.05, 2.0)
        .dots("first loading, sums", sums(overlap)?)
        .line("hd = 0.92 WT^0.22 (T7.1)", printed(first, 1e-5, 10.0))
        .dots("loaded again after 1 kgf, sums", sums_again(overlap)?)
        .line("hd = 0.53 WT^0.22 (43-7)", printed(again, 1e-4, 1.0));
    let range = AsperityRange::of_study()?;
    let slope = PowerLaw::fit(&sums_again(overlap)?)?;
    let reading = format!(
        "{:.3} µm at 1 kgf by the sums, {:.2} by the law; loaded again the overlap grows with WT^{:.2}, steeper than the line drawn parallel",
        range.under(KGF)?.overlap / UM,
        first.at(1.0),
        slope.exponent
    );
    Ok(Drawn::of_theory(vec![graph.picture()], SUMS, reading))
}

fn contacts_of_range(figure: &Figure) -> Result<Drawn, Problem> {
    let contacts: Reading = |pressed| pressed.contacts;
    let law = ContactLaws::PRINTED.contacts;
    let graph = by_load(figure, "contacts Nc", "")
        .up(1.0, 2000.0)
        .dots("sums", sums(contacts)?)
        .line("Nc = 520 WT^0.5 (T7.1)", printed(law, 1e-5, 10.0));
    let at = AsperityRange::of_study()?.under(KGF)?.contacts;
    let reading = format!(
        "at 1 kgf {at:.0} contacts by the sums, {:.0} by the law, which fits lighter loads",
        law.at(1.0)
    );
    Ok(Drawn::of_theory(vec![graph.picture()], SUMS, reading))
}

fn penetration(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("pressure Pw", "kgf/cm²"), ("penetration hd", "µm"))
        .logarithmic(true, true)
        .across(0.01, 10.0)
        .up(0.05, 2.0);
    let mut told = Vec::new();
    for degrees in ANGLES {
        let range = AsperityRange { crossing: crossing(degrees)?, step: AsperityRange::of_study()?.step };
        let points = curve(by_ratio(0.01, 8.0, 60), |load| Ok(range.under(load * KGF)?.overlap / UM))?;
        graph = graph.line(format!("a range per cm², ridges at {degrees}°"), points);
        told.push(range.under(KGF)?.overlap / UM);
    }
    let measured = PowerLaw::new(0.65, 0.45);
    let graph = graph.line("measured by others: 0.65 Pw^0.45 (41-7)", printed(measured, 0.01, 10.0));
    let reading = format!(
        "at 1 kgf/cm² {:.2} and {:.2} µm, measured {:.2}: a little less at 30 degrees; the measured line is twice as steep",
        told[0],
        told[1],
        measured.at(1.0)
    );
    Ok(Drawn::of_theory(vec![graph.picture()], SUMS, reading))
}

#[cfg(test)]
mod tests {
    use super::super::reading;

    #[test]
    fn what_is_read_off_is_what_the_text_reads() {
        assert!(reading("fig-7-04").contains("18 % less"));
        assert!(reading("fig-7-05").contains("0.46 µm") && reading("fig-7-05").contains("0.51 µm"));
        assert!(reading("fig-7-06").contains("overlap by 0.817 µm"), "{}", reading("fig-7-06"));
        assert!(reading("fig-7-08").contains("0.92 by the law"), "{}", reading("fig-7-08"));
    }
}
