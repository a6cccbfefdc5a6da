//! Fig 8.16 with hand-written location of kinks.
//!
//! Between kinks the active piece of the equations is fixed. The crate's solver stops when the state leaves the piece.
//! The kink is located on a cubic, and the solver starts again from there with the next piece.

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dopri5, System};

use crate::{EVERY, MASS, MM, SOLID, STIFFNESS, State, TC, V_RATE, VCL, VISCOUS};

/// The active piece: side of the dead zone (-1, 0, 1), sign of the velocity, whether the speed exceeds VcL.
#[derive(Clone, Copy)]
struct Piece {
    side: f64,
    sign: f64,
    beyond: bool,
}

/// Both edges of the dead zone, zero velocity, and the corner at VcL.
const KINKS: usize = 4;

impl Piece {
    /// The distances to the kinks. Each is negative if its kink is passed.
    fn margins(&self, state: &State) -> [f64; KINKS] {
        let level = SOLID / MASS * (state[2] * state[2]);
        let (plus, minus, speed) = (state[0] - level, state[0] + level, self.sign * state[1]);
        let corner = VCL / MM - speed;
        [
            if self.side > 0.0 { plus } else { -plus },
            if self.side < 0.0 { -minus } else { minus },
            speed,
            if self.beyond { -corner } else { corner },
        ]
    }

    /// Changes the piece at a kink.
    fn change(&mut self, kink: usize) {
        match kink {
            0 => self.side = if self.side > 0.0 { 0.0 } else { 1.0 },
            1 => self.side = if self.side < 0.0 { 0.0 } else { -1.0 },
            2 => self.sign = -self.sign,
            _ => self.beyond = !self.beyond,
        }
    }
}

impl System<f64, State> for Piece {
    fn system(&self, time: f64, state: &State, rates: &mut State) {
        let velocity = state[1] * MM;
        let through = if self.side == 0.0 { 0.0 } else { state[0] };
        let dead_zone = through - self.side * SOLID / MASS * (state[2] * state[2]);
        let share = if self.beyond { 0.0 } else { 1.0 - self.sign * velocity / VCL };
        rates[0] = STIFFNESS / MASS * (V_RATE * time - velocity);
        rates[1] = (dead_zone - VISCOUS / MASS * velocity) / MM;
        rates[2] = (share - state[2]) / TC;
    }

    fn solout(&mut self, _time: f64, state: &State, _rates: &State) -> bool {
        self.margins(state).iter().any(|margin| *margin < 0.0)
    }
}

/// A step with the cubic through its ends and their rates.
struct CubicStep {
    begin: f64,
    length: f64,
    states: [State; 2],
    rates: [State; 2],
}

impl CubicStep {
    /// The step between two times, with the states there.
    fn between(piece: Piece, times: [f64; 2], states: [State; 2]) -> Self {
        let rates = [0, 1].map(|end| {
            let mut rates = State::zeros();
            piece.system(times[end], &states[end], &mut rates);
            rates
        });
        CubicStep { begin: times[0], length: times[1] - times[0], states, rates }
    }

    /// The state at a time within the step.
    fn at(&self, time: f64) -> State {
        let x = (time - self.begin) / self.length;
        let y = 1.0 - x;
        self.states[0] * (y * y * (1.0 + 2.0 * x))
            + self.states[1] * (x * x * (3.0 - 2.0 * x))
            + (self.rates[0] * y - self.rates[1] * x) * (self.length * x * y)
    }

    /// The time of a kink, by bisection.
    fn kink_time(&self, piece: Piece, kink: usize) -> f64 {
        let (mut low, mut high) = (self.begin, self.begin + self.length);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if piece.margins(&self.at(middle))[kink] < 0.0 { high = middle } else { low = middle }
        }
        high
    }

    /// The time and the index of the first kink in the step. `None` if no kink is passed at its end.
    fn first_kink(&self, piece: Piece) -> Option<(f64, usize)> {
        let passed = piece.margins(&self.states[1]);
        let kinks = (0..KINKS).filter(|kink| passed[*kink] < 0.0);
        let located = kinks.map(|kink| (self.kink_time(piece, kink), kink));
        located.min_by(|kink, other| kink.0.total_cmp(&other.0))
    }
}

/// The velocity v_o in m/s every 1 ms.
pub fn solve(tolerance: f64, duration: f64) -> Vec<f64> {
    let mut piece = Piece { side: 0.0, sign: 1.0, beyond: false };
    let (mut time, mut state) = (0.0, State::new(0.0, 0.0, 1.0));
    // The crate chooses the first step. After a kink, the first step is as long as the last one before it.
    let (mut velocities, mut step) = (Vec::new(), 0.0);
    while time < duration {
        let mut solver = Dopri5::from_param(
            piece,
            time,
            duration,
            EVERY,
            state,
            tolerance,
            tolerance,
            0.9,
            0.04,
            0.2,
            10.0,
            LONGEST,
            step,
            u32::MAX,
            u32::MAX,
            OutputType::Sparse,
        );
        solver.integrate().expect("the solver must reach the end");
        let (times, states) = (solver.x_out(), solver.y_out());
        for index in 1..times.len() {
            let ends = [index - 1, index];
            let cubic = CubicStep::between(piece, ends.map(|end| times[end]), ends.map(|end| states[end]));
            let first = cubic.first_kink(piece);
            let end = first.map_or(times[index], |(end, _)| end);
            while velocities.len() as f64 * EVERY <= end {
                velocities.push(cubic.at(velocities.len() as f64 * EVERY)[1] * MM);
            }
            (time, state) = (end, cubic.at(end));
            if let Some((_, kink)) = first {
                piece.change(kink);
                step = cubic.length;
                break;
            }
        }
    }
    velocities
}

/// The longest step in s. Longer steps would miss kinks that are passed twice within one step.
const LONGEST: f64 = 2.5e-4;
