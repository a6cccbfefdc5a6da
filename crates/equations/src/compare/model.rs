//! The quantities of a wiring as functions of its states, drives and parameters.

use std::collections::{BTreeSet, HashMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_expr::{Dimension, Equation, Expression, Node};

use super::expanded::AuxiliaryValue;
use super::expansions::{Expansions, TimeLaws};
use super::intended::fraction;
use crate::derive::{
    Law, LawKind, ModeLaw, Options, System, Wiring, derive, ramps, simplified, without_unnamed_ramps,
};
use crate::symbolic::{Fraction, Symbol, SymbolKind, derivative, step};

/// Delays in an equation for whose values there are variables.
const MAX_DELAYS: usize = 8;

/// A wiring with the quantities that its equations can name.
pub(crate) struct Model<'a> {
    /// The equations of the wiring.
    pub system: System,
    /// The patch, for the names of its signals and drives.
    patch: &'a Patch,
    /// The right sides of the auxiliary quantities, by name.
    auxiliaries: HashMap<&'a str, &'a Node>,
    /// The latest values of the auxiliary quantities.
    pub(super) known_auxiliaries: HashMap<&'a str, AuxiliaryValue>,
    /// The quantities that are being expanded, and those that were.
    pub(super) expansions: Expansions,
    /// The quantities that were not expanded, because functions would be too deep inside each other.
    pub(super) too_deep: HashSet<Symbol>,
    /// The ramps as functions of time.
    pub(super) ramps: HashMap<Symbol, Fraction>,
    /// Which of drives and ramps are expanded into their laws of time too.
    pub(super) time_laws: TimeLaws,
    /// The number of laws that were derived from the wiring. Those of derivatives follow.
    derived_laws: usize,
    /// The states with limits whose rates were used.
    pub limited: BTreeSet<Symbol>,
    /// Variables that stand for the values of delays, of which nothing is known at a point.
    pub(super) delayed: Vec<Symbol>,
    /// Whether all quantities are expressed by outputs of the program, for their values at a point. Then the outputs of
    /// delay lines stay as they are, and quantities of loops without a formula have derivatives.
    pub(super) is_evaluated: bool,
}

/// The reason why a quantity has no expression.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Obstacle {
    /// The patch has no such quantity. Its check has reported it.
    Unknown(String),
    /// The quantity is the solution of a loop without a formula, and has no values at which it can be compared.
    Implicit(String),
    /// The sides of the equation differ by a small part of their terms at most. The text is this part.
    Deviation(String),
    /// The formula of this quantity has too many functions inside each other.
    TooDeep(String),
    /// A value at the start depends on this quantity, which the problem check settles.
    Unsettled(String),
}

impl<'a> Model<'a> {
    /// The model of a circuit. Limits, stops and resets do not act in it, and brakes slip: it describes free motion.
    pub(crate) fn new(circuit: &'a Circuit, program: &Program, stays_in_range: bool) -> Self {
        let patch = circuit.patch();
        let is_known = |name: &str| patch.signals.contains_key(name) || patch.drives.contains_key(name);
        let wiring = wiring(circuit, program, stays_in_range);
        Self::of_system(circuit, without_unnamed_ramps(simplified(wiring, &is_known), &is_known))
    }

    /// The same for values at a point: all symbols are outputs of the program. `read` gets the symbols of the outputs.
    pub(super) fn evaluated<T>(
        circuit: &'a Circuit,
        program: &Program,
        read: impl FnOnce(&Wiring) -> T,
    ) -> (Self, T) {
        let wiring = wiring(circuit, program, false);
        let outputs = read(&wiring);
        // Every name counts as known, so no symbol gets another name.
        let model = Self::of_system(circuit, simplified(wiring, &|_| true));
        (Model { is_evaluated: true, ..model }, outputs)
    }

    /// The model of a system that was derived from a circuit.
    fn of_system(circuit: &'a Circuit, mut system: System) -> Self {
        // A reset ends a ramp, so they are found before free motion is assumed.
        let ramps = ramps(&system);
        let free: HashMap<Symbol, Fraction> =
            system.modes.iter().filter_map(|mode| Some((mode.symbol, value_in_motion(mode)?))).collect();
        for law in &mut system.laws {
            law.kind.for_each_mut(&mut |value| *value = value.with_symbols(&free));
        }
        let delayed =
            |number| system.symbols.variable(&format!("delayed value {number}"), 0, Dimension::NONE);
        let delayed = (1..=MAX_DELAYS).map(delayed).collect();
        Model {
            derived_laws: system.laws.len(),
            delayed,
            system,
            patch: circuit.patch(),
            auxiliaries: auxiliaries(circuit),
            known_auxiliaries: HashMap::new(),
            expansions: Expansions::default(),
            too_deep: HashSet::new(),
            ramps,
            time_laws: TimeLaws::default(),
            limited: BTreeSet::new(),
            is_evaluated: false,
        }
    }

    /// A quantity of an equation, with this number of derivatives, as a function of states, drives, time and
    /// parameters. Signals in `kept` stay as they are.
    pub(crate) fn quantity(
        &mut self,
        name: &str,
        primes: usize,
        kept: &HashSet<Symbol>,
    ) -> Result<Fraction, Obstacle> {
        let (mut value, derivatives) = self.lowest(name, primes, kept)?;
        self.check_depth(name, primes - derivatives, &value)?;
        for left in (0..derivatives).rev() {
            value = self.time_derivative(&value, kept)?;
            self.check_depth(name, primes - left, &value)?;
        }
        Ok(value)
    }

    /// The quantity, or its highest derivative that is a state, and the number of derivatives that remain.
    fn lowest(
        &mut self,
        name: &str,
        primes: usize,
        kept: &HashSet<Symbol>,
    ) -> Result<(Fraction, usize), Obstacle> {
        if let Some((name, node)) = self.auxiliaries.get_key_value(name).map(|(name, node)| (*name, *node)) {
            return Ok((self.auxiliary(name, node, kept)?, primes));
        }
        for order in (0..=primes).rev() {
            let found = u8::try_from(order).ok().and_then(|order| self.symbol(name, order));
            if let Some(symbol) = found {
                let is_state = matches!(self.system.law(symbol), Some(LawKind::State { .. }));
                if order == 0 || is_state {
                    return Ok((self.expanded(symbol, kept), primes - order));
                }
            }
        }
        Err(Obstacle::Unknown(name.to_owned()))
    }

    /// The symbol of a signal or a drive, or of a derivative of one; otherwise of a parameter or the time. A parameter may
    /// have the same name as an output; then equations cannot name the output.
    pub(crate) fn symbol(&self, name: &str, order: u8) -> Option<Symbol> {
        let symbols = &self.system.symbols;
        let is_output = self.patch.signals.contains_key(name) || self.patch.drives.contains_key(name);
        if is_output { symbols.find_variable(name, order) } else { symbols.find(name, order) }
    }

    /// A name of an equation, such as x'', k or t.
    pub(crate) fn named(&mut self, name: &str, kept: &HashSet<Symbol>) -> Result<Fraction, Obstacle> {
        // In an equation pi is the number, even if a signal has this name.
        if name == "pi"
            && let Some(pi) = self.system.symbols.find(name, 0)
        {
            return Ok(Fraction::symbol(pi));
        }
        let (base, primes) = patchcord_expr::split_primes(name);
        self.quantity(base, primes, kept)
    }

    /// Chooses what is expanded into laws of time. The laws of derivatives of quantities without a formula depend on it.
    pub(super) fn set_time_laws(&mut self, time_laws: TimeLaws) {
        if time_laws != self.time_laws {
            self.system.laws.truncate(self.derived_laws);
            self.known_auxiliaries.clear();
            self.time_laws = time_laws;
        }
    }

    /// Whether a state is a ramp.
    pub(super) fn is_ramp(&self, state: Symbol) -> bool {
        self.ramps.contains_key(&state)
    }

    /// Whether an equation names the time, or a side of it contains the time.
    pub(super) fn is_explicit_in_time(&mut self, equation: &Equation) -> bool {
        let none = HashSet::new();
        equation.names().contains(&"t")
            || [equation.left(), equation.right()].into_iter().any(|side| {
                let value = fraction(side, &mut |name| self.named(name, &none));
                value.is_ok_and(|value| self.contains_time(&value))
            })
    }

    /// An expression with its symbols expanded.
    pub(crate) fn expanded_fraction(&mut self, value: &Fraction, kept: &HashSet<Symbol>) -> Fraction {
        value.mapped(&mut |symbol| self.expanded(symbol, kept))
    }

    /// The derivative of an expanded expression with respect to time.
    fn time_derivative(&mut self, value: &Fraction, kept: &HashSet<Symbol>) -> Result<Fraction, Obstacle> {
        let mut obstacle = None;
        let result = derivative(value, &mut |symbol| match self.rate(symbol, kept) {
            Ok(rate) => rate,
            Err(error) => {
                obstacle = Some(error);
                Fraction::zero()
            }
        });
        obstacle.map_or(Ok(result), Err)
    }

    /// The derivative of a symbol with respect to time.
    fn rate(&mut self, symbol: Symbol, kept: &HashSet<Symbol>) -> Result<Fraction, Obstacle> {
        let entry = self.system.symbols.entry(symbol);
        match entry.kind {
            SymbolKind::Time => return Ok(Fraction::whole(1)),
            SymbolKind::Pi | SymbolKind::Parameter(_) | SymbolKind::Held => return Ok(Fraction::zero()),
            SymbolKind::Variable => {}
        }
        let name = entry.name.clone();
        match self.system.law(symbol) {
            Some(LawKind::State { rate, limits, .. }) => {
                let (rate, is_limited) = (rate.clone(), limits.iter().any(Option::is_some));
                if is_limited {
                    self.limited.insert(symbol);
                }
                Ok(self.expanded_fraction(&rate, kept))
            }
            // A signal that is kept.
            Some(LawKind::Definition(_)) => {
                let value = self.expanded(symbol, &HashSet::new());
                self.time_derivative(&value, &HashSet::new())
            }
            Some(LawKind::Drive(_)) | None => Ok(Fraction::symbol(self.system.symbols.derivative(symbol))),
            Some(LawKind::Implicit(residual)) if self.is_evaluated => {
                let residual = residual.clone();
                self.implicit_rate(symbol, &residual, kept)
            }
            Some(_) => Err(Obstacle::Implicit(name)),
        }
    }

    /// The derivative of a quantity that is determined by a residual of 0. It becomes a quantity of its own: the
    /// derivative of the residual, in which it is linear, is 0.
    fn implicit_rate(
        &mut self,
        of: Symbol,
        residual: &Fraction,
        kept: &HashSet<Symbol>,
    ) -> Result<Fraction, Obstacle> {
        let rate = self.system.symbols.derivative(of);
        if self.system.law(rate).is_none() {
            // Residuals contain each other's quantities. So the law has a place before its residual is known.
            let place = self.system.laws.len();
            self.system.laws.push(Law { of: rate, kind: LawKind::Implicit(Fraction::zero()) });
            let residual = self.expanded_fraction(residual, kept);
            match self.time_derivative(&residual, kept) {
                Ok(derivative) => self.system.laws[place].kind = LawKind::Implicit(derivative),
                Err(obstacle) => {
                    self.system.laws.remove(place);
                    return Err(obstacle);
                }
            }
        }
        Ok(Fraction::symbol(rate))
    }

    /// The value of a quantity at t = 0 as a function of parameters.
    pub(crate) fn initial(&mut self, name: &str, primes: usize) -> Result<Fraction, Obstacle> {
        let mut at_start = self.quantity(name, primes, &HashSet::new())?;
        // Drives depend on time, and initial values can depend on drives.
        for _ in 0..3 {
            at_start = at_start.mapped(&mut |symbol| match self.system.law(symbol) {
                Some(LawKind::State { initial, .. } | LawKind::Delay { initial, .. }) => initial.clone(),
                Some(LawKind::Drive(value)) => value.clone(),
                _ if self.system.symbols.entry(symbol).kind == SymbolKind::Time => Fraction::zero(),
                _ => Fraction::symbol(symbol),
            });
        }
        match self.first_variable(&at_start) {
            Some(name) => Err(Obstacle::Unsettled(name)),
            None => Ok(at_start),
        }
    }
}

impl Model<'_> {
    /// Whether drives are expanded into their laws of time.
    pub(super) fn expands_drives(&self) -> bool {
        self.time_laws.drives
    }

    /// Whether the wiring has ramps with a name.
    pub(super) fn has_ramps(&self) -> bool {
        !self.ramps.is_empty()
    }

    /// Whether an expression contains the time.
    fn contains_time(&self, value: &Fraction) -> bool {
        value.contains(&mut |symbol| self.system.symbols.entry(symbol).kind == SymbolKind::Time)
    }

    /// The names of the parameters in expressions, in alphabetical order.
    pub(super) fn parameters_in<'f>(
        &self,
        expressions: impl IntoIterator<Item = &'f Fraction>,
    ) -> Vec<String> {
        let symbols = expressions.into_iter().flat_map(Fraction::symbols);
        let entries = symbols.map(|symbol| self.system.symbols.entry(symbol));
        let parameters = entries.filter(|entry| matches!(entry.kind, SymbolKind::Parameter(_)));
        let names: BTreeSet<&str> = parameters.map(|entry| entry.name.as_str()).collect();
        names.into_iter().map(str::to_owned).collect()
    }

    /// The name of a quantity in an expression that is no parameter.
    fn first_variable(&self, value: &Fraction) -> Option<String> {
        let mut found = None;
        value.contains(&mut |symbol| {
            if !symbol.is_constant {
                found = Some(self.system.symbols.entry(symbol).name.clone());
            }
            !symbol.is_constant
        });
        found
    }
}

/// The equations of a wiring with ideal amplifiers, without other names for its outputs.
fn wiring(circuit: &Circuit, program: &Program, stays_in_range: bool) -> Wiring {
    derive(circuit, program, Options { keeps_elements: false, has_ideal_amplifiers: true, stays_in_range })
}

/// The right sides of the equations that define auxiliary quantities, by the names of these.
fn auxiliaries(circuit: &Circuit) -> HashMap<&str, &Node> {
    let definitions = circuit.equations().iter().filter_map(|placed| match &placed.value.left().expression {
        Expression::Name(name) => Some((name.as_str(), placed.value.right())),
        _ => None,
    });
    let is_auxiliary = |name: &str| circuit.auxiliary_quantities().any(|auxiliary| auxiliary == name);
    definitions.filter(|(name, _)| is_auxiliary(name)).collect()
}

/// The value of a mode in free motion: no contact, no reset, and a brake that slips in the direction of motion. `None`
/// for the positions of relays, which are quantities of their own.
fn value_in_motion(mode: &ModeLaw) -> Option<Fraction> {
    match mode.noun {
        "contact" | "reset" => Some(Fraction::zero()),
        "brake" => {
            let output = mode.brake()?.output;
            Some(step(&output).times(&Fraction::whole(2)).minus(&Fraction::whole(1)))
        }
        _ => None,
    }
}
