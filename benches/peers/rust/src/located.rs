//! The same with every kink located by hand: between kinks the piece that holds is fixed, and the crate's solver is stopped where it
//! holds no longer and begun anew there.

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dopri5, System};

use crate::{EVERY, MASS, MM, SOLID, STIFFNESS, State, TC, V_RATE, VCL, VISCOUS};

/// Side of the dead zone, direction of motion, whether it is faster than VcL.
#[derive(Clone, Copy)]
struct Piece {
    side: f64,
    sign: f64,
    beyond: bool,
}

const KINKS: usize = 4;

impl Piece {
    /// Each below 0 once the piece holds no longer: the edges of the dead zone, turning, the corner at VcL.
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
        let beyond = through - self.side * SOLID / MASS * (state[2] * state[2]);
        let share = if self.beyond { 0.0 } else { 1.0 - self.sign * velocity / VCL };
        rates[0] = STIFFNESS / MASS * (V_RATE * time - velocity);
        rates[1] = (beyond - VISCOUS / MASS * velocity) / MM;
        rates[2] = (share - state[2]) / TC;
    }

    fn solout(&mut self, _time: f64, state: &State, _rates: &State) -> bool {
        self.margins(state).iter().any(|margin| *margin < 0.0)
    }
}

/// A step, and the cubic through its ends.
struct Stretch {
    begin: f64,
    length: f64,
    states: [State; 2],
    rates: [State; 2],
}

impl Stretch {
    fn at(&self, time: f64) -> State {
        let x = (time - self.begin) / self.length;
        let y = 1.0 - x;
        self.states[0] * (y * y * (1.0 + 2.0 * x))
            + self.states[1] * (x * x * (3.0 - 2.0 * x))
            + (self.rates[0] * y - self.rates[1] * x) * (self.length * x * y)
    }

    /// When a kink is met, by halving.
    fn meets(&self, piece: Piece, kink: usize) -> f64 {
        let (mut low, mut high) = (self.begin, self.begin + self.length);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if piece.margins(&self.at(middle))[kink] < 0.0 { high = middle } else { low = middle }
        }
        high
    }
}

/// v_o every 1 ms.
pub fn solved(tolerance: f64, duration: f64) -> Vec<f64> {
    let mut piece = Piece { side: 0.0, sign: 1.0, beyond: false };
    let (mut time, mut state) = (0.0, State::new(0.0, 0.0, 1.0));
    // The first step is the crate's own guess, the first after a kink as long as the last before it.
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
        solver.integrate().expect("the solver goes to the end");
        let (times, states) = (solver.x_out(), solver.y_out());
        for index in 1..times.len() {
            let ends = [index - 1, index].map(|end| {
                let mut rates = State::zeros();
                piece.system(times[end], &states[end], &mut rates);
                rates
            });
            let stretch = Stretch {
                begin: times[index - 1],
                length: times[index] - times[index - 1],
                states: [states[index - 1], states[index]],
                rates: ends,
            };
            let passed = piece.margins(&states[index]);
            let met =
                (0..KINKS).filter(|kink| passed[*kink] < 0.0).map(|kink| (stretch.meets(piece, kink), kink));
            let first = met.min_by(|one, other| one.0.total_cmp(&other.0));
            let end = first.map_or(times[index], |(end, _)| end);
            while velocities.len() as f64 * EVERY <= end {
                velocities.push(stretch.at(velocities.len() as f64 * EVERY)[1] * MM);
            }
            (time, state) = (end, stretch.at(end));
            if let Some((_, kink)) = first {
                piece.change(kink);
                step = stretch.length;
                break;
            }
        }
    }
    velocities
}

/// Longer steps would miss kinks that are met twice within one, in seconds.
const LONGEST: f64 = 2.5e-4;
