//! Chapter 4: friction that falls with velocity, a table that tilts, and the model that is simulated.

use super::graph::{linspace, sample_curve};
use super::sketch::{PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::tilt::{Tilt, UNIFORM_INTERFACE};
use crate::slideway::units::{MM_PER_S, N_S_PER_MM, UM};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-4-02",
        place: "4.3",
        title: "linear and falling friction, and their slope",
        claims: &["4-124.a"],
        draw: slopes,
    },
    Figure {
        id: "fig-4-05",
        place: "4.4, eq 2-4 ... 5-4",
        title: "pitch and yaw of a table",
        claims: &["4-007", "4-008", "4-009", "4-010.a", "4-011.a"],
        draw: tilt,
    },
    Figure {
        id: "fig-4-06",
        place: "4.5",
        title: "friction characteristics",
        claims: &["4-124.a", "4-124.b"],
        draw: characteristics,
    },
    Figure {
        id: "fig-4-09",
        place: "4.6, eq 6-4, 7-4",
        title: "mass, spring and friction",
        claims: &["4-114", "4-115"],
        draw: model,
    },
    Figure {
        id: "fig-4-10",
        place: "4.6, eq 8-4 ... 14-4",
        title: "a friction curve in two parts",
        claims: &["4-116", "4-117", "4-118", "4-024"],
        draw: decomposed,
    },
];

/// The largest limit velocity VcL of the simulation, in m/s.
const LIMIT: f64 = 25.4 * MM_PER_S;

/// The plotted velocities, in mm/s.
fn velocities() -> impl Iterator<Item = f64> + Clone {
    linspace(0.0, 40.0, 201)
}

/// Viscous friction of the simulation in N, by velocity in mm/s.
fn viscous() -> Vec<(f64, f64)> {
    velocities().map(|velocity| (velocity, SIMULATED_DAMPING * velocity * MM_PER_S)).collect()
}

/// Solid and viscous friction together in N, by velocity in mm/s, for the largest VcL.
fn total() -> Result<Vec<(f64, f64)>, BoxError> {
    let friction = FallingFriction::simulated(LIMIT);
    sample_curve(velocities(), |velocity| friction.total(velocity * MM_PER_S, SIMULATED_DAMPING))
}

/// Makes a graph against sliding velocity.
fn against_velocity(title: &str, up: (&str, &str)) -> Graph {
    Graph::new(title, ("sliding velocity", "mm/s"), up)
}

/// Fig 4.2: linear and falling friction, and the slope of both.
///
/// The slope is f - 2 Fs (VcL - v) / VcL^2. Claim 4-124.a.
fn slopes(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let friction = FallingFriction::simulated(LIMIT);
    let force = against_velocity(&figure.heading(), ("friction force F", "N"))
        .line("(a) linear", viscous())
        .line("(b) falling", total()?);
    let slope = |velocity: f64| Ok((SIMULATED_DAMPING - friction.slope(velocity * MM_PER_S)?) / N_S_PER_MM);
    let derivative = against_velocity("(c) slope of both", ("dF/dv", "N s/mm"))
        .line("(a)", velocities().map(|velocity| (velocity, SIMULATED_DAMPING / N_S_PER_MM)).collect())
        .line("(b)", sample_curve(velocities(), slope)?);
    let reading = format!(
        "F is never negative, but its slope is: it rises from {:.1} N s/mm at rest to 0 at {:.1} mm/s and ends at \
         {:.1}",
        slope(0.0)?,
        friction.velocity_of_least(SIMULATED_DAMPING)? / MM_PER_S,
        SIMULATED_DAMPING / N_S_PER_MM
    );
    let settings = "Fs = 771 N, VcL = 25.4 mm/s, f = 10.7 N s/mm";
    Ok(DrawnFigure::from_theory(vec![force.picture(), derivative.picture()], settings, reading))
}

/// Fig 4.5: the table from the side and from above, and the pitch and yaw by equations 2-4 ... 5-4.
///
/// The factor is 9 in the text and 12 for the uniform interface that the text assumes (claim 4-008).
fn tilt(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 700.0);
    sketch.text("(a) from the side, pulled above the friction plane", (16.0, 76.0));
    side_view(&mut sketch, 0.0, 190.0);
    sketch.text("(b) it pitches: the leading edge sinks by ΔZ", (16.0, 290.0));
    side_view(&mut sketch, 0.05, 400.0);
    sketch.text("(c) from above, pulled off centre: it yaws by ΔY within the clearance Yc", (16.0, 500.0));
    top_view(&mut sketch);
    let even = Tilt { factor: UNIFORM_INTERFACE, ..Tilt::EXAMPLE };
    let reading = format!(
        "the edge sinks by {:.2} µm with the factor of the text, by {:.2} µm on the uniform interface that the text \
         assumes; θp is {:.1} µrad",
        Tilt::EXAMPLE.pitch()? / UM,
        even.pitch()? / UM,
        Tilt::EXAMPLE.pitch_angle()? * 1e6
    );
    Ok(sketch.finish("La = 150 mm, LT = 450 mm, FA = 50 kgf, Ks = 1e5 kgf/mm", reading))
}

/// Draws the table on its interface from the side. `slope` is its pitch, as a tangent. `plane` is the height of the
/// friction plane in pixels.
fn side_view(sketch: &mut Sketch, slope: f64, plane: f64) {
    let (middle, half, high) = (400.0, 240.0, 70.0);
    let at =
        |along: f64, up: f64| -> PixelPoint { (middle + along - slope * up, plane + slope * along - up) };
    sketch.ground((middle - 330.0, plane + 20.0), (middle + 330.0, plane + 20.0));
    for index in -6..=6 {
        let along = f64::from(index) * 38.0;
        sketch.fine(&[at(along, 0.0), (middle + along, plane + 20.0)]);
    }
    sketch.body(&[at(-half, 0.0), at(half, 0.0), at(half, high), at(-half, high)]);
    if slope == 0.0 {
        sketch.span(at(-half - 20.0, 0.0), (middle - half - 20.0, plane + 20.0), "");
        sketch.text_before("Z0 = W / Ks", (middle - half - 30.0, plane + 15.0));
        sketch.span(at(-half, high + 14.0), at(half, high + 14.0), "LT");
        sketch.arrow(&[at(half, 46.0), at(half + 120.0, 46.0)], Ink::Voltage);
        sketch.coloured("FA", at(half + 126.0, 41.0), Ink::Voltage);
        sketch.span(at(half + 60.0, 0.0), at(half + 60.0, 46.0), "La");
        sketch.centred_on("table", at(0.0, high / 2.0));
    } else {
        sketch.dashed((middle - half - 40.0, plane), (middle + half + 110.0, plane));
        sketch.span((middle + half + 20.0, plane), (middle + half + 20.0, plane + slope * half), "");
        sketch.text("ΔZ = 9 La FA / (2 Ks LT)", (middle + half + 34.0, plane - 8.0));
        sketch.text("tan θp = 2 ΔZ / LT", (middle + half + 34.0, plane - 32.0));
    }
}

/// Draws the table between its guides from above.
fn top_view(sketch: &mut Sketch) {
    let (middle, half, wide, slope) = ((400.0, 600.0), 220.0, 40.0, 0.05);
    let at = |along: f64, up: f64| -> PixelPoint {
        (middle.0 + along - slope * up, middle.1 + slope * along - up)
    };
    sketch.ground((720.0, middle.1 - wide - 14.0), (80.0, middle.1 - wide - 14.0));
    sketch.ground((80.0, middle.1 + wide + 14.0), (720.0, middle.1 + wide + 14.0));
    sketch.body(&[at(-half, -wide), at(half, -wide), at(half, wide), at(-half, wide)]);
    sketch.dashed((80.0, middle.1), (740.0, middle.1));
    let (edge, off_centre) = (middle.0 + half, middle.1 - 24.0);
    sketch.arrow(&[(edge, off_centre), (edge + 110.0, off_centre)], Ink::Voltage);
    sketch.coloured("FA", (edge + 116.0, off_centre + 5.0), Ink::Voltage);
    sketch.span((edge + 60.0, middle.1), (edge + 60.0, off_centre), "LF");
    sketch.text("ΔY = 9 LF FA / (2 Ks LT) + Yc", (16.0, 530.0));
}

/// VcL of curve (b) in `patches/thesis/fig-4-07.json`, in m/s: friction falls up to it. That patch makes the profiles
/// of Fig 4.7.
const FALLING_LIMIT: f64 = 2.54 * MM_PER_S;
/// Velocity up to which friction of curve (c) of the same patch drops, in m/s.
const DROP_LIMIT: f64 = 0.508 * MM_PER_S;
/// Share of static friction that curve (c) keeps after the drop.
const CONSTANT_SHARE: f64 = 0.6;

/// Fig 4.6: linear friction, friction that falls up to VcL, and friction that drops to a constant.
///
/// Curve (c) is 0.6 Fs plus a square law that ends at 0.508 mm/s, as in the patch of Fig 4.7.
fn characteristics(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let velocities = || linspace(0.0, 10.0, 501);
    let falling = FallingFriction::simulated(FALLING_LIMIT);
    let constant = CONSTANT_SHARE * falling.static_friction;
    let dropping = FallingFriction { static_friction: falling.static_friction - constant, limit: DROP_LIMIT };
    let total = |friction: FallingFriction, constant: f64| {
        sample_curve(velocities(), move |velocity| {
            Ok(constant + friction.total(velocity * MM_PER_S, SIMULATED_DAMPING)?)
        })
    };
    let linear = velocities().map(|velocity| (velocity, SIMULATED_DAMPING * velocity * MM_PER_S)).collect();
    let graph = against_velocity(&figure.heading(), ("friction force", "N"))
        .line("(a) linear", linear)
        .line("(b) falls up to 2.54 mm/s", total(falling, 0.0)?)
        .line("(c) drops to a constant", total(dropping, constant)?);
    let reading = format!(
        "(b) and (c) begin at {:.0} N; (b) has its minimum at {:.2} mm/s, (c) keeps {constant:.0} N; the text says \
         only that both begin above 0 and fall over some range",
        falling.static_friction,
        falling.velocity_of_least(SIMULATED_DAMPING)? / MM_PER_S
    );
    let settings = "Fs = 771 N, f = 10.7 N s/mm, as in patches/thesis/fig-4-07.json";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

/// Fig 4.9: the model of mass, spring and friction, with its equations.
fn model(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 330.0);
    let (line, floor) = (170.0, 220.0);
    sketch.block((110.0, line), (90.0, 70.0), "drive");
    sketch.arrow(&[(70.0, 100.0), (150.0, 100.0)], Ink::Signal);
    sketch.coloured("xi", (156.0, 105.0), Ink::Signal);
    sketch.spring((155.0, line), (420.0, line), "K");
    sketch.block((500.0, line), (160.0, 100.0), "M");
    sketch.arrow(&[(460.0, 100.0), (540.0, 100.0)], Ink::Signal);
    sketch.coloured("xo", (546.0, 105.0), Ink::Signal);
    sketch.ground((330.0, floor), (860.0, floor));
    sketch.damper((580.0, line), (740.0, line), "f");
    sketch.line(&[(740.0, 130.0), (740.0, floor)], Ink::Line);
    sketch.arrow(&[(560.0, floor + 24.0), (460.0, floor + 24.0)], Ink::Voltage);
    sketch.coloured("F", (440.0, floor + 29.0), Ink::Voltage);
    sketch.text("M xo'' + f xo' + K xo = K xi, friction linear", (16.0, 280.0));
    sketch.text("M xo'' + sign(xo') F + K xo = K xi, friction of any kind", (16.0, 306.0));
    let table = DrivenTable::simulated(0.0);
    let reading = format!(
        "with the values of the simulation its natural frequency is {:.1} rad/s, {:.1} Hz, and its damping ratio {:.3}",
        table.natural_frequency()?,
        table.natural_frequency()? / std::f64::consts::TAU,
        table.damping_ratio()?
    );
    Ok(sketch.finish("M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm", reading))
}

/// Fig 4.10: the friction curve of the simulation as the sum of solid and viscous friction.
///
/// Solid friction is Fs (1 - v / VcL)^2, a quarter of Fs at half of VcL (claims 4-116 ... 4-118).
fn decomposed(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let friction = FallingFriction::simulated(LIMIT);
    let solid = sample_curve(velocities(), |velocity| friction.solid(velocity * MM_PER_S))?;
    let graph = against_velocity(&figure.heading(), ("friction force", "N"))
        .line("(A) solid, N (VcL - v)²", solid)
        .line("(B) viscous, f v", viscous())
        .line("both", total()?)
        .marker(LIMIT / MM_PER_S, "VcL");
    let half = friction.solid(LIMIT / 2.0)?;
    let least = friction.velocity_of_least(SIMULATED_DAMPING)?;
    let reading = format!(
        "(A) is 771 N at rest, a quarter of it ({half:.0} N) at half of VcL and 0 above VcL; the sum has its minimum \
         at {:.1} mm/s, {:.0} N",
        least / MM_PER_S,
        friction.total(least, SIMULATED_DAMPING)?
    );
    Ok(DrawnFigure::from_theory(
        vec![graph.picture()],
        "Fs = 771 N, VcL = 25.4 mm/s, f = 10.7 N s/mm",
        reading,
    ))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-4-05", "0.75 µm");
        assert_reading_contains("fig-4-05", "1.00 µm");
        assert_reading_contains("fig-4-09", "322.4 rad/s, 51.3 Hz");
        assert_reading_contains("fig-4-10", "(193 N)");
    }
}
