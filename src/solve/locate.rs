//! Where in a step the first event comes.

/// An event is found when its place in the step is known to this share of the step.
const FOUND: f64 = 1e-13;
/// One look in three halves at least: this many make the rest smaller than the step's rounding.
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
/// place. What comes and goes before it is found where a stage hints at it.
pub(super) fn first_event<A: Ahead>(ahead: &mut A, length: f64) -> (f64, Option<A::Event>) {
    let (mut share, mut first) = (1.0, ahead.event());
    if let Some(event) = &mut first {
        (share, *event) = located(ahead, length, *event);
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
        let (place, event) = located(ahead, earlier * length, event);
        (share, first) = (earlier * place, Some(event));
    }
    (share, first)
}

/// The share of the step looked at after which the first event comes, by false position (Illinois) on its excess,
/// kept safe by halving.
fn located<A: Ahead>(ahead: &mut A, length: f64, mut event: A::Event) -> (f64, A::Event) {
    let mut bracket = Bracket::new(ahead.excess_now(event), ahead.excess(event));
    for look in 0..MOST_LOOKS {
        if bracket.width() <= FOUND {
            break;
        }
        let middle = bracket.guess(look % 8 == 7);
        ahead.look(middle * length);
        match ahead.event() {
            None => {
                let excess = ahead.excess(event);
                if excess.abs() < ahead.room(event) {
                    return (middle, event);
                }
                bracket.raise(middle, excess);
            }
            Some(first) if first == event => bracket.lower(middle, ahead.excess(event)),
            Some(first) => {
                event = first;
                bracket.change(middle, ahead.excess(event));
            }
        }
    }
    ahead.look(bracket.high * length);
    (bracket.high, event)
}

/// Shares of a step between which an event comes, with its excess at both.
struct Bracket {
    low: f64,
    high: f64,
    low_excess: f64,
    high_excess: f64,
    /// Which end was moved last: -1 the lower, 1 the upper one, 0 none yet.
    moved: i8,
}

impl Bracket {
    fn new(low_excess: f64, high_excess: f64) -> Self {
        Bracket { low: 0.0, high: 1.0, low_excess, high_excess, moved: 0 }
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }

    /// A place strictly between the ends: where the straight line between the excesses is 0, or half-way.
    fn guess(&self, halve: bool) -> f64 {
        let width = self.width();
        let line = self.low + width * self.low_excess / (self.low_excess - self.high_excess);
        let edge = FOUND.max(width * 1e-3) * 0.5;
        if halve || !line.is_finite() {
            self.low + 0.5 * width
        } else {
            line.clamp(self.low + edge, self.high - edge)
        }
    }

    /// Moves the lower end. An upper end that stays twice counts half (Illinois).
    fn raise(&mut self, to: f64, excess: f64) {
        (self.low, self.low_excess) = (to, excess);
        if self.moved == -1 {
            self.high_excess *= 0.5;
        }
        self.moved = -1;
    }

    /// Moves the upper end; the same for the lower one.
    fn lower(&mut self, to: f64, excess: f64) {
        (self.high, self.high_excess) = (to, excess);
        if self.moved == 1 {
            self.low_excess *= 0.5;
        }
        self.moved = 1;
    }

    /// Moves the upper end to where another event has come, of whose past nothing is known: the next guess halves.
    fn change(&mut self, to: f64, excess: f64) {
        (self.high, self.high_excess, self.low_excess, self.moved) = (to, excess, f64::NAN, 0);
    }
}
