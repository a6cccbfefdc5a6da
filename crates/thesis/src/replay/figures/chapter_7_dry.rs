//! Chapter 7: dry iron that slides, by velocity and by load (7.3.i).
//!
//! Faster sliding deforms the asperities at a higher frequency, and the metal stiffens with that frequency. The
//! figures follow from one model of the joint.

use super::graph::{linspace, sample_curve};
use super::sketch::Sketch;
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::dry_friction::{DryFriction, DrySliding};
use crate::slideway::joint::{Joint, THESIS_PRESSURE};
use crate::slideway::units::{CM, CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, UM};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-15",
        place: "7.3.i, eq 99-7, 102-7",
        title: "asperities as a spring and a damper",
        claims: &["7-112.a", "7-113.a", "7-115.a"],
        draw: voigt_model,
    },
    Figure {
        id: "fig-7-18",
        place: "7.3.i, eq 120-7 ... 122-7",
        title: "frequency of deformation by velocity",
        claims: &["7-139.a"],
        draw: frequency,
    },
    Figure {
        id: "fig-7-19",
        place: "7.3.i, eq 95-7, 116-7",
        title: "dry friction and penetration by velocity",
        claims: &["7-121", "7-122.a", "7-131.a", "7-145.a", "7-145.b"],
        draw: friction,
    },
    Figure {
        id: "fig-7-20",
        place: "7.3.i, eq 98-7, 123-7",
        title: "normal stiffness and rise of the table by velocity",
        claims: &["7-113.a"],
        draw: stiffness_and_rise,
    },
    Figure {
        id: "fig-7-21",
        place: "7.3.i, eq 101-7, 102-7",
        title: "normal damping and viscosity of the asperities by velocity",
        claims: &["7-114"],
        draw: damping_and_viscosity,
    },
    Figure {
        id: "fig-7-25",
        place: "7.3.i, eq 130-7 ... 133-7",
        title: "dry friction under several loads",
        claims: &["7-140.d", "7-143", "7-144"],
        draw: friction_by_load,
    },
];

/// The settings of all figures of this file, except that by load.
pub(super) const SETTINGS: &str =
    "Pw = 0.65 kgf/cm², alpha up to 2.9, Um = 800 kgf s/mm² (T = 0.0318 s), dry grade 17 iron";

/// A quantity of a sliding joint, in the units of the thesis.
pub(super) type JointQuantity = fn(&DrySliding) -> f64;

/// Friction coefficient.
const FRICTION: JointQuantity = |at| at.friction;

/// Penetration, in um.
const PENETRATION: JointQuantity = |at| at.penetration / UM;

/// Normal stiffness of a square centimetre, in kgf/cm.
pub(super) const STIFFNESS: JointQuantity = |at| at.stiffness * CM2 * CM / KGF;

/// Normal damping of a square centimetre, in kgf s/cm; NaN at rest, where it is not defined.
pub(super) const DAMPING: JointQuantity =
    |at| at.damping.map_or(f64::NAN, |damping| damping * CM2 * CM / KGF);

/// Viscosity of the asperities, in kgf s/cm2; NaN at rest, where it is not defined.
const VISCOSITY: JointQuantity =
    |at| at.asperity_viscosity().map_or(f64::NAN, |viscosity| viscosity / KGF_PER_CM2);

/// The dry joint of the thesis with the printed contact laws.
pub(super) fn dry() -> DryFriction {
    DryFriction::of_thesis(Joint::PRINTED, THESIS_PRESSURE)
}

/// The largest velocity that is plotted, in mm/s.
const MAX_VELOCITY: f64 = 20.0;

/// Returns the curve of a quantity by velocity in mm/s.
fn by_velocity(joint: &DryFriction, quantity: JointQuantity) -> Result<Vec<(f64, f64)>, BoxError> {
    sample_curve(linspace(0.0, MAX_VELOCITY, 201), |velocity| {
        joint.at_velocity(velocity * MM_PER_S).map(|at| quantity(&at))
    })
}

/// Makes a graph against sliding velocity.
fn against_velocity(figure: &Figure, up: (&str, &str)) -> Graph {
    Graph::new(&figure.heading(), ("sliding velocity V", "mm/s"), up)
}

/// Fig 7.15: the asperities as a spring and a damper in parallel, with their laws.
fn voigt_model(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 430.0);
    let (top, bottom) = (150.0, 340.0);
    sketch.block((300.0, top - 25.0), (380.0, 50.0), "table");
    sketch.arrow(&[(300.0, 62.0), (300.0, top - 52.0)], Ink::Voltage);
    sketch.text("Pw", (312.0, 80.0));
    sketch.arrow(&[(500.0, top - 25.0), (590.0, top - 25.0)], Ink::Signal);
    sketch.text("V", (598.0, top - 20.0));
    sketch.spring((220.0, top), (220.0, bottom), "KE");
    sketch.damper((380.0, top), (380.0, bottom), "CE");
    sketch.ground((110.0, bottom), (490.0, bottom));
    sketch.span((540.0, top), (540.0, bottom), "hd");
    for (index, line) in [
        "Pw = KE hd + CE hd'",
        "KE = 1.46 hd^3.55 · 10⁴ kgf/cm",
        "CE = UA · 1.32 hd^2.7 kgf s/cm",
        "hd' = 2 tan θ · V",
    ]
    .into_iter()
    .enumerate()
    {
        sketch.text(line, (630.0, 200.0 + 32.0 * index as f64));
    }
    let at_rest = dry().at_frequency(0.0)?;
    let reading = format!(
        "at rest hd is {:.3} µm and KE {:.0} kgf/cm on a square centimetre; CE does not act at rest; it acts as soon \
         as the table slides",
        PENETRATION(&at_rest),
        STIFFNESS(&at_rest)
    );
    Ok(sketch.finish(SETTINGS, reading))
}

/// Fig 7.18: the frequency of deformation by velocity.
fn frequency(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let points = linspace(0.0, 375.0, 201)
        .map(|frequency| joint.at_frequency(frequency).map(|at| (at.velocity / MM_PER_S, frequency)));
    let points = points.collect::<Result<Vec<_>, _>>()?;
    let graph = against_velocity(figure, ("frequency of deformation ω", "rad/s"))
        .x_range(0.0, MAX_VELOCITY)
        .line("ω", points);
    let length = |frequency: f64| Ok::<_, BoxError>(joint.at_frequency(frequency)?.velocity / frequency / UM);
    let reading = format!(
        "ω = V / L; the length L of the leading area shrinks from {:.1} to {:.1} µm",
        length(1e-3)?,
        length(1e6)?
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.19: friction coefficient and penetration by velocity.
///
/// mu_k = AcLV Ss / W + tan(theta) (eq 116-7). VcL by eq 132-7 is above the 11 mm/s at which the curve looks flat
/// (claim 7-131.a).
fn friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let graph = against_velocity(figure, ("friction coefficient µk", ""))
        .right_axis(("penetration hdv", "µm"))
        .line("µk", by_velocity(&joint, FRICTION)?)
        .right_line("hdv", by_velocity(&joint, PENETRATION)?)
        .y_range(0.0, 0.4)
        .right_range(0.0, 1.0)
        .marker(11.0, "VcL as read, 11 mm/s")
        .note("the measurements by others are lost with the figure");
    let (rest, flat) = (joint.at_velocity(0.0)?, joint.at_velocity(11.0 * MM_PER_S)?);
    let reading = format!(
        "friction falls from {:.3} to {:.3} at 11 mm/s, above which the text calls it flat; by eq 132-7 VcL is {:.1} \
         mm/s",
        rest.friction,
        flat.friction,
        joint.limit_velocity()? / MM_PER_S
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.20: normal stiffness and rise of the table by velocity.
///
/// The rise is the penetration at rest minus that at a velocity (eq 123-7). The table rises as the asperities stiffen.
fn stiffness_and_rise(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let at_rest = PENETRATION(&joint.at_velocity(0.0)?);
    let rise = by_velocity(&joint, PENETRATION)?.into_iter().map(|(x, depth)| (x, at_rest - depth)).collect();
    let graph = against_velocity(figure, ("normal stiffness KE of 1 cm²", "kgf/cm"))
        .right_axis(("rise of the table hs", "µm"))
        .line("KE", by_velocity(&joint, STIFFNESS)?)
        .right_line("hs", rise)
        .y_range(0.0, 8000.0)
        .right_range(0.0, 0.2);
    let fast = joint.at_velocity(MAX_VELOCITY * MM_PER_S)?;
    let reading = format!(
        "from rest to {MAX_VELOCITY} mm/s the stiffness falls from {:.0} to {:.0} kgf/cm, and the table rises by \
         {:.3} µm",
        STIFFNESS(&joint.at_velocity(0.0)?),
        STIFFNESS(&fast),
        at_rest - PENETRATION(&fast)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.21: normal damping and viscosity of the asperities by velocity.
fn damping_and_viscosity(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let damping = by_velocity(&joint, DAMPING)?;
    let viscosity = by_velocity(&joint, VISCOSITY)?;
    let (at, most) = highest(&viscosity);
    let reading = format!(
        "damping has its maximum of {:.1} kgf s/cm at {:.2} mm/s, viscosity {most:.1} kgf s/cm² at {at:.2} mm/s; \
         both fall with velocity above that",
        highest(&damping).1,
        highest(&damping).0
    );
    let graph = against_velocity(figure, ("normal damping CE of 1 cm²", "kgf s/cm"))
        .right_axis(("viscosity of the asperities UA", "kgf s/cm²"))
        .line("CE", damping)
        .right_line("UA", viscosity);
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Returns the highest point of a curve. NaN is ignored.
pub(super) fn highest(points: &[(f64, f64)]) -> (f64, f64) {
    let of_two = |one: (f64, f64), other: &(f64, f64)| if other.1 > one.1 { *other } else { one };
    points.iter().fold((0.0, 0.0), of_two)
}

/// Loads of the curves in kgf/cm2. Only 0.65 survives in the text; the others are chosen.
const LOADS: [f64; 4] = [0.2, 0.65, 2.0, 5.0];

/// Pressure on the leading area above VcL, equal to the hardness of the metal (eq 114-7), in kgf/mm2.
const LEADING_PRESSURE: f64 = 220.0;

/// Fig 7.25: friction coefficient by velocity under several loads.
///
/// Each load has its own alpha, from eq 128-7 for 220 kgf/mm2. Friction at VcL depends on the load far less than static
/// friction (claim 7-144).
fn friction_by_load(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph =
        against_velocity(figure, ("friction coefficient µk", "")).x_range(0.0, 10.0).y_range(0.1, 0.5);
    let mut ends = Vec::new();
    for load in LOADS {
        let pressure = load * KGF_PER_CM2;
        let stiffening =
            DryFriction::stiffening_at(&Joint::PRINTED, pressure, LEADING_PRESSURE * KGF_PER_MM2)?;
        let joint = DryFriction { stiffening, ..DryFriction::of_thesis(Joint::PRINTED, pressure) };
        graph = graph.line(format!("{load} kgf/cm²"), by_velocity(&joint, FRICTION)?);
        ends.push((joint.at_velocity(0.0)?.friction, joint.at_velocity(10.0 * MM_PER_S)?.friction));
    }
    let reading = format!(
        "from {} to {} kgf/cm² static friction falls from {:.3} to {:.3}, and friction at 10 mm/s changes only from \
         {:.3} to {:.3}",
        LOADS[0], LOADS[3], ends[0].0, ends[3].0, ends[0].1, ends[3].1
    );
    let settings =
        "alpha at VcL such that the leading area bears 220 kgf/mm², Um = 800 kgf s/mm², dry grade 17 iron";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-15", "0.837 µm");
        assert_reading_contains("fig-7-19", "0.374 to 0.186 at 11 mm/s");
    }
}
