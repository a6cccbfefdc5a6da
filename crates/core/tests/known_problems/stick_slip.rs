//! The block of the lesson stick-slip: 2 kg on a belt, held by a spring of 200 N/m.

use std::f64::consts::TAU;

/// Velocity of the belt in m/s.
const BELT: f64 = 0.05;
/// The relay detects a slip when the block is slower than the belt by this velocity in m/s.
const SLIP_THRESHOLD: f64 = 1e-6;
/// Natural frequency sqrt(k / m) in rad/s.
const OMEGA: f64 = 10.0;
/// Stretch of the spring in m at which its force equals the static friction of 10 N.
const STICKING: f64 = 0.05;
/// Stretch of the spring in m at which its force equals the sliding friction of 6 N.
const SLIDING: f64 = 0.03;

/// The stretch of the spring in m. The belt carries the block along until the spring force exceeds friction. Then the
/// block slips until it sticks again.
pub(super) fn stretch(time: f64) -> f64 {
    let slip = slip();
    let caught = slip[2].position(slip[2].duration);
    let slips: f64 = slip.iter().map(|swing| swing.duration).sum();
    let first = STICKING / BELT;
    if time < first {
        return BELT * time;
    }
    let mut elapsed = (time - first).rem_euclid(slips + (STICKING - caught) / BELT);
    for swing in &slip {
        if elapsed < swing.duration {
            return swing.position(elapsed);
        }
        elapsed -= swing.duration;
    }
    caught + BELT * elapsed
}

/// The three swings of a slip. Friction is 10 N until the relay detects the slip, then 6 N. It is 10 N again from half
/// the threshold until the block stands on the belt.
fn slip() -> [Swing; 3] {
    // The time in which BELT cos(OMEGA t) falls by SLIP_THRESHOLD, in a form with little rounding.
    let duration = 2.0 * (SLIP_THRESHOLD / BELT / 2.0).sqrt().asin() / OMEGA;
    let breaks_loose = Swing { centre: STICKING, begin: STICKING, speed: BELT, duration };
    let slides = breaks_loose.then(SLIDING, BELT - SLIP_THRESHOLD / 2.0);
    let stops = slides.then(STICKING, BELT);
    [breaks_loose, slides, stops]
}

/// A solution of x'' = OMEGA^2 (centre - x) from a position in m and a speed in m/s, for a duration in seconds.
#[derive(Clone, Copy)]
struct Swing {
    centre: f64,
    begin: f64,
    speed: f64,
    duration: f64,
}

impl Swing {
    fn position(&self, time: f64) -> f64 {
        let (sine, cosine) = (OMEGA * time).sin_cos();
        self.centre + (self.begin - self.centre) * cosine + self.speed / OMEGA * sine
    }

    fn speed(&self, time: f64) -> f64 {
        let (sine, cosine) = (OMEGA * time).sin_cos();
        self.speed * cosine - OMEGA * (self.begin - self.centre) * sine
    }

    /// The next swing, about another centre, until its speed rises through `until`.
    fn then(&self, centre: f64, until: f64) -> Swing {
        let (begin, speed) = (self.position(self.duration), self.speed(self.duration));
        // The speed is one component of a vector that rotates with OMEGA.
        let (across, along) = (OMEGA * (begin - centre), speed);
        let angle = -(until / across.hypot(along)).acos() - across.atan2(along);
        Swing { centre, begin, speed, duration: angle.rem_euclid(TAU) / OMEGA }
    }
}
