//! Compares steps in lanes with the same steps of single frames.

use super::*;
use crate::grid::Grid;
use crate::kernel::lane::Lane as _;
use crate::kernel::{LaneFrame, Steps};

/// One frame per lane, all at one instant and in the same modes. `None` if there are not enough such points.
fn side_by_side(program: &Program, random: &mut SplitMix64) -> Option<(Kernel, Vec<Frame<f64>>)> {
    let mut points = Points::new(program);
    points.draw(random);
    let (modes, amplifiers) = (points.modes.clone(), points.amplifiers.clone());
    let kernel = Kernel::new(program, points.specialisation(), &element_outputs(program))?;
    let drawn = (0..20 * LANES).filter_map(|_| {
        points.draw(random);
        points.time = 0.25;
        (points.modes == modes && points.amplifiers == amplifiers).then(|| points.frame(&kernel)).flatten()
    });
    let frames: Vec<_> = drawn.take(LANES).collect();
    (frames.len() == LANES).then_some((kernel, frames))
}

/// The bits of every number of a frame that a step changes.
fn moving(kernel: &Kernel, frame: &Frame<f64>) -> Vec<u64> {
    let numbers = [&frame.slots[..kernel.layout.all], &frame.states, &frame.rates, &[frame.time]];
    let all = numbers.into_iter().chain(frame.extremes.parts());
    all.flatten().map(|number| number.to_bits()).collect()
}

/// Compares steps in lanes with the same steps of single frames. Hits are ignored; every value of the last evaluation
/// must be equal.
fn assert_lanes_equal_single_frames(kernel: &Kernel, mut frames: Vec<Frame<f64>>, tables: &[Vec<[f64; 2]>]) {
    let mut lane_frame = LaneFrame::of(kernel);
    for (lane, frame) in frames.iter_mut().enumerate() {
        frame.active_lanes = 0;
        lane_frame.load_lane(kernel, lane, frame);
        // Values that quick steps do not compute stay as they are.
        let pairs = lane_frame.frame.slots.iter_mut().zip(&frame.slots).skip(kernel.layout.results);
        pairs.for_each(|(all, one)| all.set(lane, *one));
    }
    let all = lane_frame.active_lanes();
    for first in 1..=5 {
        let steps = Steps { begin: 0.25, grid: Grid::new(1e-3), first, count: 1 };
        lane_frame.frame.active_lanes = 0;
        assert_eq!(kernel.steps(&mut lane_frame.frame, tables, &steps), 1);
        lane_frame.frame.active_lanes = all;
        for (lane, frame) in frames.iter_mut().enumerate() {
            assert_eq!(kernel.steps(frame, tables, &steps), 1);
            let mut unloaded = frame.clone();
            unloaded
                .slots
                .iter_mut()
                .zip(&lane_frame.frame.slots)
                .for_each(|(one, all)| *one = all.get(lane));
            [&mut unloaded.states, &mut unloaded.rates]
                .into_iter()
                .for_each(|numbers| numbers.fill(f64::NAN));
            lane_frame.clone().unload_lane(kernel, lane, &mut unloaded);
            assert!(moving(kernel, &unloaded) == moving(kernel, frame), "lane {lane}, step {first}");
        }
    }
}

#[test]
fn lanes_give_the_same_bits_as_single_frames() {
    let mut random = SplitMix64(23);
    let shipped = common::files::shipped_files().into_iter().chain(common::files::test_patch_files());
    let mut programs: Vec<Program> = shipped.map(|file| program(&common::patch_of(&file))).collect();
    programs.extend((0..40).map(|_| program(&circuits::random_circuit(&mut random))));
    let mut compared = 0;
    for program in programs.iter().filter(|program| is_specialised(program)) {
        if let Some((kernel, frames)) = side_by_side(program, &mut random) {
            assert_lanes_equal_single_frames(&kernel, frames, &program.tables);
            compared += 1;
        }
    }
    assert!(compared >= 30, "{compared}");
}

/// A hit affects its own lane only, both in the middle and at the end of a step.
#[test]
fn hits_are_reported_by_lane() {
    let program = generated(&[[-50.0, 0.0], [10.0, 0.0], [50.0, 40.0]], 0.0);
    let mut points = Points::new(&program);
    let kernel = kernel(&program);
    let mut lane_frame = LaneFrame::of(&kernel);
    for lane in 0..LANES {
        // A falls by B per second; the table has a corner at -10 V.
        points.states = vec![if lane % 3 == 1 { -9.99 } else { 5.0 }, 20.0];
        lane_frame.load_lane(&kernel, lane, &mut points.frame(&kernel).unwrap());
    }
    let steps = Steps { begin: 0.0, grid: Grid::new(1e-3), first: 1, count: 9 };
    assert_eq!(kernel.steps(&mut lane_frame.frame, &program.tables, &steps), 0);
    assert_eq!(lane_frame.hit_lanes(), 0x2492);
    let mut one = kernel.frame();
    (0..LANES).filter(|lane| lane % 3 == 1).for_each(|lane| lane_frame.unload_lane(&kernel, lane, &mut one));
    assert_eq!(one.states, [-9.99, 20.0]);
    assert!(lane_frame.finish_step(&kernel, &program.tables, 1e-3));
    assert_eq!((lane_frame.active_lanes(), lane_frame.time()), (0xffff & !0x2492, 1e-3));
    assert_eq!(kernel.steps(&mut lane_frame.frame, &program.tables, &steps.after(1)), 8);
}
