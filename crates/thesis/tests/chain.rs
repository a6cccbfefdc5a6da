//! Tests of the design chain from oil, load, stiffness and surface to the critical velocity. They also write the
//! table of docs/slideway.md.

mod errors;
mod parameters;

use proptest::prelude::*;

use crate::common::pages::assert_part_up_to_date;
use crate::common::random_cases;
use patchcord_analysis::instruments::{Criterion, CriticalVelocityError, critical_velocity};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Backend, RunSettings};
use patchcord_thesis::chain::{
    AdviceVerdict, Chain, ChainError, Inputs, MeasurementComparison, Parameters, Settings, Simulation,
    table_9_2,
};
use patchcord_thesis::slideway::ridge::Ridge;
use patchcord_thesis::slideway::units::{CM2, KGF, MM_PER_S, POISE, UM};

/// The page whose table of measured velocities is generated.
const PAGE: &str = "docs/slideway.md";

/// A table of 450 kgf on the thesis's slideway with oil of 0.34 P, and a drive stiffness in kN/mm.
fn inputs(stiffness: f64) -> Inputs {
    Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, stiffness * 1e6)
}

/// The chain for these inputs with some parameters set, in SI units. Panics if it fails.
fn chain(inputs: &Inputs, set: &[(&str, f64)]) -> Chain {
    try_chain(inputs, set).unwrap_or_else(|error| panic!("{error}"))
}

/// The chain for these inputs with some parameters set, or its error.
fn try_chain(inputs: &Inputs, set: &[(&str, f64)]) -> Result<Chain, ChainError> {
    let set = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Chain::new(inputs, &Settings { set, ..Settings::default() })
}

/// Asserts that two numbers agree within a relative tolerance.
fn assert_close(got: f64, expected: f64, tolerance: f64) {
    assert!((got / expected - 1.0).abs() < tolerance, "got {got}, expected {expected}");
}

#[test]
fn written_patch_gives_the_same_run() {
    let chain = chain(&inputs(20.0), &[("v_rate", 2e-3)]);
    let file = tempfile::NamedTempFile::new().unwrap();
    chain.simulation.patch().write(file.path()).unwrap();
    let circuit = Circuit::new(&Patch::read(file.path()).unwrap()).unwrap();
    assert_eq!(circuit.warnings().to_string(), "");
    let trace = solve::run(&Program::new(&circuit).unwrap(), &RunSettings::of(&circuit).unwrap()).unwrap();
    assert!(trace == chain.simulation.trace);
    let [command, velocity] = ["v_i", "v_o"].map(|name| trace.values(name).unwrap());
    let read = critical_velocity(&trace.time, &command, &velocity, Criterion::USUAL);
    assert_eq!(read, chain.simulation.critical);
    assert!(read.rising.unwrap() > 2.0 * read.falling.unwrap());
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn larger_scales_permit_45_mm_s_with_the_same_critical_velocity() {
    let first = chain(&inputs(20.0), &[("VcL", 45e-3)]);
    let further = chain(&inputs(20.0), &[("VcL", 45e-3), ("v_turn", 40.0)]);
    assert_eq!((first.simulation.multiple, further.simulation.multiple), (1.0, 5.0));
    for chain in [&first, &further] {
        assert_eq!(chain.simulation.trace.overloads().count(), 0);
    }
    let [small, large] = [first, further].map(|chain| chain.simulation.critical.rising.unwrap());
    assert!((small - large).abs() < 0.048e-3, "{small}, {large}");
}

/// The scales are sufficient for the command, and the overshoot of velocity overloads them.
#[test]
fn overload_selects_larger_scales() {
    let chain = chain(&inputs(11.0), &[("v_turn", 18.0), ("Fs", 1990.0)]);
    assert!(chain.simulation.ramp.top() < 0.9 * 25.4e-3);
    assert!(chain.simulation.multiple > 1.0);
    assert_eq!(chain.simulation.trace.overloads().count(), 0);
}

#[test]
fn every_rule_is_confirmed_for_a_soft_drive() {
    let chain = chain(&inputs(20.0), &[]);
    let letters: String = chain.advice.iter().map(|advice| advice.letter).collect();
    assert_eq!(letters, "abcdefg");
    let before = chain.simulation.critical.rising.unwrap();
    for advice in &chain.advice {
        let outcome = advice.outcome.as_ref().unwrap();
        assert_eq!(advice.verdict, AdviceVerdict::Confirmed, "{}", advice.letter);
        assert!(outcome.critical.rising.unwrap() < before);
        assert!((advice.factor - 1.0).abs() - 0.1 < 1e-12);
    }
    let outcome = |letter: usize| chain.advice[letter].outcome.as_ref().unwrap().parameters;
    let unchanged = chain.simulation.parameters;
    let [oil, weight, drive] = [0, 1, 2].map(outcome);
    assert!(
        oil.memory > unchanged.memory
            && oil.limit < unchanged.limit
            && oil.static_friction == unchanged.static_friction
    );
    assert!(weight.memory > unchanged.memory && weight.limit < unchanged.limit && weight.mass == 405.0);
    assert_eq!(Parameters { stiffness: unchanged.stiffness, ..drive }, unchanged);
    assert_close(drive.stiffness, 22e6, 1e-9);
}

/// The statements of docs/slideway.md on its example.
#[test]
#[ignore = "takes several seconds: chains of runs"]
fn example_agrees_with_the_page() {
    let chain = chain(&inputs(20.0), &[]);
    let heavier = chain.advice[1].outcome.as_ref().unwrap().printed.clone().unwrap();
    assert!(heavier > chain.predictions.printed.clone().unwrap());
    let sticking = chain.predictions.sticking.clone().unwrap().velocity;
    let [command, velocity] = ["v_i", "v_o"].map(|name| chain.simulation.trace.values(name).unwrap());
    let rises = command.windows(2).take_while(|pair| pair[1] > pair[0]).count();
    let slow = (0..rises).filter(|sample| (0.5e-3..sticking).contains(&command[*sample]));
    assert!(slow.clone().count() > 1000 && slow.clone().all(|sample| velocity[sample] > 0.0));
    let oil_drag = Parameters { damping: 326.0, ..chain.simulation.parameters };
    let run = Simulation::new("", &oil_drag, &Settings::default()).unwrap();
    assert_close(run.critical.rising.unwrap(), 171.07e-3, 1e-3);
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn rules_that_a_run_does_not_confirm_are_reported() {
    let heavy = Inputs { weight: 850.0 * KGF, area: 1000.0 * CM2, viscosity: 0.13 * POISE, ..inputs(11.0) };
    let verdicts: Vec<_> = chain(&heavy, &[]).advice.iter().map(|advice| advice.verdict).collect();
    let mut expected = [AdviceVerdict::Confirmed; 7];
    (expected[4], expected[6]) = (AdviceVerdict::NotConfirmed, AdviceVerdict::NotConfirmed);
    assert_eq!(verdicts, expected);
}

/// The unchanged design oscillates up to 16.4 mm/s, which is above the turn of the command.
#[test]
fn rules_are_judged_by_bounds_if_oscillation_has_not_ended() {
    let chain = chain(&inputs(20.0), &[("v_turn", 11.0)]);
    assert_eq!(
        chain.simulation.critical.rising,
        Err(CriticalVelocityError::NotEnded(chain.simulation.ramp.top()))
    );
    let verdict = |letter| chain.advice.iter().find(|advice| advice.letter == letter).unwrap().verdict;
    let (e, g, a) = (verdict('e'), verdict('g'), verdict('a'));
    assert_eq!([e, g, a], [AdviceVerdict::Confirmed, AdviceVerdict::Confirmed, AdviceVerdict::NotRead]);
}

#[test]
fn set_parameters_are_kept() {
    let chain = chain(&inputs(20.0), &[("K", 21e6), ("v_rate", 2e-3), ("VcL", 40e-3)]);
    let parameters = chain.simulation.parameters;
    assert_eq!((parameters.stiffness, parameters.limit, chain.simulation.ramp.rate), (21e6, 40e-3, 2e-3));
    let verdict = |letter| chain.advice.iter().find(|advice| advice.letter == letter).unwrap().verdict;
    assert_eq!((verdict('c'), verdict('e')), (AdviceVerdict::NothingChanged, AdviceVerdict::NothingChanged));
    let origin = chain.origins.iter().find(|origin| origin.name == "K").unwrap();
    assert_eq!((origin.value, origin.from.as_str()), (21e6, "set"));
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn results_do_not_depend_on_threads_and_backend() {
    let run_with = |threads, backend| {
        let settings = Settings { threads, backend, ..Settings::default() };
        let chain = Chain::new(&inputs(20.0), &settings).unwrap();
        (format!("{:?}", chain.advice), chain.simulation.trace)
    };
    let (advice, trace) = run_with(1, Backend::Automatic);
    for (threads, backend) in [(2, Backend::Automatic), (7, Backend::Interpreter)] {
        let (again, same) = run_with(threads, backend);
        assert!(again == advice && same == trace, "{threads} {backend}");
    }
}

/// A run is not extended if oscillation decays too slowly.
#[test]
#[ignore = "takes several seconds: chains of runs"]
fn tiny_damping_gives_no_end_and_a_note() {
    for damping in [0.0, 10.0] {
        let chain = chain(&inputs(20.0), &[("f", damping)]);
        let Simulation { ramp, critical, parameters, .. } = &chain.simulation;
        let once = 1.25 * parameters.limit + 4e-3;
        assert!((once..once + 0.1 * ramp.rate + 1e-9).contains(&ramp.top()), "{ramp:?}");
        assert_eq!(critical.rising, Err(CriticalVelocityError::NotEnded(ramp.top())));
        assert!(
            chain.notes.len() == 1 && chain.notes[0].contains(", above VcL, and velocity falls below VcL, "),
            "{:?}",
            chain.notes
        );
        assert!(
            chain.advice.iter().all(|advice| advice.verdict == AdviceVerdict::NotRead),
            "{:?}",
            chain.advice
        );
        // Without friction the amplitude falls by the factor e in 2 M / f. The initial amplitude is about the command.
        let minimum =
            2.0 * parameters.mass / damping * (ramp.top() / chain.simulation.criterion.threshold).ln();
        assert!((minimum..1.3 * minimum).contains(&chain.simulation.min_decay_time()) || damping == 0.0);
    }
}

/// Only the viscous coefficient damps a swing above VcL.
#[test]
#[ignore = "takes several seconds: chains of runs"]
fn note_gives_the_decay_time_of_swings_above_vcl() {
    let notes = chain(&inputs(20.0), &[("f", 326.0), ("v_rate", 3e-3), ("v_turn", 57.0)]).notes;
    let note = "oscillation continues at a command of 171 mm/s, above VcL; \
                f = 326 N s/m needs at least 12.15 s to damp it";
    assert_eq!(notes, [note]);
}

#[test]
fn notes_name_extrapolated_inputs() {
    let extrapolated = chain(&Inputs { weight: 1000.0 * KGF, ..inputs(50.0) }, &[]);
    assert_eq!(
        extrapolated.notes[..2],
        [
            "table is 1000 kgf, measured only at 450 and 850 kgf: the result is extrapolated",
            "drive is 50 kN/mm, measured only at 11 ... 45 kN/mm: the result is extrapolated",
        ]
    );
}

#[test]
fn progress_is_reported_up_to_the_end() {
    let mut progress = Vec::new();
    let chain =
        Chain::with_progress(&inputs(20.0), &Settings::default(), |done, all| progress.push((done, all)))
            .unwrap();
    let all = 1 + chain.advice.len() as u64;
    assert_eq!(progress.last(), Some(&(all, all)));
    assert!(progress.is_sorted() && progress.contains(&(1, all)), "{progress:?}");
}

proptest! {
    #![proptest_config(random_cases(24))]

    #[test]
    #[ignore = "takes several seconds: chains of runs"]
    fn random_slideways_give_no_overload_or_an_error(
        poise in 0.05..2.0f64, kilograms in 150.0..1500.0f64, stiffness in 4.0..200.0f64, area in 200.0..3000.0f64,
        polar in any::<bool>(), width in 30.0..80.0f64, height in 1.0..5.0f64,
    ) {
        let ridge = Ridge { width: width * UM, height: height * UM };
        let thesis = Inputs::of_thesis(poise * POISE, kilograms * KGF, stiffness * 1e6);
        let inputs = Inputs { area: area * CM2, polar, ridge, ..thesis };
        match try_chain(&inputs, &[]) {
            Ok(chain) => {
                prop_assert_eq!(chain.simulation.trace.overloads().count(), 0);
                prop_assert_eq!(chain.advice.len(), 7);
                let critical = chain.simulation.critical;
                // The thesis states that the rising critical velocity is above the falling one.
                if let (Ok(rising), Ok(falling)) = (critical.rising, critical.falling) {
                    prop_assert!(rising > falling, "{} {}", rising, falling);
                }
            }
            Err(ChainError::OutsideCircuitRange { .. }) => {}
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}

/// A critical velocity in mm/s, or "none".
fn mm(velocity: Result<f64, CriticalVelocityError>) -> String {
    match velocity {
        Ok(velocity) => format!("{:.2}", velocity / MM_PER_S),
        Err(CriticalVelocityError::NoOscillation) => "none".to_owned(),
        Err(error) => panic!("{error}"),
    }
}

/// A row of the table in docs/slideway.md.
fn row(row: &MeasurementComparison) -> String {
    let predicted = |prediction: &Result<f64, _>| {
        prediction.as_ref().map_or("none".to_owned(), |velocity| mm(Ok(*velocity)))
    };
    let cells = [
        format!("{}", row.cell.stiffness / 1e6),
        format!("{:.3}", row.cell.viscosity / POISE),
        mm(Ok(row.measured)),
        predicted(&row.equation),
        predicted(&row.stability),
        mm(row.run.rising),
        mm(row.nearby_thresholds[0].rising),
        mm(row.run.falling),
        mm(row.with_cell_memory.rising),
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// The largest relative deviation from the measured velocity in these cells.
fn max_deviation(rows: &[MeasurementComparison], got: impl Fn(&MeasurementComparison) -> f64) -> f64 {
    rows.iter().map(|row| (got(row) / row.measured - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn measured_critical_velocities_are_compared_with_equation_and_run() {
    let rows = table_9_2(&Settings::default()).unwrap();
    let head = "| kN/mm | P | measured | eq 18-9 | Routh-Hurwitz | run, rising | at half the threshold | \
                run, falling | with the Tc of the cell |\n\
                |---|---|---|---|---|---|---|---|---|\n";
    let table: String = rows.iter().map(row).collect();
    assert_part_up_to_date(PAGE, "T9-2", &format!("{head}{table}"), "patchcord-thesis");
    let (stiff, [middle, soft]) = (&rows[..4], [&rows[4..8], &rows[8..]]);
    assert!(max_deviation(middle, |row| row.run.rising.unwrap()) < 0.25);
    assert!(max_deviation(middle, |row| row.with_cell_memory.rising.unwrap()) < 0.10);
    assert!(max_deviation(middle, |row| row.nearby_thresholds[0].rising.unwrap()) < 0.19);
    assert!(stiff.iter().all(|row| row.run.rising.unwrap() < 1e-3 && row.stability.is_err()));
    let deviating =
        rows.iter().filter(|row| (row.equation.clone().unwrap() / row.measured - 1.0).abs() > 0.21);
    assert_eq!(deviating.map(|row| row.cell.viscosity / POISE).collect::<Vec<_>>(), [0.13; 2]);
    let ratios = soft.iter().map(|row| row.run.rising.unwrap() / row.measured);
    assert!(ratios.clone().all(|ratio| (1.39..4.36).contains(&ratio)), "{:?}", ratios.collect::<Vec<_>>());
}
