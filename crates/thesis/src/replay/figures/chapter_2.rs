//! Chapter 2: results of earlier authors.

use super::graph::{geomspace, sample_curve};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::history::GrowthAtRest;
use crate::slideway::units::{MM_PER_S, UM};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[Figure {
    id: "fig-2-02",
    place: "2.3",
    title: "size of stick-slip by sliding velocity",
    claims: &["2-009"],
    draw: stick_slip,
}];

/// An example of static friction that grows with the time at rest. The curves of the cited paper are lost, so its
/// numbers are chosen.
const EXAMPLE: GrowthAtRest = GrowthAtRest { kinetic: 0.2, factor: 0.05, exponent: 0.3 };
/// Weight of the example, in N; chosen.
const WEIGHT: f64 = 10.0;
/// The slip distance at which stick-slip ends, in m; chosen.
const CRITICAL_DISTANCE: f64 = 10.0 * UM;

/// Stiffnesses of the drive in the example, in N/mm.
const DRIVES: [f64; 3] = [10.0, 20.0, 50.0];

/// Fig 2.2: the length of a slip against the sliding velocity, for three drives, by the theory of static friction
/// that grows at rest.
///
/// A slip is x = (2 W gamma / (K V^beta))^(1 / (1 - beta)) (eq 20.2). Each curve ends at the velocity at which x equals
/// the critical distance.
fn stick_slip(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("sliding velocity", "mm/s"), ("length of a slip", "µm"))
        .logarithmic(true, true)
        .x_range(1e-3, 100.0)
        .y_range(5.0, 1000.0);
    let (mut ends, mut texts) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let stiffness = drive * 1e3;
        let end = EXAMPLE.end_of_stick_slip(WEIGHT, stiffness, CRITICAL_DISTANCE)? / MM_PER_S;
        let slip = |velocity: f64| Ok(EXAMPLE.slip(WEIGHT, stiffness, velocity * MM_PER_S)? / UM);
        graph = graph.line(format!("{drive} N/mm"), sample_curve(geomspace(1e-3, end, 41), slip)?);
        ends.push((end, CRITICAL_DISTANCE / UM));
        texts.push(format!("{end:.2}"));
    }
    let graph = graph.dots("ends at the critical distance", ends);
    let reading = format!(
        "with 10, 20 and 50 N/mm stick-slip ends at {} mm/s: with a stiffer drive slips are shorter and end at a \
         lower velocity, as the text says",
        texts.join(", ")
    );
    let settings = "an example: µs - µk = 0.05 t^0.3, W = 10 N, critical distance 10 µm; the curves of the paper are \
         lost";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn a_stiffer_drive_ends_stick_slip_at_a_lower_velocity() {
        assert_reading_contains("fig-2-02", "21.54, 2.14, 0.10 mm/s");
    }
}
