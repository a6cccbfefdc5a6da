//! A step of the solver allocates no memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::common::{built, circuit, element, patch, program, slideway, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Backend, Machine, RunSettings};

thread_local! {
    // One counter per thread, because the test harness allocates on other threads at the same time.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    ALLOCATIONS.set(ALLOCATIONS.get() + 1);
}

/// The system's allocator with a count of allocations.
struct Counting;

// SAFETY: every call is forwarded to the system's allocator, and the counter is separate from the caller's memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(place, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn lesson(stem: &str) -> Patch {
    Patch::read(format!("../../patches/lessons/{stem}.json")).unwrap()
}

/// A triangle through an odd function generator and a lag, which reaches its limit and leaves it again.
fn lag_and_generator() -> Program {
    let points = serde_json::json!([[0.0, 0.0], [20.0, 60.0], [80.0, 90.0]]);
    let triangle = element("triangle").set("amplitude", 80).set("frequency", 2);
    let generator =
        element("function-generator").cord("in", "u").set("points", points).set("symmetry", "odd");
    let lag = element("lag").cords("x2", ["F"]).set("time", 0.05);
    built(
        volts("lag and function generator")
            .drive("u", "volt", triangle)
            .element("F", generator)
            .element("L", lag)
            .signal("l", "L", "volt", 1.0),
    )
}

/// The number of allocations in `steps` steps with derivatives by the first `parameters` parameters. The machine has
/// made the same run before, so that everything that is built once for each set of modes exists.
fn allocations(program: &Program, step: f64, steps: usize, parameters: usize, backend: Backend) -> usize {
    allocations_of(
        Machine::new(program, step).unwrap().with_backend(backend),
        step * steps as f64,
        program,
        parameters,
    )
}

/// The number of allocations of the second of two equal runs.
fn allocations_of(mut machine: Machine<'_>, length: f64, program: &Program, parameters: usize) -> usize {
    let names: Vec<_> =
        program.parameters().iter().take(parameters).map(|slot| slot.declared.name.as_str()).collect();
    machine.differentiate(&names).unwrap();
    machine.operate(length).unwrap();
    machine.initial_condition().unwrap();
    let before = ALLOCATIONS.get();
    machine.operate(length).unwrap();
    ALLOCATIONS.get() - before
}

#[test]
fn steps_allocate_nothing() {
    let cases = [
        ("fig-8-16", program(&slideway(), &[]), 2e-5, 4_000),
        ("loop-lag", program(&patch("loop-lag"), &[]), 1e-3, 4_000),
        ("delay-line", program(&patch("delay-line"), &[]), 1e-3, 4_000),
        ("bouncing-ball", program(&patch("bouncing-ball"), &[]), 1e-3, 4_000),
        ("stick-slip-brake", program(&patch("stick-slip-brake"), &[]), 1e-3, 4_000),
        ("relay-oscillator", program(&patch("relay-oscillator"), &[]), 1e-2, 4_000),
        ("integrator-limit", program(&patch("integrator-limit"), &[]), 1e-2, 4_000),
        ("memory", program(&patch("memory"), &[]), 1e-3, 4_000),
        ("lag and function generator", lag_and_generator(), 1e-3, 4_000),
        ("square-root-and-division", program(&lesson("square-root-and-division"), &[]), 1e-3, 500),
    ];
    for (name, program, step, longest) in &cases {
        let variants =
            [Backend::Reference, Backend::Interpreter, Backend::Native].map(|backend| (0, backend));
        for (parameters, backend) in variants.into_iter().chain([(2, Backend::Reference)]) {
            let counts =
                [*longest / 5, *longest].map(|steps| allocations(program, *step, steps, parameters, backend));
            assert_eq!(counts, [0, 0], "{name}, {backend}, derivatives by {parameters}");
        }
        for parameters in [0, 2] {
            let machine = Machine::adaptive(program, 1e-6, *step).unwrap();
            let count = allocations_of(machine, 0.1 * *longest as f64 * step, program, parameters);
            assert_eq!(count, 0, "{name}, with a tolerance, derivatives by {parameters}");
        }
    }
}

/// The number of allocations of a batch of runs of `steps` steps, which records only the first and the last sample.
fn allocations_of_batch(programs: &[Program], settings: &RunSettings, steps: u32) -> usize {
    let length = settings.step * f64::from(steps);
    let settings = settings.clone().with_sample_interval(length).with_duration(length);
    let before = ALLOCATIONS.get();
    let runs = solve::run_batch(programs, &settings);
    let count = ALLOCATIONS.get() - before;
    assert!(runs.iter().all(Result::is_ok));
    count
}

/// A batch allocates at its beginning. The number of allocations does not depend on the number of steps.
#[test]
fn steps_of_a_batch_allocate_nothing() {
    let cases = [
        ("fig-8-16", slideway(), ("VcL", 2e-3, 1e-4), 80_000),
        ("relay-oscillator", patch("relay-oscillator"), ("slope", 80.0, 2.0), 8_000),
        ("mass-and-spring", lesson("mass-and-spring"), ("k", 10.0, 5.0), 8_000),
        ("delay-line", patch("delay-line"), ("T", 0.8, 0.05), 8_000),
    ];
    for (name, patch, (parameter, first, increment), steps) in &cases {
        let mut programs = vec![program(patch, &[]); 16];
        for (run, program) in programs.iter_mut().enumerate() {
            program.set_parameters([(*parameter, first + increment * run as f64)]).unwrap();
        }
        for backend in [Backend::Lanes, Backend::Automatic] {
            let settings = RunSettings::of(&circuit(patch, &[])).unwrap().with_backend(backend);
            // The first run builds the native code and everything that is built once for each set of modes.
            allocations_of_batch(&programs, &settings, *steps);
            let [short, long] =
                [steps / 2, *steps].map(|steps| allocations_of_batch(&programs, &settings, steps));
            assert_eq!(short, long, "{name}, {backend}");
        }
    }
}
