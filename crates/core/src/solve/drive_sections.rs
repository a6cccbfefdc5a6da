//! The drives of a program over problem time, in sections between their jumps and corners.
//!
//! Within a section every drive is a smooth function of time. A machine finds the ends of the sections, so they are the
//! same instants as in a run. Another solver can then end its steps there.

use super::discontinuities::next_corner;
use super::error::RunError;
use super::lamps::Lamps;
use super::machine::Machine;
use super::observer::StepObserver;
use super::state::Solver;
use crate::ir::{Program, Scratch, Sources};

/// The drives of a program, one section of time after the other. Times are problem times in seconds.
///
/// The program is meant to have drives only. Integrators of other programs have the values of the end of the section.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::DriveSections;
///
/// let triangle = ElementBuilder::new("triangle").set("amplitude", 10).set("frequency", 0.25);
/// let patch = PatchBuilder::new("triangle").scale("force", 1, "N").drive("push", "force", triangle).build()?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let push = program.element_outputs().iter().find(|output| output.name == "push").ok_or("no drive")?;
/// let mut sections = DriveSections::new(&program, 0.01, 6.0)?;
/// // The wave rises for 1 s and then falls for 2 s.
/// assert!((sections.end() - 1.0).abs() < 1e-9);
/// assert!((sections.voltages_at(0.5)[push.register.index()] - 5.0).abs() < 1e-9);
/// sections.advance()?;
/// assert!((sections.end() - 3.0).abs() < 1e-9);
/// assert!((sections.voltages_at(1.5)[push.register.index()] - 5.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct DriveSections<'p> {
    /// A machine at the end of the present section, after the jump or corner there.
    machine: Machine<'p>,
    /// The modes within the present section.
    modes: Vec<f64>,
    /// The levels within the present section.
    levels: Vec<f64>,
    /// The end of the present section.
    end: f64,
    /// The end of the last section.
    duration: f64,
    /// Every voltage of the last evaluation.
    registers: Vec<f64>,
    /// Scratch memory of an evaluation.
    scratch: Scratch,
}

impl<'p> DriveSections<'p> {
    /// The first section of a run of this duration. Jumps and corners are found if they are at least a step apart.
    ///
    /// # Errors
    /// If the step is not a positive time, or a drive has no value.
    pub fn new(program: &'p Program, step: f64, duration: f64) -> Result<Self, RunError> {
        let mut sections = DriveSections {
            machine: Machine::new(program, step)?,
            modes: Vec::new(),
            levels: Vec::new(),
            end: 0.0,
            duration,
            registers: vec![0.0; program.lowered.body.len()],
            scratch: Scratch::new(program),
        };
        sections.advance()?;
        Ok(sections)
    }

    /// The end of the present section: the next jump or corner, or the end of the run.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Whether the present section is the last one.
    pub fn is_last(&self) -> bool {
        self.end >= self.duration
    }

    /// Moves to the section that begins at the end of the present one.
    ///
    /// # Errors
    /// If a drive has no value.
    pub fn advance(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, .. } = &self.machine.solver;
        self.modes.clone_from(&state.modes);
        self.levels.clone_from(&state.levels);
        let corner = next_corner(setup.program.corners.times(), state.time, setup.step);
        let target = corner.unwrap_or(f64::INFINITY).min(self.duration);
        let length = (target - state.time).max(0.0);
        let mut change =
            FirstChange { modes: self.modes.clone(), levels: self.levels.clone(), has_happened: false };
        self.machine.operate_observed(length, &mut change)?;
        self.end = if change.has_happened { self.machine.time() } else { target };
        Ok(())
    }

    /// Every voltage of the program at a time of the present section, by register. At the end of the section it is the
    /// voltage before the jump.
    pub fn voltages_at(&mut self, time: f64) -> &[f64] {
        let Solver { setup, state, buffers, .. } = &self.machine.solver;
        let from = Sources {
            parameters: &state.parameters,
            coefficients: &state.coefficients,
            states: &state.states,
            modes: &self.modes,
            time,
            tables: &setup.program.tables,
            delayed: &buffers.delayed,
            sampled: &state.sampled,
            levels: &self.levels,
        };
        self.scratch.forget();
        setup.program.evaluate(&from, &mut self.registers, &mut self.scratch);
        &self.registers
    }
}

/// An observer that ends the operation at the first instant at which a mode or a level changes.
struct FirstChange {
    /// The modes before the change.
    modes: Vec<f64>,
    /// The levels before the change.
    levels: Vec<f64>,
    /// Whether one of them has changed.
    has_happened: bool,
}

impl StepObserver for FirstChange {
    fn step_accepted(&mut self, _: &mut Solver<'_>) {}

    fn step_ended(&mut self, solver: &Solver<'_>) {
        let state = &solver.state;
        self.has_happened |= state.modes != self.modes || state.levels != self.levels;
    }

    fn should_stop(&self, _: &Lamps) -> bool {
        false
    }

    fn is_phase_over(&self) -> bool {
        self.has_happened
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::Patch;

    /// The program of a drive "u" in volts with these keys.
    fn program(keys: &str) -> Program {
        let scales = r#"{"volt": {"per_volt": 1, "unit": "V"}}"#;
        let drives = format!(r#"{{"u": {{{keys}, "scale": "volt"}}}}"#);
        let text = format!(r#"{{"patchcord": 1, "scales": {scales}, "drives": {drives}}}"#);
        let patch = Patch::parse("u.json", &text).unwrap_or_else(|report| panic!("{report}"));
        Program::new(&Circuit::new(&patch).unwrap()).unwrap()
    }

    /// The end of each section of a run, with the voltages of the drive at its beginning and at its end.
    fn sections(keys: &str, duration: f64) -> Vec<[f64; 3]> {
        let program = program(keys);
        let register = program.lowered.drives[0].index();
        let mut sections = DriveSections::new(&program, 0.01, duration).unwrap();
        let (mut found, mut begin) = (Vec::new(), 0.0);
        loop {
            let end = sections.end();
            let volts = [begin, end].map(|time| sections.voltages_at(time)[register]);
            found.push([end, volts[0], volts[1]]);
            if sections.is_last() {
                return found;
            }
            begin = end;
            sections.advance().unwrap();
        }
    }

    /// Asserts that the sections of a drive are these: the end, and the voltages at both ends.
    fn assert_sections(keys: &str, duration: f64, expected: &[[f64; 3]]) {
        let found = sections(keys, duration);
        assert_eq!(found.len(), expected.len(), "{keys}: {found:?}");
        for (number, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((number - expected).abs() < 1e-8, "{keys}: {found:?}");
        }
    }

    #[test]
    fn sections_end_at_jumps_and_corners() {
        let step = r#""kind": "step", "height": 4, "at": 0.333"#;
        assert_sections(step, 1.0, &[[0.333, 0.0, 0.0], [1.0, 4.0, 4.0]]);
        let ramp = r#""kind": "ramp", "rate": 3, "turn": 0.5"#;
        assert_sections(ramp, 1.0, &[[0.5, 0.0, 1.5], [1.0, 1.5, 0.0]]);
        let pulse = r#""kind": "pulse", "height": 2, "begin": 0.25, "width": 0.125"#;
        assert_sections(pulse, 1.0, &[[0.25, 0.0, 0.0], [0.375, 2.0, 2.0], [1.0, 0.0, 0.0]]);
        let table = r#""kind": "table", "points": [[0.1234, 1], [0.5, 3], [2, 9]]"#;
        assert_sections(table, 1.0, &[[0.1234, 1.0, 1.0], [0.5, 1.0, 3.0], [1.0, 3.0, 5.0]]);
        let held = r#""kind": "table", "points": [[0, 1], [0.5, 3]], "hold": "previous""#;
        assert_sections(held, 1.0, &[[0.5, 1.0, 1.0], [1.0, 3.0, 3.0]]);
    }

    #[test]
    fn a_smooth_drive_has_one_section() {
        let sine = r#""kind": "sine", "amplitude": 5, "frequency": 0.25"#;
        assert_sections(sine, 1.0, &[[1.0, 0.0, 5.0]]);
    }
}
