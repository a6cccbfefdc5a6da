//! The test of one rewiring.

use std::cell::OnceCell;

use patchcord_expr::{Equation, split_primes};

use super::expression::measured;
use super::instants::{Instant, Setup};
use super::{Case, Output, Screen};
use crate::fixes::netlist::{Order, Rewiring};

/// Deviation of the two sides of an equation, as a share of the size of their terms, up to which they are equal.
/// Settings are often rounded to three digits.
const TOLERANCE: f64 = 1.5e-3;
/// Derivatives of a higher order have no digits as differences. Those inside of auxiliary quantities count, too.
const MAX_ORDER: usize = 2;
/// Size of initial values in volts up to which they count as 0.
const ZERO: f64 = 1e-7;
/// Difference of two equal rates by rounding, as a share.
const SAME_RATE: f64 = 1e-12;
/// Points that may contradict an equation, because a difference reaches across a corner of a characteristic.
const MAX_CONTRADICTIONS: usize = 1;

/// An instant that is computed when it is first needed. `None` if a loop without an integrator cannot be solved.
type LazyInstant<'s> = OnceCell<Option<Instant<'s>>>;

/// A rewiring of the circuit of a screen, with the voltages that were computed so far.
pub(in crate::fixes) struct Trial<'s, 'a> {
    screen: &'s Screen<'a>,
    rewiring: &'s Rewiring,
    order: Order,
    /// The instants of the points, by case.
    points: Vec<Vec<LazyInstant<'s>>>,
    /// The instants at the start of a run, by case.
    starts: Vec<LazyInstant<'s>>,
    /// Whether each state follows the time.
    follows_time: OnceCell<Vec<bool>>,
}

/// The result of a comparison at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    /// The sides are equal.
    Equal,
    /// Both sides are 0.
    Zero,
    /// The sides differ.
    Different,
    /// A side has no value.
    Unknown,
}

/// An instant of a case.
#[derive(Clone, Copy)]
struct At<'t, 's> {
    case: usize,
    instant: &'t Instant<'s>,
    /// Whether it is the start of a run.
    is_start: bool,
}

impl<'s, 'a> Trial<'s, 'a> {
    /// The trial of a rewiring.
    pub(super) fn new(screen: &'s Screen<'a>, rewiring: &'s Rewiring) -> Self {
        let order = Order::new(&screen.netlist, rewiring);
        let lazy = |count: usize| -> Vec<LazyInstant<'s>> { (0..count).map(|_| OnceCell::new()).collect() };
        let points = screen.cases.iter().map(|_| lazy(screen.centres.len())).collect();
        let starts = lazy(screen.cases.len());
        Trial { screen, rewiring, order, points, starts, follows_time: OnceCell::new() }
    }

    /// The number of loops without an integrator that no open amplifier opens.
    pub(in crate::fixes) fn closed_loops(&self) -> usize {
        self.order.closed_loops(&self.screen.netlist)
    }

    /// Whether the wiring can solve an equation: both sides are equal at nearly all points at which they have values.
    pub(in crate::fixes) fn passes(&self, equation: &Equation) -> bool {
        if let Some(quantity) = equation.initial_quantity() {
            return self.passes_at_start(equation, quantity);
        }
        let screen = self.screen;
        let writes_out_drives = screen.can_write_out_drives(equation);
        let mut cases = screen.cases.iter().enumerate();
        cases.any(|(index, case)| (case.has_free_drives || writes_out_drives) && self.holds(index, equation))
    }

    /// Whether the points of a case do not contradict an equation.
    fn holds(&self, case: usize, equation: &Equation) -> bool {
        let contradicts = |point: &usize| {
            let instant = self.point(case, *point);
            let at = instant.map(|instant| At { case, instant, is_start: false });
            at.is_some_and(|at| self.verdict(equation, at, 0.0) == Verdict::Different)
        };
        let mut contradictions = (0..self.screen.centres.len()).filter(contradicts);
        contradictions.nth(MAX_CONTRADICTIONS).is_none()
    }

    /// Whether an initial value can be the stated one. If both are 0 for the present parameters, other parameters
    /// decide.
    fn passes_at_start(&self, equation: &Equation, quantity: &str) -> bool {
        // The cases with other parameters follow those with the first ones, in the same order.
        let others = self.screen.cases.len() / 2;
        (0..others).any(|case| match self.start_verdict(equation, quantity, case) {
            Verdict::Zero => self.start_verdict(equation, quantity, case + others) != Verdict::Different,
            Verdict::Equal | Verdict::Unknown => true,
            Verdict::Different => false,
        })
    }

    /// The comparison of an initial value with the stated one.
    fn start_verdict(&self, equation: &Equation, quantity: &str, case: usize) -> Verdict {
        let screen = self.screen;
        let setup = self.setup(&screen.cases[case], false);
        let start = self.starts[case].get_or_init(|| Instant::new(&screen.cases[case].start, setup));
        let Some(instant) = start else { return Verdict::Unknown };
        let output = screen.signals.get(split_primes(quantity).0);
        let per_volt = output.map_or(0.0, |output| self.per_volt(output, case));
        self.verdict(equation, At { case, instant, is_start: true }, ZERO * per_volt.abs())
    }

    /// The comparison of both sides of an equation. Values up to `zero` count as 0.
    fn verdict(&self, equation: &Equation, at: At<'_, 's>, zero: f64) -> Verdict {
        let [left, right] = [equation.left(), equation.right()]
            .map(|side| measured(side, &|name: &str| self.named(name, at)));
        let (size, difference) = (left.size.max(right.size), (left.value - right.value).abs());
        if !(size.is_finite() && difference.is_finite()) {
            Verdict::Unknown
        } else if difference > TOLERANCE * size + zero {
            Verdict::Different
        } else if size <= zero {
            Verdict::Zero
        } else {
            Verdict::Equal
        }
    }

    /// The instant of a point. `None` if a loop without an integrator cannot be solved there.
    fn point(&self, case: usize, point: usize) -> Option<&Instant<'s>> {
        let screen = self.screen;
        let setup = self.setup(&screen.cases[case], screen.cases[case].has_free_drives);
        let follows_time = self.follows_time();
        let instant = || Instant::at_time(&screen.centres[point], setup, follows_time);
        self.points[case][point].get_or_init(instant).as_ref()
    }

    /// Whether each state follows the time: the equations name the time, and the state is a ramp. A ramp has the same rate
    /// at different points.
    fn follows_time(&self) -> &[bool] {
        self.follows_time.get_or_init(|| {
            let screen = self.screen;
            let (Some(case), true) = (screen.cases.first(), screen.names_time) else { return Vec::new() };
            let setup = self.setup(case, case.has_free_drives);
            let instants = screen.centres.iter().take(2).filter_map(|centre| Instant::new(centre, setup));
            let rates: Vec<Vec<f64>> = instants.map(|instant| instant.voltages.rates).collect();
            let [one, other] = rates.as_slice() else { return Vec::new() };
            let is_ramp =
                |(one, other): (&f64, &f64)| *one != 0.0 && (one - other).abs() <= SAME_RATE * one.abs();
            one.iter().zip(other).map(is_ramp).collect()
        })
    }

    /// The wiring with the conditions of a case.
    fn setup<'t>(&'t self, case: &'t Case, has_free_drives: bool) -> Setup<'t> {
        Setup {
            netlist: &self.screen.netlist,
            rewiring: self.rewiring,
            order: &self.order,
            conditions: &case.conditions,
            has_free_drives,
        }
    }

    /// The value of a name of an equation, such as x''. NaN if it is not known.
    fn named(&self, name: &str, at: At<'_, 's>) -> f64 {
        let (base, order) = split_primes(name);
        self.quantity(base, order, at)
    }

    /// The value of a quantity with this number of derivatives. NaN if it is not known.
    fn quantity(&self, name: &str, order: usize, at: At<'_, 's>) -> f64 {
        if order > 0 {
            return self.derivative(name, order, at);
        }
        let screen = self.screen;
        if let Some((name, equation)) = screen.auxiliaries.get_key_value(name) {
            let compute = || measured(equation.right(), &|name: &str| self.named(name, at)).value;
            return at.instant.auxiliary(name, compute);
        }
        if let Some(output) = screen.signals.get(name) {
            return self.per_volt(output, at.case) * at.instant.voltages.outputs[output.element];
        }
        match screen.parameters.get(name) {
            Some(index) => screen.cases[at.case].conditions.parameters[*index],
            None if name == "t" => at.instant.time,
            None => f64::NAN,
        }
    }

    /// The derivative of a quantity: the rate of a state, otherwise a central difference along the motion.
    fn derivative(&self, name: &str, order: usize, at: At<'_, 's>) -> f64 {
        let screen = self.screen;
        if order == 1
            && let Some(output) = screen.signals.get(name)
            && let Some(state) = output.state
        {
            return self.per_volt(output, at.case) * at.instant.voltages.rates[state];
        }
        if at.instant.differences + order > MAX_ORDER || at.is_start {
            return f64::NAN;
        }
        let case = &screen.cases[at.case];
        let Some([after, before]) = at.instant.neighbours(self.setup(case, case.has_free_drives)) else {
            return f64::NAN;
        };
        let [next, last] =
            [after, before].map(|instant| self.quantity(name, order - 1, At { instant, ..at }));
        (next - last) / after.since(before)
    }

    /// The value per volt of a signal in SI.
    fn per_volt(&self, output: &Output, case: usize) -> f64 {
        let coefficients = &self.screen.cases[case].conditions.coefficients;
        output.per_volt.map_or(1.0, |index| coefficients[index as usize])
    }
}
