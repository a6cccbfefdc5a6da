//! Chapter 7: the lubricated joint (7.3.ii).
//!
//! The ranges of ridges enclose wedges of oil. Their pressure lifts the table as velocity rises, until the ridges
//! part at VcL. Solid friction then vanishes and oil friction remains.

use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{Grid, PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::joint::STUDY_PRESSURE;
use crate::slideway::lubricated::{
    FALL_EXPONENT, LubricatedJoint, LubricatedSliding, falling_solid_friction,
};
use crate::slideway::oil::Oil;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{CM_PER_S, MM_PER_S, POISE, UM, UM2};
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
    Figure {
        id: "fig-7-29",
        place: "7.3.ii, eq 160-7",
        title: "lift of the table by velocity",
        claims: &["7-164.a", "7-164.b", "7-171", "7-172"],
        draw: lift,
    },
    Figure {
        id: "fig-7-30",
        place: "7.3.ii, eq 163-7 ... 167-7",
        title: "solid friction by velocity",
        claims: &["7-167", "7-168", "7-169", "7-170"],
        draw: solid_friction,
    },
    Figure {
        id: "fig-7-31",
        place: "7.3.ii, eq 168-7 ... 170-7",
        title: "solid friction by the difference between VcL and velocity",
        claims: &[],
        draw: solid_friction_law,
    },
    Figure {
        id: "fig-7-32",
        place: "7.3.ii, eq 172-7 ... 178-7",
        title: "oil friction by velocity",
        claims: &["7-203.a", "7-203.b"],
        draw: oil_friction,
    },
    Figure {
        id: "fig-7-33",
        place: "7.3.ii, eq 179-7",
        title: "friction of the lubricated joint",
        claims: &["7-193", "7-195.c", "7-195.d", "7-197.a", "7-197.b"],
        draw: whole_friction,
    },
];

/// The profile of a range in the study.
const PROFILE: RangeProfile = RangeProfile::OF_STUDY;

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

/// The range of gaps in the study, from that at rest to that at 10 cm/s, in um.
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

/// Both oils of the study, with their names.
const OILS: [(&str, Oil); 2] = [("oil 1", Oil::ONE), ("oil 2", Oil::TWO)];

/// Formats the name of an oil with its viscosity, in poise.
fn labelled(name: &str, oil: &Oil) -> String {
    format!("{name}, {:.2} P", oil.viscosity / POISE)
}

/// Both boundary films of the study, with the text that they add to a name.
const FILMS: [(&str, BoundaryFilm); 2] = [("", BoundaryFilm::NON_POLAR), (", polar", BoundaryFilm::POLAR)];

/// Returns the four lubricated joints with their names: each oil with each film.
fn joints() -> Result<Vec<(String, LubricatedJoint)>, SlidewayError> {
    let pairs = OILS.iter().flat_map(|oil| FILMS.iter().map(move |film| (oil, film)));
    pairs
        .map(|((oil, fluid), (film, molecules))| {
            LubricatedJoint::of_study(*fluid, *molecules, STUDY_PRESSURE)
                .map(|joint| (labelled(oil, fluid) + film, joint))
        })
        .collect()
}

/// The largest velocity of the study's laws, in mm/s.
const FASTEST: f64 = 100.0;

/// The settings of the figures by velocity.
const SETTINGS: &str =
    "Pw = 0.65 kgf/cm², Ho = 4.64 µm, hd = 0.84 µm; polar additive Ko = 120, none Ko = 70 kgf/mm²";

/// Makes a graph against sliding velocity.
fn against_velocity(title: &str, up: (&str, &str)) -> Graph {
    Graph::new(title, ("sliding velocity V", "mm/s"), up)
}

/// Returns the curve of a quantity by velocity in mm/s, up to `most`. Points are denser near rest, where the curve is
/// steep.
fn by_velocity(
    joint: &LubricatedJoint,
    most: f64,
    quantity: impl Fn(&LubricatedSliding) -> f64,
) -> Result<Vec<(f64, f64)>, BoxError> {
    let velocities = linspace(0.0, 1.0, 301).map(|part| most * part * part);
    sample_curve(velocities, |velocity| joint.at_velocity(velocity * MM_PER_S).map(|at| quantity(&at)))
}

/// Adds a marker at the VcL of each oil, where the ridges part.
fn marked(mut graph: Graph) -> Result<Graph, BoxError> {
    for (name, oil) in OILS {
        let joint = LubricatedJoint::of_study(oil, BoundaryFilm::NON_POLAR, STUDY_PRESSURE)?;
        let limit = joint.limit_velocity()? / MM_PER_S;
        graph = graph.mark(limit, format!("VcL {limit:.1} mm/s, {name}"));
    }
    Ok(graph)
}

/// Fig 7.29: the lift of the table by velocity, for both oils.
///
/// Below VcL the ridges and the film share the load (eq 160-7). Above it the film carries all of it, and the lift grows
/// faster.
fn lift(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = against_velocity(&figure.heading(), ("lift hs", "µm"))
        .note("the measurements by others are lost with the figure");
    let mut parting = Vec::new();
    for (name, oil) in OILS {
        let joint = LubricatedJoint::of_study(oil, BoundaryFilm::NON_POLAR, STUDY_PRESSURE)?;
        graph = graph.line(labelled(name, &oil), by_velocity(&joint, FASTEST, |at| at.lift / UM)?);
        let limit = joint.limit_velocity()?;
        parting.push((limit / MM_PER_S, joint.at_velocity(limit)?.lift / UM));
    }
    let reading = format!(
        "oil 1 parts the ridges at {:.1} mm/s, oil 2 at {:.1} mm/s, both at a lift of {:.3} µm, the penetration at \
         rest",
        parting[0].0, parting[1].0, parting[0].1
    );
    Ok(DrawnFigure::from_theory(vec![marked(graph)?.picture()], SETTINGS, reading))
}

/// Fig 7.30: solid friction by velocity, for both oils with and without polar additive.
///
/// mu_k = (AcL KLP + load tan(theta)) / weight for the load on the ridges (eq 163-7).
fn solid_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = against_velocity(&figure.heading(), ("solid friction coefficient µk", ""));
    let mut static_frictions = Vec::new();
    for (name, joint) in joints()? {
        graph = graph.line(name, by_velocity(&joint, 60.0, |at| at.solid)?);
        static_frictions.push(joint.static_friction()?);
    }
    let reading = format!(
        "solid friction falls from {:.3} without and {:.3} with polar additive (the text: 0.288 and 0.13) to 0 at \
         VcL; the additive does not change VcL",
        static_frictions[0], static_frictions[1]
    );
    Ok(DrawnFigure::from_theory(vec![marked(graph)?.y_range(0.0, 0.3).picture()], SETTINGS, reading))
}

/// The power law of the study is fitted up to this share of VcL.
const FITTED: f64 = 0.7;

/// Fig 7.31: solid friction against VcL - V on logarithmic axes, with the printed law.
fn solid_friction_law(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("VcL - V", "mm/s"), ("solid friction coefficient µk", ""))
        .logarithmic(true, true)
        .x_range(3.0, 50.0)
        .y_range(1e-3, 1.0);
    let mut exponents = Vec::new();
    let mut dots = Vec::new();
    for (name, joint) in joints()? {
        let limit = joint.limit_velocity()?;
        let at = |part: f64| -> Result<(f64, f64), SlidewayError> {
            let velocity = part * limit;
            Ok(((limit - velocity) / MM_PER_S, joint.at_velocity(velocity)?.solid))
        };
        let points = |most: f64| linspace(0.0, most, 101).map(at).collect::<Result<Vec<_>, _>>();
        graph = graph.line(name, points(0.98)?);
        exponents.push(PowerLaw::fit(&points(FITTED)?)?.exponent);
        for part in [0.0, 0.2, 0.4, 0.6, 0.8] {
            let law = falling_solid_friction(joint.static_friction()?, limit, part * limit)?;
            dots.push(((1.0 - part) * limit / MM_PER_S, law));
        }
    }
    let graph = graph.dots(format!("µs (1 - V / VcL)^{FALL_EXPONENT} (170-7)"), dots);
    let texts: Vec<_> = exponents.iter().map(|exponent| format!("{exponent:.2}")).collect();
    let reading = format!(
        "the exponents up to 0.7 VcL are {}; the text draws one line with 2.18; nearer to VcL the curves fall more \
         steeply",
        texts.join(", ")
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.32: oil friction by velocity, and its straight part extended to rest.
///
/// mu_0 is drag by the load that the oil carries (eq 172-7). The line joins its values at VcL and at 100 mm/s (claim
/// 7-195).
fn oil_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = against_velocity(&figure.heading(), ("oil friction coefficient µ0", ""));
    let mut texts = Vec::new();
    for (name, oil) in OILS {
        let joint = LubricatedJoint::of_study(oil, BoundaryFilm::NON_POLAR, STUDY_PRESSURE)?;
        graph = graph.line(labelled(name, &oil), by_velocity(&joint, FASTEST, |at| at.oil)?);
        let (slow, fast) = (joint.limit_velocity()?, 10.0 * CM_PER_S);
        let (near, far) = (joint.at_velocity(slow)?.oil, joint.at_velocity(fast)?.oil);
        let offset = near - (far - near) / (fast - slow) * slow;
        let straight = vec![(0.0, offset), (fast / MM_PER_S, far)];
        graph = graph.line(format!("straight line above VcL, {name}"), straight);
        texts.push(format!("{offset:.4}"));
    }
    let reading = format!(
        "extended to rest, the straight parts have the intercepts {}; the more viscous oil has the larger one, as \
         the text says",
        texts.join(" and ")
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.33: solid and oil friction together by velocity.
///
/// The curves are mu_k + mu_0 as the text adds them (eq 179-7), which is slightly too large below VcL (claim 7-193).
fn whole_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = against_velocity(&figure.heading(), ("friction coefficient µT", ""));
    let mut texts = Vec::new();
    for (name, joint) in joints()? {
        let points = by_velocity(&joint, FASTEST, LubricatedSliding::printed_total)?;
        let of_two = |one: (f64, f64), other: &(f64, f64)| if other.1 < one.1 { *other } else { one };
        let least = points.iter().fold((0.0, f64::INFINITY), of_two);
        texts.push(format!("{:.4} at {:.0} mm/s", least.1, least.0));
        graph = graph.line(name, points);
    }
    let reading = format!(
        "the minimum of friction is {}, in the order of the curves; a polar additive lowers friction below VcL only",
        texts.join(", ")
    );
    Ok(DrawnFigure::from_theory(vec![graph.y_range(0.0, 0.3).picture()], SETTINGS, reading))
}

#[cfg(test)]
mod tests {
    use super::super::reading;

    #[test]
    fn readings_agree_with_the_text() {
        assert!(reading("fig-7-26").contains("gap of 5.48 µm"), "{}", reading("fig-7-26"));
        assert!(reading("fig-7-29").contains("43.1 mm/s"), "{}", reading("fig-7-29"));
        assert!(reading("fig-7-31").contains("2.18"), "{}", reading("fig-7-31"));
    }
}
