//! Chapter 9: analysis of the simulation, up to the criterion of Routh and Hurwitz (9.2 ... 9.4 (i)).
//!
//! The figures compare three sources: laws that the study fitted to its simulation, measured values of Table T9-2,
//! and the stability criterion.

use super::chapter_9_simulated::circuit_slopes;
use super::graph::{geomspace, linspace, sample_curve};
use super::sketch::{PixelPoint, Sketch};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::design::{Design, Interface, limit_velocity};
use crate::slideway::falling::{FallingFriction, stable_limit};
use crate::slideway::measured::{Measurement, STATIC_FRICTION, TABLE_9_2};
use crate::slideway::simulated::{
    OilLaw, SLOPE_BY_MEMORY, SLOPE_BY_STIFFNESS, memory_from_critical_velocity,
};
use crate::slideway::stability::{DrivenTable, Groups, PRINTED_BY_MEMORY, PRINTED_BY_STIFFNESS};
use crate::slideway::units::{KGF_PER_CM2, MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE};
use patchcord_draw::plot::Ink;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-9-01",
        place: "9.2, eq 1-9",
        title: "slope at which oscillation ceases by time constant",
        claims: &["9-010.a", "9-064.a", "9-064.b", "9-064.d", "9-065"],
        draw: slope_by_memory,
    },
    Figure {
        id: "fig-9-02",
        place: "9.2, eq 3-9",
        title: "boundary of stability in VcL and Tc",
        claims: &["8-147", "9-004"],
        draw: boundary,
    },
    Figure {
        id: "fig-9-03",
        place: "9.2, eq 5-9",
        title: "slope at which oscillation ceases by stiffness",
        claims: &["9-010.b", "9-066.a", "9-066.b", "9-066.c"],
        draw: slope_by_stiffness,
    },
    Figure {
        id: "fig-9-04",
        place: "9.3, eq 16-9, 17-9, 20-9",
        title: "time constant by viscosity of the oil",
        claims: &["9-042.a", "9-042.b", "9-043.a", "9-043.b", "9-041", "9-052"],
        draw: memory_by_viscosity,
    },
    Figure {
        id: "fig-9-05",
        place: "9.3, eq 14-9, 18-9",
        title: "critical velocity by viscosity, table of 450 kgf",
        claims: &["9-021.a", "9-023", "9-036.d", "9-044.a", "9-044.b"],
        draw: velocity_at_450_kgf,
    },
    Figure {
        id: "fig-9-06",
        place: "9.3, eq 21-9",
        title: "critical velocity by viscosity, table of 850 kgf",
        claims: &["9-020", "9-047.a", "9-047.b", "9-053"],
        draw: velocity_at_850_kgf,
    },
    Figure {
        id: "fig-9-07",
        place: "9.4 (i), eq 26-9",
        title: "signal flow of the slideway",
        claims: &["9-054", "9-055", "9-057", "9-059"],
        draw: signal_flow,
    },
    Figure {
        id: "fig-9-08",
        place: "9.4 (i), eq 33-9 ... 36-9",
        title: "boundary of stability in dimensionless numbers",
        claims: &["9-060", "9-063.a", "9-063.b", "9-070"],
        draw: groups,
    },
];

/// The range of time constants in the simulation, in s.
const MEMORIES: (f64, f64) = (6e-3, 25e-3);

/// Returns the slope in N s/mm at which the simulated table becomes unstable, by time constant in s.
fn routh_hurwitz(memory: f64) -> Result<f64, SlidewayError> {
    Ok(DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM)
}

/// Fig 9.1: the slope at which oscillation ends by time constant: laws, and runs of the circuit.
fn slope_by_memory(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let memories = geomspace(MEMORIES.0, MEMORIES.1, 61);
    let in_ms = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x / MS, y)).collect::<Vec<_>>();
    let theory = sample_curve(memories.clone(), routh_hurwitz)?;
    let printed =
        sample_curve(geomspace(MEMORIES.0, MEMORIES.1, 9), |memory| Ok(PRINTED_BY_MEMORY.at(memory)))?;
    let simulated = sample_curve(memories, |memory| Ok(SLOPE_BY_MEMORY.at(memory)))?;
    let graph = Graph::new("(a) laws", ("time constant Tc", "ms"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .x_range(5.0, 30.0)
        .y_range(20.0, 500.0)
        .line("study's simulation: 7.5e4 Tc^1.54 (1-9)", in_ms(simulated))
        .line("Routh-Hurwitz (32-9)", in_ms(theory))
        .dots("its printed fit (37-9)", in_ms(printed));
    let [short, long] = [MEMORIES.0, MEMORIES.1]
        .map(|memory| -> Result<f64, BoxError> { Ok(routh_hurwitz(memory)? / SLOPE_BY_MEMORY.at(memory)) });
    let all: Vec<f64> = geomspace(MEMORIES.0, MEMORIES.1, 9).collect();
    let fitted = DrivenTable::simulated(0.0).slope_by_memory(&all)?;
    let reading = format!(
        "both laws rise alike; Routh-Hurwitz, with Tc^{:.2} (printed: 1.55), is {:.2} times the study's law at 6 ms, \
         {:.2} times at 25 ms",
        fitted.exponent, short?, long?
    );
    let run = circuit_slopes()?;
    let pictures = [graph.picture()].into_iter().chain(run.pictures).collect();
    let drawn =
        DrawnFigure::from_sweeps(figure, &[run.sweep], pictures, format!("{reading}; {}", run.reading))?;
    Ok(DrawnFigure { table: Some(run.table), ..drawn })
}

/// Fig 9.2: the boundary of stability in VcL and Tc, by the study's law and by Routh-Hurwitz.
///
/// The boundary is VcL = 2 Fs / Cn. A larger VcL has no slope as steep as Cn at any velocity.
fn boundary(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let static_friction = FallingFriction::simulated(1.0).static_friction;
    let limit = |slope: f64| Ok(stable_limit(static_friction, slope * N_S_PER_MM)? / MM_PER_S);
    let simulated = |memory: f64| limit(SLOPE_BY_MEMORY.at(memory * MS));
    let theory = |memory: f64| limit(routh_hurwitz(memory * MS)?);
    let memories = || linspace(MEMORIES.0 / MS, MEMORIES.1 / MS, 96);
    let graph = Graph::new(&figure.heading(), ("time constant Tc", "ms"), ("VcL", "mm/s"))
        .x_divisions(5.0, 25.0, 10)
        .y_range(0.0, 60.0)
        .line("VcL = 2 Fs / (7.5e4 Tc^1.54) (3-9)", sample_curve(memories(), simulated)?)
        .label(20, "above: stable, below: may oscillate")
        .line("by Routh-Hurwitz (32-9)", sample_curve(memories(), theory)?);
    let reading = format!(
        "at 7.1 ms the table is stable above a VcL of {:.1} mm/s, by Routh-Hurwitz above {:.1}; at 15 ms above {:.1} \
         and {:.1}",
        simulated(7.1)?,
        theory(7.1)?,
        simulated(15.0)?,
        theory(15.0)?
    );
    let settings = "Fs = 771 N, M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

/// The time constant of Fig 8.35, in s.
const MEMORY: f64 = 7.1e-3;

/// Fig 9.3: the slope at which oscillation ends by stiffness, by the study's law and by Routh-Hurwitz.
fn slope_by_stiffness(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let theory = |stiffness: f64| {
        let table = DrivenTable { stiffness: stiffness * 1e3 * N_PER_MM, ..DrivenTable::simulated(MEMORY) };
        Ok(table.critical_slope()? / N_S_PER_MM)
    };
    let stiffnesses = || geomspace(10.0, 60.0, 61);
    let simulated = |stiffness: f64| Ok(SLOPE_BY_STIFFNESS.at(stiffness * 1e3));
    let printed = |stiffness: f64| Ok(PRINTED_BY_STIFFNESS.at(stiffness * 1e3));
    let graph = Graph::new(&figure.heading(), ("stiffness K", "kN/mm"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .x_range(10.0, 60.0)
        .y_range(20.0, 100.0)
        .line("study's simulation: 16 K^0.077 (5-9)", sample_curve(stiffnesses(), simulated)?)
        .line("Routh-Hurwitz (32-9)", sample_curve(stiffnesses(), theory)?)
        .dots("its printed fit (38-9)", sample_curve(geomspace(11.0, 45.0, 6), printed)?);
    let reading = format!(
        "from 11 to 45 kN/mm the slope grows by {:.0} % by the simulation's law and by {:.0} % by Routh-Hurwitz; the \
         two disagree, as the text says",
        100.0 * (simulated(45.0)? / simulated(11.0)? - 1.0),
        100.0 * (theory(45.0)? / theory(11.0)? - 1.0)
    );
    let settings = "M = 433 kg, f = 10.7 N s/mm, Tc = 7.1 ms";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

/// Stiffnesses of Table T9-2, in kN/mm.
const DRIVES: [f64; 3] = [45.0, 27.6, 11.0];

/// Index of the cell of Table T9-2 whose printed critical velocity does not agree with its time constant.
const MISPRINTED: usize = 8;
/// The critical velocity printed for that cell, in m/s.
const PRINTED_VELOCITY: f64 = 16.0 * MM_PER_S;

/// Selects the cells of Table T9-2 with a drive in kN/mm.
fn measured_with(drive: f64) -> impl Iterator<Item = &'static Measurement> {
    TABLE_9_2.iter().filter(move |cell| (cell.stiffness / 1e6 - drive).abs() < 0.01)
}

/// Fig 9.4: time constant by viscosity: Table T9-2, and the two laws of the study.
///
/// The misprinted cell is that of 0.13 P and 11 kN/mm: 0.0059 s next to 16 mm/s (claim 9-036.e).
fn memory_by_viscosity(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let law =
        |oil: OilLaw| sample_curve(geomspace(0.1, 1.0, 2), move |poise| Ok(oil.memory(poise * POISE)? / MS));
    let mut graph = Graph::new(&figure.heading(), ("viscosity", "P"), ("time constant Tc", "ms"))
        .logarithmic(true, true)
        .x_range(0.1, 1.0)
        .y_range(4.0, 12.0);
    for drive in DRIVES {
        let cells = measured_with(drive).map(|cell| (cell.viscosity / POISE, cell.memory / MS)).collect();
        graph = graph.dots(format!("450 kgf, {drive} kN/mm (T9-2)"), cells);
    }
    let misprinted = &TABLE_9_2[MISPRINTED];
    let meant =
        memory_from_critical_velocity(&misprinted.friction(), PRINTED_VELOCITY, misprinted.stiffness)?;
    let graph = graph.dots("from the printed 16 mm/s", vec![(misprinted.viscosity / POISE, meant / MS)]);
    let graph = graph
        .line("450 kgf: 11.16 η^0.236 (17-9)", law(OilLaw::AT_450_KGF)?)
        .line("850 kgf: 8.3 η^0.183 (20-9)", law(OilLaw::AT_850_KGF)?);
    let misses = TABLE_9_2.iter().map(|cell| -> Result<f64, SlidewayError> {
        Ok((cell.memory / OilLaw::AT_450_KGF.memory(cell.viscosity)? - 1.0).abs())
    });
    let mut misses = misses.collect::<Result<Vec<_>, _>>()?;
    misses.sort_by(f64::total_cmp);
    let reading = format!(
        "the line of 450 kgf misses eleven of twelve cells by at most {:.0} %, and one by {:.0} %; for that one 16 \
         mm/s are printed, which correspond to {:.2} ms",
        100.0 * misses[10],
        100.0 * misses[11],
        meant / MS
    );
    let settings = "each Tc from a measured critical velocity by eq 15-9, Fs = 1249 N; the measurements at 850 kgf \
         are lost";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

/// Returns the law of critical velocity in mm/s by viscosity in P. Its arguments are an oil law, static friction in
/// N, a pressure in kgf/cm2, and a drive in kN/mm (eq 18-9, 21-9).
fn velocity_by_viscosity(
    law: OilLaw,
    static_friction: f64,
    pressure: f64,
    drive: f64,
) -> impl Fn(f64) -> Result<f64, SlidewayError> {
    let lift = Design::model(POISE, N_PER_MM).lift;
    move |poise| {
        let limit = limit_velocity(pressure * KGF_PER_CM2, lift, poise * POISE)?;
        let friction = FallingFriction { static_friction, limit };
        Ok(friction.velocity_at_slope(law.slope(poise * POISE, drive * 1e6)?)? / MM_PER_S)
    }
}

/// Pressures of the study for 450 and 850 kgf, in kgf/cm2. On 697 cm2 these weights would give 0.646 and 1.22.
const PRESSURES: [f64; 2] = [0.615, 1.18];

/// Fig 9.5: critical velocity by viscosity for 450 kgf: law, and velocities computed back from Table T9-2.
fn velocity_at_450_kgf(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("viscosity", "P"), ("critical velocity Vc", "mm/s"))
        .x_range(0.0, 0.7)
        .y_range(0.0, 30.0);
    let (mut velocities, mut from) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let law = velocity_by_viscosity(OilLaw::AT_450_KGF, STATIC_FRICTION, PRESSURES[0], drive);
        graph = graph.line(format!("{drive} kN/mm (18-9)"), sample_curve(linspace(0.1, 0.65, 111), &law)?);
        velocities.push(format!("{:.1}", law(0.34)?));
        let cells = measured_with(drive).map(|cell| -> Result<(f64, f64), SlidewayError> {
            Ok((cell.viscosity / POISE, cell.critical_velocity()? / MM_PER_S))
        });
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        from.push(format!("{:.1}", cells[1].1));
        graph = graph.dots(format!("measured, {drive} (T9-2)"), cells);
    }
    let graph = graph.label(0, "0.0059 s of T9-2; printed for it: 16 mm/s");
    let reading = format!(
        "at 0.34 P the law gives {} mm/s for 45, 27.6 and 11 kN/mm; the Tc of T9-2 correspond to {} (by eq 15-9 \
         inverted: the measurements are lost)",
        velocities.join(", "),
        from.join(", ")
    );
    let settings = "Pw = 0.615 kgf/cm², Fs = 1249 N, Ho + hd = 5.48 µm";
    Ok(DrawnFigure::from_theory(vec![graph.picture()], settings, reading))
}

/// Fig 9.6: critical velocity by viscosity for 850 kgf, by the law.
fn velocity_at_850_kgf(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let static_friction = Interface::MODEL.static_friction(PRESSURES[1] * KGF_PER_CM2)?;
    let mut graph =
        Graph::new(&figure.heading(), ("viscosity", "P"), ("critical velocity Vc", "mm/s")).x_range(0.0, 0.7);
    let (mut velocities, mut before) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let law = velocity_by_viscosity(OilLaw::AT_850_KGF, static_friction, PRESSURES[1], drive);
        graph = graph.line(format!("{drive} kN/mm (21-9)"), sample_curve(linspace(0.1, 0.65, 111), &law)?);
        velocities.push(format!("{:.1}", law(0.34)?));
        let lighter = velocity_by_viscosity(OilLaw::AT_450_KGF, STATIC_FRICTION, PRESSURES[0], drive);
        before.push(format!("{:.1}", lighter(0.34)?));
    }
    let reading = format!(
        "at 0.34 P the law gives {} mm/s for 45, 27.6 and 11 kN/mm, and {} under 450 kgf; weight has more effect on \
         soft drives; the measurements are lost",
        velocities.join(", "),
        before.join(", ")
    );
    let settings = format!("Pw = 1.18 kgf/cm², Fs = {static_friction:.0} N (13-9), Ho + hd kept at 5.48 µm");
    Ok(DrawnFigure::from_theory(vec![graph.picture()], &settings, reading))
}

/// The vertical position of the forward path, in pixels.
const LINE: f64 = 150.0;

/// Blocks of the signal flow: centre, size and text.
const BLOCKS: [(PixelPoint, (f64, f64), &str); 6] = [
    ((190.0, LINE), (80.0, 46.0), "K"),
    ((420.0, LINE), (80.0, 46.0), "1 / M"),
    ((550.0, LINE), (80.0, 46.0), "1 / s"),
    ((740.0, LINE), (80.0, 46.0), "1 / s"),
    ((430.0, 240.0), (80.0, 42.0), "f"),
    ((430.0, 315.0), (160.0, 46.0), "N / (1 + Tc s)"),
];

/// Arrows of the signal flow.
const WIRES: [&[PixelPoint]; 12] = [
    &[(20.0, LINE), (77.0, LINE)],
    &[(103.0, LINE), (150.0, LINE)],
    &[(230.0, LINE), (297.0, LINE)],
    &[(323.0, LINE), (380.0, LINE)],
    &[(460.0, LINE), (510.0, LINE)],
    &[(590.0, LINE), (700.0, LINE)],
    &[(780.0, LINE), (880.0, LINE)],
    &[(640.0, LINE), (640.0, 240.0), (470.0, 240.0)],
    &[(390.0, 240.0), (318.0, 240.0), (318.0, LINE + 13.0)],
    &[(640.0, 240.0), (640.0, 315.0), (510.0, 315.0)],
    &[(350.0, 315.0), (302.0, 315.0), (302.0, LINE + 13.0)],
    &[(830.0, LINE), (830.0, 395.0), (90.0, 395.0), (90.0, LINE + 13.0)],
];

/// Texts of the signal flow, with their positions.
const TEXTS: [(&str, PixelPoint); 10] = [
    ("xi", (24.0, LINE - 8.0)),
    ("e", (122.0, LINE - 8.0)),
    ("xo'", (650.0, LINE - 8.0)),
    ("xo", (850.0, LINE - 8.0)),
    ("+", (62.0, LINE - 8.0)),
    ("−", (72.0, LINE + 28.0)),
    ("+", (280.0, LINE - 8.0)),
    ("−", (286.0, LINE + 28.0)),
    ("−", (324.0, LINE + 28.0)),
    ("solid friction, N = Cn at the working point", (300.0, 358.0)),
];

/// Fig 9.7: the signal flow of the slideway, with its condition of stability.
fn signal_flow(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut sketch = Sketch::new(&figure.heading(), 430.0);
    WIRES.iter().for_each(|points| sketch.arrow(points, Ink::Line));
    BLOCKS.iter().for_each(|(middle, size, name)| sketch.block(*middle, *size, name));
    [90.0, 310.0].iter().for_each(|x| sketch.sum((*x, LINE)));
    [(640.0, LINE), (830.0, LINE), (640.0, 240.0)].iter().for_each(|place| sketch.dot(*place, Ink::Line));
    TEXTS.iter().for_each(|(text, place)| sketch.text(text, *place));
    let table = DrivenTable { damping: 10.71e3, ..DrivenTable::simulated(MEMORY) };
    let slope = table.critical_slope()? / N_S_PER_MM;
    let reading = format!(
        "the loop is stable if (M + f Tc)(K Tc + f + N) is larger than M K Tc; at 7.1 ms, if friction falls by less \
         than {slope:.1} N s/mm"
    );
    Ok(sketch
        .finish("M = 433 kg, K = 45 kN/mm, f = 10.71 N s/mm; N is negative where friction falls", reading))
}

/// Fig 9.8: the boundary of stability in the dimensionless numbers A, B and C.
///
/// The lines are -B = C + A C / (1 + C) (eq 36-9), with the sign of the study.
fn groups(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("A = K Tc² / M", ""), ("-B = Cn Tc / M", ""))
        .x_range(0.0, 70.0)
        .y_range(0.0, 30.0);
    for damping in [0.1, 0.2, 0.4, 0.6] {
        let points =
            sample_curve(linspace(0.0, 70.0, 2), |stiffness| Ok(Groups::boundary(stiffness, damping)))?;
        graph = graph.line(format!("C = f Tc / M = {damping}"), points);
    }
    let memories = [6.0, 10.0, 15.0, 20.0, 25.0];
    let mut dots = Vec::new();
    for memory in memories {
        let table = DrivenTable::simulated(memory * MS);
        let groups = table.groups(table.critical_slope()?)?;
        dots.push((groups.stiffness, groups.slope));
    }
    let mut graph = graph.dots("study's simulation, Tc in ms", dots.clone());
    for (index, memory) in memories.iter().enumerate() {
        graph = graph.label(index, format!("{memory}"));
    }
    let reading = format!(
        "the table is stable below a line; from 6 to 25 ms the table of the simulation moves from -B = {:.2} to \
         {:.1}; Tc has the largest effect",
        dots[0].1, dots[4].1
    );
    Ok(DrawnFigure::from_theory(
        vec![graph.picture()],
        "simulation: M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm",
        reading,
    ))
}

#[cfg(test)]
mod tests {
    use super::super::reading;

    #[test]
    #[ignore = "takes a minute and a half"]
    fn readings_agree_with_the_text() {
        assert!(reading("fig-9-01").contains("Tc^1.60 (printed: 1.55)"), "{}", reading("fig-9-01"));
        assert!(
            reading("fig-9-04").contains("eleven of twelve cells by at most 4 %"),
            "{}",
            reading("fig-9-04")
        );
        assert!(reading("fig-9-05").contains("correspond to 4.5, 6.7, 8.0 (by"), "{}", reading("fig-9-05"));
        assert!(reading("fig-9-02").contains("at 15 ms above 13.2"), "{}", reading("fig-9-02"));
        assert!(reading("fig-9-07").contains("58.4 N s/mm"), "{}", reading("fig-9-07"));
    }
}
