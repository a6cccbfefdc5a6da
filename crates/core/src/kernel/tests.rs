//! A kernel against the program that it was folded from, one evaluation at a time.

#[path = "../../tests/common/mod.rs"]
mod common;

use std::sync::Arc;

#[cfg(feature = "native")]
use super::Native;
use super::lane::Lane as _;
use super::store::{FEWEST_BEYOND_NATIVE, Kernels, pays};
use super::{Asked, Formation, Frame, Kernel, LANES, Posted, Stance, Steps, Watched};
use crate::delay_line::DelayLine;
use crate::grid::Grid;
use crate::ir::{Program, Register, Scratch, Sources};
use crate::patch::Patch;
use common::circuits;
use common::dice::Dice;

fn program(patch: &Patch) -> Program {
    common::program(patch, &[])
}

/// A program at points drawn by chance, in the stance that holds there.
struct Points<'p> {
    program: &'p Program,
    coefficients: Vec<f64>,
    registers: Vec<f64>,
    modes: Vec<f64>,
    asked: Vec<Asked>,
    states: Vec<f64>,
    kept: Vec<f64>,
    levels: Vec<f64>,
    time: f64,
}

impl<'p> Points<'p> {
    fn new(program: &'p Program) -> Self {
        let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
        Points {
            program,
            coefficients: program.prepare(&parameters),
            registers: vec![0.0; program.body.len()],
            modes: program.modes.iter().map(|mode| mode.initial).collect(),
            asked: vec![Asked::Within; program.lamps.len()],
            states: Vec::new(),
            kept: Vec::new(),
            levels: Vec::new(),
            time: 0.0,
        }
    }

    /// Draws one near initial condition, where amplifiers of large gain stay within their range.
    fn draw(&mut self, dice: &mut Dice) {
        let size = 10f64.powf(dice.even(-2.0, 2.0));
        let mut volts = |count: usize| (0..count).map(|_| dice.even(-size, size)).collect::<Vec<f64>>();
        (self.states, self.kept) = (volts(self.program.states.len()), volts(self.program.kept.len()));
        self.levels = volts(self.program.levels.len());
        self.time = dice.even(0.0, 1.0);
        for (volts, state) in self.states.iter_mut().zip(&self.program.states) {
            *volts += self.coefficients[state.initial as usize];
        }
        self.settle();
    }

    /// Takes these voltages of the states, and nothing else.
    fn stand(&mut self, states: &[f64]) {
        self.states = states.to_vec();
        self.settle();
    }

    fn stance(&self) -> Stance<'_> {
        Stance { modes: &self.modes, asked: &self.asked }
    }

    /// The modes that hold there, and the amplifiers that are overloaded then.
    fn settle(&mut self) {
        self.modes = self.program.modes.iter().map(|mode| mode.initial).collect();
        for _ in 0..20 {
            self.evaluate();
            let mut any = false;
            let program = self.program;
            program.change_modes(&self.registers, &mut self.modes, &mut self.states, |_, _| any = true);
            if !any {
                break;
            }
        }
        let demands = self.program.lamps.iter().map(|lamp| self.registers[lamp.demand.index()]);
        self.asked = demands.map(Asked::of).collect();
    }

    /// Nothing has come out of delay lines yet.
    fn evaluate(&mut self) {
        let from = Sources {
            coefficients: &self.coefficients,
            states: &self.states,
            modes: &self.modes,
            time: self.time,
            tables: &self.program.tables,
            kept: &self.kept,
            levels: &self.levels,
            delayed: &vec![0.0; self.program.delays.len()],
            ..Sources::none()
        };
        self.program.evaluate(&from, &mut self.registers, &mut Scratch::new(self.program));
    }

    /// Volts by which the kernel differs at most in outputs, and in rates of up to 1000 V/s: larger ones carry more
    /// rounding. Nothing where the kernel does not hold.
    fn difference(&self, outputs: &[Register]) -> Option<f64> {
        let program = self.program;
        let folded = Kernels::of(program, self.stance(), outputs)?;
        let kernel = &folded.kernel;
        let frame = self.frame(kernel)?;
        let outputs = outputs.iter().enumerate().map(|(index, register)| {
            (frame.last_seen(kernel, index) - self.registers[register.index()]).abs()
        });
        let rates = kernel.rates.iter().zip(&program.states).map(|(slot, state)| {
            let rate = self.registers[state.rate.index()];
            (frame.slots[*slot as usize] - rate).abs() / (rate.abs() / 1e3).max(1.0)
        });
        Some(outputs.chain(rates).fold(0.0, f64::max))
    }

    /// A kernel's frame there; nothing where the kernel does not hold.
    fn frame(&self, kernel: &Kernel) -> Option<Frame<f64>> {
        let mut frame = kernel.frame::<f64>();
        frame.put_standing(kernel, &self.kept, &self.levels);
        frame.states.copy_from_slice(&self.states);
        frame.time = self.time;
        frame.lines[0] = vec![DelayLine::new(1.0, 0.0, 1e-3); self.program.delays.len()];
        kernel.settle(&mut frame, self.program, &self.coefficients, true).then_some(frame)
    }
}

/// The kernel of a program's first modes, within the range of all amplifiers.
fn kernel(program: &Program) -> Kernel {
    Kernel::new(program, Points::new(program).stance(), &[]).unwrap()
}

/// The registers of all elements.
fn outlets(program: &Program) -> Vec<Register> {
    program.elements.iter().map(|outlet| outlet.register).collect()
}

/// At how many of 200 points the kernel holds; there it is held against the program.
fn held(program: &Program, dice: &mut Dice, told: &str) -> usize {
    let outputs = outlets(program);
    let mut points = Points::new(program);
    let mut difference = || {
        points.draw(dice);
        points.difference(&outputs)
    };
    let differences: Vec<f64> = (0..200).filter_map(|_| difference()).collect();
    let worst = differences.iter().fold(0.0, |worst: f64, difference| worst.max(*difference));
    assert!(worst <= 1e-10, "{told}: {worst:e} V");
    differences.len()
}

/// Whether a program is folded at all.
fn is_folded(program: &Program) -> bool {
    program.loops.is_empty()
}

#[test]
fn folding_changes_no_voltage_by_more_than_rounding() {
    let mut dice = Dice(20);
    for file in common::files::shipped().into_iter().chain(common::files::of_tests()) {
        let (program, told) = (program(&common::patch_of(&file)), file.display().to_string());
        if is_folded(&program) {
            let held = held(&program, &mut dice, &told);
            assert!(held >= 100, "{told}: {held} points");
        }
    }
}

#[test]
fn nor_does_it_in_random_circuits() {
    let mut dice = Dice(21);
    let programs: Vec<Program> = (0..60).map(|_| program(&circuits::circuit(&mut dice))).collect();
    let folded = programs.iter().filter(|program| is_folded(program)).enumerate();
    let held: Vec<usize> =
        folded.map(|(number, program)| held(program, &mut dice, &format!("circuit {number}"))).collect();
    assert!(held.len() >= 20 && held.iter().all(|held| *held >= 100), "{held:?}");
}

/// Frames at one instant, in the same modes: as many as there are lanes, where the kernel holds so often.
fn side_by_side(program: &Program, dice: &mut Dice) -> Option<(Kernel, Vec<Frame<f64>>)> {
    let mut points = Points::new(program);
    points.draw(dice);
    let (modes, asked) = (points.modes.clone(), points.asked.clone());
    let kernel = Kernel::new(program, points.stance(), &outlets(program))?;
    let drawn = (0..20 * LANES).filter_map(|_| {
        points.draw(dice);
        points.time = 0.25;
        (points.modes == modes && points.asked == asked).then(|| points.frame(&kernel)).flatten()
    });
    let frames: Vec<_> = drawn.take(LANES).collect();
    (frames.len() == LANES).then_some((kernel, frames))
}

/// Every number of a frame that steps change, as its bits.
fn moving(kernel: &Kernel, frame: &Frame<f64>) -> Vec<u64> {
    let numbers = [&frame.slots[..kernel.layout.all], &frame.states, &frame.rates, &[frame.time]];
    let all = numbers.into_iter().chain(frame.extremes.parts());
    all.flatten().map(|number| number.to_bits()).collect()
}

/// Steps of lanes, whatever is met, against the same of every frame alone: all that is worked out at the last evaluation of
/// each step.
fn abreast_as_alone(kernel: &Kernel, mut frames: Vec<Frame<f64>>, tables: &[Vec<[f64; 2]>]) {
    let mut formation = Formation::of(kernel);
    for (lane, frame) in frames.iter_mut().enumerate() {
        frame.aboard = 0;
        formation.board(kernel, lane, frame);
        // What quiet steps do not work out stays as it is.
        let pairs = formation.frame.slots.iter_mut().zip(&frame.slots).skip(kernel.layout.results);
        pairs.for_each(|(all, one)| all.set(lane, *one));
    }
    let all = formation.aboard();
    for first in 1..=5 {
        let steps = Steps { begin: 0.25, grid: Grid::new(1e-3), first, count: 1 };
        formation.frame.aboard = 0;
        assert_eq!(kernel.steps(&mut formation.frame, tables, &steps), 1);
        formation.frame.aboard = all;
        for (lane, frame) in frames.iter_mut().enumerate() {
            assert_eq!(kernel.steps(frame, tables, &steps), 1);
            let mut left = frame.clone();
            left.slots.iter_mut().zip(&formation.frame.slots).for_each(|(one, all)| *one = all.get(lane));
            [&mut left.states, &mut left.rates].into_iter().for_each(|numbers| numbers.fill(f64::NAN));
            formation.clone().leave(kernel, lane, &mut left);
            assert!(moving(kernel, &left) == moving(kernel, frame), "lane {lane}, step {first}");
        }
    }
}

#[test]
fn lanes_give_the_bits_of_each_alone() {
    let mut dice = Dice(23);
    let shipped = common::files::shipped().into_iter().chain(common::files::of_tests());
    let mut programs: Vec<Program> = shipped.map(|file| program(&common::patch_of(&file))).collect();
    programs.extend((0..40).map(|_| program(&circuits::circuit(&mut dice))));
    let mut compared = 0;
    for program in programs.iter().filter(|program| is_folded(program)) {
        if let Some((kernel, frames)) = side_by_side(program, &mut dice) {
            abreast_as_alone(&kernel, frames, &program.tables);
            compared += 1;
        }
    }
    assert!(compared >= 30, "{compared}");
}

#[test]
fn the_pages_tell_how_many_lanes_there_are() {
    let page =
        |name: &str| std::fs::read_to_string(format!("../../docs/{name}.md")).unwrap().replace('\n', " ");
    let told = format!("up to {LANES} runs side by side");
    assert!(page("sweep").contains(&told) && page("architecture").contains(&format!("{LANES} at most")));
    let fewest = format!("Fewer than {FEWEST_BEYOND_NATIVE} at a time are left to native code");
    assert!(page("performance").contains(&fewest));
}

/// What is met is told of its own lane alone, in the middle of a step as at its end.
#[test]
fn what_is_met_is_told_by_lane() {
    let program = generated(&[[-50.0, 0.0], [10.0, 0.0], [50.0, 40.0]], 0.0);
    let mut points = Points::new(&program);
    let kernel = kernel(&program);
    let mut formation = Formation::of(&kernel);
    for lane in 0..LANES {
        // A falls by what B has in a second; below -10 V the table turns.
        points.states = vec![if lane % 3 == 1 { -9.99 } else { 5.0 }, 20.0];
        formation.board(&kernel, lane, &mut points.frame(&kernel).unwrap());
    }
    let steps = Steps { begin: 0.0, grid: Grid::new(1e-3), first: 1, count: 9 };
    assert_eq!(kernel.steps(&mut formation.frame, &program.tables, &steps), 0);
    assert_eq!(formation.beyond(), 0x2492);
    let mut one = kernel.frame();
    (0..LANES).filter(|lane| lane % 3 == 1).for_each(|lane| formation.leave(&kernel, lane, &mut one));
    assert_eq!(one.states, [-9.99, 20.0]);
    assert!(formation.go_without(&kernel, &program.tables, 1e-3));
    assert_eq!((formation.aboard(), formation.time()), (0xffff & !0x2492, 1e-3));
    assert_eq!(kernel.steps(&mut formation.frame, &program.tables, &steps.after(1)), 8);
}

#[test]
fn signs_gains_and_potentiometers_leave_sums() {
    let program = program(&common::slideway());
    let kernel = kernel(&program);
    // The square of the friction level, and three rates: between its corners everything else is straight.
    assert!(kernel.moving.instructions.len() <= 4, "{:?}", kernel.moving);
    // Five corners, and no amplifier twice that gives the negative of another.
    assert!(kernel.watches.len() <= 18, "{:?}", kernel.watches);
}

/// An integrator A from an initial voltage, and B, which takes what a function generator makes of A by way of a sign.
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

/// From 0 to 100 V within two millionths of a volt, at 90 V: no curve may be steeper.
#[test]
fn a_steep_piece_far_from_0_loses_nothing() {
    let steep = [[90.0, 0.0], [90.0 + 2e-6, 100.0]];
    let inside = [[-100.0, 0.0], steep[0], steep[1], [100.0, 99.0]];
    // On the piece, and beyond the ends of one that goes on.
    for (points, low, high) in [(&inside[..], 0.0, 2e-6), (&steep[..], -1.9e-6, 0.0)] {
        let program = generated(points, -90.0);
        let mut at = Points::new(&program);
        for share in 0..=100 {
            let place = 90.0 + low + (high - low) * f64::from(share) / 100.0;
            at.stand(&[-place, 0.0]);
            let difference = at.difference(&outlets(&program)).unwrap_or_else(|| panic!("none at {place}"));
            assert!(difference <= 1e-10, "{difference:e} V at {place}");
        }
    }
}

/// Where a watch is met, the fence that stands for it holds nothing: at its ends, and of what is no number.
#[test]
fn no_fence_holds_what_a_watch_meets() {
    let mut dice = Dice(22);
    let shipped = common::files::shipped().into_iter().chain(common::files::of_tests());
    let mut programs: Vec<Program> = shipped.map(|file| program(&common::patch_of(&file))).collect();
    // Beyond the last corner of a table.
    programs.push(generated(&[[-20.0, 0.0], [-10.0, 10.0]], 50.0));
    let met = programs.iter().filter(|program| is_folded(program)).map(|program| {
        let mut points = Points::new(program);
        points.draw(&mut dice);
        let kernel = Kernel::new(program, points.stance(), &outlets(program)).unwrap();
        points.frame(&kernel).map_or(0, |frame| watches_met(&kernel, &frame))
    });
    let met: usize = met.sum();
    assert!(met >= 500, "{met}");
}

/// How often a watch is met by what stands at the ends of its fence, or is hardly a number: never within the fence.
fn watches_met(kernel: &Kernel, frame: &Frame<f64>) -> usize {
    let mut met = 0;
    for (fence, (low, high)) in kernel.fences.iter().zip(frame.lows.iter().zip(&frame.highs)) {
        let doubtful = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 1e300, 0.0];
        let ends = [low, high].map(|end| [end.next_down(), *end, end.next_up()]);
        for value in doubtful.into_iter().chain(ends.into_iter().flatten()) {
            let is_met = fence.watches.iter().any(|posted| is_met(kernel, frame, posted, value));
            assert!(!is_met || !(*low..=*high).contains(&value), "{value:e} in {low:e} ... {high:e}");
            met += usize::from(is_met);
        }
    }
    met
}

/// Whether a watch at a fence is met where the fence's voltage is so large.
fn is_met(kernel: &Kernel, frame: &Frame<f64>, posted: &Posted, voltage: f64) -> bool {
    let line = posted.line.map(|line| line.map(|slot| frame.slots[slot as usize]));
    let value = line.map_or(voltage, |[constant, factor]| factor.mul_add(voltage, constant));
    let size = matches!(kernel.watches[posted.watch].what, Watched::Size(_));
    let value = if size { value.abs() } else { value };
    let rest = value.mul_add(frame.slopes[posted.watch], frame.rooms[posted.watch]);
    rest < 0.0 || rest.is_nan()
}

/// Whether the kernel of a program's first modes holds where its only state is at a voltage.
fn holds_at(program: &Program, volts: f64) -> bool {
    let mut points = Points::new(program);
    points.states = vec![volts];
    points.frame(&kernel(program)).is_some()
}

#[test]
fn what_is_bound_by_a_guard_and_by_an_amplifier_stays_within_both() {
    let integrator = || common::element("integrator").cords("x1", ["S"]);
    let summer = common::element("summer").cords("x1", ["A"]);
    let limit = serde_json::json!({"upper": 50, "drop": 0});
    let limited = common::volts("limited").element("S", summer.clone());
    let limited = common::built(limited.element("A", integrator().set("limit", limit)));
    // The limit meets what passes it; the lamp lights 1e-11 V beyond 100 V.
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

/// Beyond an end of its range an amplifier gives that end, as long as it is asked for no less.
#[test]
fn what_is_overloaded_gives_an_end_of_its_range() {
    let summer = common::element("summer").cords("x2", ["A"]);
    let integrator = common::element("integrator").cords("x1", ["S"]);
    let builder = common::volts("overloaded").element("S", summer).element("A", integrator);
    let program = common::built(builder);
    let mut points = Points::new(&program);
    points.stand(&[60.0]);
    assert_eq!(points.asked, [Asked::TooLow]);
    assert_eq!(points.difference(&outlets(&program)), Some(0.0));
    let kernel = Kernel::new(&program, points.stance(), &outlets(&program)).unwrap();
    // The summer is asked for twice as much, of the other sign.
    for (volts, holds) in [(50.1, true), (49.9, false), (-60.0, false)] {
        points.states = vec![volts];
        assert_eq!(points.frame(&kernel).is_some(), holds, "{volts} V");
    }
}

#[test]
fn kernels_that_are_used_are_kept() {
    let program = generated(&[[-10.0, 0.0], [10.0, 10.0]], 0.0);
    let points = Points::new(&program);
    let kernel = |seen: usize| Kernels::of(&program, points.stance(), &vec![Register(0); seen]).unwrap();
    let [used, unused] = [0, 1].map(kernel);
    for seen in 2..100 {
        kernel(seen);
        assert!(Arc::ptr_eq(&kernel(0), &used));
    }
    assert!(!Arc::ptr_eq(&kernel(1), &unused));
}

/// Integrators one after the other, so many of them.
fn chained(count: usize) -> Program {
    let mut builder = common::volts("chain");
    for number in 0..count {
        let before = format!("A{}", number.max(1) - 1);
        let integrator = common::element("integrator").cords("x1", [before.as_str()]);
        builder = builder.element(&format!("A{number}"), integrator);
    }
    common::built(builder)
}

/// Their kernel.
fn chain(count: usize) -> Kernel {
    kernel(&chained(count))
}

#[test]
fn native_code_of_larger_kernels_pays_later() {
    let own = pays(&kernel(&program(&common::slideway())));
    // docs/performance.md tells about 10,000.
    assert!((9_000..11_000).contains(&own), "{own}");
    let many = pays(&chain(1000));
    assert!(many > 100_000, "{many}");
}

#[cfg(feature = "native")]
#[test]
fn native_code_is_made_of_kernels_of_moderate_size() {
    assert!(Native::new(&chain(10)).is_some());
    assert!(Native::new(&chain(2000)).is_none());
}

#[cfg(feature = "native")]
#[test]
#[should_panic(expected = "a frame of another kernel")]
fn native_code_takes_no_frame_of_another_kernel() {
    let native = Native::new(&chain(2)).unwrap();
    native.look(&mut chain(1).frame(), &[], 1e-3);
}

#[cfg(feature = "native")]
#[test]
#[should_panic(expected = "a frame of another kernel")]
fn native_steps_take_no_frame_of_another_kernel() {
    let steps = Steps { begin: 0.0, grid: Grid::new(1e-3), first: 1, count: 10 };
    Native::new(&chain(1)).unwrap().steps(&mut chain(2).frame(), &[], &steps);
}

/// Numbers that tell where a frame is and what it has seen, bit by bit.
#[cfg(feature = "native")]
fn bits(kernel: &Kernel, frame: &Frame<f64>) -> Vec<u64> {
    let seen = frame.extremes.parts().into_iter().flatten();
    let moving = frame.states.iter().chain(&frame.rates).chain(frame.kept(kernel));
    let all = moving.chain(seen).chain([&frame.time]);
    all.map(|number| number.to_bits()).collect()
}

/// Native steps judge blocks of them afterwards: they stop where steps that are looked at one by one do.
#[cfg(feature = "native")]
#[test]
fn native_steps_stop_before_the_step_in_which_something_is_met() {
    let mut dice = Dice(29);
    let mut stopped = [0; 2];
    let still = common::volts("still").element("S", common::element("summer").cords("x1", ["+100"]));
    let play = common::element("backlash").cord("in", "A").set("width", 10);
    let kept = common::volts("kept").element("B", play);
    let kept = kept.element("A", common::element("integrator").cords("x1", ["B"]).set("initial", 20));
    let programs = [
        (program(&common::slideway()), 40),
        (common::built(kept), 30),
        // So wide that few rows stay near the processor; and one without anything to look at.
        (chained(400), 1),
        (common::built(still), 1),
    ];
    for (program, points_drawn) in programs {
        let mut points = Points::new(&program);
        for _ in 0..points_drawn {
            points.draw(&mut dice);
            let kernel = Kernel::new(&program, points.stance(), &outlets(&program)).unwrap();
            let Some(mut alone) = points.frame(&kernel) else { continue };
            kernel.show(&mut alone, &program.tables);
            alone.stand();
            alone.see_anew();
            let mut native = alone.clone();
            let grid = Grid::new(10f64.powf(dice.even(-6.0, -3.0)));
            let steps = Steps { begin: alone.time, grid, first: 1, count: 200 };
            let gone = kernel.steps(&mut alone, &program.tables, &steps);
            let code = Native::new(&kernel).unwrap();
            assert_eq!(code.steps(&mut native, &program.tables, &steps), gone);
            let [native, alone] = [&native, &alone].map(|frame| bits(&kernel, frame));
            assert_eq!(native, alone, "after {gone} steps");
            stopped[usize::from(gone < steps.count)] += 1;
        }
    }
    assert!(stopped.iter().all(|often| *often >= 10), "{stopped:?}");
}
