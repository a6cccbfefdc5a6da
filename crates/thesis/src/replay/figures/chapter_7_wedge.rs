//! Chapter 7: the wedges of oil between ranges of ridges (7.3.ii).
//!
//! Two ranges that touch enclose a free area for oil. A plain wedge replaces this area, and its factors give the
//! pressure and the drag of the film.

use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{Grid, PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{UM, UM2};
use crate::slideway::wedge::{DRAG_FACTOR, PRESSURE_FACTOR, RangeProfile, Wedge};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-26",
        place: "7.3.ii, eq 137-7 ... 139-7",
        title: "free area for oil between two ranges that just touch",
        claims: &["7-147", "7-148.a", "7-148.b", "7-198"],
        draw: free_area,
    },
    Figure {
        id: "fig-7-27",
        place: "7.3.ii, eq 136-7, 141-7",
        title: "the equivalent wedge of oil",
        claims: &["7-149", "7-150", "7-151"],
        draw: wedge,
    },
    Figure {
        id: "fig-7-28",
        place: "7.3.ii, eq 142-7, 151-7, 175-7, 176-7",
        title: "pressure factor and drag factor of the wedge",
        claims: &["7-157.a", "7-157.b", "7-189", "7-190.a", "7-190.b"],
        draw: wedge_factors,
    },
];

/// The profile of a range in the thesis.
const PROFILE: RangeProfile = RangeProfile::OF_THESIS;

/// Number of ridges that are drawn; a range has 200.
const DRAWN_RIDGES: i32 = 14;

/// Drawn length of a range, in pixels.
const LENGTH: f64 = 780.0;

/// Fig 7.26: the free area between two ranges that touch at their highest crests.
fn free_area(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 560.0);
    sketch.text("(a) along the ridges of the upper table: their crest is level", (16.0, 70.0));
    between_ranges(&mut sketch, 105.0, 1.0);
    sketch.text("(b) along those of the lower one, the same upside down", (16.0, 330.0));
    between_ranges(&mut sketch, 515.0, -1.0);
    let left = 60.0;
    sketch.span((left, 284.0), (left + LENGTH, 284.0), "");
    sketch.centred("l = 1 cm", (left + LENGTH / 2.0, 302.0));
    let reading = format!(
        "{:.0} µm² on each side over 1 cm, the same as a uniform gap of {:.2} µm; the text has 27440 and 5.48",
        PROFILE.free_area()? / UM2,
        PROFILE.touching_gap()? / UM
    );
    Ok(sketch.finish(
        "l = 1 cm, B = 50 µm, Z = 2.5 µm, 100 hT = 3 µm; 14 of 200 ridges are drawn, heights are stretched",
        reading,
    ))
}

/// Draws the gap from the middle of one range to that of the next. `level` is the height of the level crest in
/// pixels. `down` is 1 if the ridges are below it, and -1 if they are above it.
fn between_ranges(sketch: &mut Sketch, level: f64, down: f64) {
    let grid = Grid { origin: (60.0, level), scale: (LENGTH / f64::from(DRAWN_RIDGES), -26.0 * down) };
    let fall = PROFILE.fall * 100.0 / UM;
    let height = PROFILE.ridge.height / UM;
    let half = f64::from(DRAWN_RIDGES) / 2.0;
    // Distance of a crest from the level crest, in um.
    let crest = |index: f64| fall * (1.0 - (index / half - 1.0).abs());
    let mut outline: Vec<(f64, f64)> = Vec::new();
    for index in 0..=DRAWN_RIDGES {
        let at = f64::from(index);
        outline.push((at, crest(at)));
        if index < DRAWN_RIDGES {
            outline.push((at + 0.5, crest(at + 0.5) + height));
        }
    }
    let deep = fall + height + 0.7;
    let free: Vec<PixelPoint> = grid.all(outline.iter().copied());
    sketch.area(&free, Ink::Faint);
    let solid = outline.iter().copied().chain([(f64::from(DRAWN_RIDGES), deep), (0.0, deep)]);
    sketch.body(&grid.all(solid));
    let upper = [(0.0, 0.0), (f64::from(DRAWN_RIDGES), 0.0), (f64::from(DRAWN_RIDGES), -1.0), (0.0, -1.0)];
    sketch.body(&grid.all(upper));
    sketch.span(grid.at(half, 0.0), grid.at(half, fall), "100 hT");
    sketch.span(grid.at(2.0, crest(2.0)), grid.at(2.0, crest(2.0) + height), "Z");
}

/// Fig 7.27: the wedge of oil that replaces the gap, with its pressure.
fn wedge(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let gap = PROFILE.touching_gap()?;
    let mut sketch = Sketch::new(&figure.heading(), 380.0);
    let (left, right, floor) = (150.0, 730.0, 280.0);
    let (high, low) = (floor - 150.0, floor - 97.0);
    sketch.area(&[(left, floor), (right, floor), (right, low), (left, high)], Ink::Faint);
    sketch.body(&[(left, high), (right, low), (right, 90.0), (left, 90.0)]);
    sketch.body(&[(60.0, floor), (820.0, floor), (820.0, floor + 34.0), (60.0, floor + 34.0)]);
    sketch.arrow(&[(400.0, floor + 17.0), (500.0, floor + 17.0)], Ink::Voltage);
    sketch.coloured("V", (510.0, floor + 22.0), Ink::Voltage);
    sketch.span((left - 24.0, high), (left - 24.0, floor), "");
    sketch.text_before("H1", (left - 34.0, (high + floor) / 2.0 + 5.0));
    sketch.span((right + 24.0, low), (right + 24.0, floor), "H");
    sketch.span((left, floor + 56.0), (right, floor + 56.0), "");
    sketch.centred("l", ((left + right) / 2.0, floor + 76.0));
    sketch.centred_on("pressure PL = 6 η V l Kp / H²", (440.0, 230.0));
    let wedge = PROFILE.wedge(gap)?;
    let reading = format!(
        "where the ridges part, H is {:.2} µm and H1 {:.2}: m = {:.4}, Kp = {:.4}, Kf = {:.3}",
        gap / UM,
        (gap + PROFILE.depth()?) / UM,
        wedge.slope(),
        wedge.pressure_factor(),
        wedge.drag_factor()
    );
    Ok(sketch.finish("H1 = H + 100 hT, m = H1 / H - 1", reading))
}

/// The range of gaps in the thesis, from that at rest to that at 10 cm/s, in um.
const GAPS: (f64, f64) = (4.64, 9.2);

/// Fig 7.28: pressure factor and drag factor of the wedge by the height of the gap, with the printed power laws.
fn wedge_factors(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let one = |title: &str, label: &str, factor: fn(&Wedge) -> f64, law_name: &str, law: PowerLaw| {
        let exact = sample_curve(geomspace(4.0, 10.0, 61), |gap| {
            PROFILE.wedge(gap * UM).map(|wedge| factor(&wedge))
        })?;
        let dots: Vec<_> = geomspace(GAPS.0, GAPS.1, 6).map(|gap| (gap, law.at(gap))).collect();
        let graph = Graph::new(title, ("height of the gap H", "µm"), (label, ""))
            .logarithmic(true, true)
            .x_range(4.0, 10.0)
            .line("wedge", exact)
            .dots(law_name, dots);
        Ok::<_, BoxError>(graph)
    };
    let pressure =
        one(&figure.heading(), "Kp", Wedge::pressure_factor, "0.05 / H^0.478 (151-7)", PRESSURE_FACTOR)?;
    let drag = one("drag factor", "Kf", Wedge::drag_factor, "0.51 H^0.23 (176-7)", DRAG_FACTOR)?;
    let fitted = |factor: fn(&Wedge) -> f64| -> Result<PowerLaw, BoxError> {
        let points = sample_curve(linspace(GAPS.0, GAPS.1, 41), |gap| {
            PROFILE.wedge(gap * UM).map(|wedge| factor(&wedge))
        })?;
        Ok(PowerLaw::fit(&points)?)
    };
    let (kp, kf) = (fitted(Wedge::pressure_factor)?, fitted(Wedge::drag_factor)?);
    let reading = format!(
        "fitted over {} ... {} µm: Kp = {:.3} / H^{:.3}, Kf = {:.2} H^{:.2}",
        GAPS.0, GAPS.1, kp.factor, -kp.exponent, kf.factor, kf.exponent
    );
    let pictures = vec![pressure.y_range(0.015, 0.03).picture(), drag.y_range(0.5, 1.0).picture()];
    Ok(DrawnFigure::from_theory(pictures, "m = 3 µm / H", reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-26", "gap of 5.48 µm");
    }
}
