//! Chapter 7: the joint that is pulled until it slips, dry and with a film of oil (7.2, 7.2.i).

use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::joint::{Joint, THESIS_PRESSURE};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{CM2, KGF_PER_CM2, UM, UM2};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-11",
        place: "7.2, eq 47-7 ... 56-7",
        title: "the equivalent pair of ridges of a range, sheared",
        claims: &["7-069.a", "7-070", "7-077.a", "7-078.a"],
        draw: sheared_pair,
    },
    Figure {
        id: "fig-7-12",
        place: "7.2, eq 51-7, 55-7, 63-7",
        title: "friction grows as the joint is pulled",
        claims: &["7-081.a", "7-088"],
        draw: friction_while_pulled,
    },
    Figure {
        id: "fig-7-13",
        place: "7.2, eq 64-7 ... 66-7",
        title: "static friction and displacement by load",
        claims: &["7-085.a", "7-085.b", "7-086.a", "7-086.b", "7-087", "7-090.b"],
        draw: friction_by_load,
    },
    Figure {
        id: "fig-7-14",
        place: "7.2.i, eq 85-7",
        title: "static friction by the strength of the oil film",
        claims: &["7-104", "7-105", "7-169", "7-170"],
        draw: friction_by_film,
    },
];

/// Fig 7.11: the equivalent pair of ridges at rest and pulled, and its flanks as springs.
fn sheared_pair(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = Joint::PRINTED;
    let mut sketch = Sketch::new(&figure.heading(), 640.0);
    sketch.text("(a) at rest: both flanks carry half", (16.0, 72.0));
    pair(&mut sketch, (230.0, 240.0), 0.0);
    sketch.text("(b) pulled by x: the leading flank carries all", (460.0, 72.0));
    pair(&mut sketch, (660.0, 240.0), 46.0);
    sketch.text("(c) flanks as springs", (16.0, 410.0));
    springs(&mut sketch);
    let (area, leading) = (joint.area_share(THESIS_PRESSURE)?, joint.leading_share(THESIS_PRESSURE)?);
    let reading = format!(
        "under 0.65 kgf the leading area grows from half of {:.0} µm² to {:.0} µm² over a displacement of {:.1} µm, \
         and then shears",
        area * CM2 / UM2,
        leading * CM2 / UM2,
        joint.slip_displacement(THESIS_PRESSURE)? / UM
    );
    Ok(sketch.finish(
        "one pair at right angles for a square centimetre, tan θ = Z / B = 0.05 (drawn far steeper)",
        reading,
    ))
}

/// The drawn slope of a flank, as a tangent.
const DRAWN_SLOPE: f64 = 0.55;
/// Half the drawn width of a body, in pixels.
const HALF_WIDTH: f64 = 170.0;
/// The drawn depth of the notch, in pixels.
const NOTCH_DEPTH: f64 = 46.0;

/// Draws a ridge pressed into the body above it, with the centre of the notch at (x, y). `moved` is its displacement
/// to the right, in pixels.
fn pair(sketch: &mut Sketch, (x, y): PixelPoint, moved: f64) {
    let (half, sunk) = (HALF_WIDTH, NOTCH_DEPTH);
    let lower = |at: f64| y + DRAWN_SLOPE * (at - x - moved).abs();
    let upper_edge = y - 110.0;
    // The upper body, with the notch that the ridge has pressed into it.
    let notch = [
        (x - half, y + sunk),
        (x + moved - sunk / DRAWN_SLOPE, y + sunk),
        (x + moved, y),
        (x + moved + sunk / DRAWN_SLOPE, y + sunk),
        (x + half, y + sunk),
        (x + half, upper_edge),
        (x - half, upper_edge),
    ];
    sketch.body(&notch);
    let ridge = [
        (x + moved - half, lower(x + moved - half)),
        (x + moved, y),
        (x + moved + half, lower(x + moved + half)),
    ];
    sketch.body(&[ridge[0], ridge[1], ridge[2]]);
    let flank = |side: f64| [(x + moved, y), (x + moved + side * sunk / DRAWN_SLOPE, y + sunk)];
    sketch.line(&flank(1.0), Ink::Voltage);
    if moved > 0.0 {
        pulled_flank(sketch, (x, y), moved);
    } else {
        sketch.line(&flank(-1.0), Ink::Signal);
        sketch.coloured("AcT = Ac / 2", (x - 150.0, y + 14.0), Ink::Signal);
        sketch.coloured("AcL = Ac / 2", (x + 58.0, y + 14.0), Ink::Voltage);
        sketch.centred_on("θ", (x - half + 40.0, y + 84.0));
    }
    sketch.arrow(&[(x, upper_edge - 34.0), (x, upper_edge - 2.0)], Ink::Line);
    sketch.text("WT", (x + 10.0, upper_edge - 16.0));
}

/// Draws the displacement, the leading area and the force of a ridge that is pulled to the right by `moved` pixels, and
/// the material that piles up in front of it.
fn pulled_flank(sketch: &mut Sketch, (x, y): PixelPoint, moved: f64) {
    let bottom = y + NOTCH_DEPTH;
    let (foot, rise) = (x + moved + NOTCH_DEPTH / DRAWN_SLOPE, 20.0);
    let front = foot + rise / DRAWN_SLOPE;
    sketch.area(&[(foot, bottom), (front, bottom), (front, bottom + rise)], Ink::Soft);
    sketch.text("prow", (foot + 44.0, bottom + 16.0));
    sketch.span((x, y - 30.0), (x + moved, y - 30.0), "x");
    sketch.dashed((x, y - 40.0), (x, bottom));
    sketch.coloured("AcL", (x + moved + 58.0, y + 14.0), Ink::Voltage);
    sketch.arrow(&[(x + moved - 60.0, y + 116.0), (x + moved + 50.0, y + 116.0)], Ink::Line);
    sketch.text("F", (x + moved + 58.0, y + 121.0));
}

/// Draws both flanks as springs in parallel, with their equations.
fn springs(sketch: &mut Sketch) {
    let (left, right, top, bottom) = (170.0, 290.0, 470.0, 590.0);
    sketch.block((230.0, top - 14.0), (220.0, 28.0), "table");
    sketch.spring((left, top), (left, bottom), "KT = Ka / 2");
    sketch.spring((right, top), (right, bottom), "KL = Ka / 2");
    sketch.ground((130.0, bottom), (330.0, bottom));
    sketch.text("Ka = dWT / dhd = 4.94 WT^0.78 kgf/µm", (460.0, 500.0));
    sketch.text("x = 2 dW / (Ka tan θ), at slip dW = WT / 2", (460.0, 530.0));
    sketch.text("AcL = Ac / 2 + Δh Kd / 2, Kd = dAc / dhd", (460.0, 560.0));
}

/// Loads of the curves in kgf on a square centimetre. Only 0.65 survives in the text; the others are chosen.
const LOADS: [f64; 4] = [0.1, 0.3, 0.65, 1.0];

/// Returns displacement in um and friction coefficient, where the pull begins and where the joint slips. Displacement
/// and leading area are both proportional to the load that changes sides. A straight line therefore joins the two
/// points.
fn pull_line(joint: &Joint, pressure: f64) -> Result<[(f64, f64); 2], SlidewayError> {
    let first = joint.initial_friction(pressure)? + joint.ridge.climb()?;
    let slip = joint.static_friction(pressure, &BoundaryFilm::DRY)?;
    Ok([(0.0, first), (joint.slip_displacement(pressure)? / UM, slip)])
}

/// Fig 7.12: friction coefficient by displacement, for several loads.
///
/// Each line begins at mu_so + tan(theta) and ends at the slip. Claims 7-081.a and 7-088.
fn friction_while_pulled(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = Joint::PRINTED;
    let mut graph = Graph::new(&figure.heading(), ("displacement x", "µm"), ("friction coefficient", ""))
        .y_range(0.0, 0.6)
        .x_range(0.0, 5.0);
    for load in LOADS {
        let [first, slip] = pull_line(&joint, load * KGF_PER_CM2)?;
        graph = graph.line(format!("{load} kgf/cm²"), vec![first, slip]).label(1, "slips");
    }
    let [first, slip] = pull_line(&joint, THESIS_PRESSURE)?;
    let reading = format!(
        "at 0.65 kgf/cm² friction rises from {:.3} to {:.3} over {:.2} µm, where the joint slips; under more load it \
         slips at a larger displacement and a lower coefficient",
        first.1, slip.1, slip.0
    );
    Ok(DrawnFigure::from_theory(
        vec![graph.picture()],
        "dry grade 17 iron, Ss = 30.87 kgf/mm², tan θ = 0.05",
        reading,
    ))
}

/// Fig 7.13: static friction and displacement at slip by load, with the printed power laws.
fn friction_by_load(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = Joint::PRINTED;
    let loads = geomspace(0.01, 1.0, 41);
    let initial = sample_curve(loads.clone(), |load| joint.initial_friction(load * KGF_PER_CM2))?;
    let slip =
        sample_curve(loads.clone(), |load| joint.static_friction(load * KGF_PER_CM2, &BoundaryFilm::DRY))?;
    let distance = sample_curve(loads, |load| Ok(joint.slip_displacement(load * KGF_PER_CM2)? / UM))?;
    let frame = |title: &str, up: (&str, &str)| {
        Graph::new(title, ("load WT", "kgf"), up).logarithmic(true, true).x_range(0.01, 1.0)
    };
    let printed = |law: PowerLaw| [0.01, 0.03, 0.1, 0.3, 1.0].map(|load| (load, law.at(load))).to_vec();
    let friction = frame(&figure.heading(), ("friction coefficient", ""))
        .line("at slip, µsx", slip.clone())
        .line("at the first pull, µso", initial.clone())
        .dots("0.35 / WT^0.165 (65-7)", printed(PowerLaw::new(0.35, -0.165)))
        .dots("0.160 / WT^0.181 (64-7)", printed(PowerLaw::new(0.160, -0.181)))
        .y_range(0.1, 1.0);
    let displacement = frame("displacement at which it slips", ("displacement xm", "µm"))
        .line("xm", distance.clone())
        .dots("4.00 WT^0.22 (66-7)", printed(PowerLaw::new(4.0, 0.22)))
        .y_range(1.0, 10.0);
    let (initial, slip, distance) =
        (PowerLaw::fit(&initial)?, PowerLaw::fit(&slip)?, PowerLaw::fit(&distance)?);
    let reading = format!(
        "fitted over 0.01 ... 1 kgf: {:.3} / WT^{:.3}, {:.2} / WT^{:.3}, {:.2} WT^{:.2} µm",
        initial.factor, -initial.exponent, slip.factor, -slip.exponent, distance.factor, distance.exponent
    );
    let settings = "dry grade 17 iron; µso without climbing, as in eq 67-7";
    Ok(DrawnFigure::from_theory(vec![friction.picture(), displacement.picture()], settings, reading))
}

/// Fig 7.14: static friction by the strength of the oil film.
///
/// mu_s = (AcL / W) KLP + tan(theta), with KLP between the strengths of metal and film by the covered share (eq 84-7,
/// 85-7).
fn friction_by_film(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = Joint::PRINTED;
    let friction = |rupture: f64| joint.static_friction(THESIS_PRESSURE, &BoundaryFilm::of_thesis(rupture));
    let [none, plain, polar, most] = [friction(0.0)?, friction(70.0)?, friction(120.0)?, friction(131.94)?];
    let graph = Graph::new(&figure.heading(), ("film constant Ko", "kgf/mm²"), ("static friction µs", ""))
        .line("0.65 kgf/cm²", sample_curve(linspace(0.0, 150.0, 151), friction)?)
        .dots("oils of chapter 7", vec![(70.0, plain), (120.0, polar)])
        .label(0, "without polar additive")
        .label(1, "polar")
        .dots("printed ends", vec![(0.0, 0.373), (131.94, 0.0807)])
        .y_range(0.0, 0.4);
    let reading = format!(
        "static friction is {none:.3} without a film, {plain:.3} at Ko = 70, {polar:.3} at 120 and {most:.4} from Pm \
         on; the text has 0.373, 0.288, 0.13, 0.0807"
    );
    let settings = "Pw = 0.65 kgf/cm², Pm = 132, Ss = 30.87, SoL = 2.9 kgf/mm²";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-12", "0.374 over 3.68 µm");
        assert_reading_contains("fig-7-13", "0.161 / WT^0.180");
        assert_reading_contains("fig-7-14", "0.0804 from Pm on");
    }
}
