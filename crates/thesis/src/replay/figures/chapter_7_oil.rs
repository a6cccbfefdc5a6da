//! Chapter 7: the lubricated joint (7.3.ii).
//!
//! The ranges of ridges enclose wedges of oil. Their pressure lifts the table as velocity rises, until the ridges
//! part at VcL. Solid friction then vanishes and oil friction remains.

use super::graph::{linspace, sample_curve};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::joint::THESIS_PRESSURE;
use crate::slideway::lubricated::{
    FALL_EXPONENT, LubricatedJoint, LubricatedSliding, falling_solid_friction,
};
use crate::slideway::oil::Oil;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{CM_PER_S, MM_PER_S, POISE, UM};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
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

/// Both oils of the thesis, with their names.
const OILS: [(&str, Oil); 2] = [("oil 1", Oil::ONE), ("oil 2", Oil::TWO)];

/// Formats the name of an oil with its viscosity, in poise.
fn labelled(name: &str, oil: &Oil) -> String {
    format!("{name}, {:.2} P", oil.viscosity / POISE)
}

/// Both boundary films of the thesis, with the text that they add to a name.
const FILMS: [(&str, BoundaryFilm); 2] = [("", BoundaryFilm::NON_POLAR), (", polar", BoundaryFilm::POLAR)];

/// Returns the four lubricated joints with their names: each oil with each film.
fn joints() -> Result<Vec<(String, LubricatedJoint)>, SlidewayError> {
    let pairs = OILS.iter().flat_map(|oil| FILMS.iter().map(move |film| (oil, film)));
    pairs
        .map(|((oil, fluid), (film, molecules))| {
            LubricatedJoint::of_thesis(*fluid, *molecules, THESIS_PRESSURE)
                .map(|joint| (labelled(oil, fluid) + film, joint))
        })
        .collect()
}

/// The largest velocity of the thesis's laws, in mm/s.
const MAX_VELOCITY: f64 = 100.0;

/// The settings of the figures by velocity.
const SETTINGS: &str =
    "Pw = 0.65 kgf/cm², Ho = 4.64 µm, hd = 0.84 µm; polar additive Ko = 120, none Ko = 70 kgf/mm²";

/// Makes a graph against sliding velocity.
fn against_velocity(title: &str, up: (&str, &str)) -> Graph {
    Graph::new(title, ("sliding velocity V", "mm/s"), up)
}

/// Returns the curve of a quantity by velocity in mm/s, up to `max_velocity`. Points are denser near rest, where the
/// curve is steep.
fn by_velocity(
    joint: &LubricatedJoint,
    max_velocity: f64,
    quantity: impl Fn(&LubricatedSliding) -> f64,
) -> Result<Vec<(f64, f64)>, BoxError> {
    let velocities = linspace(0.0, 1.0, 301).map(|part| max_velocity * part * part);
    sample_curve(velocities, |velocity| joint.at_velocity(velocity * MM_PER_S).map(|at| quantity(&at)))
}

/// Adds a marker at the VcL of each oil, where the ridges part.
fn with_limit_markers(mut graph: Graph) -> Result<Graph, BoxError> {
    for (name, oil) in OILS {
        let joint = LubricatedJoint::of_thesis(oil, BoundaryFilm::NON_POLAR, THESIS_PRESSURE)?;
        let limit = joint.limit_velocity()? / MM_PER_S;
        graph = graph.marker(limit, format!("VcL {limit:.1} mm/s, {name}"));
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
    let mut separations = Vec::new();
    for (name, oil) in OILS {
        let joint = LubricatedJoint::of_thesis(oil, BoundaryFilm::NON_POLAR, THESIS_PRESSURE)?;
        graph = graph.line(labelled(name, &oil), by_velocity(&joint, MAX_VELOCITY, |at| at.lift / UM)?);
        let limit = joint.limit_velocity()?;
        separations.push((limit / MM_PER_S, joint.at_velocity(limit)?.lift / UM));
    }
    let reading = format!(
        "oil 1 parts the ridges at {:.1} mm/s, oil 2 at {:.1} mm/s, both at a lift of {:.3} µm, the penetration at \
         rest",
        separations[0].0, separations[1].0, separations[0].1
    );
    Ok(DrawnFigure::from_theory(vec![with_limit_markers(graph)?.picture()], SETTINGS, reading))
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
    Ok(DrawnFigure::from_theory(
        vec![with_limit_markers(graph)?.y_range(0.0, 0.3).picture()],
        SETTINGS,
        reading,
    ))
}

/// The power law of the thesis is fitted up to this share of VcL.
const FITTED_SHARE: f64 = 0.7;

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
        let points = |max_share: f64| linspace(0.0, max_share, 101).map(at).collect::<Result<Vec<_>, _>>();
        graph = graph.line(name, points(0.98)?);
        exponents.push(PowerLaw::fit(&points(FITTED_SHARE)?)?.exponent);
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
        let joint = LubricatedJoint::of_thesis(oil, BoundaryFilm::NON_POLAR, THESIS_PRESSURE)?;
        graph = graph.line(labelled(name, &oil), by_velocity(&joint, MAX_VELOCITY, |at| at.oil)?);
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
        let points = by_velocity(&joint, MAX_VELOCITY, LubricatedSliding::printed_total)?;
        let lower = |one: (f64, f64), other: &(f64, f64)| if other.1 < one.1 { *other } else { one };
        let least = points.iter().fold((0.0, f64::INFINITY), lower);
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
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-7-29", "43.1 mm/s");
        assert_reading_contains("fig-7-31", "2.18");
    }
}
