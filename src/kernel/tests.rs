//! A kernel against the program that it was folded from, one evaluation at a time.

use std::path::{Path, PathBuf};

use super::Kernel;
use crate::circuit::Circuit;
use crate::patch::Patch;
use crate::program::{Program, Register, Scratch, Sources};

/// Numbers drawn by chance, the same every time (Park and Miller's generator).
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0 * 48271 % 2_147_483_647;
        low + (high - low) * self.0 as f64 / 2_147_483_647.0
    }
}

fn patches() -> Vec<PathBuf> {
    let folders = ["patches/thesis", "patches/lessons", "tests/patches"];
    let files = folders.into_iter().flat_map(|folder| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path())
    });
    let mut patches: Vec<_> =
        files.filter(|file| file.extension().is_some_and(|end| end == "json")).collect();
    patches.sort();
    patches
}

fn program(file: &Path) -> Option<Program> {
    let circuit = Circuit::new(&Patch::read(file).ok()?, &[]).ok()?;
    Program::new(&circuit).ok()
}

/// A program at points drawn by chance, in the modes that hold there.
struct Points<'p> {
    program: &'p Program,
    coefficients: Vec<f64>,
    registers: Vec<f64>,
    modes: Vec<f64>,
    states: Vec<f64>,
    kept: Vec<f64>,
    noise: Vec<f64>,
    time: f64,
}

impl<'p> Points<'p> {
    fn new(program: &'p Program) -> Self {
        let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
        Points {
            program,
            coefficients: program.prepare(&parameters),
            registers: vec![0.0; program.body.len()],
            modes: Vec::new(),
            states: Vec::new(),
            kept: Vec::new(),
            noise: Vec::new(),
            time: 0.0,
        }
    }

    /// Draws one near initial condition, where amplifiers of large gain stay within their range.
    fn draw(&mut self, dice: &mut Dice) {
        let size = 10f64.powf(dice.between(-2.0, 2.0));
        let mut volts = |count: usize| (0..count).map(|_| dice.between(-size, size)).collect::<Vec<f64>>();
        (self.states, self.kept) = (volts(self.program.states.len()), volts(self.program.kept.len()));
        self.noise = volts(self.program.noises.len());
        self.time = dice.between(0.0, 1.0);
        for (volts, state) in self.states.iter_mut().zip(&self.program.states) {
            *volts += self.coefficients[state.initial as usize];
        }
        self.modes = self.program.modes.iter().map(|mode| mode.initial).collect();
        for _ in 0..20 {
            self.evaluate();
            let mut any = false;
            let program = self.program;
            program.change_modes(&self.registers, &mut self.modes, &mut self.states, |_, _| any = true);
            if !any {
                return;
            }
        }
    }

    fn evaluate(&mut self) {
        let from = Sources {
            coefficients: &self.coefficients,
            states: &self.states,
            modes: &self.modes,
            time: self.time,
            tables: &self.program.tables,
            kept: &self.kept,
            noise: &self.noise,
            ..Sources::none()
        };
        self.program.evaluate(&from, &mut self.registers, &mut Scratch::new(self.program));
    }

    /// Volts by which the kernel differs at most in outputs, and in rates of up to 1000 V/s: larger ones carry more
    /// rounding. Nothing where the kernel does not hold.
    fn difference(&self, outputs: &[Register]) -> Option<f64> {
        let program = self.program;
        let folded = program.kernels.of(program, &self.modes, outputs)?;
        let kernel = &folded.kernel;
        let mut frame = kernel.frame::<f64>();
        frame.put_standing(kernel, 0, &self.kept, &self.noise);
        frame.states.copy_from_slice(&self.states);
        frame.time = self.time;
        kernel.settle(&mut frame, program, &self.coefficients, 0, true).then_some(())?;
        let outputs = outputs.iter().enumerate().map(|(index, register)| {
            (frame.last_seen(kernel, index, 0) - self.registers[register.index()]).abs()
        });
        let rates = kernel.rates.iter().zip(&program.states).map(|(slot, state)| {
            let rate = self.registers[state.rate.index()];
            (frame.slots[*slot as usize] - rate).abs() / (rate.abs() / 1e3).max(1.0)
        });
        Some(outputs.chain(rates).fold(0.0, f64::max))
    }
}

#[test]
fn folding_changes_no_voltage_by_more_than_rounding() {
    let mut dice = Dice(20);
    for file in patches() {
        let program = program(&file).filter(|program| program.loops.is_empty() && program.delays.is_empty());
        let Some(program) = program else { continue };
        let outputs: Vec<Register> = program.elements.iter().map(|outlet| outlet.register).collect();
        let mut points = Points::new(&program);
        let mut held = 0;
        for _ in 0..200 {
            points.draw(&mut dice);
            if let Some(difference) = points.difference(&outputs) {
                assert!(difference <= 1e-10, "{}: {difference:e} V", file.display());
                held += 1;
            }
        }
        assert!(held >= 100, "{}: {held} points", file.display());
    }
}

#[test]
fn signs_gains_and_potentiometers_leave_sums() {
    let program = program("patches/thesis/fig-8-16.json".as_ref()).unwrap();
    let modes: Vec<f64> = program.modes.iter().map(|mode| mode.initial).collect();
    let kernel = Kernel::new(&program, &modes, &[]).unwrap();
    // The square of the friction level, and three rates: between its corners everything else is straight.
    assert!(kernel.moving.instructions.len() <= 4, "{:?}", kernel.moving);
    // Five corners, and no amplifier twice that gives the negative of another.
    assert!(kernel.watches.len() <= 18, "{:?}", kernel.watches);
}
