//! What went into a delay line, and what comes out.

use std::collections::VecDeque;

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
}

/// The past of one input, as far back as its delay.
#[derive(Debug, Clone)]
pub(super) struct DelayLine {
    delay: f64,
    initial: f64,
    past: VecDeque<Sample>,
    breaks: VecDeque<Break>,
    /// Times nearer to each other than this are the same.
    near: f64,
    /// Samples nearer to each other than this are not both used: their rounding would grow in the curve.
    apart: f64,
}

/// Room beyond the delay: for the cubic's outer points, and for changes of mode between steps.
const SPARE: usize = 64;
/// Share of a step within which times are the same.
const NEAR: f64 = 1e-9;
/// Share of a step by which the samples of a curve lie apart: keeps rounding under 1e-11 of the voltage.
const APART: f64 = 1e-3;
/// Share of a voltage by which two ways of working it out may differ without a jump.
const ROUNDING: f64 = 1e-9;
/// An echo is one derivative smoother than what it echoes; steps of order 4 need not stop for more of them.
const MOST_ECHOES: u8 = 4;

/// A voltage that comes out of a line, and how it depends on the line's settings.
#[derive(Debug, Clone, Copy)]
pub(super) enum Output {
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
        }
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
        self.echoes_by(time);
    }

    pub fn clear(&mut self) {
        self.past.clear();
        self.breaks.clear();
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
        self.put(time, volts);
        let Some(last) = self.past.back_mut() else { return };
        let jumps = (last.volts - volts).abs() > ROUNDING * (1.0 + volts.abs());
        last.breaks = true;
        if jumps {
            self.past.push_back(Sample { time, volts, breaks: true });
        }
        if jumps || echoes < MOST_ECHOES {
            self.breaks.push_back(Break { time, echoes: if jumps { 0 } else { echoes } });
        }
    }

    /// Twice the delay is kept, so that the delay may be made longer while the machine runs.
    fn forget(&mut self, time: f64) {
        while self.past.get(3).is_some_and(|sample| sample.time <= time - 2.0 * self.delay) {
            self.past.pop_front();
        }
    }

    /// When the next break comes out, if that is well before a time.
    pub fn echo_before(&self, end: f64) -> Option<f64> {
        self.breaks.front().map(|first| first.time + self.delay).filter(|echo| *echo < end - self.near)
    }

    /// Takes off the breaks that have come out by now; tells how often the least smooth of them has echoed.
    pub fn echoes_by(&mut self, time: f64) -> Option<u8> {
        let mut least: Option<u8> = None;
        while let Some(first) =
            self.breaks.front().filter(|first| first.time + self.delay <= time + self.near)
        {
            least = Some(least.map_or(first.echoes, |least| least.min(first.echoes)));
            self.breaks.pop_front();
        }
        least
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
        if after == 0 {
            return self.initial;
        }
        if after == self.past.len() {
            return self.past[after - 1].volts;
        }
        self.lagrange(self.around(after), wanted)
    }

    /// The slope of the curve there; nothing moves before the first sample.
    fn slope(&self, after: usize, wanted: f64) -> f64 {
        if after == 0 {
            return 0.0;
        }
        let nodes = self.around(after.min(self.past.len() - 1));
        nodes.each().map(|node| self.past[node].volts * self.weight_slope(nodes, node, wanted)).sum()
    }

    /// The four samples around the pair that ends here, or as many as there are on the same smooth piece.
    fn around(&self, after: usize) -> Nodes {
        let (mut first, mut last) = (after.saturating_sub(1), after);
        let mut nodes = Nodes::pair(first, last);
        for _ in 0..2 {
            if let Some(before) = self.node_before(first).filter(|_| nodes.count < 4) {
                first = before;
                nodes.add(before);
            }
            if let Some(next) = self.node_after(last).filter(|_| nodes.count < 4) {
                last = next;
                nodes.add(next);
            }
        }
        nodes
    }

    fn node_before(&self, first: usize) -> Option<usize> {
        let fit = |node: usize| self.past[first].time - self.past[node].time > self.apart;
        let mut smooth = (0..first).rev().take_while(|node| !self.past[node + 1].breaks);
        smooth.find(|node| fit(*node))
    }

    fn node_after(&self, last: usize) -> Option<usize> {
        let fit = |node: usize| self.past[node].time - self.past[last].time > self.apart;
        let mut smooth = (last + 1..self.past.len()).take_while(|node| !self.past[node - 1].breaks);
        smooth.find(|node| fit(*node))
    }

    /// The polynomial through these samples (Lagrange).
    fn lagrange(&self, nodes: Nodes, time: f64) -> f64 {
        nodes.each().map(|node| self.past[node].volts * self.weight(nodes, node, time)).sum()
    }

    fn weight(&self, nodes: Nodes, own: usize, time: f64) -> f64 {
        let own_time = self.past[own].time;
        let others = nodes.each().filter(|node| *node != own).map(|node| self.past[node].time);
        others.map(|other| (time - other) / (own_time - other)).product()
    }

    fn weight_slope(&self, nodes: Nodes, own: usize, time: f64) -> f64 {
        let distance = |node: usize| self.past[own].time - self.past[node].time;
        let others = || nodes.each().filter(move |node| *node != own);
        let rest = |left_out: usize| {
            let left = others().filter(move |node| *node != left_out);
            left.map(|node| (time - self.past[node].time) / distance(node)).product::<f64>()
        };
        others().map(|other| rest(other) / distance(other)).sum()
    }
}

/// Indices of up to four samples.
#[derive(Debug, Clone, Copy)]
struct Nodes {
    indices: [usize; 4],
    count: usize,
}

impl Nodes {
    fn pair(first: usize, last: usize) -> Self {
        Nodes { indices: [first, last, 0, 0], count: if first == last { 1 } else { 2 } }
    }

    fn add(&mut self, index: usize) {
        self.indices[self.count] = index;
        self.count += 1;
    }

    fn each(self) -> impl Iterator<Item = usize> {
        self.indices.into_iter().take(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!((line.echoes_by(0.9), line.echoes_by(1.0)), (None, Some(0)));
        assert_eq!(line.echo_before(9.0), Some(1.5));
    }
}
