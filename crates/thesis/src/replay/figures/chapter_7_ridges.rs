//! Chapter 7: single ridges, and the section of a range of ridges (7.2).
//!
//! Two crossed ridges touch as Hertz contacts until the metal flows. A range is a set of ridges whose crests fall on
//! both sides of its middle.

use std::f64::consts::FRAC_PI_2;

use super::graph::{linspace, sample_curve};
use super::sketch::{Grid, PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::asperities::AsperityRange;
use crate::slideway::crossing::Crossing;
use crate::slideway::joint::THESIS_PRESSURE;
use crate::slideway::material::Material;
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
];

/// The two cross angles of the thesis, in degrees.
pub(super) const ANGLES: [f64; 2] = [90.0, 30.0];

/// Two ground ridges of grade 17 iron that cross at an angle in degrees.
pub(super) fn crossing(degrees: f64) -> Result<Crossing, SlidewayError> {
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
    let reduction = 1.0 - oblique.overlap(KGF)? / square.overlap(KGF)?;
    let (major, minor) = oblique.semi_axes(KGF)?;
    let reading = format!(
        "at 30 degrees the overlap is {:.0} % less than at 90 degrees, and the contact is {:.1} times as long as wide",
        100.0 * reduction,
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
    let (mut yield_points, mut texts) = (Vec::new(), Vec::new());
    for degrees in ANGLES {
        let pair = crossing(degrees)?;
        let points = sample_curve(linspace(0.0, 1.0, 101).map(|part| 0.02 * part.powi(3)), |load| {
            Ok(pair.overlap(load * KGF)? / UM)
        })?;
        graph = graph.line(format!("ridges cross at {degrees}°"), points);
        let (load, overlap) = (pair.yield_load() / KGF, pair.yield_overlap() / UM);
        yield_points.push((load, overlap));
        texts.push(format!("{overlap:.2} µm and {load:.4} kgf at {degrees} degrees"));
    }
    let graph = graph
        .dots("peak pressure 132 kgf/mm²: metal flows", yield_points)
        .note("the curves are elastic throughout; the points of 0.1 % proof stress are lost with the figure");
    Ok(DrawnFigure::from_theory(
        vec![graph.picture()],
        RIDGES,
        format!("the metal flows at {}", texts.join(", ")),
    ))
}

/// Fig 7.6: the section of a range, and the contacts of two ranges under 0.65 kgf.
fn range_of_ridges(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let range = AsperityRange::of_thesis()?;
    let pressed = range.under(THESIS_PRESSURE * CM2)?;
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
const WIDTH_FACTOR: f64 = 2.5;

/// Draws (b): the contacts of two ranges at an overlap in m, seen from above.
fn contacts(sketch: &mut Sketch, range: &AsperityRange, overlap: f64) -> Result<(), BoxError> {
    let yield_overlap = range.crossing.yield_overlap();
    let ridge = Ridge::GROUND;
    let grid = Grid { origin: (450.0, 545.0), scale: (0.33 / UM, 0.33 / UM) };
    let most = (overlap / range.step) as i32;
    let pairs = (-most..=most).flat_map(|row| (-most..=most).map(move |column| (row, column)));
    for (row, column) in pairs {
        let pair_overlap = overlap - f64::from(row.abs() + column.abs()) * range.step;
        if pair_overlap <= 0.0 {
            continue;
        }
        // A diagonal of the square is horizontal. Half its area is the square of its half diagonal.
        let half = WIDTH_FACTOR * (ridge.overlap_area(pair_overlap, FRAC_PI_2)? / 2.0).sqrt();
        let (x, y) = (f64::from(column) * ridge.width, f64::from(row) * ridge.width);
        let corners = [(half, 0.0), (0.0, half), (-half, 0.0), (0.0, -half)];
        let ink = if pair_overlap > yield_overlap { Ink::Voltage } else { Ink::Signal };
        sketch.area(&grid.all(corners.map(|(right, up)| (x + right, y + up))), ink);
    }
    let [from, to] =
        [grid.at(9.0 * ridge.width, 12.0 * ridge.width), grid.at(13.0 * ridge.width, 12.0 * ridge.width)];
    sketch.span(from, to, "200 µm");
    sketch.text(
        &format!("(b) contacts under 0.65 kgf, drawn {WIDTH_FACTOR} times as wide as they are"),
        (16.0, 320.0),
    );
    sketch.coloured("elastic", (16.0, 346.0), Ink::Signal);
    sketch.coloured("flowing: overlap above 0.46 µm", (16.0, 368.0), Ink::Voltage);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-04", "18 % less");
        assert_reading_contains("fig-7-05", "0.46 µm");
        assert_reading_contains("fig-7-05", "0.51 µm");
        assert_reading_contains("fig-7-06", "overlap by 0.817 µm");
    }
}
