//! The block of the lesson stick-slip: 2 kg on a belt, held by a spring of 200 N/m.

use std::f64::consts::TAU;

/// Velocity of the belt, in m/s, and at which the relay feels that the block slides: less than that by so much.
const BELT: f64 = 0.05;
const FELT: f64 = 1e-6;
/// sqrt(k / m), per second.
const OMEGA: f64 = 10.0;
/// Stretches of the spring, in m, at which it pulls as hard as friction of 10 N and 6 N.
const STICKING: f64 = 0.05;
const SLIDING: f64 = 0.03;

/// The stretch of the spring. The block is carried along until the spring breaks it loose, slips, and is caught again.
pub fn stretch(time: f64) -> f64 {
    let slip = slip();
    let caught = slip[2].place(slip[2].lasts);
    let slips: f64 = slip.iter().map(|swing| swing.lasts).sum();
    let first = STICKING / BELT;
    if time < first {
        return BELT * time;
    }
    let mut gone = (time - first).rem_euclid(slips + (STICKING - caught) / BELT);
    for swing in &slip {
        if gone < swing.lasts {
            return swing.place(gone);
        }
        gone -= swing.lasts;
    }
    caught + BELT * gone
}

/// Friction is 10 N until sliding is felt, then 6 N, and 10 N again from half of what is felt to standstill on the belt.
fn slip() -> [Swing; 3] {
    // The speed BELT cos(OMEGA t) falls by what is felt; written so that little is lost in rounding.
    let lasts = 2.0 * (FELT / BELT / 2.0).sqrt().asin() / OMEGA;
    let breaks_loose = Swing { about: STICKING, begin: STICKING, speed: BELT, lasts };
    let slides = breaks_loose.then(SLIDING, BELT - FELT / 2.0);
    let stops = slides.then(STICKING, BELT);
    [breaks_loose, slides, stops]
}

/// x'' = OMEGA^2 (about - x) for a time.
#[derive(Clone, Copy)]
struct Swing {
    about: f64,
    begin: f64,
    speed: f64,
    lasts: f64,
}

impl Swing {
    fn place(&self, time: f64) -> f64 {
        let (sine, cosine) = (OMEGA * time).sin_cos();
        self.about + (self.begin - self.about) * cosine + self.speed / OMEGA * sine
    }

    fn speed(&self, time: f64) -> f64 {
        let (sine, cosine) = (OMEGA * time).sin_cos();
        self.speed * cosine - OMEGA * (self.begin - self.about) * sine
    }

    /// What follows, about another place, until its speed rises through one.
    fn then(&self, about: f64, until: f64) -> Swing {
        let (begin, speed) = (self.place(self.lasts), self.speed(self.lasts));
        // The speed is the shadow of an arrow that turns by OMEGA.
        let (across, along) = (OMEGA * (begin - about), speed);
        let turned = -(until / across.hypot(along)).acos() - across.atan2(along);
        Swing { about, begin, speed, lasts: turned.rem_euclid(TAU) / OMEGA }
    }
}
