//! Events whose instant depends on a parameter.

use super::Sensitivities;
use super::column::Column;
use crate::ir::{Beside, Guard, ON_THE_KINK, Program, Slopes};
use crate::solve::error::RunError;
use crate::solve::machine::Machine;

/// Derivatives of a guard below this, in volts for a whole parameter, are 0.
pub(super) const STANDS: f64 = 1e-12;
/// Share by which rounding may make two derivatives of one instant differ.
const SAME: f64 = 1e-6;

/// A change of mode that is due.
#[derive(Clone, Copy)]
struct Due {
    element: usize,
    of_drive: bool,
    guard: Guard,
}

impl Machine<'_> {
    /// Goes to the moving instant of whatever is due now, before anything of it is carried out.
    pub(in crate::solve) fn enter_event(&mut self) -> Result<(), RunError> {
        if self.sensitivities.is_none() {
            return Ok(());
        }
        let echoes = self.lines.iter().any(|line| line.jumps_at(self.time));
        if !echoes && due(self.program, &self.modes, &self.registers).next().is_none() {
            self.beside(|own, _| own.columns.iter_mut().for_each(|column| column.event = 0.0));
            return Ok(());
        }
        let mut outcome = Ok(());
        self.beside(|own, machine| {
            own.flow_now(machine);
            for place in 0..own.columns.len() {
                match own.moves(place, machine) {
                    Ok(moves) => own.columns[place].event = moves,
                    Err(error) => outcome = Err(error),
                }
            }
            own.enter(machine);
        });
        outcome
    }

    /// Goes to the instant at which the present phase of a run began, where that moves, for something that a hand does
    /// there; nothing once it is there.
    pub(in crate::solve) fn enter_phase(&mut self) {
        self.beside(|own, machine| {
            let moves = own.columns.iter().any(|column| column.phase != 0.0);
            own.columns.iter_mut().for_each(|column| column.event = column.phase);
            if moves && !own.is_at_event {
                own.flow_now(machine);
                own.enter(machine);
            }
        });
    }

    /// Comes back to a fixed time.
    pub(in crate::solve) fn leave_event(&mut self) -> Result<(), RunError> {
        self.beside(|own, machine| own.leave(machine));
        self.check_derivatives()
    }

    /// Takes note that a phase ended with the last event.
    pub(in crate::solve) fn end_phase(&mut self) {
        self.beside(|own, _| own.columns.iter_mut().for_each(|column| column.phase = column.event));
    }
}

/// The changes of mode that are due, the first of each mode.
fn due<'a>(program: &'a Program, modes: &'a [f64], registers: &'a [f64]) -> impl Iterator<Item = Due> + 'a {
    let pairs = program.modes.iter().zip(modes);
    pairs.filter_map(|(mode, value)| {
        let mut open = mode.transitions.iter().filter(|open| open.from == *value);
        let first = open.find(|open| open.guard.holds(registers))?;
        Some(Due { element: mode.element, of_drive: mode.of_drive, guard: first.guard })
    })
}

impl Sensitivities {
    /// The slopes of all voltages of now along the motion.
    fn flow_now(&mut self, machine: &Machine<'_>) {
        for (slope, line) in self.delayed_flow.iter_mut().zip(&machine.lines) {
            *slope = line.slope_until(machine.time);
        }
        let program = machine.program;
        let from = Slopes {
            coefficients: &self.nothing,
            states: &machine.slopes,
            time: 1.0,
            delayed: &self.delayed_flow,
            kept: &self.nothing,
        };
        let (values, watched) = (machine.registers.as_slice(), program.parts.watched);
        let guide = &self.stages[machine.method.middle + 1];
        program.differentiate(0..watched, Beside { values, guide }, &from, &mut self.flow);
        let rest = watched..program.body.len();
        program.differentiate(rest, Beside { values, guide: values }, &from, &mut self.flow);
    }

    /// How the present instant moves, by everything that is due in it.
    fn moves(&self, place: usize, machine: &Machine<'_>) -> Result<f64, RunError> {
        let column = &self.columns[place];
        let guards = due(machine.program, &machine.modes, &machine.registers)
            .map(|due| Ok((self.crossing(column, due, machine)?, due.element)));
        let lines = machine.lines.iter().zip(&column.lines).zip(&machine.program.delays);
        let echoes = lines
            .filter(|((line, _), _)| line.jumps_at(machine.time))
            .map(|((_, line), delay)| Ok((line.shift_of_echo(machine.time), delay.element)));
        let mut first: Option<(f64, usize)> = None;
        for found in guards.chain(echoes) {
            let (moves, element) = found?;
            let Some((before, other)) = first else {
                first = Some((moves, element));
                continue;
            };
            if (moves - before).abs() > SAME * (moves.abs() + before.abs()) + STANDS {
                let other = machine.program.name(other);
                let why = format!("and {other} switch at the same instant, and would not for another value");
                return Err(lost(column, element, why, machine));
            }
        }
        Ok(first.map_or(0.0, |(moves, _)| moves))
    }

    /// How the instant moves at which a guard comes to its mark.
    fn crossing(&self, column: &Column, due: Due, machine: &Machine<'_>) -> Result<f64, RunError> {
        let at = due.guard.register.index();
        let (by_itself, along) = (column.registers[at], self.flow[at]);
        if by_itself.abs() <= STANDS {
            return Ok(0.0);
        }
        // Guards of drives follow time in straight lines; that of a triangle's foot comes to its mark by a jump.
        let is_fair = if due.of_drive { along != 0.0 } else { along > 0.0 && !self.grazes(due.guard, along) };
        if is_fair {
            return Ok(-by_itself / along);
        }
        let why = "only just touches the place where it switches".to_owned();
        Err(lost(column, due.element, why, machine))
    }

    /// Whether a guard turns back less than 1e-9 V beyond its mark, by the parabola through its value at the
    /// beginning of the last stretch and what it does at its end.
    fn grazes(&self, guard: Guard, along: f64) -> bool {
        let (before, way) = (guard.excess(&self.stages[0]), along * self.length);
        let bend = -(before + way);
        // A stretch that began at the mark is too short to tell.
        before < -ON_THE_KINK && bend > STANDS && way * way < 4.0 * ON_THE_KINK * bend
    }

    fn enter(&mut self, machine: &Machine<'_>) {
        self.is_at_event = true;
        for column in &mut self.columns {
            let moves = column.event;
            column.frame = moves;
            if moves != 0.0 {
                add(&mut column.states, &machine.slopes, moves);
                add(&mut column.registers, &self.flow, moves);
            }
            column.remember_values(machine.program);
        }
    }

    fn leave(&mut self, machine: &Machine<'_>) {
        if !std::mem::take(&mut self.is_at_event) {
            return;
        }
        for column in &mut self.columns {
            if column.frame != 0.0 {
                add(&mut column.states, &machine.slopes, -column.frame);
                column.frame = 0.0;
                column.evaluate(machine.program, machine.time, &machine.lines, &machine.registers);
            }
            column.put_breaks(machine, column.event);
        }
    }
}

fn add(slopes: &mut [f64], rates: &[f64], moves: f64) {
    slopes.iter_mut().zip(rates).for_each(|(slope, rate)| *slope += rate * moves);
}

fn lost(column: &Column, element: usize, why: String, machine: &Machine<'_>) -> RunError {
    RunError::DerivativeLost {
        parameter: machine.program.parameters[column.parameter].name.clone(),
        element: machine.program.name(element).to_owned(),
        why,
        time: machine.time,
    }
}
