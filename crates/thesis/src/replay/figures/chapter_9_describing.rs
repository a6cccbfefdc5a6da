//! Chapter 9: describing functions of friction (9.4 (ii)).
//!
//! Constant friction acts as a dead zone, friction of the slideway as a cut-off. A describing function replaces the
//! output by its fundamental. Forces are divided by the viscous friction a = f v, or by F.

use std::f64::consts::PI;

use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{Grid, PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::describing::{Swing, cut_off, cut_off_gain, dead_zone, dead_zone_gain};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::MM_PER_S;
use patchcord_draw::plot::{Ink, Picture};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-9-09",
        place: "9.4 (ii), eq 41-9 ... 44-9",
        title: "linear and non-linear part",
        claims: &["9-071"],
        draw: closed_loop,
    },
    Figure {
        id: "fig-9-10",
        place: "9.4 (ii), eq 51-9, 52-9",
        title: "constant friction as a dead zone",
        claims: &[],
        draw: constant_friction,
    },
    Figure {
        id: "fig-9-11",
        place: "9.4 (ii), eq 53-9",
        title: "slideway friction as a cut-off",
        claims: &["9-078", "9-079"],
        draw: slideway_friction,
    },
    Figure {
        id: "fig-9-12",
        place: "9.4 (ii), eq 54-9 ... 56-9",
        title: "from a sine to its cut-off",
        claims: &["9-081", "9-082", "9-083.a", "9-083.b"],
        draw: cut_off_sine,
    },
    Figure {
        id: "fig-9-13",
        place: "9.4 (ii), Table T9-3",
        title: "Nyquist diagram with constant friction",
        claims: &["9-084", "9-085", "9-086", "9-087", "9-088"],
        draw: nyquist_without_friction,
    },
    Figure {
        id: "fig-9-14",
        place: "9.4 (ii), eq 60-9 ... 80-9",
        title: "wave forms with oscillating friction",
        claims: &["9-093", "9-094", "9-096", "9-096.b"],
        draw: wave_forms,
    },
];

/// Stiffnesses of Table T9-5, in MN/m.
pub(super) const DRIVES: [f64; 2] = [45.0, 22.5];

/// The slideway of Tables T9-5 and T9-6, with a stiffness in MN/m and without a time constant.
pub(super) fn table(stiffness: f64) -> DrivenTable {
    DrivenTable { stiffness: stiffness * 1e6, damping: 10.71e3, ..DrivenTable::simulated(0.0) }
}

/// The settings of the Nyquist diagrams.
pub(super) const SETTINGS: &str = "M = 433 kg, f = 10.71 N s/mm, without time constant";

/// Fig 9.9: the closed loop, with a linear and a non-linear part.
fn closed_loop(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 460.0);
    sketch.text("(a) the system, with a linear and a non-linear part", (16.0, 76.0));
    draw_loop(&mut sketch, 150.0, "xi", ("solid friction", "mass, spring, viscous friction"));
    sketch.text("(b) the same without an input, in the form of control theory", (16.0, 270.0));
    draw_loop(&mut sketch, 344.0, "0", ("NE", "G(s)"));
    sketch.text("G(jω) = −1 / NE", (560.0, 270.0));
    let reading = "the loop oscillates by itself where the curves of G(jω) and −1 / NE meet; G gives the frequency, \
         NE the amplitude";
    Ok(sketch.finish("G(s) = K / (s (M s + f))", reading))
}

/// Draws a loop with two blocks. `y` is the vertical position of its forward path, in pixels.
fn draw_loop(sketch: &mut Sketch, y: f64, input: &str, (first, second): (&str, &str)) {
    sketch.text(input, (64.0, y - 8.0));
    sketch.arrow(&[(60.0, y), (147.0, y)], Ink::Line);
    sketch.sum((160.0, y));
    sketch.text("+", (132.0, y - 8.0));
    sketch.text("−", (140.0, y + 28.0));
    sketch.arrow(&[(173.0, y), (240.0, y)], Ink::Line);
    sketch.text("E sin θ", (182.0, y - 8.0));
    sketch.block((320.0, y), (160.0, 50.0), first);
    sketch.arrow(&[(400.0, y), (470.0, y)], Ink::Line);
    sketch.block((585.0, y), (230.0, 50.0), second);
    sketch.arrow(&[(700.0, y), (840.0, y)], Ink::Line);
    sketch.text("xo", (812.0, y - 8.0));
    sketch.dot((770.0, y), Ink::Line);
    sketch.arrow(&[(770.0, y), (770.0, y + 80.0), (160.0, y + 80.0), (160.0, y + 13.0)], Ink::Line);
}

/// Returns the points of a wave over one period, by angle in degrees.
fn wave(law: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    linspace(0.0, 360.0, 361).map(|degrees| (degrees, law(degrees.to_radians()))).collect()
}

/// Makes a graph against angle, over one period.
fn waves(title: &str, side: &str) -> Graph {
    Graph::new(title, ("angle θ", "degrees"), (side, "")).x_divisions(0.0, 360.0, 8)
}

/// Amplitudes of the force, divided by F, that are plotted.
const AMPLITUDES: [f64; 3] = [1.5, 3.0, 10.0];

/// Fig 9.10: constant friction as a dead zone, and its effect on sines of several amplitudes.
fn constant_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let zone = linspace(-4.0, 4.0, 161).map(|force| (force, dead_zone(force))).collect();
    let law = Graph::new(&figure.heading(), ("drive force K e / F", ""), ("useful force / F", ""))
        .note("(a) friction is F at every velocity, (b) the useful part of a force")
        .line("useful force", zone)
        .x_range(-4.0, 4.0)
        .picture();
    let mut sines = waves("(c) sines of several amplitudes, divided by their amplitude", "useful force / E");
    let mut texts = Vec::new();
    for size in AMPLITUDES {
        sines = sines.line(format!("E = {size} F"), wave(|angle| dead_zone(size * angle.sin()) / size));
        texts.push(format!("{:.2} for E = {size} F", dead_zone_gain(size)));
    }
    let reading = format!("NE is {}; it tends to 1 for a larger amplitude or a smaller F", texts.join(", "));
    Ok(DrawnFigure::from_theory(vec![law, sines.picture()], "in units of F", reading))
}

/// The working point of the thesis's example, as a share of VcL.
const WORKING_POINT: f64 = 0.4;

/// Fig 9.11: solid and viscous friction at a working point, and the cut-off that they make.
fn slideway_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (friction, damping) = (FallingFriction::simulated(40.0 * MM_PER_S), table(DRIVES[0]).damping);
    let velocities = linspace(0.0, 50.0, 101);
    let solid = sample_curve(velocities.clone(), |velocity| friction.solid(velocity * MM_PER_S))?;
    let viscous = velocities.map(|velocity| (velocity, damping * velocity * MM_PER_S)).collect();
    let working = WORKING_POINT * friction.limit;
    let (solid_force, viscous_force) = (friction.solid(working)?, damping * working);
    let title = format!("{}, (a) as two parts", figure.heading());
    let decomposed = Graph::new(&title, ("velocity", "mm/s"), ("friction force", "N"))
        .line("solid friction F", solid)
        .line("viscous friction a = f v", viscous)
        .dots("at 16 mm/s", vec![(working / MM_PER_S, solid_force), (working / MM_PER_S, viscous_force)])
        .picture();
    let cut = linspace(-4.0, 4.0, 161).map(|force| (force, cut_off(force))).collect();
    let law = Graph::new(
        "(b) the drive does not push back",
        ("(K e - F - a) / a", ""),
        ("accelerating force / a", ""),
    )
    .x_range(-4.0, 4.0)
    .y_range(-2.0, 4.0)
    .line("output", cut)
    .picture();
    let (small, large) = (0.8, 3.0);
    let sines = waves("(c) a small sine passes, a large one is cut", "accelerating force / a")
        .y_range(-2.0, 4.0)
        .line("E1 = 0.8 a", wave(|angle| cut_off(small * angle.sin())))
        .line("E2 = 3 a", wave(|angle| cut_off(large * angle.sin())))
        .picture();
    let reading = format!(
        "at {:.0} mm/s F is {solid_force:.0} N and a {viscous_force:.0} N; NE is {:.0} for E = 0.8 a and {:.3} for E \
         = 3 a",
        working / MM_PER_S,
        cut_off_gain(small),
        cut_off_gain(large)
    );
    let settings = "Fs = 771 N, VcL = 40 mm/s, f = 10.71 N s/mm";
    Ok(DrawnFigure::from_theory(vec![decomposed, law, sines], settings, reading))
}

/// The ratio E/a of the example in Fig 9.12.
const EXAMPLE_RATIO: f64 = 3.0;

/// Fig 9.12: a sine, its cut-off and the fundamental of that, laid out around the characteristic.
fn cut_off_sine(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 640.0);
    // Coordinates are in units of a. Time runs down below the characteristic, and to the right next to it.
    let law = Grid { origin: (230.0, 220.0), scale: (38.0, 38.0) };
    let right = Grid { origin: (440.0, 220.0), scale: (380.0 / (2.0 * PI), 38.0) };
    let below = Grid { origin: (230.0, 370.0), scale: (38.0, -220.0 / (2.0 * PI)) };
    axes(&mut sketch, law, (-4.0, 4.4), (-1.8, 3.6));
    sketch.text("input force", law.at(2.2, -0.5));
    sketch.text_before("output force", law.at(-0.2, 3.3));
    sketch.line(&law.all([(-4.0, -1.0), (-1.0, -1.0), (3.5, 3.5)]), Ink::Line);
    sketch.text_before("−a", law.at(-0.2, -1.4));
    let angles = || linspace(0.0, 2.0 * PI, 181);
    sketch.line(&below.all(angles().map(|angle| (EXAMPLE_RATIO * angle.sin(), angle))), Ink::Signal);
    axes(&mut sketch, below, (-4.0, 4.4), (0.0, 6.6));
    sketch.coloured("E sin θ", below.at(3.2, PI / 2.0 + 0.1), Ink::Signal);
    axes(&mut sketch, right, (0.0, 6.6), (-1.8, 3.6));
    sketch
        .line(&right.all(angles().map(|angle| (angle, cut_off(EXAMPLE_RATIO * angle.sin())))), Ink::Voltage);
    let gain = cut_off_gain(EXAMPLE_RATIO);
    let fundamental: Vec<PixelPoint> =
        right.all(angles().map(|angle| (angle, gain * EXAMPLE_RATIO * angle.sin())));
    fundamental.chunks(4).step_by(2).for_each(|dash| sketch.fine(dash));
    let cut = (1.0 / EXAMPLE_RATIO).asin();
    for angle in [PI + cut, 2.0 * PI - cut] {
        sketch.dashed(right.at(angle, -1.0), right.at(angle, 0.0));
    }
    sketch.centred("π + θ1", right.at(PI + cut, 0.25));
    sketch.centred("2π − θ1", right.at(2.0 * PI - cut, 0.25));
    sketch.text("dashed: the fundamental, g(E) E sin θ", (440.0, 330.0));
    sketch.text("θ1 = asin(a / E)", (460.0, 430.0));
    sketch.text("g(E) = 1/2 + θ1 / π + a / (π E) · (1 − (a / E)²)^0.5", (460.0, 460.0));
    sketch.text("b(E) = 0: the output has no phase lag", (460.0, 490.0));
    let reading = format!(
        "for E = {EXAMPLE_RATIO} a the angle θ1 = asin(a / E) is {:.1} degrees, and g(E) {gain:.3}, between 1 for E = \
         a and 1/2 for a = 0",
        cut.to_degrees()
    );
    Ok(sketch.finish("E = 3 a, constant friction", reading))
}

/// Draws axes through the origin of a grid, between given ends.
fn axes(sketch: &mut Sketch, grid: Grid, across: (f64, f64), up: (f64, f64)) {
    sketch.fine(&[grid.at(across.0, 0.0), grid.at(across.1, 0.0)]);
    sketch.fine(&[grid.at(0.0, up.0), grid.at(0.0, up.1)]);
}

/// Points of the complex plane: real and imaginary part.
pub(super) type Curve = Vec<(f64, f64)>;

/// Returns G(jw) of a table for frequencies from `low` to `high`, in rad/s.
pub(super) fn locus(table: &DrivenTable, low: f64, high: f64) -> Result<Curve, BoxError> {
    Ok(geomspace(low, high, 201)
        .map(|frequency| open_loop_point(table, frequency))
        .collect::<Result<_, _>>()?)
}

/// Returns G(jw) of a table at a frequency in rad/s.
pub(super) fn open_loop_point(table: &DrivenTable, frequency: f64) -> Result<(f64, f64), SlidewayError> {
    table.open_loop(frequency).map(|response| (response.re, response.im))
}

/// Returns -1 / N for a ratio E/a, with friction that oscillates with an amplitude n. `friction` is n/a.
pub(super) fn negative_reciprocal(force: f64, friction: f64) -> Result<(f64, f64), SlidewayError> {
    let function = Swing { force, friction }.describing_function()?;
    Ok((-function.re / function.norm_sqr(), function.im / function.norm_sqr()))
}

/// Makes a graph of the complex plane.
pub(super) fn complex_plane(figure: &Figure) -> Graph {
    Graph::new(&figure.heading(), ("real part", ""), ("imaginary part", ""))
}

/// Ratios E/a of Table T9-3.
const T9_3: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];

/// Fig 9.13: the Nyquist diagram with a constant friction force.
fn nyquist_without_friction(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let dots =
        T9_3.map(|force| negative_reciprocal(force, 0.0)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let line =
        geomspace(1.0, 1000.0, 61).map(|force| negative_reciprocal(force, 0.0)).collect::<Result<_, _>>()?;
    let mut graph = complex_plane(figure)
        .x_range(-3.0, 0.5)
        .y_range(-0.4, 0.1)
        .line("G(jω), 45 MN/m", locus(&table(DRIVES[0]), 150.0, 3000.0)?)
        .line("−1 / NE", line)
        .dots("E/a of Table T9-3", dots.clone());
    for (index, force) in T9_3.iter().enumerate() {
        graph = graph.label(index, format!("{force}"));
    }
    let at = |index: usize| -dots[index].0;
    let reading = format!(
        "−1 / NE is on the real axis, from −{:.2} at E = a over −{:.2} at 5 a to −2; G never meets it, so there is \
         no limit cycle",
        at(0),
        at(2)
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// The ratio E/a, and two ratios n/a below and above 1, as in Table T9-4.
const EXAMPLE_RATIOS: (f64, [f64; 2]) = (5.0, [0.6, 4.0]);

/// Fig 9.14: wave forms with oscillating friction, for n < a and n > a.
fn wave_forms(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (force, frictions) = EXAMPLE_RATIOS;
    let one = |title: &str, friction: f64| -> Result<Picture, BoxError> {
        let function = Swing { force, friction }.describing_function()?;
        let fundamental = |angle: f64| force * (function.re * angle.sin() + function.im * angle.cos());
        let graph = waves(title, "force / a")
            .line("E sin θ", wave(|angle| force * angle.sin()))
            .line("n cos θ", wave(|angle| friction * angle.cos()))
            .line("output", wave(|angle| cut_off(force * angle.sin() - friction * angle.cos())))
            .line("its fundamental", wave(fundamental));
        Ok(graph.picture())
    };
    let title = format!("{}, (a) n < a", figure.heading());
    let pictures = vec![one(&title, frictions[0])?, one("(b) n > a", frictions[1])?];
    let texts = frictions.map(|friction| -> Result<String, SlidewayError> {
        let swing = Swing { force, friction };
        Ok(format!(
            "n/a = {friction}: 1/|N| = {:.3}, phase lag {:.2} degrees",
            swing.reciprocal()?,
            swing.angle()?.to_degrees()
        ))
    });
    let [first, second] = texts;
    let reading = format!("{}; {} (Table T9-4: 1.586, 6.84; 1.30, 38.66)", first?, second?);
    Ok(DrawnFigure::from_theory(pictures, "E = 5 a; n/a = 0.6 and 4", reading))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-9-13", "−1.60 at 5 a");
        assert_reading_contains("fig-9-14", "n/a = 0.6: 1/|N| = 1.587, phase lag 6.84");
    }
}
