//! Chapter 9: what analysis makes of the simulation.

use super::graph::by_ratio;
use super::{Drawn, Figure, Graph};
use crate::replay::recipe::Problem;
use crate::slideway::falling::stable_limit;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[Figure {
    id: "fig-9-02",
    place: "9.2, eq 3-9",
    title: "boundary of stability in VcL and Cn",
    claims: &["8-147"],
    draw: boundary,
}];

fn boundary(figure: &Figure) -> Result<Drawn, Problem> {
    let slopes = by_ratio(10.0, 400.0, 100);
    let curve: Result<Vec<_>, Problem> =
        slopes.map(|slope| Ok((slope, stable_limit(771.0, slope * N_S_PER_MM)? / MM_PER_S))).collect();
    let graph = Graph::new(&figure.heading(), ("Cn", "N s/mm"), ("VcL", "mm/s"))
        .logarithmic(true, true)
        .line("VcL = 2 Fs / Cn", curve?)
        .label(50, "stable below");
    let reading =
        format!("at 51.2 N s/mm all is stable below {:.1} mm/s", stable_limit(771.0, 51.2e3)? / MM_PER_S);
    Ok(Drawn::of_theory(vec![graph.picture()], "Fs = 771 N", reading))
}
