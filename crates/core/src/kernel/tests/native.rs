//! Compares steps of native code with interpreted ones, and tests the limits of native code.

use super::*;
use crate::grid::Grid;
use crate::kernel::{Native, Steps};

#[test]
fn native_code_exists_for_kernels_of_moderate_size() {
    assert!(Native::new(&chain(10)).is_some());
    assert!(Native::new(&chain(2000)).is_none());
}

#[test]
#[should_panic(expected = "a frame of another kernel")]
fn native_code_refuses_frames_of_another_kernel() {
    let native = Native::new(&chain(2)).unwrap();
    native.look(&mut chain(1).frame(), &[], 1e-3);
}

#[test]
#[should_panic(expected = "a frame of another kernel")]
fn native_steps_refuse_frames_of_another_kernel() {
    let steps = Steps { begin: 0.0, grid: Grid::new(1e-3), first: 1, count: 10 };
    Native::new(&chain(1)).unwrap().steps(&mut chain(2).frame(), &[], &steps);
}

/// The bits of all numbers that show where a frame is and what it has observed.
fn bits(kernel: &Kernel, frame: &Frame<f64>) -> Vec<u64> {
    let recorded = frame.extremes.parts().into_iter().flatten();
    let moving = frame.states.iter().chain(&frame.rates).chain(frame.sampled(kernel));
    let all = moving.chain(recorded).chain([&frame.time]);
    all.map(|number| number.to_bits()).collect()
}

/// Native steps are tested in blocks afterwards. They must stop where steps that are tested one by one do.
#[test]
fn native_steps_stop_before_a_hit() {
    let mut random = SplitMix64(29);
    let mut stopped = [0; 2];
    let fixed = common::volts("fixed").element("S", common::element("summer").cords("x1", ["+100"]));
    let play = common::element("backlash").cord("in", "A").set("width", 10);
    let sampled = common::volts("sampled").element("B", play);
    let sampled = sampled.element("A", common::element("integrator").cords("x1", ["B"]).set("initial", 20));
    let programs = [
        (program(&common::slideway()), 40),
        (common::built(sampled), 30),
        // A kernel so wide that few rows fit into the cache, and one without any tests.
        (chained(400), 1),
        (common::built(fixed), 1),
    ];
    for (program, points_drawn) in programs {
        let mut points = Points::new(&program);
        for _ in 0..points_drawn {
            points.draw(&mut random);
            let kernel = Kernel::new(&program, points.specialisation(), &element_outputs(&program)).unwrap();
            let Some(mut alone) = points.frame(&kernel) else { continue };
            kernel.evaluate_present(&mut alone, &program.tables);
            alone.accept_present();
            alone.reset_extremes();
            let mut native = alone.clone();
            let grid = Grid::new(10f64.powf(random.uniform(-6.0, -3.0)));
            let steps = Steps { begin: alone.time, grid, first: 1, count: 200 };
            let taken = kernel.steps(&mut alone, &program.tables, &steps);
            let code = Native::new(&kernel).unwrap();
            assert_eq!(code.steps(&mut native, &program.tables, &steps), taken);
            let [native, alone] = [&native, &alone].map(|frame| bits(&kernel, frame));
            assert_eq!(native, alone, "after {taken} steps");
            stopped[usize::from(taken < steps.count)] += 1;
        }
    }
    assert!(stopped.iter().all(|count| *count >= 10), "{stopped:?}");
}
