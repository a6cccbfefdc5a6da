//! A system of equations in exact symbolic form.

use std::collections::HashMap;

use num_traits::{Signed as _, Zero as _};
use patchcord_expr::Dimension;

use crate::symbolic::{Fraction, Symbol, Symbols};

/// The equations of a circuit, in SI units.
#[derive(Debug, Clone)]
pub(crate) struct System {
    /// The names of all quantities.
    pub symbols: Symbols,
    /// The laws. A definition comes before the laws that read its quantity, except in implicit laws and delays.
    pub laws: Vec<Law>,
    /// The modes.
    pub modes: Vec<ModeLaw>,
    /// The tables, by their index in the program: each with the name of its element.
    pub tables: Vec<TableLaw>,
    /// By how much the inputs of squaring networks and logarithms are within their range, in volts.
    pub margins: Vec<Fraction>,
    /// The values at 1 V of the states that have got the name of a signal or of a derivative.
    pub per_volt: HashMap<Symbol, Fraction>,
}

/// What determines a quantity.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    /// The quantity.
    pub of: Symbol,
    /// How it is determined.
    pub kind: LawKind,
}

/// How a quantity is determined.
#[derive(Debug, Clone)]
pub(crate) enum LawKind {
    /// A state: its rate, its value at the start, and its limits if it has any within those of the amplifier.
    State { rate: Fraction, initial: Fraction, limits: [Option<Fraction>; 2] },
    /// A value that follows from other quantities.
    Definition(Fraction),
    /// A value at which an expression is 0.
    Implicit(Fraction),
    /// A value that another one had some time ago, and the value before the first one arrives.
    Delay { input: Fraction, time: Fraction, initial: Fraction },
    /// A value that is stored at the end of each step: what is stored, and the value at the start.
    Stored { next: Fraction, initial: Fraction },
    /// A drive: a value that follows from time and parameters.
    Drive(Fraction),
    /// A source that is constant between known instants.
    Source(Source),
}

impl LawKind {
    /// Changes every expression of the law.
    pub(crate) fn for_each_mut(&mut self, change: &mut dyn FnMut(&mut Fraction)) {
        match self {
            LawKind::State { rate, initial, limits } => {
                change(rate);
                change(initial);
                limits.iter_mut().flatten().for_each(change);
            }
            LawKind::Definition(value) | LawKind::Implicit(value) | LawKind::Drive(value) => change(value),
            LawKind::Delay { input, time, initial } => [input, time, initial].into_iter().for_each(change),
            LawKind::Stored { next, initial } => [next, initial].into_iter().for_each(change),
            LawKind::Source(Source::Pulses(value)) => change(value),
            LawKind::Source(Source::Noise | Source::Steps(_)) => {}
        }
    }
}

/// A source that is constant between known instants.
#[derive(Debug, Clone)]
pub(crate) enum Source {
    /// Random numbers with mean 0 and variance 1.
    Noise,
    /// The last value of a table of time at or before the present time.
    Steps(usize),
    /// 1 within a pulse, 0 outside: a law of time.
    Pulses(Fraction),
}

/// A discrete value that is constant until a transition.
#[derive(Debug, Clone)]
pub(crate) struct ModeLaw {
    /// The mode.
    pub symbol: Symbol,
    /// Name of its element.
    pub element: String,
    /// A noun, such as "contact".
    pub noun: &'static str,
    /// Its values with their names.
    pub values: &'static [(f64, &'static str)],
    /// The value in initial condition.
    pub initial: f64,
    /// The possible changes; of several that are due, the first one happens.
    pub transitions: Vec<TransitionLaw>,
}

/// The law of a brake at an integrator, in volts: the output does not change while it is 0 and |net| <= level. Otherwise
/// its rate is net - level x sign(output).
#[derive(Debug, Clone)]
pub(crate) struct BrakeLaw {
    /// The mode: the sign of the output while it moves, 0 while it does not.
    pub direction: Symbol,
    /// The output.
    pub output: Fraction,
    /// Its rate without the brake.
    pub net: Fraction,
    /// The level, which is not negative.
    pub level: Fraction,
}

impl ModeLaw {
    /// The law of a brake. `None` for another mode.
    ///
    /// The first two changes begin a motion of an output that is not 0. The others begin and end one in either direction:
    /// net - level and -net - level are their guards.
    pub(crate) fn brake(&self) -> Option<BrakeLaw> {
        let [motion, _, up, _, down, _] = self.transitions.as_slice() else { return None };
        let begins = |change: &TransitionLaw, to: f64| change.from == 0.0 && change.to == to;
        if self.noun != "brake" || !(begins(motion, 1.0) && begins(up, 1.0) && begins(down, -1.0)) {
            return None;
        }
        let half = |sum: Fraction| sum.over(&Fraction::whole(2));
        Some(BrakeLaw {
            direction: self.symbol,
            output: motion.guard.clone(),
            net: half(up.guard.minus(&down.guard)),
            level: half(up.guard.plus(&down.guard)).negated(),
        })
    }
}

/// A change of a mode.
#[derive(Debug, Clone)]
pub(crate) struct TransitionLaw {
    /// The value before the change.
    pub from: f64,
    /// The value after the change.
    pub to: f64,
    /// The change happens if this is 0 or above.
    pub guard: Fraction,
    /// Whether it must be above 0.
    pub is_strict: bool,
    /// The state that the change sets, with its new value.
    pub reset: Option<(Symbol, Fraction)>,
}

impl TransitionLaw {
    /// Whether the change can happen: its condition is not a number that fails.
    pub(crate) fn is_possible(&self) -> bool {
        self.guard
            .as_rational()
            .is_none_or(|value| value.is_positive() || (value.is_zero() && !self.is_strict))
    }
}

/// A table of points.
#[derive(Debug, Clone)]
pub(crate) struct TableLaw {
    /// Name of the element.
    pub element: String,
    /// The points, [abscissa, ordinate].
    pub points: Vec<[f64; 2]>,
    /// The unit of the ordinates if it is looked up at time. Otherwise both are voltages.
    pub unit: Option<TableUnit>,
}

impl TableLaw {
    /// The ordinate in SI at an abscissa; volts if the table has no unit.
    pub(crate) fn value_in_si(&self, at: f64) -> f64 {
        self.unit.as_ref().map_or(1.0, |unit| unit.factor) * interpolated(&self.points, at)
    }
}

/// The ordinate of a table of points at an abscissa: straight lines between the points, constant outside. NaN if there
/// is no point.
fn interpolated(points: &[[f64; 2]], at: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < at);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some([x, y]), Some([next, ordinate])) => y + (ordinate - y) * (at - x) / (next - x),
        (Some([_, y]), None) => y,
        (None, Some([_, y])) => *y,
        (None, None) => f64::NAN,
    }
}

/// The unit of a table of time.
#[derive(Debug, Clone)]
pub(crate) struct TableUnit {
    /// Its text.
    pub text: String,
    /// Its size in SI.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

impl System {
    /// A system without laws.
    pub(crate) fn without_laws(symbols: Symbols) -> Self {
        System {
            symbols,
            laws: Vec::new(),
            modes: Vec::new(),
            tables: Vec::new(),
            margins: Vec::new(),
            per_volt: HashMap::new(),
        }
    }

    /// The law of a quantity.
    pub(crate) fn law(&self, of: Symbol) -> Option<&LawKind> {
        self.laws.iter().find(|law| law.of == of).map(|law| &law.kind)
    }

    /// Replaces a quantity in all laws and modes by an expression. Returns whether any contains it.
    pub(crate) fn replace(&mut self, symbol: Symbol, by: &Fraction) -> bool {
        self.replace_all(&HashMap::from([(symbol, by.clone())]))
    }

    /// Replaces quantities in all laws and modes by expressions. Returns whether any contains one of them.
    pub(crate) fn replace_all(&mut self, by: &HashMap<Symbol, Fraction>) -> bool {
        let mut is_found = false;
        let mut replaced = |fraction: &mut Fraction| {
            if fraction.contains(&mut |symbol| by.contains_key(&symbol)) {
                is_found = true;
                *fraction = fraction.with_symbols(by);
            }
        };
        self.laws.iter_mut().for_each(|law| law.kind.for_each_mut(&mut replaced));
        self.margins.iter_mut().for_each(&mut replaced);
        for transition in self.modes.iter_mut().flat_map(|mode| &mut mode.transitions) {
            replaced(&mut transition.guard);
            transition.reset.iter_mut().for_each(|(_, to)| replaced(to));
        }
        is_found
    }
}
