//! Compares kernels with the programs from which they were specialised, one evaluation at a time.

#[path = "../../tests/common/mod.rs"]
mod common;
mod lanes;
#[cfg(feature = "native")]
mod native;

use std::sync::Arc;

use super::store::{Kernels, MIN_LANES_OVER_NATIVE, native_threshold};
use super::{AmplifierState, Frame, IntervalWatch, Kernel, LANES, Specialisation, WatchCondition};
use crate::delay_line::DelayLine;
use crate::ir::{Program, Register, Scratch, Sources};
use crate::patch::Patch;
use common::circuits;
use common::random::SplitMix64;

fn program(patch: &Patch) -> Program {
    common::program(patch, &[])
}

/// A program at random points, with the modes and amplifier states that apply there.
struct Points<'p> {
    program: &'p Program,
    coefficients: Vec<f64>,
    registers: Vec<f64>,
    modes: Vec<f64>,
    amplifiers: Vec<AmplifierState>,
    states: Vec<f64>,
    sampled: Vec<f64>,
    levels: Vec<f64>,
    time: f64,
}

impl<'p> Points<'p> {
    fn new(program: &'p Program) -> Self {
        let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
        Points {
            program,
            coefficients: program.prepare(&parameters),
            registers: vec![0.0; program.lowered.body.len()],
            modes: program.lowered.modes.iter().map(|mode| mode.initial).collect(),
            amplifiers: vec![AmplifierState::Within; program.lowered.lamps.len()],
            states: Vec::new(),
            sampled: Vec::new(),
            levels: Vec::new(),
            time: 0.0,
        }
    }

    /// Draws a point near initial condition, where amplifiers of large gain stay in range.
    fn draw(&mut self, random: &mut SplitMix64) {
        let size = 10f64.powf(random.uniform(-2.0, 2.0));
        let mut volts = |count: usize| (0..count).map(|_| random.uniform(-size, size)).collect::<Vec<f64>>();
        (self.states, self.sampled) =
            (volts(self.program.lowered.states.len()), volts(self.program.lowered.sampled.len()));
        self.levels = volts(self.program.lowered.levels.len());
        self.time = random.uniform(0.0, 1.0);
        for (volts, state) in self.states.iter_mut().zip(&self.program.lowered.states) {
            *volts += self.coefficients[state.initial as usize];
        }
        self.settle();
    }

    /// Sets the states, and nothing else.
    fn set_states(&mut self, states: &[f64]) {
        self.states = states.to_vec();
        self.settle();
    }

    fn specialisation(&self) -> Specialisation<'_> {
        Specialisation { modes: &self.modes, amplifiers: &self.amplifiers }
    }

    /// Finds the modes at the point, and then the overloaded amplifiers.
    fn settle(&mut self) {
        self.modes = self.program.lowered.modes.iter().map(|mode| mode.initial).collect();
        for _ in 0..20 {
            self.evaluate();
            let mut has_changed = false;
            let program = self.program;
            program
                .change_modes(&self.registers, &mut self.modes, &mut self.states, |_, _| has_changed = true);
            if !has_changed {
                break;
            }
        }
        let demands = self.program.lowered.lamps.iter().map(|lamp| self.registers[lamp.demand.index()]);
        self.amplifiers = demands.map(AmplifierState::of).collect();
    }

    /// Evaluates the program, as long as nothing has come out of delay lines.
    fn evaluate(&mut self) {
        let from = Sources {
            coefficients: &self.coefficients,
            states: &self.states,
            modes: &self.modes,
            time: self.time,
            tables: &self.program.tables,
            sampled: &self.sampled,
            levels: &self.levels,
            delayed: &vec![0.0; self.program.lowered.delays.len()],
            ..Sources::none()
        };
        self.program.evaluate(&from, &mut self.registers, &mut Scratch::new(self.program));
    }

    /// The largest difference between kernel and program, in volts, for outputs and for rates up to 1000 V/s. Larger
    /// rates have more rounding. `None` if the kernel is not valid at the point.
    fn difference(&self, outputs: &[Register]) -> Option<f64> {
        let program = self.program;
        let specialised = Kernels::of(program, self.specialisation(), outputs)?;
        let kernel = &specialised.kernel;
        let frame = self.frame(kernel)?;
        let outputs = outputs.iter().enumerate().map(|(index, register)| {
            (frame.last_recorded(kernel, index) - self.registers[register.index()]).abs()
        });
        let rates = kernel.rates.iter().zip(&program.lowered.states).map(|(slot, state)| {
            let rate = self.registers[state.rate.index()];
            (frame.slots[*slot as usize] - rate).abs() / (rate.abs() / 1e3).max(1.0)
        });
        Some(outputs.chain(rates).fold(0.0, f64::max))
    }

    /// A frame of a kernel at the point; `None` if the kernel is not valid there.
    fn frame(&self, kernel: &Kernel) -> Option<Frame<f64>> {
        let mut frame = kernel.frame::<f64>();
        frame.set_held_inputs(kernel, &self.sampled, &self.levels);
        frame.states.copy_from_slice(&self.states);
        frame.time = self.time;
        frame.lines[0] = vec![DelayLine::new(1.0, 0.0, 1e-3); self.program.lowered.delays.len()];
        kernel.settle(&mut frame, self.program, &self.coefficients, true).then_some(frame)
    }
}

/// The kernel for the initial modes, with all amplifiers in range.
fn kernel(program: &Program) -> Kernel {
    Kernel::new(program, Points::new(program).specialisation(), &[]).unwrap()
}

/// The output registers of all elements.
fn element_outputs(program: &Program) -> Vec<Register> {
    program.lowered.elements.iter().map(|output| output.register).collect()
}

/// The number of 200 random points at which the kernel is valid. There it is compared with the program.
fn valid_points(program: &Program, random: &mut SplitMix64, name: &str) -> usize {
    let outputs = element_outputs(program);
    let mut points = Points::new(program);
    let mut difference = || {
        points.draw(random);
        points.difference(&outputs)
    };
    let differences: Vec<f64> = (0..200).filter_map(|_| difference()).collect();
    let worst = differences.iter().fold(0.0, |worst: f64, difference| worst.max(*difference));
    assert!(worst <= 1e-10, "{name}: {worst:e} V");
    differences.len()
}

/// Whether a program has kernels.
fn is_specialised(program: &Program) -> bool {
    program.lowered.loops.is_empty()
}

#[test]
fn kernels_equal_programs_except_for_rounding() {
    let mut random = SplitMix64(20);
    for file in common::files::shipped_files().into_iter().chain(common::files::test_patch_files()) {
        let (program, name) = (program(&common::patch_of(&file)), file.display().to_string());
        if is_specialised(&program) {
            let valid = valid_points(&program, &mut random, &name);
            assert!(valid >= 100, "{name}: {valid} points");
        }
    }
}

#[test]
fn kernels_of_random_circuits_equal_programs() {
    let mut random = SplitMix64(21);
    let programs: Vec<Program> = (0..60).map(|_| program(&circuits::random_circuit(&mut random))).collect();
    let specialised = programs.iter().filter(|program| is_specialised(program)).enumerate();
    let valid: Vec<usize> = specialised
        .map(|(number, program)| valid_points(program, &mut random, &format!("circuit {number}")))
        .collect();
    assert!(valid.len() >= 20 && valid.iter().all(|count| *count >= 100), "{valid:?}");
}

#[test]
fn the_pages_state_the_number_of_lanes() {
    let page =
        |name: &str| std::fs::read_to_string(format!("../../docs/{name}.md")).unwrap().replace('\n', " ");
    let lanes = format!("up to {LANES} runs side by side");
    assert!(
        page("sweep").contains(&lanes) && page("solver").contains(&format!("up to {LANES} runs of a sweep"))
    );
    let sentence = format!("Fewer than {MIN_LANES_OVER_NATIVE} at a time are left to native code");
    assert!(page("performance").contains(&sentence));
}

#[test]
fn signs_gains_and_potentiometers_become_factors() {
    let program = program(&common::slideway());
    let kernel = kernel(&program);
    // The square of the friction level, and three rates. Everything else is linear between corners.
    assert!(kernel.moving.instructions.len() <= 4, "{:?}", kernel.moving);
    // Five corners. An amplifier that gives the negative of another one is not watched twice.
    assert!(kernel.watches.len() <= 18, "{:?}", kernel.watches);
}

/// An integrator A with an initial voltage, and an integrator B. The input of B is a function generator of -A.
fn generated(points: &[[f64; 2]], initial: f64) -> Program {
    let points: Vec<Vec<f64>> = points.iter().map(|point| point.to_vec()).collect();
    let generator = common::element("function-generator").cord("in", "S").set("points", points);
    let builder = common::volts("steep")
        .element("A", common::element("integrator").cords("x1", ["B"]).set("initial", initial))
        .element("S", common::element("inverter").cord("in", "A"))
        .element("F", generator)
        .element("B", common::element("integrator").cords("x1", ["F"]));
    common::built(builder)
}

/// A segment from 0 to 100 V within 2e-6 V, at 90 V: the steepest permitted one.
#[test]
fn a_steep_segment_far_from_0_stays_accurate() {
    let steep = [[90.0, 0.0], [90.0 + 2e-6, 100.0]];
    let inside = [[-100.0, 0.0], steep[0], steep[1], [100.0, 99.0]];
    // On the segment, and beyond the end of a segment that continues.
    for (points, low, high) in [(&inside[..], 0.0, 2e-6), (&steep[..], -1.9e-6, 0.0)] {
        let program = generated(points, -90.0);
        let mut at = Points::new(&program);
        for share in 0..=100 {
            let voltage = 90.0 + low + (high - low) * f64::from(share) / 100.0;
            at.set_states(&[-voltage, 0.0]);
            let difference =
                at.difference(&element_outputs(&program)).unwrap_or_else(|| panic!("none at {voltage}"));
            assert!(difference <= 1e-10, "{difference:e} V at {voltage}");
        }
    }
}

/// If a watch is hit, the voltage is outside the safe interval, also at its ends and if it is not a number.
#[test]
fn no_safe_interval_contains_a_hit() {
    let mut random = SplitMix64(22);
    let shipped = common::files::shipped_files().into_iter().chain(common::files::test_patch_files());
    let mut programs: Vec<Program> = shipped.map(|file| program(&common::patch_of(&file))).collect();
    // Beyond the last corner of a table.
    programs.push(generated(&[[-20.0, 0.0], [-10.0, 10.0]], 50.0));
    let hits = programs.iter().filter(|program| is_specialised(program)).map(|program| {
        let mut points = Points::new(program);
        points.draw(&mut random);
        let kernel = Kernel::new(program, points.specialisation(), &element_outputs(program)).unwrap();
        points.frame(&kernel).map_or(0, |frame| count_hits(&kernel, &frame))
    });
    let hits: usize = hits.sum();
    assert!(hits >= 500, "{hits}");
}

/// Counts how often a watch is hit at the ends of its safe interval or at extreme numbers. A hit must be outside the
/// interval.
fn count_hits(kernel: &Kernel, frame: &Frame<f64>) -> usize {
    let mut hits = 0;
    for (interval, (low, high)) in kernel.safe_intervals.iter().zip(frame.lows.iter().zip(&frame.highs)) {
        let doubtful = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 1e300, 0.0];
        let ends = [low, high].map(|end| [end.next_down(), *end, end.next_up()]);
        for value in doubtful.into_iter().chain(ends.into_iter().flatten()) {
            let is_hit = interval.watches.iter().any(|watch| is_hit(kernel, frame, watch, value));
            assert!(!is_hit || !(*low..=*high).contains(&value), "{value:e} in {low:e} ... {high:e}");
            hits += usize::from(is_hit);
        }
    }
    hits
}

/// Whether a watch of a safe interval is hit if the interval's voltage has this value.
fn is_hit(kernel: &Kernel, frame: &Frame<f64>, watch: &IntervalWatch, voltage: f64) -> bool {
    let line = watch.line.map(|line| line.map(|slot| frame.slots[slot as usize]));
    let value = line.map_or(voltage, |[constant, factor]| factor.mul_add(voltage, constant));
    let size = matches!(kernel.watches[watch.watch].condition, WatchCondition::Size(_));
    let value = if size { value.abs() } else { value };
    let margin = value.mul_add(frame.slopes[watch.watch], frame.offsets[watch.watch]);
    margin < 0.0 || margin.is_nan()
}

/// Whether the kernel for the initial modes is valid if the only state has this voltage.
fn holds_at(program: &Program, volts: f64) -> bool {
    let mut points = Points::new(program);
    points.states = vec![volts];
    points.frame(&kernel(program)).is_some()
}

#[test]
fn the_narrower_of_two_bounds_applies() {
    let integrator = || common::element("integrator").cords("x1", ["S"]);
    let summer = common::element("summer").cords("x1", ["A"]);
    let limit = serde_json::json!({"upper": 50, "drop": 0});
    let limited = common::volts("limited").element("S", summer.clone());
    let limited = common::built(limited.element("A", integrator().set("limit", limit)));
    // The limit is passed above 50 V; the lamp lights 1e-11 V above 100 V.
    for (volts, holds) in [(-101.0, false), (-99.0, true), (50.0, true), (50.1, false), (101.0, false)] {
        assert_eq!(holds_at(&limited, volts), holds, "{volts} V");
    }
    let relay = common::element("relay").cord("in", "S").set("pull_in", 50).set("drop_out", 0);
    let relay = relay.cord("on", "A").cord("off", "S");
    let guarded = common::volts("guarded").element("A", integrator()).element("S", summer);
    let guarded = common::built(guarded.element("R", relay));
    // The summer changes the sign.
    for (volts, holds) in [(-101.0, false), (-50.0, false), (-49.9, true), (99.0, true), (101.0, false)] {
        assert_eq!(holds_at(&guarded, volts), holds, "{volts} V");
    }
}

/// An overloaded amplifier stays at an end of its range while its demand does not come back.
#[test]
fn an_overloaded_amplifier_is_at_an_end_of_its_range() {
    let summer = common::element("summer").cords("x2", ["A"]);
    let integrator = common::element("integrator").cords("x1", ["S"]);
    let builder = common::volts("overloaded").element("S", summer).element("A", integrator);
    let program = common::built(builder);
    let mut points = Points::new(&program);
    points.set_states(&[60.0]);
    assert_eq!(points.amplifiers, [AmplifierState::Below]);
    assert_eq!(points.difference(&element_outputs(&program)), Some(0.0));
    let kernel = Kernel::new(&program, points.specialisation(), &element_outputs(&program)).unwrap();
    // The demand of the summer is -2 x the state.
    for (volts, holds) in [(50.1, true), (49.9, false), (-60.0, false)] {
        points.states = vec![volts];
        assert_eq!(points.frame(&kernel).is_some(), holds, "{volts} V");
    }
}

#[test]
fn used_kernels_stay_in_the_cache() {
    let program = generated(&[[-10.0, 0.0], [10.0, 10.0]], 0.0);
    let points = Points::new(&program);
    let kernel = |recorded: usize| {
        Kernels::of(&program, points.specialisation(), &vec![Register(0); recorded]).unwrap()
    };
    let [used, unused] = [0, 1].map(kernel);
    for recorded in 2..100 {
        kernel(recorded);
        assert!(Arc::ptr_eq(&kernel(0), &used));
    }
    assert!(!Arc::ptr_eq(&kernel(1), &unused));
}

/// A chain of integrators.
fn chained(count: usize) -> Program {
    let mut builder = common::volts("chain");
    for number in 0..count {
        let before = format!("A{}", number.max(1) - 1);
        let integrator = common::element("integrator").cords("x1", [before.as_str()]);
        builder = builder.element(&format!("A{number}"), integrator);
    }
    common::built(builder)
}

/// The kernel of a chain of integrators.
fn chain(count: usize) -> Kernel {
    kernel(&chained(count))
}

#[test]
fn larger_kernels_are_compiled_later() {
    let slideway = native_threshold(&kernel(&program(&common::slideway())));
    // docs/performance.md states about 10,000.
    assert!((9_000..11_000).contains(&slideway), "{slideway}");
    let many = native_threshold(&chain(1000));
    assert!(many > 100_000, "{many}");
}
