//! Chapter 7: the stiffening of dry iron by the frequency of deformation (7.3.i).
//!
//! alpha is the complex modulus of the metal, relative to that at rest. The joint is that of
//! [`chapter_7_dry`](super::chapter_7_dry).

use super::chapter_7_dry::{DAMPING, JointQuantity, SETTINGS, STIFFNESS, dry, highest};
use super::graph::{geomspace, linspace, sample_curve};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{CM2, UM2};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-7-16",
        place: "7.3.i, eq 117-7 ... 119-7",
        title: "how much the metal stiffens",
        claims: &["7-125", "7-126", "7-128"],
        draw: stiffening,
    },
    Figure {
        id: "fig-7-17",
        place: "7.3.i, eq 92-7",
        title: "leading area by frequency of deformation",
        claims: &["7-078.a", "7-120"],
        draw: leading_area,
    },
    Figure {
        id: "fig-7-22",
        place: "7.3.i",
        title: "stiffness and the real part of alpha",
        claims: &[],
        draw: stiffness_and_alpha,
    },
    Figure {
        id: "fig-7-23",
        place: "7.3.i",
        title: "damping and the imaginary part of alpha",
        claims: &["7-133.a", "7-133.b"],
        draw: damping_and_alpha,
    },
    Figure {
        id: "fig-7-24",
        place: "7.3.i, eq 125-7",
        title: "dry friction by stiffening",
        claims: &["7-137", "7-138"],
        draw: friction_by_stiffening,
    },
];

/// The plotted frequencies, in rad/s.
fn frequencies() -> impl Iterator<Item = f64> + Clone {
    geomspace(1.0, 1000.0, 121)
}

/// Returns the curve of a quantity by frequency in rad/s.
fn by_frequency(quantity: JointQuantity) -> Result<Vec<(f64, f64)>, BoxError> {
    let joint = dry();
    sample_curve(frequencies(), |frequency| joint.at_frequency(frequency).map(|at| quantity(&at)))
}

/// Makes a graph against frequency, with a marker at the corner frequency 1 / T.
fn against_frequency(figure: &Figure, up: (&str, &str)) -> Result<Graph, SlidewayError> {
    let corner = 1.0 / dry().time_constant()?;
    Ok(Graph::new(&figure.heading(), ("frequency of deformation ω", "rad/s"), up)
        .logarithmic(true, false)
        .marker(corner, format!("1 / T = {corner:.1} rad/s")))
}

/// Fig 7.16: the modulus of the metal by frequency, relative to that at rest.
///
/// alpha = sqrt((1 + (2.9 T w)^2) / (1 + (T w)^2)) (eq 119-7).
fn stiffening(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let graph = against_frequency(figure, ("alpha, modulus by that at rest", ""))?
        .line("alpha", by_frequency(|at| at.stiffening)?)
        .y_range(0.0, 3.0);
    let corner = dry().at_frequency(1.0 / dry().time_constant()?)?;
    let reading = format!("alpha rises from 1 to 2.9; at 1 / T it is {:.2}", corner.stiffening);
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.17: the leading area of contact by frequency.
///
/// AcLV = AcL / alpha^0.82 (eq 92-7). The text also computes it from a pressure of 220 kgf/mm2 (claim 7-120).
fn leading_area(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let area: JointQuantity = |at| at.leading_share * CM2 / UM2;
    let graph = against_frequency(figure, ("leading area AcLV of 1 cm²", "µm²"))?
        .line("AcLV", by_frequency(area)?)
        .y_range(0.0, 8000.0);
    let (slow, fast) = (dry().at_frequency(0.0)?, dry().at_frequency(1e6)?);
    let reading = format!(
        "the area shrinks from {:.0} µm² at rest to {:.0} µm²; eq 114-7, with 220 kgf/mm² on it, gives 2950",
        area(&slow),
        area(&fast)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.22: normal stiffness, and the reciprocal of the real part of alpha, by frequency.
fn stiffness_and_alpha(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let inverse = sample_curve(frequencies(), |frequency| Ok(1.0 / joint.response(frequency)?.0))?;
    let graph = against_frequency(figure, ("normal stiffness KE of 1 cm²", "kgf/cm"))?
        .right_axis(("1 / real part of alpha", ""))
        .line("KE", by_frequency(STIFFNESS)?)
        .right_line("1 / α'", inverse)
        .y_range(0.0, 8000.0)
        .right_range(0.0, 1.0);
    let (slow, fast) = (joint.at_frequency(0.0)?, joint.at_frequency(1e6)?);
    let reading = format!(
        "the stiffness falls to {:.3} of its value at rest, 1 / α' to {:.3}",
        fast.stiffness / slow.stiffness,
        1.0 / joint.response(1e6)?.0
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.23: normal damping and the imaginary part of alpha, by frequency.
fn damping_and_alpha(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let damping = by_frequency(DAMPING)?;
    let imaginary = sample_curve(frequencies(), |frequency| Ok(joint.response(frequency)?.1))?;
    let reading = format!(
        "α'' is largest at {:.1} rad/s, CE at {:.1}, which is (1 / T)^{:.2}",
        highest(&imaginary).0,
        highest(&damping).0,
        highest(&damping).0.ln() / (1.0 / joint.time_constant()?).ln()
    );
    let graph = against_frequency(figure, ("normal damping CE of 1 cm²", "kgf s/cm"))?
        .right_axis(("imaginary part of alpha", ""))
        .line("CE", damping)
        .right_line("α''", imaginary);
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Fig 7.24: friction coefficient against 1 / alpha, with the printed power law.
fn friction_by_stiffening(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let joint = dry();
    let points = geomspace(0.1, 3000.0, 121)
        .map(|frequency| joint.at_frequency(frequency).map(|at| (1.0 / at.stiffening, at.friction)))
        .collect::<Result<Vec<_>, _>>()?;
    let at_rest = joint.at_frequency(0.0)?.friction;
    let printed = PowerLaw::new(at_rest, 0.67);
    let dots = linspace(0.35, 1.0, 8).map(|inverse| (inverse, printed.at(inverse))).collect();
    let fitted = PowerLaw::fit(&points)?;
    let graph = Graph::new(&figure.heading(), ("1 / alpha", ""), ("friction coefficient µk", ""))
        .logarithmic(true, true)
        .x_range(0.3, 1.0)
        .y_range(0.1, 0.5)
        .line("model", points)
        .dots("µs alpha^-0.67 (125-7)", dots);
    let reading =
        format!("friction is proportional to alpha^-{:.2}; the text has the exponent -0.67", fitted.exponent);
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-24", "alpha^-0.66;");
    }
}
