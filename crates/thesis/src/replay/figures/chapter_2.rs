//! Chapter 2: what others had found.

use super::graph::{by_ratio, curve};
use super::{Drawn, Figure, Graph};
use crate::replay::recipe::Problem;
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

/// Friction that grows at rest, as an example: the curves of the paper are lost.
const EXAMPLE: GrowthAtRest = GrowthAtRest { kinetic: 0.2, factor: 0.05, exponent: 0.3 };
const WEIGHT: f64 = 10.0;
const CRITICAL_DISTANCE: f64 = 10.0 * UM;

/// Stiffnesses of the drive, in N/mm.
const DRIVES: [f64; 3] = [10.0, 20.0, 50.0];

fn stick_slip(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("sliding velocity", "mm/s"), ("way of a slip", "µm"))
        .logarithmic(true, true)
        .across(1e-3, 100.0)
        .up(5.0, 1000.0);
    let (mut ends, mut told) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let stiffness = drive * 1e3;
        let end = EXAMPLE.end_of_stick_slip(WEIGHT, stiffness, CRITICAL_DISTANCE)? / MM_PER_S;
        let slip = |velocity: f64| Ok(EXAMPLE.slip(WEIGHT, stiffness, velocity * MM_PER_S)? / UM);
        graph = graph.line(format!("{drive} N/mm"), curve(by_ratio(1e-3, end, 41), slip)?);
        ends.push((end, CRITICAL_DISTANCE / UM));
        told.push(format!("{end:.2}"));
    }
    let graph = graph.dots("ends at the critical distance", ends);
    let reading = format!(
        "with 10, 20 and 50 N/mm it ends at {} mm/s: a stiffer drive makes it smaller and ends it sooner, as the text says",
        told.join(", ")
    );
    let settings = "an example: µs - µk = 0.05 t^0.3, W = 10 N, critical distance 10 µm; the curves of the paper are lost";
    Ok(Drawn::of_theory(vec![graph.picture()], settings, reading))
}

#[cfg(test)]
mod tests {
    use super::super::reading;

    #[test]
    fn a_stiffer_drive_ends_it_sooner() {
        assert!(reading("fig-2-02").contains("21.54, 2.14, 0.10 mm/s"), "{}", reading("fig-2-02"));
    }
}
