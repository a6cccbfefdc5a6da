//! What went into a delay line, and what comes out.

use std::collections::VecDeque;

use crate::divided::divide;

/// A sample of the input.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time: f64,
    volts: f64,
    /// Whether the input has a jump or a corner here: no curve is drawn across it.
    breaks: bool,
}

/// A place where the input is not smooth, and whose echo is still to come.
#[derive(Debug, Clone, Copy)]
struct Break {
    time: f64,
    /// How often it has gone through a line and become smoother.
    echoes: u8,
    /// Whether what comes out jumps here.
    jumps: bool,
}

/// What comes out of a line where its input was not smooth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Echo {
    /// How often the least smooth of it has echoed.
    echoes: u8,
    /// Whether it jumps.
    jumps: bool,
}

/// The past of one input, as far back as its delay.
#[derive(Debug, Clone)]
pub(crate) struct DelayLine {
    delay: f64,
    initial: f64,
    past: VecDeque<Sample>,
    breaks: VecDeque<Break>,
    /// Times nearer to each other than this are the same.
    near: f64,
    /// Samples nearer to each other than this are not both used: their rounding would grow in the curve.
    apart: f64,
    /// The lines whose echoes come to this one's input.
    hears: Vec<usize>,
    /// What came out last.
    heard: Option<Echo>,
    /// How many samples lie before what was read last, and the curve on which it lies.
    place: usize,
    stretch: Option<Stretch>,
}

/// Room beyond the delay: for the cubic's outer points, and for changes of mode between steps.
const SPARE: usize = 64;
/// Share of a step within which times are the same.
const NEAR: f64 = 1e-9;
/// Share of a step by which the samples of a curve lie apart: keeps rounding under 1e-11 of the voltage.
const APART: f64 = 1e-3;
/// Share of a voltage by which two ways of working it out may differ without a jump.
const ROUNDING: f64 = 1e-9;
/// So many samples are tried one after the other before all are searched.
const MOST_TRIED: usize = 4;
/// An echo is one derivative smoother than what it echoes; steps of order 4 need not stop for more of them.
const MOST_ECHOES: u8 = 4;

/// Takes in what goes into lines at the end of a stretch, at which nothing jumps; where tables have corners there, that is one
/// of theirs.
pub(crate) fn arrive(
    lines: &mut [DelayLine],
    time: f64,
    volts: impl Iterator<Item = f64> + Clone,
    is_at_corner: bool,
) {
    for (line, volts) in lines.iter_mut().zip(volts.clone()) {
        line.put(time, volts);
        if is_at_corner {
            line.put_break(time, volts, 0);
        }
    }
    if hear(lines, time).is_some() {
        pass_on(lines, time, volts);
    }
}

/// Takes off what has come out of lines by now; where there is anything, tells whether any of it jumps.
pub(crate) fn hear(lines: &mut [DelayLine], time: f64) -> Option<bool> {
    let heard = lines.iter_mut().filter_map(|line| {
        line.heard = line.echo_by(time);
        line.heard.map(|echo| echo.jumps)
    });
    heard.reduce(|any, jumps| any || jumps)
}

/// Takes in what goes into lines where echoes were heard: those that it hears are there echoed once more.
pub(crate) fn pass_on(lines: &mut [DelayLine], time: f64, volts: impl Iterator<Item = f64>) {
    for (index, volts) in (0..lines.len()).zip(volts) {
        let heard = lines[index].hears.iter().filter_map(|other| lines[*other].heard).min();
        if let Some(echo) = heard {
            lines[index].put_break(time, volts, echo.echoes + 1);
        }
    }
}

/// A voltage that comes out of a line, and how it depends on the line's settings.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Output {
    /// The initial voltage: nothing that went in has arrived.
    Initial,
    /// What went in, in volts, and its slope in volts per second.
    Arrived(f64, f64),
}

impl DelayLine {
    /// An empty line with room for a delay at a step.
    pub fn new(delay: f64, initial: f64, step: f64) -> Self {
        let room = (2.0 * delay / step).min(1e7) as usize + SPARE;
        DelayLine {
            delay,
            initial,
            past: VecDeque::with_capacity(room),
            breaks: VecDeque::with_capacity(SPARE),
            near: NEAR * step,
            apart: APART * step,
            hears: Vec::new(),
            heard: None,
            place: 0,
            stretch: None,
        }
    }

    /// The same, to whose input the echoes of these lines come.
    pub fn hearing(self, hears: &[usize]) -> Self {
        DelayLine { hears: hears.to_vec(), ..self }
    }

    /// The same with room for so many jumps in a second, and for their echoes.
    pub fn with_room_for(mut self, jumps: f64) -> Self {
        let breaks = (2.0 * self.delay * jumps * f64::from(1 + MOST_ECHOES)).min(1e7) as usize;
        self.breaks.reserve(breaks);
        self.past.reserve(2 * breaks);
        self
    }

    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// The delay and initial output as they are set at a time; the past stays. Echoes that would have come out
    /// before then are not heard any more.
    pub fn set(&mut self, delay: f64, initial: f64, time: f64) {
        (self.delay, self.initial) = (delay, initial);
        self.echo_by(time);
    }

    pub fn clear(&mut self) {
        self.past.clear();
        self.breaks.clear();
        self.stretch = None;
    }

    /// Takes in a sample.
    pub fn put(&mut self, time: f64, volts: f64) {
        if self.past.back().is_none_or(|last| last.time < time) {
            self.past.push_back(Sample { time, volts, breaks: false });
            self.forget(time);
        }
    }

    /// Takes in a sample at which the input jumps or has a corner, itself an echo of so many.
    pub fn put_break(&mut self, time: f64, volts: f64, echoes: u8) {
        // Before what goes in first the initial voltage comes out.
        let begins = self.past.is_empty();
        self.put(time, volts);
        let Some(last) = self.past.back_mut() else { return };
        let jumps = (last.volts - volts).abs() > ROUNDING * (1.0 + volts.abs());
        last.breaks = true;
        if jumps {
            self.past.push_back(Sample { time, volts, breaks: true });
        }
        if jumps || echoes < MOST_ECHOES {
            let echoes = if jumps { 0 } else { echoes };
            self.breaks.push_back(Break { time, echoes, jumps: jumps || begins });
        }
    }

    /// Twice the delay is kept, so that the delay may be made longer while the machine runs.
    fn forget(&mut self, time: f64) {
        while self.past.get(3).is_some_and(|sample| sample.time <= time - 2.0 * self.delay) {
            self.past.pop_front();
            self.place = self.place.saturating_sub(1);
        }
    }

    /// When the next break comes out, if that is well before a time.
    pub fn echo_before(&self, end: f64) -> Option<f64> {
        self.breaks.front().map(|first| first.time + self.delay).filter(|echo| *echo < end - self.near)
    }

    /// When the next break comes out at which the voltage may jump.
    pub fn next_jump(&self) -> Option<f64> {
        self.breaks.iter().find(|own| own.jumps).map(|own| own.time + self.delay)
    }

    /// Takes off the breaks that have come out by now, and tells what that was.
    pub fn echo_by(&mut self, time: f64) -> Option<Echo> {
        let mut echo: Option<Echo> = None;
        while let Some(&Break { echoes, jumps, .. }) =
            self.breaks.front().filter(|first| first.time + self.delay <= time + self.near)
        {
            echo = Some(echo.map_or(Echo { echoes, jumps }, |known| Echo {
                echoes: known.echoes.min(echoes),
                jumps: known.jumps || jumps,
            }));
            self.breaks.pop_front();
        }
        echo
    }

    /// What comes out from a time on.
    pub fn from(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time <= wanted + self.near), wanted)
    }

    /// What comes out up to a time: at a jump, the voltage before it.
    pub fn until(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time < wanted - self.near), wanted)
    }

    /// The same as [`from`](DelayLine::from), the quicker the nearer to what was read last.
    pub fn next_from(&mut self, time: f64) -> f64 {
        let (wanted, near) = (time - self.delay, self.near);
        self.read(wanted, |time| time <= wanted + near)
    }

    /// The same as [`until`](DelayLine::until), the quicker the nearer to what was read last.
    pub fn next_until(&mut self, time: f64) -> f64 {
        let (wanted, near) = (time - self.delay, self.near);
        self.read(wanted, |time| time < wanted - near)
    }

    /// What comes out from a time on, with its slope.
    pub fn output(&self, time: f64) -> Output {
        let wanted = time - self.delay;
        match self.past.partition_point(|sample| sample.time <= wanted + self.near) {
            0 => Output::Initial,
            after => Output::Arrived(self.volts(after, wanted), self.slope(after, wanted)),
        }
    }

    /// The slope, in volts per second, of what comes out from a time on.
    pub fn slope_from(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time <= wanted + self.near), wanted)
    }

    /// The slope of what comes out up to a time.
    pub fn slope_until(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time < wanted - self.near), wanted)
    }

    /// Whether what comes out jumps at a time.
    pub fn jumps_at(&self, time: f64) -> bool {
        let (before, after) = (self.until(time), self.from(time));
        (after - before).abs() > ROUNDING * (1.0 + after.abs())
    }

    /// Times nearer to each other than this are the same.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// The last sample, if there is one.
    pub fn last(&self) -> Option<(f64, f64)> {
        self.past.back().map(|sample| (sample.time, sample.volts))
    }

    /// The voltage at a time before the sample of this index and not before the one ahead of it.
    fn volts(&self, after: usize, wanted: f64) -> f64 {
        let horizon = self.horizon(wanted);
        match after {
            0 => self.initial,
            _ if self.is_to_come(after, horizon) => self.past[after - 1].volts,
            _ => self.curve(self.around(after, horizon)).value(wanted),
        }
    }

    /// What comes out at a time is drawn through samples before that time only: it is the same before and after a sample was
    /// taken in there.
    fn horizon(&self, wanted: f64) -> f64 {
        wanted + self.delay - self.near
    }

    /// Whether no sample of this index comes before a time.
    fn is_to_come(&self, index: usize, horizon: f64) -> bool {
        self.past.get(index).is_none_or(|sample| sample.time >= horizon)
    }

    /// The slope of the curve there; nothing moves before the first sample.
    fn slope(&self, after: usize, wanted: f64) -> f64 {
        if after == 0 {
            return 0.0;
        }
        let horizon = self.horizon(wanted);
        let after = if self.is_to_come(after, horizon) { after - 1 } else { after };
        self.curve(self.around(after, horizon)).slope(wanted)
    }

    /// The voltage at a time, of which is told what lies before it.
    fn read(&mut self, wanted: f64, is_before: impl Fn(f64) -> bool) -> f64 {
        if let Some(stretch) = &self.stretch
            && is_before(stretch.from)
            && !is_before(stretch.until)
        {
            return stretch.curve.value(wanted);
        }
        self.place = self.count(is_before);
        let horizon = self.horizon(wanted);
        if self.place == 0 || self.is_to_come(self.place, horizon) {
            return self.volts(self.place, wanted);
        }
        let nodes = self.around(self.place, horizon);
        let curve = self.curve(nodes);
        let [from, until] = [self.place - 1, self.place].map(|at| self.past[at].time);
        self.stretch = nodes.are_all.then_some(Stretch { from, until, curve });
        curve.value(wanted)
    }

    /// How many samples lie before something: mostly one or two more than before what was read last.
    fn count(&self, is_before: impl Fn(f64) -> bool) -> usize {
        let is_before = |sample: &Sample| is_before(sample.time);
        let place = self.place.min(self.past.len());
        if place == 0 || is_before(&self.past[place - 1]) {
            let near =
                (place..place + MOST_TRIED).find(|at| self.past.get(*at).is_none_or(|own| !is_before(own)));
            if let Some(found) = near {
                return found;
            }
        }
        self.past.partition_point(is_before)
    }

    /// The four samples around the pair that ends here, or as many as there are on the same smooth piece before a time.
    fn around(&self, after: usize, horizon: f64) -> Nodes {
        let (mut first, mut last) = (after.saturating_sub(1), after);
        let mut nodes = Nodes::pair(first, last);
        for _ in 0..2 {
            if nodes.count == 4 {
                break;
            }
            if let Some(before) = self.node_before(first).filter(|_| nodes.count < 4) {
                first = before;
                nodes.add(before);
            }
            match self.node_after(last, horizon) {
                Next::There(next) if nodes.count < 4 => {
                    last = next;
                    nodes.add(next);
                }
                Next::ToCome => nodes.are_all = false,
                _ => {}
            }
        }
        nodes
    }

    fn node_before(&self, first: usize) -> Option<usize> {
        let mut node = first;
        while node > 0 && !self.past[node].breaks {
            node -= 1;
            if self.past[first].time - self.past[node].time > self.apart {
                return Some(node);
            }
        }
        None
    }

    fn node_after(&self, last: usize, horizon: f64) -> Next {
        let mut node = last;
        while !self.past[node].breaks {
            node += 1;
            if self.is_to_come(node, horizon) {
                return Next::ToCome;
            }
            if self.past[node].time - self.past[last].time > self.apart {
                return Next::There(node);
            }
        }
        Next::None
    }

    /// The polynomial through these samples.
    fn curve(&self, nodes: Nodes) -> Curve {
        let mut curve = Curve { times: [0.0; 4], shares: [0.0; 4] };
        for (place, node) in nodes.indices[..nodes.count].iter().enumerate() {
            (curve.times[place], curve.shares[place]) = (self.past[*node].time, self.past[*node].volts);
        }
        divide(&curve.times, &mut curve.shares[..nodes.count]);
        curve
    }
}

/// A polynomial in Newton's form: shares of 1, of t - t0, of that times t - t1, and so on.
#[derive(Debug, Clone, Copy)]
struct Curve {
    times: [f64; 4],
    shares: [f64; 4],
}

impl Curve {
    fn value(&self, time: f64) -> f64 {
        let [from_first, from_second, from_third, _] = self.times.map(|own| time - own);
        let [constant, first, second, third] = self.shares;
        constant + from_first * (first + from_second * (second + from_third * third))
    }

    fn slope(&self, time: f64) -> f64 {
        let [a, b, c, _] = self.times.map(|own| time - own);
        let [_, first, second, third] = self.shares;
        first + (a + b) * second + (a * b + a * c + b * c) * third
    }
}

/// The curve between two samples that follow each other, which no further sample changes.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    from: f64,
    until: f64,
    curve: Curve,
}

/// The sample of a curve after others.
enum Next {
    There(usize),
    /// None: the piece ends before it.
    None,
    /// None before the time.
    ToCome,
}

/// Indices of up to four samples.
#[derive(Debug, Clone, Copy)]
struct Nodes {
    indices: [usize; 4],
    count: usize,
    /// Whether no sample that comes would be one of them.
    are_all: bool,
}

impl Nodes {
    fn pair(first: usize, last: usize) -> Self {
        Nodes { indices: [first, last, 0, 0], count: if first == last { 1 } else { 2 }, are_all: true }
    }

    fn add(&mut self, index: usize) {
        self.indices[self.count] = index;
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn echo(echoes: u8, jumps: bool) -> Option<Echo> {
        Some(Echo { echoes, jumps })
    }

    #[test]
    fn a_cubic_comes_out_as_it_went_in_and_so_does_its_slope() {
        let cubic = |t: f64| 1.0 + t - 2.0 * t * t + 0.5 * t * t * t;
        let slope = |t: f64| 1.0 - 4.0 * t + 1.5 * t * t;
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        (0..=30).for_each(|k| line.put(f64::from(k) * 0.1, cubic(f64::from(k) * 0.1)));
        for t in [3.05, 3.51, 3.77, 3.97] {
            assert!((line.from(t) - cubic(t - 1.0)).abs() < 1e-12, "{t}");
            let Output::Arrived(volts, found) = line.output(t) else { panic!("{t}") };
            assert!((volts - line.from(t)).abs() < 1e-12 && (found - slope(t - 1.0)).abs() < 1e-11, "{t}");
        }
    }

    #[test]
    fn before_the_delay_the_initial_voltage_comes_out() {
        let mut line = DelayLine::new(1.0, 7.0, 0.1);
        line.put_break(0.0, 3.0, 0);
        line.put(0.1, 3.0);
        assert_eq!((line.from(0.5), line.until(1.0), line.from(1.0)), (7.0, 7.0, 3.0));
    }

    #[test]
    fn a_jump_stays_a_jump() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        [0.0, 0.1, 0.15].iter().for_each(|time| line.put(*time, 1.0));
        line.put_break(0.15, 5.0, 0);
        [0.2, 0.3].iter().for_each(|time| line.put(*time, 5.0));
        assert_eq!((line.from(1.149), line.from(1.151)), (1.0, 5.0));
        assert_eq!((line.until(1.15), line.from(1.15)), (1.0, 5.0));
    }

    #[test]
    fn a_corner_is_not_rounded() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        let corner = |k: i32| (f64::from(k) * 0.1, f64::from((k - 5).max(0)).powi(3));
        for (time, volts) in (0..=10).map(corner) {
            line.put(time, volts);
            if volts == 0.0 && time > 0.45 {
                line.put_break(time, volts, 0);
            }
        }
        assert_eq!(line.from(1.45), 0.0);
        assert!((line.from(1.55) - 0.125).abs() < 1e-9);
    }

    #[test]
    fn samples_close_together_do_not_blow_up_their_rounding() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        for k in 0..20 {
            let time = f64::from(k) * 0.1;
            line.put(time, time);
            line.put(time + 1e-14, time + 5e-14);
        }
        assert!(
            (1..10).all(|k| (line.from(1.05 + f64::from(k) * 0.1) - f64::from(k) * 0.1 - 0.05).abs() < 1e-11)
        );
    }

    #[test]
    fn breaks_come_out_in_their_order_and_wear_off() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        line.put_break(0.0, 1.0, 0);
        line.put_break(0.25, 1.0, MOST_ECHOES);
        line.put_break(0.5, 1.0, 3);
        assert_eq!((line.echo_before(1.0), line.echo_before(1.1)), (None, Some(1.0)));
        assert_eq!((line.echo_by(0.9), line.echo_by(1.0)), (None, echo(0, true)));
        assert_eq!(line.echo_before(9.0), Some(1.5));
    }

    #[test]
    fn what_is_read_on_and_on_is_what_is_read_anywhere() {
        for delay in [0.1, 0.137, 0.25, 1.0] {
            let mut line = DelayLine::new(delay, 7.0, 0.1);
            line.put_break(0.0, 3.0, 0);
            for k in 1..100 {
                let time = f64::from(k) * 0.1;
                for share in [-0.9, -0.5, -0.31, 0.0] {
                    let at = time + 0.1 * share;
                    assert_eq!(line.next_until(at).to_bits(), line.until(at).to_bits(), "{delay} {at}");
                    assert_eq!(line.next_from(at).to_bits(), line.from(at).to_bits(), "{delay} {at}");
                }
                line.put(time, (0.9 * time).sin());
                match k % 7 {
                    2 => line.put_break(time, (0.9 * time).sin(), 0),
                    5 => line.put(time + 3e-5, (0.9 * (time + 3e-5)).sin()),
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn jumps_are_told_from_corners() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        line.put_break(0.0, 1.0, 0);
        line.put_break(0.25, 1.0, 0);
        line.put_break(0.5, 2.0, 1);
        assert_eq!(line.next_jump(), Some(1.0));
        assert_eq!(line.echo_by(1.3), echo(0, true));
        // What had no other voltage at that instant has a corner there, and no jump.
        assert_eq!((line.next_jump(), line.echo_before(9.0)), (None, Some(1.5)));
        line.put(0.75, 2.0);
        line.put_break(0.75, 3.0, 1);
        assert_eq!((line.next_jump(), line.echo_by(1.5)), (Some(1.75), echo(1, false)));
    }

    #[test]
    fn lines_hear_those_that_lead_to_them() {
        let mut lines = [&[][..], &[0], &[0, 1]].map(|hears| DelayLine::new(1.0, 0.0, 0.1).hearing(hears));
        let mut arrive_at =
            |time: f64, is_at_corner| arrive(&mut lines, time, [time; 3].into_iter(), is_at_corner);
        arrive_at(0.0, true);
        (1..=10).for_each(|k| arrive_at(f64::from(k) * 0.1, false));
        assert_eq!(lines.each_ref().map(|line| line.echo_before(9.0)), [None, Some(2.0), Some(2.0)]);
        let mut arrive_at = |time: f64| arrive(&mut lines, time, [time; 3].into_iter(), false);
        (11..=20).for_each(|k| arrive_at(f64::from(k) * 0.1));
        assert_eq!(lines.each_ref().map(|line| line.echo_before(9.0)), [None, None, Some(3.0)]);
    }

    #[test]
    fn a_sample_changes_nothing_that_came_out_until_then() {
        for delay in [0.1, 0.137, 0.25, 0.31] {
            let mut line = DelayLine::new(delay, 7.0, 0.1);
            for time in (0..40).map(|k| f64::from(k) * 0.1) {
                let before = line.next_until(time);
                line.put(time, (0.9 * time).sin());
                assert_eq!(before.to_bits(), line.next_until(time).to_bits(), "{delay} {time}");
                let after = line.next_from(time);
                assert!(time < delay + 0.05 || (after - before).abs() < 1e-9, "{delay} {time}");
            }
        }
    }
}
