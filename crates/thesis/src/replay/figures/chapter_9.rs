//! Chapter 9: what analysis makes of the simulation, up to Routh and Hurwitz (9.2 ... 9.4 (i)).

use super::chapter_9_simulated::slopes_of_the_circuit;
use super::graph::{by_ratio, curve, evenly};
use super::sketch::{Place, Sketch};
use super::{Drawn, Figure, Graph};
use crate::replay::recipe::Problem;
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
        title: "boundary of stability in numbers without unit",
        claims: &["9-060", "9-063.a", "9-063.b", "9-070"],
        draw: groups,
    },
];

/// Time constants that the simulation set, in s.
const MEMORIES: (f64, f64) = (6e-3, 25e-3);

fn routh_hurwitz(memory: f64) -> Result<f64, SlidewayError> {
    Ok(DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM)
}

fn slope_by_memory(figure: &Figure) -> Result<Drawn, Problem> {
    let memories = by_ratio(MEMORIES.0, MEMORIES.1, 61);
    let in_ms = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x / MS, y)).collect::<Vec<_>>();
    let theory = curve(memories.clone(), routh_hurwitz)?;
    let printed = curve(by_ratio(MEMORIES.0, MEMORIES.1, 9), |memory| Ok(PRINTED_BY_MEMORY.at(memory)))?;
    let simulated = curve(memories, |memory| Ok(SLOPE_BY_MEMORY.at(memory)))?;
    let graph = Graph::new("(a) laws", ("time constant Tc", "ms"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .across(5.0, 30.0)
        .up(20.0, 500.0)
        .line("study's simulation: 7.5e4 Tc^1.54 (1-9)", in_ms(simulated))
        .line("Routh-Hurwitz (32-9)", in_ms(theory))
        .dots("its printed fit (37-9)", in_ms(printed));
    let [short, long] = [MEMORIES.0, MEMORIES.1]
        .map(|memory| -> Result<f64, Problem> { Ok(routh_hurwitz(memory)? / SLOPE_BY_MEMORY.at(memory)) });
    let all: Vec<f64> = by_ratio(MEMORIES.0, MEMORIES.1, 9).collect();
    let fitted = DrivenTable::simulated(0.0).slope_by_memory(&all)?;
    let reading = format!(
        "both rise alike; Routh-Hurwitz, with Tc^{:.2} (printed: 1.55), lies {:.2} times as high at 6 ms, {:.2} at 25 ms",
        fitted.exponent, short?, long?
    );
    let run = slopes_of_the_circuit()?;
    let pictures = [graph.picture()].into_iter().chain(run.pictures).collect();
    let drawn = Drawn::of_sweeps(figure, &[run.sweep], pictures, format!("{reading}; {}", run.reading))?;
    Ok(Drawn { table: Some(run.table), ..drawn })
}

fn boundary(figure: &Figure) -> Result<Drawn, Problem> {
    let static_friction = FallingFriction::simulated(1.0).static_friction;
    let limit = |slope: f64| Ok(stable_limit(static_friction, slope * N_S_PER_MM)? / MM_PER_S);
    let simulated = |memory: f64| limit(SLOPE_BY_MEMORY.at(memory * MS));
    let theory = |memory: f64| limit(routh_hurwitz(memory * MS)?);
    let memories = || evenly(MEMORIES.0 / MS, MEMORIES.1 / MS, 96);
    let graph = Graph::new(&figure.heading(), ("time constant Tc", "ms"), ("VcL", "mm/s"))
        .divided(5.0, 25.0, 10)
        .up(0.0, 60.0)
        .line("VcL = 2 Fs / (7.5e4 Tc^1.54) (3-9)", curve(memories(), simulated)?)
        .label(20, "above: stable, below: may oscillate")
        .line("by Routh-Hurwitz (32-9)", curve(memories(), theory)?);
    let reading = format!(
        "at 7.1 ms all is stable above a VcL of {:.1} mm/s, by Routh-Hurwitz above {:.1}; at 15 ms above {:.1} and {:.1}",
        simulated(7.1)?,
        theory(7.1)?,
        simulated(15.0)?,
        theory(15.0)?
    );
    let settings = "Fs = 771 N, M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm";
    Ok(Drawn::of_theory(vec![graph.picture()], settings, reading))
}

/// The time constant of Fig 8.35, in s.
const MEMORY: f64 = 7.1e-3;

fn slope_by_stiffness(figure: &Figure) -> Result<Drawn, Problem> {
    let theory = |stiffness: f64| {
        let table = DrivenTable { stiffness: stiffness * 1e3 * N_PER_MM, ..DrivenTable::simulated(MEMORY) };
        Ok(table.critical_slope()? / N_S_PER_MM)
    };
    let stiffnesses = || by_ratio(10.0, 60.0, 61);
    let simulated = |stiffness: f64| Ok(SLOPE_BY_STIFFNESS.at(stiffness * 1e3));
    let printed = |stiffness: f64| Ok(PRINTED_BY_STIFFNESS.at(stiffness * 1e3));
    let graph = Graph::new(&figure.heading(), ("stiffness K", "kN/mm"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .across(10.0, 60.0)
        .up(20.0, 100.0)
        .line("study's simulation: 16 K^0.077 (5-9)", curve(stiffnesses(), simulated)?)
        .line("Routh-Hurwitz (32-9)", curve(stiffnesses(), theory)?)
        .dots("its printed fit (38-9)", curve(by_ratio(11.0, 45.0, 6), printed)?);
    let reading = format!(
        "from 11 to 45 kN/mm the slope grows by {:.0} % on the simulation's line and by {:.0} % by Routh-Hurwitz: they do not agree, as the text says",
        100.0 * (simulated(45.0)? / simulated(11.0)? - 1.0),
        100.0 * (theory(45.0)? / theory(11.0)? - 1.0)
    );
    let settings = "M = 433 kg, f = 10.7 N s/mm, Tc = 7.1 ms";
    Ok(Drawn::of_theory(vec![graph.picture()], settings, reading))
}

/// Stiffnesses of Table T9-2, in kN/mm.
const DRIVES: [f64; 3] = [45.0, 27.6, 11.0];

/// The cell of Table T9-2 beside which a critical velocity is printed that does not go with it, and that velocity in m/s.
const MISPRINTED: usize = 8;
const PRINTED_VELOCITY: f64 = 16.0 * MM_PER_S;

/// Cells of Table T9-2 with a drive in kN/mm.
fn measured_with(drive: f64) -> impl Iterator<Item = &'static Measurement> {
    TABLE_9_2.iter().filter(move |cell| (cell.stiffness / 1e6 - drive).abs() < 0.01)
}

fn memory_by_viscosity(figure: &Figure) -> Result<Drawn, Problem> {
    let law = |oil: OilLaw| curve(by_ratio(0.1, 1.0, 2), move |poise| Ok(oil.memory(poise * POISE)? / MS));
    let mut graph = Graph::new(&figure.heading(), ("viscosity", "P"), ("time constant Tc", "ms"))
        .logarithmic(true, true)
        .across(0.1, 1.0)
        .up(4.0, 12.0);
    for drive in DRIVES {
        let cells = measured_with(drive).map(|cell| (cell.viscosity / POISE, cell.memory / MS)).collect();
        graph = graph.dots(format!("450 kgf, {drive} kN/mm (T9-2)"), cells);
    }
    let misprinted = &TABLE_9_2[MISPRINTED];
    let meant =
        memory_from_critical_velocity(&misprinted.friction(), PRINTED_VELOCITY, misprinted.stiffness)?;
    let graph =
        graph.dots("from the 16 mm/s printed there", vec![(misprinted.viscosity / POISE, meant / MS)]);
    let graph = graph
        .line("450 kgf: 11.16 η^0.236 (17-9)", law(OilLaw::AT_450_KGF)?)
        .line("850 kgf: 8.3 η^0.183 (20-9)", law(OilLaw::AT_850_KGF)?);
    let misses = TABLE_9_2.iter().map(|cell| -> Result<f64, SlidewayError> {
        Ok((cell.memory / OilLaw::AT_450_KGF.memory(cell.viscosity)? - 1.0).abs())
    });
    let mut misses = misses.collect::<Result<Vec<_>, _>>()?;
    misses.sort_by(f64::total_cmp);
    let reading = format!(
        "the line of 450 kgf misses eleven of twelve cells by at most {:.0} %, and by {:.0} % the one for which 16 mm/s are printed, which make it {:.2} ms",
        100.0 * misses[10],
        100.0 * misses[11],
        meant / MS
    );
    let settings = "each Tc from a measured critical velocity by eq 15-9, Fs = 1249 N; the measurements at 850 kgf are lost";
    Ok(Drawn::of_theory(vec![graph.picture()], settings, reading))
}

/// Critical velocity in mm/s by viscosity in P, for an oil law, static friction in N and a pressure in kgf/cm2 (eq 18-9, 21-9).
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

/// Pressures as the study has them, in kgf/cm2; 450 and 850 kgf on 697 cm2 make 0.646 and 1.22.
const PRESSURES: [f64; 2] = [0.615, 1.18];

fn velocity_at_450_kgf(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("viscosity", "P"), ("critical velocity Vc", "mm/s"))
        .across(0.0, 0.7)
        .up(0.0, 30.0);
    let (mut told, mut from) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let law = velocity_by_viscosity(OilLaw::AT_450_KGF, STATIC_FRICTION, PRESSURES[0], drive);
        graph = graph.line(format!("{drive} kN/mm (18-9)"), curve(evenly(0.1, 0.65, 111), &law)?);
        told.push(format!("{:.1}", law(0.34)?));
        let cells = measured_with(drive).map(|cell| -> Result<(f64, f64), SlidewayError> {
            Ok((cell.viscosity / POISE, cell.critical_velocity()? / MM_PER_S))
        });
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        from.push(format!("{:.1}", cells[1].1));
        graph = graph.dots(format!("measured, {drive} (T9-2)"), cells);
    }
    let graph = graph.label(0, "0.0059 s of T9-2; printed beside it: 16 mm/s");
    let reading = format!(
        "at 0.34 P {} mm/s for 45, 27.6 and 11 kN/mm, and {} behind the Tc of T9-2 (eq 15-9 backwards: the measurements are lost)",
        told.join(", "),
        from.join(", ")
    );
    let settings = "Pw = 0.615 kgf/cm², Fs = 1249 N, Ho + hd = 5.48 µm";
    Ok(Drawn::of_theory(vec![graph.picture()], settings, reading))
}

fn velocity_at_850_kgf(figure: &Figure) -> Result<Drawn, Problem> {
    let static_friction = Interface::MODEL.static_friction(PRESSURES[1] * KGF_PER_CM2)?;
    let mut graph =
        Graph::new(&figure.heading(), ("viscosity", "P"), ("critical velocity Vc", "mm/s")).across(0.0, 0.7);
    let (mut told, mut before) = (Vec::new(), Vec::new());
    for drive in DRIVES {
        let law = velocity_by_viscosity(OilLaw::AT_850_KGF, static_friction, PRESSURES[1], drive);
        graph = graph.line(format!("{drive} kN/mm (21-9)"), curve(evenly(0.1, 0.65, 111), &law)?);
        told.push(format!("{:.1}", law(0.34)?));
        let lighter = velocity_by_viscosity(OilLaw::AT_450_KGF, STATIC_FRICTION, PRESSURES[0], drive);
        before.push(format!("{:.1}", lighter(0.34)?));
    }
    let reading = format!(
        "at 0.34 P {} mm/s for 45, 27.6 and 11 kN/mm, {} under 450 kgf: more weight tells on soft drives; the measurements are lost",
        told.join(", "),
        before.join(", ")
    );
    let settings = format!("Pw = 1.18 kgf/cm², Fs = {static_friction:.0} N (13-9), Ho + hd kept at 5.48 µm");
    Ok(Drawn::of_theory(vec![graph.picture()], &settings, reading))
}

/// The height of the forward path, and what is drawn of the signal flow.
const LINE: f64 = 150.0;

const BLOCKS: [(Place, (f64, f64), &str); 6] = [
    ((190.0, LINE), (80.0, 46.0), "K"),
    ((420.0, LINE), (80.0, 46.0), "1 / M"),
    ((550.0, LINE), (80.0, 46.0), "1 / s"),
    ((740.0, LINE), (80.0, 46.0), "1 / s"),
    ((430.0, 240.0), (80.0, 42.0), "f"),
    ((430.0, 315.0), (160.0, 46.0), "N / (1 + Tc s)"),
];

const WIRES: [&[Place]; 12] = [
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

const TEXTS: [(&str, Place); 10] = [
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

fn signal_flow(figure: &Figure) -> Result<Drawn, Problem> {
    let mut sketch = Sketch::new(&figure.heading(), 430.0);
    WIRES.iter().for_each(|points| sketch.arrow(points, Ink::Line));
    BLOCKS.iter().for_each(|(middle, size, name)| sketch.block(*middle, *size, name));
    [90.0, 310.0].iter().for_each(|x| sketch.sum((*x, LINE)));
    [(640.0, LINE), (830.0, LINE), (640.0, 240.0)].iter().for_each(|place| sketch.dot(*place, Ink::Line));
    TEXTS.iter().for_each(|(text, place)| sketch.text(text, *place));
    let table = DrivenTable { damping: 10.71e3, ..DrivenTable::simulated(MEMORY) };
    let slope = table.critical_slope()? / N_S_PER_MM;
    let reading = format!(
        "stable as long as (M + f Tc)(K Tc + f + N) is more than M K Tc: at 7.1 ms while friction falls by less than {slope:.1} N s/mm"
    );
    Ok(sketch.drawn("M = 433 kg, K = 45 kN/mm, f = 10.71 N s/mm; N is below 0 where friction falls", reading))
}

fn groups(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("A = K Tc² / M", ""), ("-B = Cn Tc / M", ""))
        .across(0.0, 70.0)
        .up(0.0, 30.0);
    for damping in [0.1, 0.2, 0.4, 0.6] {
        let points = curve(evenly(0.0, 70.0, 2), |stiffness| Ok(Groups::boundary(stiffness, damping)))?;
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
        "below a line all is stable; from 6 to 25 ms the table of the simulation goes from -B = {:.2} to {:.1}: Tc moves it most",
        dots[0].1, dots[4].1
    );
    Ok(Drawn::of_theory(
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
    fn what_is_read_off_is_what_the_text_reads() {
        assert!(reading("fig-9-01").contains("Tc^1.60 (printed: 1.55)"), "{}", reading("fig-9-01"));
        assert!(
            reading("fig-9-04").contains("eleven of twelve cells by at most 4 %"),
            "{}",
            reading("fig-9-04")
        );
        assert!(reading("fig-9-05").contains("and 4.5, 6.7, 8.0 behind"), "{}", reading("fig-9-05"));
        assert!(reading("fig-9-02").contains("at 15 ms above 13.2"), "{}", reading("fig-9-02"));
        assert!(reading("fig-9-07").contains("58.4 N s/mm"), "{}", reading("fig-9-07"));
    }
}
