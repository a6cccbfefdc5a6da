//! The design chain: from oil, load, stiffness and surface to the critical velocity. The table of docs/slideway.md is worked out here.

use proptest::prelude::*;

use crate::common::pages::check_part;
use crate::common::random_cases;
use patchcord_analysis::instruments::{Criterion, NoCriticalVelocity, critical_velocity};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Backend, RunSettings};
use patchcord_thesis::chain::{
    Chain, ChainError, Compared, Inputs, Parameters, Settings, Simulation, Verdict, table_9_2,
};
use patchcord_thesis::slideway::ridge::Ridge;
use patchcord_thesis::slideway::units::{CM2, KGF, MM_PER_S, POISE, UM};

const PAGE: &str = "docs/slideway.md";

/// A table of 450 kgf on the study's slideway, oil of 0.34 P, and a drive of so many kN/mm.
fn inputs(stiffness: f64) -> Inputs {
    Inputs::of_study(0.34 * POISE, 450.0 * KGF, stiffness * 1e6)
}

fn chain(inputs: &Inputs, set: &[(&str, f64)]) -> Chain {
    made(inputs, set).unwrap_or_else(|error| panic!("{error}"))
}

fn made(inputs: &Inputs, set: &[(&str, f64)]) -> Result<Chain, ChainError> {
    let set = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Chain::new(inputs, &Settings { set, ..Settings::default() })
}

fn near(got: f64, wanted: f64, share: f64) {
    assert!((got / wanted - 1.0).abs() < share, "{got}, not {wanted}");
}

fn other(chain: &Chain, name: &str) -> f64 {
    let origin = chain.origins.iter().find(|origin| origin.name == name).unwrap();
    origin.other.clone().unwrap().value.unwrap()
}

#[test]
fn numbers_of_the_chain_are_those_of_its_equations() {
    let chain = chain(&inputs(20.0), &[]);
    let parameters = chain.simulation.parameters;
    let pressure: f64 = 450.0 / 697.0;
    near(
        parameters.static_friction,
        6970.0 * (0.009705 * pressure.powf(0.82) * 22.8 + pressure * 0.05),
        1e-5,
    );
    let lift: f64 = 5.47875;
    let base = pressure * lift.powf(2.478) / (18.7 * 0.34f64.powf(0.181));
    near(parameters.limit, 0.01 * base.powf(1.515), 1e-5);
    near(parameters.memory, 11.16e-3 * 0.34f64.powf(0.236), 1e-5);
    assert_eq!((parameters.mass, parameters.stiffness, parameters.damping), (450.0, 20e6, 10.7e3));
    near(other(&chain, "Fs"), 450.0 * KGF * 0.2914, 2e-3);
    near(other(&chain, "VcL"), 57.93e-3, 1e-3);
    near(other(&chain, "Tc"), 0.0318, 5e-3);
    near(other(&chain, "f"), 0.034 * 0.0697 * 0.51 * 5.47875f64.powf(0.23) / 5.47875e-6, 1e-3);
    assert!(chain.notes.is_empty(), "{:?}", chain.notes);
}

/// With the study's printed pressure, 0.615 kgf/cm2, eq 13-9 and 14-9 give what it prints.
#[test]
fn the_studys_own_pressure_gives_its_own_figures() {
    let area = 450.0 / 0.615 * CM2;
    let parameters = Parameters::of_design(&Inputs { area, ..inputs(20.0) }.design().unwrap()).unwrap();
    near(parameters.static_friction * 697.0 / (450.0 / 0.615), 1249.0, 1e-3);
    // Eq 14-9 rounds its base to 2.23.
    near(parameters.limit, 45.31e-3, 4e-3);
}

#[test]
fn surfaces_and_oil_come_in_where_the_text_has_them() {
    let rough = Inputs { ridge: Ridge { width: 50.0 * UM, height: 3.0 * UM }, ..inputs(20.0) };
    let (ground, rough) = (inputs(20.0).design().unwrap(), rough.design().unwrap());
    near(rough.interface.flank, 0.06, 1e-12);
    // Eq 137-7: a rise of Z by 0.5 um lifts by (2 l - B) / (2 l) of it.
    near(rough.lift - ground.lift, (2.0 - 0.005) / 2.0 * 0.5 * UM, 1e-9);
    let polar = Inputs { polar: true, ..inputs(20.0) };
    near(polar.design().unwrap().interface.polar / ground.interface.polar, 7.87 / 22.8, 1e-12);
    let chain = chain(&Inputs { stiffness: 27.6e6, ..polar }, &[]);
    assert_eq!(chain.simulation.critical.rising, Err(NoCriticalVelocity::Quiet));
    assert!(chain.predictions.printed.is_err() && chain.predictions.stability.is_err());
    assert!(chain.advice.iter().all(|advice| advice.verdict == Verdict::NothingToLower));
    assert!(chain.notes[0].contains("polar"), "{:?}", chain.notes);
}

#[test]
fn the_patch_it_writes_gives_the_same_run() {
    let chain = chain(&inputs(20.0), &[("v_rate", 2e-3)]);
    let file = tempfile::NamedTempFile::new().unwrap();
    chain.simulation.patch().write(file.path()).unwrap();
    let circuit = Circuit::new(&Patch::read(file.path()).unwrap(), &[]).unwrap();
    assert_eq!(circuit.warnings().to_string(), "");
    let trace = solve::run(&Program::new(&circuit).unwrap(), &RunSettings::of(&circuit).unwrap()).unwrap();
    assert!(trace == chain.simulation.trace);
    let [command, velocity] = ["v_i", "v_o"].map(|name| trace.values(name).unwrap());
    let read = critical_velocity(&trace.time, &command, &velocity, Criterion::USUAL);
    assert_eq!(read, chain.simulation.critical);
    assert!(read.rising.unwrap() > 2.0 * read.falling.unwrap());
}

#[test]
fn pots_are_set_as_the_text_sets_them() {
    let (inputs, set) = (
        Inputs::of_study(0.34 * POISE, 433.0 * KGF, 45e6),
        [("VcL", 2.54e-3), ("Tc", 0.0065), ("Fs", 771.0)],
    );
    let chain = chain(&inputs, &set);
    assert_eq!(chain.simulation.multiple, 1.0);
    let pots = chain.simulation.pots();
    let setting = |name: &str| pots.iter().find(|pot| pot.name == name).unwrap().setting;
    for (name, wanted) in [
        ("PC5", 0.252),
        ("PA3", 0.4124),
        ("PA4", 0.0599),
        ("PC2", 0.1),
        ("PA1", 0.1538),
        ("PC1", 0.5f64.sqrt()),
    ] {
        near(setting(name), wanted, 1e-3);
    }
    near(setting("PB1, PB2"), 771.0 / (771.0 + 50.0 * 45.36), 1e-9);
    // Fig 8.24 ends at 4.54 mm/s (docs/compromise.md).
    near(chain.simulation.critical.rising.unwrap(), 4.54e-3, 0.02);
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn larger_scales_leave_the_critical_velocity_and_take_a_limit_of_45_mm_s() {
    let first = chain(&inputs(20.0), &[("VcL", 45e-3)]);
    let further = chain(&inputs(20.0), &[("VcL", 45e-3), ("v_turn", 40.0)]);
    assert_eq!((first.simulation.multiple, further.simulation.multiple), (1.0, 5.0));
    for chain in [&first, &further] {
        assert_eq!(chain.simulation.trace.overloads().count(), 0);
    }
    let [one, other] = [first, further].map(|chain| chain.simulation.critical.rising.unwrap());
    assert!((one - other).abs() < 0.048e-3, "{one}, {other}");
}

/// Velocity overshoots the command so far that the scales which the command fits into are overloaded.
#[test]
fn an_overload_makes_the_scales_larger() {
    let chain = chain(&inputs(11.0), &[("v_turn", 18.0), ("Fs", 1990.0)]);
    assert!(chain.simulation.ramp.top() < 0.9 * 25.4e-3);
    assert!(chain.simulation.multiple > 1.0);
    assert_eq!(chain.simulation.trace.overloads().count(), 0);
}

#[test]
fn soft_drives_bear_every_advice_out() {
    let chain = chain(&inputs(20.0), &[]);
    let letters: String = chain.advice.iter().map(|advice| advice.letter).collect();
    assert_eq!(letters, "abcdefg");
    let before = chain.simulation.critical.rising.unwrap();
    for advice in &chain.advice {
        let outcome = advice.outcome.as_ref().unwrap();
        assert_eq!(advice.verdict, Verdict::Confirmed, "{}", advice.letter);
        assert!(outcome.critical.rising.unwrap() < before);
        assert!((advice.factor - 1.0).abs() - 0.1 < 1e-12);
    }
    let outcome = |letter: usize| chain.advice[letter].outcome.as_ref().unwrap().parameters;
    let own = chain.simulation.parameters;
    let [oil, weight, drive] = [0, 1, 2].map(outcome);
    assert!(oil.memory > own.memory && oil.limit < own.limit && oil.static_friction == own.static_friction);
    assert!(weight.memory > own.memory && weight.limit < own.limit && weight.mass == 405.0);
    assert_eq!(Parameters { stiffness: own.stiffness, ..drive }, own);
    near(drive.stiffness, 22e6, 1e-9);
}

/// What docs/slideway.md says beside the output of its command.
#[test]
fn the_example_does_what_is_said_of_it() {
    let chain = chain(&inputs(20.0), &[]);
    let heavier = chain.advice[1].outcome.as_ref().unwrap().printed.clone().unwrap();
    assert!(heavier > chain.predictions.printed.clone().unwrap());
    let sticking = chain.predictions.sticking.clone().unwrap().velocity;
    let [command, velocity] = ["v_i", "v_o"].map(|name| chain.simulation.trace.values(name).unwrap());
    let rises = command.windows(2).take_while(|pair| pair[1] > pair[0]).count();
    let slow = (0..rises).filter(|sample| (0.5e-3..sticking).contains(&command[*sample]));
    assert!(slow.clone().count() > 1000 && slow.clone().all(|sample| velocity[sample] > 0.0));
    let own_drag = Parameters { damping: 326.0, ..chain.simulation.parameters };
    let run = Simulation::new("", &own_drag, &Settings::default()).unwrap();
    near(run.critical.rising.unwrap(), 171.07e-3, 1e-3);
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn advice_that_a_run_does_not_bear_out_is_told() {
    let heavy = Inputs { weight: 850.0 * KGF, area: 1000.0 * CM2, viscosity: 0.13 * POISE, ..inputs(11.0) };
    let verdicts: Vec<_> = chain(&heavy, &[]).advice.iter().map(|advice| advice.verdict).collect();
    let mut wanted = [Verdict::Confirmed; 7];
    (wanted[4], wanted[6]) = (Verdict::NotConfirmed, Verdict::NotConfirmed);
    assert_eq!(verdicts, wanted);
}

/// Without an advice it oscillates up to 16.4 mm/s, beyond where the command turns back.
#[test]
fn advice_is_weighed_against_what_is_known_of_an_oscillation_that_has_not_ended() {
    let chain = chain(&inputs(20.0), &[("v_turn", 11.0)]);
    assert_eq!(
        chain.simulation.critical.rising,
        Err(NoCriticalVelocity::NotEnded(chain.simulation.ramp.top()))
    );
    let verdict = |letter| chain.advice.iter().find(|advice| advice.letter == letter).unwrap().verdict;
    let (e, g, a) = (verdict('e'), verdict('g'), verdict('a'));
    assert_eq!([e, g, a], [Verdict::Confirmed, Verdict::Confirmed, Verdict::NotRead]);
}

#[test]
fn what_is_set_stays_set() {
    let chain = chain(&inputs(20.0), &[("K", 21e6), ("v_rate", 2e-3), ("VcL", 40e-3)]);
    let parameters = chain.simulation.parameters;
    assert_eq!((parameters.stiffness, parameters.limit, chain.simulation.ramp.rate), (21e6, 40e-3, 2e-3));
    let verdict = |letter| chain.advice.iter().find(|advice| advice.letter == letter).unwrap().verdict;
    assert_eq!((verdict('c'), verdict('e')), (Verdict::NothingChanged, Verdict::NothingChanged));
    let origin = chain.origins.iter().find(|origin| origin.name == "K").unwrap();
    assert_eq!((origin.value, origin.from.as_str()), (21e6, "set"));
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn the_same_comes_out_whatever_the_threads_and_the_backend() {
    let with = |threads, backend| {
        let settings = Settings { threads, backend, ..Settings::default() };
        let chain = Chain::new(&inputs(20.0), &settings).unwrap();
        (format!("{:?}", chain.advice), chain.simulation.trace)
    };
    let (advice, trace) = with(1, Backend::Automatic);
    for (threads, backend) in [(2, Backend::Automatic), (7, Backend::Interpreter)] {
        let (again, same) = with(threads, backend);
        assert!(again == advice && same == trace, "{threads} {backend}");
    }
}

/// What dies away too slowly is not run longer and longer.
#[test]
#[ignore = "takes several seconds: chains of runs"]
fn next_to_no_damping_has_no_end_and_says_so() {
    for damping in [0.0, 10.0] {
        let chain = chain(&inputs(20.0), &[("f", damping)]);
        let Simulation { ramp, critical, parameters, .. } = &chain.simulation;
        let once = 1.25 * parameters.limit + 4e-3;
        assert!((once..once + 0.1 * ramp.rate + 1e-9).contains(&ramp.top()), "{ramp:?}");
        assert_eq!(critical.rising, Err(NoCriticalVelocity::NotEnded(ramp.top())));
        assert!(
            chain.notes.len() == 1 && chain.notes[0].contains(", beyond VcL, and comes down below VcL, "),
            "{:?}",
            chain.notes
        );
        assert!(chain.advice.iter().all(|advice| advice.verdict == Verdict::NotRead), "{:?}", chain.advice);
        // Friction is gone: what is left shrinks by e in 2 M / f. It swings about the command by as much as that.
        let least =
            2.0 * parameters.mass / damping * (ramp.top() / chain.simulation.criterion.threshold).ln();
        assert!((least..1.3 * least).contains(&chain.simulation.dies_in()) || damping == 0.0);
    }
}

/// Only what swings above VcL is left to the viscous coefficient.
#[test]
#[ignore = "takes several seconds: chains of runs"]
fn what_swings_above_vcl_is_told_how_long_it_lasts() {
    let notes = chain(&inputs(20.0), &[("f", 326.0), ("v_rate", 3e-3), ("v_turn", 57.0)]).notes;
    let told = "oscillation goes on at a command of 171 mm/s, beyond VcL; f = 326 N s/m takes 12.15 s at least to damp it";
    assert_eq!(notes, [told]);
}

#[test]
fn what_was_not_measured_is_extrapolated() {
    let beyond = chain(&Inputs { weight: 1000.0 * KGF, ..inputs(50.0) }, &[]);
    assert_eq!(
        beyond.notes[..2],
        [
            "table is 1000 kgf, and was measured at 450 and 850 kgf only: this extrapolates",
            "drive is 50 kN/mm, and was measured at 11 ... 45 kN/mm only: this extrapolates",
        ]
    );
}

#[test]
fn progress_is_told_up_to_the_end() {
    let mut told = Vec::new();
    let chain =
        Chain::watched(&inputs(20.0), &Settings::default(), |done, all| told.push((done, all))).unwrap();
    let all = 1 + chain.advice.len() as u64;
    assert_eq!(told.last(), Some(&(all, all)));
    assert!(told.is_sorted() && told.contains(&(1, all)), "{told:?}");
}

#[test]
fn what_makes_no_chain_is_told() {
    let base = inputs(20.0);
    let told = |inputs: Inputs, set: &[(&str, f64)]| made(&inputs, set).unwrap_err().to_string();
    let cases = [
        (told(Inputs { viscosity: 0.0, ..base }, &[]), "viscosity is 0 P, and must be 0.001 ... 1000"),
        (told(Inputs { viscosity: f64::NAN, ..base }, &[]), "viscosity is NaN P, and must be 0.001 ... 1000"),
        (told(Inputs { weight: -KGF, ..base }, &[]), "weight is -1 kgf, and must be above 0"),
        (told(Inputs { area: CM2, ..base }, &[]), "weight / area is 450 kgf/cm2, and must be 0.0001 ... 8"),
        (told(inputs(0.0), &[]), "stiffness is 0 kN/mm, and must be above 0"),
        (told(inputs(1.0), &[]), "K = 1 MN/m is below what the circuit of Fig 8.16 takes, 5 ... 178 MN/m"),
        (
            told(Inputs { weight: 20.0 * KGF, ..base }, &[]),
            "M = 20 kg is below what the circuit of Fig 8.16 takes, 180 ... 4000 kg",
        ),
        (
            told(Inputs { ridge: Ridge { width: 50.0 * UM, height: 0.0 }, ..base }, &[]),
            "height of a ridge is 0 um, and must be 0.001 ... 100000",
        ),
        (told(base, &[("k", 1.0)]), "the circuit of Fig 8.16 has no parameter k; did you mean \"K\"?"),
        (
            told(base, &[("v_turn", 4000.0)]),
            "v_turn = 4000 s is above what the circuit of Fig 8.16 takes, 0 ... 3600 s",
        ),
        (
            told(base, &[("v_rate", -1e-3)]),
            "the velocity command has to rise from rest or forward motion, which v_start = 0 m/s, v_rate = -0.001 m/s2 and v_turn = ",
        ),
        (
            told(base, &[("v_rate", 0.1)]),
            "the critical velocity cannot be read: the command alone changes by 3.9 mm/s within a window",
        ),
        (told(base, &[("Tc", 1e-4)]), "Tc = 0.1 ms is below what the circuit of Fig 8.16 takes, "),
        // From the least with the smallest scales to the largest with the largest.
        (
            told(base, &[("VcL", 15.0)]),
            "VcL = 15000 mm/s is above what the circuit of Fig 8.16 takes, 0.254 ... 10000 mm/s",
        ),
        (
            told(base, &[("VcL", 0.3e-3), ("v_turn", 40.0)]),
            "VcL = 0.3 mm/s is below what the circuit of Fig 8.16 takes with scales 5 times as large, which the command or what \
             overshoots it asks for: 1.27 ... 250 mm/s",
        ),
    ];
    for (told, wanted) in cases {
        assert!(told.starts_with(wanted), "{told}, not {wanted}");
    }
    let wrong = |settings: Settings| Chain::new(&base, &settings).unwrap_err().to_string();
    let settings = Settings::default;
    assert!(wrong(Settings { share: 1.0, ..settings() }).ends_with("must be between 0 and 1, not 1"));
    assert!(wrong(Settings { threshold: f64::NAN, ..settings() }).ends_with("must be above 0, not NaN"));
    assert!(wrong(Settings { window: Some(0.0), ..settings() }).ends_with("must be above 0, not 0"));
    let overloaded = wrong(Settings { step: Some(0.05), ..settings() });
    // By so long a step nothing is followed: it is rounding that says which amplifier comes first.
    assert!(overloaded.contains(" is overloaded even at 25.4 mm/s a volt: the motion"), "{overloaded}");
    assert!(wrong(Settings { every: Some(0.02), ..settings() }).contains("2 samples stand in a window"));
}

proptest! {
    #![proptest_config(random_cases(24))]

    #[test]
    #[ignore = "takes several seconds: chains of runs"]
    fn any_slideway_gives_a_chain_without_overload_or_is_refused(
        poise in 0.05..2.0f64, kilograms in 150.0..1500.0f64, stiffness in 4.0..200.0f64, area in 200.0..3000.0f64,
        polar in any::<bool>(), width in 30.0..80.0f64, height in 1.0..5.0f64,
    ) {
        let ridge = Ridge { width: width * UM, height: height * UM };
        let inputs = Inputs { area: area * CM2, polar, ridge, ..Inputs::of_study(poise * POISE, kilograms * KGF, stiffness * 1e6) };
        match made(&inputs, &[]) {
            Ok(chain) => {
                prop_assert_eq!(chain.simulation.trace.overloads().count(), 0);
                prop_assert_eq!(chain.advice.len(), 7);
                let critical = chain.simulation.critical;
                // Claim C13: rising above falling.
                if let (Ok(rising), Ok(falling)) = (critical.rising, critical.falling) {
                    prop_assert!(rising > falling, "{} {}", rising, falling);
                }
            }
            Err(ChainError::BeyondCircuit { .. }) => {}
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}

fn mm(velocity: Result<f64, NoCriticalVelocity>) -> String {
    match velocity {
        Ok(velocity) => format!("{:.2}", velocity / MM_PER_S),
        Err(NoCriticalVelocity::Quiet) => "none".to_owned(),
        Err(error) => panic!("{error}"),
    }
}

fn row(row: &Compared) -> String {
    let predicted =
        |said: &Result<f64, _>| said.as_ref().map_or("none".to_owned(), |velocity| mm(Ok(*velocity)));
    let cells = [
        format!("{}", row.cell.stiffness / 1e6),
        format!("{:.3}", row.cell.viscosity / POISE),
        mm(Ok(row.measured)),
        predicted(&row.equation),
        predicted(&row.stability),
        mm(row.run.rising),
        mm(row.nearby[0].rising),
        mm(row.run.falling),
        mm(row.own_memory.rising),
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// By what share the worst of these cells misses what was measured.
fn farthest(rows: &[Compared], got: impl Fn(&Compared) -> f64) -> f64 {
    rows.iter().map(|row| (got(row) / row.measured - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "takes several seconds: chains of runs"]
fn measured_critical_velocities_stand_beside_equation_and_run() {
    let rows = table_9_2(&Settings::default()).unwrap();
    let head = "| kN/mm | P | measured | eq 18-9 | Routh-Hurwitz | run, rising | at half the threshold | run, falling | with its own Tc |\n\
                |---|---|---|---|---|---|---|---|---|\n";
    let table: String = rows.iter().map(row).collect();
    check_part(PAGE, "T9-2", &format!("{head}{table}"), "patchcord-thesis");
    let (stiff, [middle, soft]) = (&rows[..4], [&rows[4..8], &rows[8..]]);
    assert!(farthest(middle, |row| row.run.rising.unwrap()) < 0.25);
    assert!(farthest(middle, |row| row.own_memory.rising.unwrap()) < 0.10);
    assert!(farthest(middle, |row| row.nearby[0].rising.unwrap()) < 0.19);
    assert!(stiff.iter().all(|row| row.run.rising.unwrap() < 1e-3 && row.stability.is_err()));
    let missed = rows.iter().filter(|row| (row.equation.clone().unwrap() / row.measured - 1.0).abs() > 0.21);
    assert_eq!(missed.map(|row| row.cell.viscosity / POISE).collect::<Vec<_>>(), [0.13; 2]);
    let ratios = soft.iter().map(|row| row.run.rising.unwrap() / row.measured);
    assert!(ratios.clone().all(|ratio| (1.39..4.36).contains(&ratio)), "{:?}", ratios.collect::<Vec<_>>());
}
