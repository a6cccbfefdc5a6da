//! The slideway of the thesis in physical units, independent of any wiring.

use super::equations::Equations;

/// How solid friction depends on velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum FrictionLaw {
    /// No solid friction.
    Absent,
    /// Equal at every velocity.
    Constant,
    /// A straight fall to 0 at VcL.
    Linear,
    /// A fall to 0 at VcL by a square law.
    Square,
    /// The velocity passes through the lag Tc, and then friction falls by the square law.
    LagBeforeSquare,
    /// Friction falls by the square law, and then passes through the lag Tc.
    LagAfterSquare,
}

/// The slideway `e' = v_in - v`, `M v' = dead_zone(w, F) - f v` with the spring force `w = K (e + x_step)`.
///
/// The friction memory is `Tc u' = s - u` or `Tc u' = s^2 - u` with `s = 1 - min(|v| / VcL, 1)`. With a brake,
/// `M v' = w - F sign(v) - f v`; at standstill v stays 0 if |w| <= F, or if w <= F when the brake is one-way.
#[derive(Debug, Clone)]
pub(crate) struct Slideway {
    pub law: FrictionLaw,
    /// True if solid friction is a brake; false if it is a dead zone in the spring force.
    pub brake: bool,
    /// True if the brake holds against every backward force.
    pub one_way: bool,
    /// Mass M in kg.
    pub mass: f64,
    /// Stiffness K in N/m.
    pub stiffness: f64,
    /// Viscous friction f in N s/m.
    pub viscous: f64,
    /// Solid friction Fs at standstill in N.
    pub solid: f64,
    /// The part of solid friction in N that never falls.
    pub constant_part: f64,
    /// Velocity VcL in m/s at which friction has fallen completely.
    pub vcl: f64,
    /// Time constant Tc of the friction memory in s.
    pub tc: f64,
    /// Drive velocity at t = 0 in m/s.
    pub v_start: f64,
    /// Acceleration of the drive in m/s2.
    pub v_rate: f64,
    /// Time in s at which the drive's acceleration changes its sign.
    pub v_turn: f64,
    /// Step of the drive position at t = 0 in m.
    pub x_step: f64,
}

/// Position error in m, output velocity in m/s, friction memory 0 ... 1.
type State = [f64; 3];

/// The state at t = 0.
const AT_REST: State = [0.0, 0.0, 1.0];

/// Velocities below this, in m/s, are rounding of a velocity that has just reached 0.
const STANDSTILL_ROUNDING: f64 = 1e-15;

impl Slideway {
    /// The final setting of the thesis (8.4) with a friction law.
    pub(crate) const fn thesis(law: FrictionLaw) -> Self {
        Slideway {
            law,
            brake: false,
            one_way: false,
            mass: 433.0,
            stiffness: 45e6,
            viscous: 10.7e3,
            solid: 771.0,
            constant_part: 0.0,
            vcl: 2.54e-3,
            tc: 0.0065,
            v_start: 0.0,
            v_rate: 1.2e-3,
            v_turn: 3600.0,
            x_step: 0.0,
        }
    }

    /// The setting of Fig 8.8 with a friction law: the response to a step of 0.127 mm.
    pub(crate) const fn step_response(law: FrictionLaw) -> Self {
        Slideway {
            mass: 454.0,
            stiffness: 17.86e6,
            viscous: 17.86e3,
            v_rate: 0.0,
            x_step: 0.127e-3,
            ..Slideway::thesis(law)
        }
    }

    /// The parameter values of this setting for the patch of its friction law.
    pub(crate) fn changes(&self) -> Vec<(&'static str, f64)> {
        let mut changes = vec![
            ("M", self.mass),
            ("K", self.stiffness),
            ("f", self.viscous),
            ("v_start", self.v_start),
            ("v_rate", self.v_rate),
            ("v_turn", self.v_turn),
            ("x_step", self.x_step),
        ];
        if self.law != FrictionLaw::Absent {
            changes.push(("Fs", self.solid));
        }
        if !matches!(self.law, FrictionLaw::Absent | FrictionLaw::Constant) {
            changes.push(("VcL", self.vcl));
        }
        if matches!(self.law, FrictionLaw::LagBeforeSquare | FrictionLaw::LagAfterSquare) {
            changes.push(("Tc", self.tc));
        }
        changes
    }

    /// Output velocity in m/s at 0, every, 2 every, ... All arguments are in seconds.
    pub(crate) fn velocity(&self, duration: f64, every: f64, step: f64) -> Vec<f64> {
        self.integrate(AT_REST, duration, every, step).into_iter().map(|[_, velocity, _]| velocity).collect()
    }

    /// Output velocity in m/s without solid friction and before `v_turn`, in closed form. It solves
    /// y' = v_start + v_rate t - v, M v' = K y - f v from y = x_step and v = 0. The solution is a ramp plus a damped
    /// oscillation.
    pub(crate) fn linear_velocity(&self, time: f64) -> f64 {
        let Slideway { mass, stiffness, viscous, v_start, v_rate, x_step, .. } = *self;
        let (wn, decay) = ((stiffness / mass).sqrt(), viscous / (2.0 * mass));
        let wd = (wn * wn - decay * decay).sqrt();
        let ramp_start = v_start - viscous * v_rate / stiffness;
        let error_at_start = (mass * v_rate + viscous * ramp_start) / stiffness;
        // Position error and velocity of the oscillation at t = 0. The velocity is minus the error's rate.
        let (error, velocity) = (x_step - error_at_start, -ramp_start);
        let acceleration = (stiffness * error - viscous * velocity) / mass;
        let sine = (acceleration + decay * velocity) / wd;
        let swing = (-decay * time).exp() * (velocity * (wd * time).cos() + sine * (wd * time).sin());
        ramp_start + v_rate * time + swing
    }

    /// The fraction of friction that remains at a velocity by the straight law.
    fn fraction(&self, velocity: f64) -> f64 {
        1.0 - (velocity.abs() / self.vcl).min(1.0)
    }

    /// Solid friction in N by the fraction of the straight law and the friction memory.
    fn friction(&self, fraction: f64, memory: f64) -> f64 {
        let remaining = match self.law {
            FrictionLaw::Absent => 0.0,
            FrictionLaw::Constant => 1.0,
            FrictionLaw::Linear => fraction,
            FrictionLaw::Square => fraction * fraction,
            FrictionLaw::LagBeforeSquare => memory * memory,
            FrictionLaw::LagAfterSquare => memory,
        };
        self.constant_part + (self.solid - self.constant_part) * remaining
    }
}

impl Equations<3, 6> for Slideway {
    /// The two edges of the dead zone, the velocity, VcL in both directions, and the empty memory.
    fn kinks(&self, [error, velocity, memory]: State) -> [f64; 6] {
        let spring = self.stiffness * (error + self.x_step);
        let friction = self.friction(self.fraction(velocity), memory.max(0.0));
        [spring - friction, spring + friction, velocity, velocity - self.vcl, velocity + self.vcl, memory]
    }

    fn drive_corner(&self) -> f64 {
        self.v_turn
    }

    /// A brake holds the slide at standstill.
    fn held_at_kink(&self, [error, velocity, memory]: State) -> State {
        let [above, below, ..] = self.kinks([error, velocity, memory]);
        let can_hold = above <= 0.0 && (below >= 0.0 || self.one_way);
        let stops = self.brake && velocity.abs() < STANDSTILL_ROUNDING && can_hold;
        [error, if stops { 0.0 } else { velocity }, memory]
    }

    fn rates(&self, [error, velocity, memory]: State, time: f64, sides: [f64; 6]) -> State {
        let [above, below, forward, fast, back, has_memory] = sides.map(|side| side >= 0.0);
        let spring = self.stiffness * (error + self.x_step);
        let speed = if forward { velocity } else { -velocity };
        let fraction = if fast || !back { 0.0 } else { 1.0 - speed / self.vcl };
        let friction = self.friction(fraction, if has_memory { memory } else { 0.0 });
        let is_held = !above && (below || self.one_way);
        // The part of the force that exceeds the dead zone.
        let above = if above { spring - friction } else { 0.0 };
        let below = if below { 0.0 } else { spring + friction };
        let net_force = match (self.brake, forward) {
            (false, _) => above + below,
            (true, _) if is_held && velocity == 0.0 => 0.0,
            (true, true) => spring - friction,
            (true, false) => spring + friction,
        };
        let accelerating = net_force - self.viscous * velocity;
        let commanded = self.v_start + self.v_rate * time.min(2.0 * self.v_turn - time);
        let lag_input = if self.law == FrictionLaw::LagAfterSquare { fraction * fraction } else { fraction };
        [commanded - velocity, accelerating / self.mass, (lag_input - memory) / self.tc]
    }
}
