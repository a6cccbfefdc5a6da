//! Where in a step the first event comes.

/// An event is found when its place in the step is known to this share of the step.
const FOUND: f64 = 1e-13;
/// So many looks follow the curve; after them one in three halves, and both ends come nearer.
const CURVED: usize = 7;
/// So many make the rest smaller than the step's rounding.
const MOST_LOOKS: usize = 150;

/// Something that can look ahead by a step, and see what comes on the way.
pub(super) trait Ahead {
    type Event: Copy + PartialEq;
    /// Looks ahead by a step of this length.
    fn look(&mut self, length: f64);
    /// Something that comes on the way to what was looked at.
    fn event(&self) -> Option<Self::Event>;
    /// Whether the step last looked at hints at an event that its end does not show.
    fn is_hinted(&self) -> bool;
    /// Where in the step that is.
    fn middle(&self) -> f64;
    /// How far past an event the present is; negative before it.
    fn excess_now(&self, event: Self::Event) -> f64;
    /// The same of what was looked at.
    fn excess(&self, event: Self::Event) -> f64;
    /// Within so many volts of it a step may end on either side; 0 where it must end past it.
    fn room(&self, event: Self::Event) -> f64;
}

/// The share of the step looked at after which the first event comes, and which it is. Leaves the look at that
/// place. What comes and goes before it is found where a stage hints at it. It may be known near which share it is.
pub(super) fn first_event<A: Ahead>(
    ahead: &mut A,
    length: f64,
    near: Option<f64>,
) -> (f64, Option<A::Event>) {
    let (mut share, mut first) = (1.0, ahead.event());
    if let Some(event) = &mut first {
        (share, *event) = located(ahead, length, *event, near);
    }
    for _ in 0..MOST_LOOKS {
        if !ahead.is_hinted() {
            break;
        }
        let earlier = share * ahead.middle();
        ahead.look(earlier * length);
        let Some(event) = ahead.event() else {
            ahead.look(share * length);
            break;
        };
        let (place, event) = located(ahead, earlier * length, event, None);
        (share, first) = (earlier * place, Some(event));
    }
    (share, first)
}

/// The share of the step looked at after which the first event comes: where the curve through its last excesses is 0, kept
/// safe by halving.
fn located<A: Ahead>(
    ahead: &mut A,
    length: f64,
    mut event: A::Event,
    mut near: Option<f64>,
) -> (f64, A::Event) {
    let mut bracket = Bracket::new(ahead.excess_now(event), ahead.excess(event));
    for look in 0..MOST_LOOKS {
        if bracket.width() <= FOUND {
            break;
        }
        let room = ahead.room(event);
        let zero = if room > 0.0 { bracket.zero() } else { bracket.beside_zero() };
        let place = near.take().unwrap_or(zero);
        let middle = bracket.guess(place, look);
        ahead.look(middle * length);
        match ahead.event() {
            Some(first) if first != event => {
                event = first;
                bracket.change(middle, ahead.excess(event));
            }
            met => {
                let excess = ahead.excess(event);
                if excess.abs() < room {
                    return (middle, event);
                }
                bracket.narrow(middle, excess, met.is_some());
            }
        }
    }
    if bracket.looked_at() < bracket.high {
        ahead.look(bracket.high * length);
    }
    (bracket.high, event)
}

/// Shares of a step between which an event comes, and what is known of it.
struct Bracket {
    low: f64,
    high: f64,
    /// Shares with the excess there, the latest first, and how many they are.
    latest: [[f64; 2]; 4],
    known: usize,
}

impl Bracket {
    fn new(low_excess: f64, high_excess: f64) -> Self {
        let none = [f64::NAN; 2];
        Bracket { low: 0.0, high: 1.0, latest: [[1.0, high_excess], [0.0, low_excess], none, none], known: 2 }
    }

    /// The share looked at last.
    fn looked_at(&self) -> f64 {
        self.latest[0][0]
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }

    /// Just before where the curve through what is known is 0, or, where the lower end is there already, just past it: two looks
    /// that show that it is there.
    fn beside_zero(&self) -> f64 {
        let zero = self.zero();
        if zero - self.low > FOUND { zero - 0.5 * FOUND } else { zero + 0.5 * FOUND }
    }

    /// A place strictly between the ends: the one that is wanted, or half-way. After many looks it is not too near to either.
    fn guess(&self, place: f64, look: usize) -> f64 {
        let width = self.width();
        let edge = if look >= CURVED { FOUND.max(width * 1e-3) } else { FOUND } * 0.5;
        let halve = look >= CURVED && look.is_multiple_of(3);
        if halve || !(self.low..=self.high).contains(&place) {
            self.low + 0.5 * width
        } else {
            place.clamp(self.low + edge, self.high - edge)
        }
    }

    /// Where the excess would be 0 if the share were a polynomial of it (Lagrange); none of a single share.
    fn zero(&self) -> f64 {
        let known = &self.latest[..self.known];
        let weight = |excess: f64| -> f64 {
            let others = known.iter().filter(|[_, other]| *other != excess);
            others.map(|[_, other]| other / (other - excess)).product()
        };
        if known.len() < 2 {
            f64::NAN
        } else {
            known.iter().map(|[share, excess]| share * weight(*excess)).sum()
        }
    }

    /// Moves one end, to where the event has come or not.
    fn narrow(&mut self, to: f64, excess: f64, has_come: bool) {
        *(if has_come { &mut self.high } else { &mut self.low }) = to;
        self.latest.rotate_right(1);
        self.latest[0] = [to, excess];
        self.known = (self.known + 1).min(self.latest.len());
    }

    /// Moves the upper end to where another event has come, of whose past nothing is known.
    fn change(&mut self, to: f64, excess: f64) {
        self.known = 0;
        self.narrow(to, excess, true);
    }
}
