//! Where in a step the first event comes.

use std::mem;

use crate::divided::divide;

/// An event is found when its place in the step is known to this share of the step,
const FOUND: f64 = 1e-13;
/// or to this share, and what happens in between is rounding:
const FOUND_IN_ROUNDING: f64 = 1e-11;
/// no more volts than a bit of 100 V.
const ROUNDING: f64 = 1.5e-14;
/// So many looks follow the curve; after them one in three halves, and both ends come nearer.
const CURVED: usize = 10;
/// So little past where an event should be it is looked for, in shares of a step: a bit of the step's end.
const JUST_PAST: f64 = 1e-16;
/// So much further beyond where the event should be every look goes that comes to the same side as the one before.
const FURTHER: f64 = 8.0;
/// So many steps of Newton's at most find where a curve is 0.
const MOST_TURNS: usize = 60;
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
        // What comes and goes sooner than a place is known is at that place.
        if !ahead.is_hinted() || share <= FOUND {
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

/// The share of the step looked at after which the first event comes: where the curve through its excesses is 0, kept safe by
/// halving.
fn located<A: Ahead>(
    ahead: &mut A,
    length: f64,
    mut event: A::Event,
    mut near: Option<f64>,
) -> (f64, A::Event) {
    let end = Seen { share: 1.0, excess: ahead.excess(event) };
    let mut bracket = Bracket::new(ahead.excess_now(event), end);
    for look in 0..MOST_LOOKS {
        if bracket.is_found() {
            break;
        }
        let room = ahead.room(event);
        let place = near.take().unwrap_or_else(|| bracket.next(look, room == 0.0));
        let share = bracket.inside(place, look);
        ahead.look(share * length);
        let met = ahead.event();
        if let Some(first) = met.filter(|first| *first != event) {
            event = first;
            bracket = Bracket::new(ahead.excess_now(event), Seen { share, excess: ahead.excess(event) });
            continue;
        }
        let excess = ahead.excess(event);
        if excess.abs() < room {
            return (share, event);
        }
        bracket.narrow(Seen { share, excess }, met.is_some());
    }
    if !bracket.is_at_its_upper_end() {
        ahead.look(bracket.high.share * length);
    }
    (bracket.high.share, event)
}

/// How far past an event a share of a step is.
#[derive(Debug, Clone, Copy)]
struct Seen {
    share: f64,
    excess: f64,
}

/// Shares of a step between which an event comes, and what is known of it.
struct Bracket {
    /// Where it has not come yet, and where it has.
    low: Seen,
    high: Seen,
    /// The ends before these, the latest first, and how many places are known with these.
    former: [Seen; 2],
    known: usize,
    /// So far beyond where the excess should be 0 is looked next, towards the end that was not moved last.
    beyond: f64,
}

impl Bracket {
    /// From the present to a share at which the event has come.
    fn new(excess_now: f64, high: Seen) -> Self {
        let low = Seen { share: 0.0, excess: excess_now };
        Bracket { low, high, former: [low, high], known: 2, beyond: 0.0 }
    }

    fn width(&self) -> f64 {
        self.high.share - self.low.share
    }

    /// Whether it is known well enough where the event comes.
    fn is_found(&self) -> bool {
        let rise = self.high.excess - self.low.excess;
        self.width() <= FOUND || (self.width() <= FOUND_IN_ROUNDING && self.is_passed() && rise <= ROUNDING)
    }

    /// Whether the excess passes 0 between the ends. Where there are several events, that of the first need not.
    fn is_passed(&self) -> bool {
        self.low.excess <= 0.0 && self.high.excess >= 0.0 && self.low.excess < self.high.excess
    }

    /// Whether the step was last looked at to its upper end.
    fn is_at_its_upper_end(&self) -> bool {
        self.beyond <= 0.0
    }

    /// Where to look next: where the excess should be 0, or beside it, or half-way.
    fn next(&self, look: usize, is_beside: bool) -> f64 {
        if !self.is_passed() || (look >= CURVED && look.is_multiple_of(3)) {
            return self.low.share + 0.5 * self.width();
        }
        self.zero() + if is_beside { self.beyond } else { 0.0 }
    }

    /// A place, or the nearest strictly between the ends. After many looks it is not too near to either.
    fn inside(&self, place: f64, look: usize) -> f64 {
        let width = self.width();
        let edge = if look >= CURVED { 0.5 * FOUND.max(width * 1e-3) } else { JUST_PAST };
        let edge = edge.min(0.25 * width);
        place.clamp(self.low.share + edge, self.high.share - edge)
    }

    /// Where between the ends the curve through what is known is 0: Newton's steps, halving where they leave the ends.
    fn zero(&self) -> f64 {
        let curve = Curve::through([self.low, self.high, self.former[0], self.former[1]], self.known);
        let (mut low, mut high) = (self.low.share, self.high.share);
        let mut share = low - self.low.excess * self.width() / (self.high.excess - self.low.excess);
        for _ in 0..MOST_TURNS {
            let (excess, slope) = curve.at(share);
            let back = excess / slope;
            if back.abs() < 0.1 * FOUND {
                break;
            }
            *(if excess < 0.0 { &mut low } else { &mut high }) = share;
            let next = share - back;
            share = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        share
    }

    /// Moves one end, to where the event has come or not.
    fn narrow(&mut self, to: Seen, has_come: bool) {
        let end = if has_come { &mut self.high } else { &mut self.low };
        self.former = [mem::replace(end, to), self.former[0]];
        self.known = (self.known + 1).min(4);
        let back = if has_come { -0.5 * FOUND } else { JUST_PAST };
        self.beyond = if self.beyond * back > 0.0 { FURTHER * self.beyond } else { back };
    }
}

/// The polynomial through places: the excess of a Runge-Kutta step is one over its length, as long as nothing bends.
struct Curve {
    shares: [f64; 4],
    /// Divided differences.
    differences: [f64; 4],
    known: usize,
}

impl Curve {
    /// Through the first places.
    fn through(seen: [Seen; 4], known: usize) -> Self {
        let shares = seen.map(|seen| seen.share);
        let mut differences = seen.map(|seen| seen.excess);
        divide(&shares, &mut differences[..known]);
        Curve { shares, differences, known }
    }

    /// Its value at a share, and its slope there.
    fn at(&self, share: f64) -> (f64, f64) {
        let first = (self.differences[self.known - 1], 0.0);
        (0..self.known - 1).rev().fold(first, |(value, slope), place| {
            let from = share - self.shares[place];
            (value * from + self.differences[place], slope * from + value)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A voltage over the length of a step, and an event where it is above 0.
    struct Swing<F> {
        excess: F,
        length: f64,
        looks: usize,
        hint: Option<f64>,
    }

    impl<F: Fn(f64) -> f64> Ahead for Swing<F> {
        type Event = ();

        fn look(&mut self, length: f64) {
            self.length = length;
            self.looks += 1;
        }

        fn event(&self) -> Option<()> {
            (self.excess(()) > 0.0).then_some(())
        }

        fn is_hinted(&self) -> bool {
            self.hint.is_some()
        }

        fn middle(&self) -> f64 {
            self.hint.unwrap_or(1.0)
        }

        fn excess_now(&self, (): ()) -> f64 {
            (self.excess)(0.0)
        }

        fn excess(&self, (): ()) -> f64 {
            (self.excess)(self.length)
        }

        fn room(&self, (): ()) -> f64 {
            0.0
        }
    }

    /// Where a voltage passes 0 in a step of 1 s, and after how many looks that is known.
    fn first(excess: impl Fn(f64) -> f64, hint: Option<f64>) -> (f64, usize) {
        let mut swing = Swing { excess, length: 1.0, looks: 0, hint };
        let (share, met) = first_event(&mut swing, 1.0, None);
        assert!(met.is_some() && swing.length == share && (swing.excess)(share) > 0.0, "{share}");
        (share, swing.looks)
    }

    #[test]
    fn what_passes_0_is_found_in_a_few_looks() {
        let fall = (0.3_f64).exp();
        type Case<'a> = (&'a dyn Fn(f64) -> f64, f64, usize);
        let cases: [Case<'_>; 6] = [
            (&|t| t - 0.7, 0.7, 3),
            // From rest, as where friction lets go.
            (&|t| 0.6 * t * t - 5e-4, (5e-4_f64 / 0.6).sqrt(), 7),
            (&|t| 40.0 * t * t * t - 1e-3, (1e-3_f64 / 40.0).cbrt(), 10),
            (&|t| fall - (0.3 + 2.0 * (0.15 - t)).exp(), 0.15, 8),
            // A corner on the way.
            (&|t| t.max(30.0 * t - 20.0) - 0.9, 20.9 / 30.0, 18),
            (&|t| 1e-12 * t - 3e-13, 0.3, 6),
        ];
        for (place, (excess, expected, most)) in cases.into_iter().enumerate() {
            let (share, looks) = first(excess, None);
            assert!((share - expected).abs() <= 2.0 * FOUND, "case {place}: {share} for {expected}");
            assert!(looks <= most, "case {place}: {looks} looks");
        }
    }

    /// A voltage that is known to a bit of 100 V only.
    #[test]
    fn rounding_is_not_looked_through() {
        let rounded = |t: f64| (1e-3 * (t - 0.4) + 50.0) - 50.0;
        let (share, looks) = first(rounded, None);
        assert!((share - 0.4).abs() <= FOUND_IN_ROUNDING && looks <= 10, "{share}, {looks} looks");
    }

    /// What is due at once, and hints at something sooner wherever one looks.
    #[test]
    fn nothing_is_looked_for_sooner_than_a_place_is_known() {
        let (share, looks) = first(|_| 1e-8, Some(0.5));
        assert!(share <= FOUND && looks <= 2 * MOST_LOOKS, "{share}, {looks} looks");
    }
}
