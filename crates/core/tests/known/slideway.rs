//! The slideway of the thesis in physical units, written down apart from any wiring.

use super::equations::Equations;

/// How solid friction depends on velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// None at all.
    Absent,
    /// The same at every velocity.
    Constant,
    /// Straight down to 0 at VcL.
    Straight,
    /// Down to 0 at VcL along a square law.
    Square,
    /// The same, following velocity with the lag Tc.
    Remembered,
    /// Down along the square law, what comes of it following with the lag Tc.
    Followed,
}

/// e' = v_in - v, w = K (e + x_step), M v' = dead_zone(w, F) - f v, Tc u' = (1 - min(|v| / VcL, 1)) - u, or its square less u; with a brake
/// M v' = w - F sign(v) - f v, and v = 0 where it stands and |w| <= F, or w <= F where it goes one way.
#[derive(Debug, Clone)]
pub struct Slideway {
    pub law: Law,
    /// Whether solid friction is a brake, and not a dead zone in the spring's force.
    pub brake: bool,
    /// Whether the brake holds whatever pulls back.
    pub one_way: bool,
    pub mass: f64,
    pub stiffness: f64,
    pub viscous: f64,
    pub solid: f64,
    /// What of solid friction never falls.
    pub kept: f64,
    pub vcl: f64,
    pub tc: f64,
    pub v_start: f64,
    pub v_rate: f64,
    pub v_turn: f64,
    pub x_step: f64,
}

/// Position error, output velocity, remembered share of friction.
type State = [f64; 3];

const AT_REST: State = [0.0, 0.0, 1.0];

/// A velocity in m/s that is the rounding of one that has just come to 0.
const STANDING_STILL: f64 = 1e-15;

impl Slideway {
    /// The final setting of the thesis (8.4) in a law.
    pub const fn thesis(law: Law) -> Self {
        Slideway {
            law,
            brake: false,
            one_way: false,
            mass: 433.0,
            stiffness: 45e6,
            viscous: 10.7e3,
            solid: 771.0,
            kept: 0.0,
            vcl: 2.54e-3,
            tc: 0.0065,
            v_start: 0.0,
            v_rate: 1.2e-3,
            v_turn: 3600.0,
            x_step: 0.0,
        }
    }

    /// The setting of Fig 8.8, which answers a step of 0.127 mm, in a law.
    pub const fn step_response(law: Law) -> Self {
        Slideway {
            mass: 454.0,
            stiffness: 17.86e6,
            viscous: 17.86e3,
            v_rate: 0.0,
            x_step: 0.127e-3,
            ..Slideway::thesis(law)
        }
    }

    /// The same setting for the patch of its law.
    pub fn changes(&self) -> Vec<(&'static str, f64)> {
        let mut changes = vec![
            ("M", self.mass),
            ("K", self.stiffness),
            ("f", self.viscous),
            ("v_start", self.v_start),
            ("v_rate", self.v_rate),
            ("v_turn", self.v_turn),
            ("x_step", self.x_step),
        ];
        if self.law != Law::Absent {
            changes.push(("Fs", self.solid));
        }
        if !matches!(self.law, Law::Absent | Law::Constant) {
            changes.push(("VcL", self.vcl));
        }
        if matches!(self.law, Law::Remembered | Law::Followed) {
            changes.push(("Tc", self.tc));
        }
        changes
    }

    /// Output velocity at 0, every, 2 every, ... by steps of this length.
    pub fn velocity(&self, duration: f64, every: f64, step: f64) -> Vec<f64> {
        self.course(AT_REST, duration, every, step).into_iter().map(|[_, velocity, _]| velocity).collect()
    }

    /// Output velocity without solid friction and before the turn, in closed form: position error y and output velocity v of
    /// y' = v_start + v_rate t - v, M v' = K y - f v, from y = x_step and v = 0: what moves with the ramp, and a damped
    /// oscillation about it.
    pub fn linear_velocity(&self, time: f64) -> f64 {
        let Slideway { mass, stiffness, viscous, v_start, v_rate, x_step, .. } = *self;
        let (wn, decay) = ((stiffness / mass).sqrt(), viscous / (2.0 * mass));
        let wd = (wn * wn - decay * decay).sqrt();
        let behind = v_start - viscous * v_rate / stiffness;
        let error_at_start = (mass * v_rate + viscous * behind) / stiffness;
        // Of the oscillation: position error and velocity at t = 0; velocity is the error's rate without sign.
        let (error, velocity) = (x_step - error_at_start, -behind);
        let acceleration = (stiffness * error - viscous * velocity) / mass;
        let sine = (acceleration + decay * velocity) / wd;
        let swing = (-decay * time).exp() * (velocity * (wd * time).cos() + sine * (wd * time).sin());
        behind + v_rate * time + swing
    }

    /// What is left of friction at a velocity, before the law's own curve.
    fn share(&self, velocity: f64) -> f64 {
        1.0 - (velocity.abs() / self.vcl).min(1.0)
    }

    fn friction(&self, share: f64, memory: f64) -> f64 {
        let left = match self.law {
            Law::Absent => 0.0,
            Law::Constant => 1.0,
            Law::Straight => share,
            Law::Square => share * share,
            Law::Remembered => memory * memory,
            Law::Followed => memory,
        };
        self.kept + (self.solid - self.kept) * left
    }
}

impl Equations<3, 6> for Slideway {
    /// Edges of the dead zone, the velocity's sign, VcL, and the memory's end.
    fn kinks(&self, [error, velocity, memory]: State) -> [f64; 6] {
        let spring = self.stiffness * (error + self.x_step);
        let friction = self.friction(self.share(velocity), memory.max(0.0));
        [spring - friction, spring + friction, velocity, velocity - self.vcl, velocity + self.vcl, memory]
    }

    fn turn(&self) -> f64 {
        self.v_turn
    }

    /// A brake holds what comes to stand.
    fn settled(&self, [error, velocity, memory]: State) -> State {
        let [above, below, ..] = self.kinks([error, velocity, memory]);
        let held = above <= 0.0 && (below >= 0.0 || self.one_way);
        let stands = self.brake && velocity.abs() < STANDING_STILL && held;
        [error, if stands { 0.0 } else { velocity }, memory]
    }

    fn rates(&self, [error, velocity, memory]: State, time: f64, sides: [f64; 6]) -> State {
        let [above, below, forward, fast, back, remembered] = sides.map(|side| side >= 0.0);
        let spring = self.stiffness * (error + self.x_step);
        let speed = if forward { velocity } else { -velocity };
        let share = if fast || !back { 0.0 } else { 1.0 - speed / self.vcl };
        let friction = self.friction(share, if remembered { memory } else { 0.0 });
        let is_held = !above && (below || self.one_way);
        // What of the force lies beyond the dead zone.
        let above = if above { spring - friction } else { 0.0 };
        let below = if below { 0.0 } else { spring + friction };
        let beyond = match (self.brake, forward) {
            (false, _) => above + below,
            (true, _) if is_held && velocity == 0.0 => 0.0,
            (true, true) => spring - friction,
            (true, false) => spring + friction,
        };
        let accelerating = beyond - self.viscous * velocity;
        let commanded = self.v_start + self.v_rate * time.min(2.0 * self.v_turn - time);
        let followed = if self.law == Law::Followed { share * share } else { share };
        [commanded - velocity, accelerating / self.mass, (followed - memory) / self.tc]
    }
}
