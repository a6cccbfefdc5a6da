//! The values of all quantities of the stated equations at a point.
//!
//! The test values of the states are known, and so are drives and parameters. Every equation with one unknown quantity
//! gives its value, and so do several equations with as many unknowns. If a derivative is still unknown, the equations
//! are differentiated: `v = x'` gives `v' = x''`. A quantity that no equation determines has the value of the wiring.

use std::collections::btree_map::{BTreeMap, Entry};
use std::collections::{BTreeSet, VecDeque};
use std::f64::consts::TAU;

use patchcord_expr::Function;

use super::agenda::{Agenda, Posed};
use super::handles::{Handle, stated_names};
use super::stated::Stated;
use super::wired::Wired;
use crate::symbolic::{
    CallOrder, Fraction, Operation, Roots, Symbol, SymbolKind, Values, is_at_switch, partial_derivative,
    term_size, value,
};

/// Where the value of a quantity comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// It is a test value.
    Test,
    /// The equations give it.
    Equations,
    /// No equation determines it, so the wiring gives it.
    Wiring,
}

/// The value of a quantity, in SI.
#[derive(Debug, Clone)]
pub(super) struct Known {
    /// The value.
    pub value: f64,
    /// The sum of the sizes of the terms of its equation, divided by its factor there; at least the size of the value. A
    /// relative deviation of the terms causes a deviation of the value by this share of the sum. Terms that are sums
    /// themselves count with the sizes of their terms.
    pub size: f64,
    /// Where the value comes from.
    pub origin: Origin,
    /// Indices of the stated equations that give it.
    equations: Vec<usize>,
    /// The other quantities in these equations.
    reads: BTreeSet<Symbol>,
}

impl Known {
    /// A value that no equation gives.
    fn given(value: f64, origin: Origin) -> Self {
        Known { value, size: value.abs(), origin, equations: Vec::new(), reads: BTreeSet::new() }
    }
}

/// Times that the equations are differentiated at most.
const MAX_DIFFERENTIATIONS: usize = 2;
/// Longest equation that is differentiated, in terms.
const LONGEST: usize = 200;
/// Largest difference in radians of two angles that are equal up to whole turns.
const SAME_ANGLE: f64 = 1e-2;

/// The values of the quantities at a point.
pub(super) struct Solution<'a> {
    /// The equations with the names of all quantities.
    pub stated: Stated<'a>,
    /// For each state, the quantity by which the equations know it.
    pub handles: Vec<Option<Handle>>,
    wired: &'a Wired<'a>,
    values: BTreeMap<Symbol, Known>,
    /// The equations: first the stated ones, then their derivatives.
    agenda: Agenda,
    /// The quantities in the stated equations.
    named: BTreeSet<Symbol>,
}

impl<'a> Solution<'a> {
    /// Solves the equations of a circuit at a point. `handles` are the quantities that determine each state.
    /// `is_initial` is whether the point is the initial condition, so that stated initial values apply.
    pub(super) fn new(wired: &'a Wired<'a>, handles: &[Vec<Handle>], is_initial: bool) -> Self {
        let stated = Stated::new(wired.circuit, wired.program);
        let names = stated_names(wired.circuit);
        let best = |of_state: &Vec<Handle>| {
            of_state.first().filter(|handle| names.contains(handle.name.as_str())).cloned()
        };
        let handles = handles.iter().map(best).collect();
        let named = stated.symbols.all().filter(|symbol| stated.varies(*symbol)).collect();
        let (values, agenda) = (BTreeMap::new(), Agenda::default());
        let mut solution = Solution { stated, handles, wired, values, agenda, named };
        solution.supply_drives();
        for (index, residual) in solution.stated.residuals.clone() {
            solution.pose(index, residual);
        }
        if is_initial {
            solution.supply_initial_values();
            solution.propagate();
        }
        solution.supply_states();
        solution.propagate();
        solution.supply_from_wiring(0);
        solution.differentiate();
        solution.supply_from_wiring(usize::MAX);
        solution
    }

    /// The value of a quantity. `None` if it is not known.
    pub(super) fn quantity(&self, name: &str, order: usize) -> Option<&Known> {
        self.values.get(&self.stated.symbols.find(name, u8::try_from(order).ok()?)?)
    }

    /// Indices of the stated equations that give a quantity, and then of those that give the quantities in them.
    pub(super) fn equations_behind(&self, name: &str, order: usize) -> Vec<usize> {
        let symbol = u8::try_from(order).ok().and_then(|order| self.stated.symbols.find(name, order));
        let mut open: VecDeque<Symbol> = symbol.into_iter().collect();
        let (mut seen, mut found) = (BTreeSet::new(), Vec::new());
        while let Some(symbol) = open.pop_front() {
            let Some(known) = self.values.get(&symbol) else { continue };
            for equation in &known.equations {
                if !found.contains(equation) {
                    found.push(*equation);
                }
            }
            open.extend(known.reads.iter().filter(|read| seen.insert(**read)));
        }
        found
    }

    /// The derivatives in the stated equations that the equations determine, each with its name and number of primes.
    pub(super) fn stated_derivatives(&self) -> Vec<(String, usize)> {
        let is_determined = |symbol: &&Symbol| {
            self.values.get(*symbol).is_some_and(|known| known.origin == Origin::Equations)
        };
        let entries = self.named.iter().filter(is_determined);
        let entries = entries.map(|symbol| self.stated.symbols.entry(*symbol));
        let derivatives = entries.filter(|entry| entry.primes > 0);
        derivatives.map(|entry| (entry.name.clone(), usize::from(entry.primes))).collect()
    }

    /// Adds an equation: an expression that is 0, and the index of the stated equation from which it follows.
    fn pose(&mut self, stated: usize, residual: Fraction) {
        let symbols = self.quantities(&residual);
        let is_unknown = |symbol: &&Symbol| !self.values.contains_key(*symbol);
        let unknowns = symbols.iter().filter(is_unknown).copied().collect();
        self.agenda.add(Posed { residual, stated, symbols, unknowns });
    }

    /// The quantities in an expression that vary.
    fn quantities(&self, expression: &Fraction) -> BTreeSet<Symbol> {
        expression.symbols().into_iter().filter(|symbol| self.stated.varies(*symbol)).collect()
    }

    /// Adds a value, unless the quantity has one.
    fn know(&mut self, symbol: Symbol, known: Known) {
        if let Entry::Vacant(place) = self.values.entry(symbol) {
            place.insert(known);
            self.agenda.know(symbol);
        }
    }

    /// Adds the stated initial values.
    fn supply_initial_values(&mut self) {
        let solution = &*self;
        let at = At { solution };
        let values = solution.stated.initial.iter().map(|(index, symbol, initial)| {
            let value = value(initial, &at);
            let size = term_size(initial, &at).max(value.abs());
            let (equations, reads) = (vec![*index], solution.quantities(initial));
            (*symbol, Known { value, size, origin: Origin::Equations, equations, reads })
        });
        let values: Vec<(Symbol, Known)> = values.filter(|(_, known)| known.value.is_finite()).collect();
        values.into_iter().for_each(|(symbol, known)| self.know(symbol, known));
    }

    /// Adds the quantities that determine the states.
    fn supply_states(&mut self) {
        for handle in self.handles.clone().into_iter().flatten() {
            let symbol = self.stated.symbol(&handle.name, handle.order);
            if let Some(value) = self.wired.quantity(&handle.name, handle.order) {
                self.know(symbol, Known::given(value, Origin::Test));
            }
        }
    }

    /// Adds the drives that the equations name, with the derivatives that they name.
    fn supply_drives(&mut self) {
        let symbols = &self.stated.symbols;
        let unknown = symbols.all().filter(|symbol| !self.values.contains_key(symbol));
        let drives = unknown.filter_map(|symbol| {
            let entry = symbols.entry(symbol);
            let (register, _) = self.wired.place(&entry.name)?;
            let is_drive = entry.kind == SymbolKind::Variable && self.wired.is_drive(register);
            let value = is_drive.then(|| self.wired.quantity(&entry.name, usize::from(entry.primes)))??;
            Some((symbol, Known::given(value, Origin::Wiring)))
        });
        let drives: Vec<(Symbol, Known)> = drives.collect();
        drives.into_iter().for_each(|(symbol, known)| self.know(symbol, known));
    }

    /// Adds quantities of the stated equations that remain unknown, with the values of the wiring: those with at most
    /// this number of derivatives, in the order of derivatives and then of signal flow. The equations are solved again
    /// after each of them.
    fn supply_from_wiring(&mut self, order: usize) {
        let symbols = &self.stated.symbols;
        let place = |symbol: &Symbol| {
            let entry = symbols.entry(*symbol);
            let register = self.wired.place(&entry.name).map(|(register, _)| register);
            (entry.primes, register, symbol.index)
        };
        let is_low = |symbol: &&Symbol| usize::from(symbols.entry(**symbol).primes) <= order;
        let mut supplied: Vec<Symbol> = self.named.iter().filter(is_low).copied().collect();
        supplied.sort_by_cached_key(place);
        for symbol in supplied {
            if self.values.contains_key(&symbol) {
                continue;
            }
            if let Some(value) = self.wired_value(symbol) {
                self.know(symbol, Known::given(value, Origin::Wiring));
                self.propagate();
            }
        }
    }

    /// The value of a quantity in the wiring. `None` if it has none.
    fn wired_value(&self, symbol: Symbol) -> Option<f64> {
        let entry = self.stated.symbols.entry(symbol);
        let value = self.wired.quantity(&entry.name, usize::from(entry.primes));
        value.filter(|value| value.is_finite())
    }

    /// Differentiates the equations until the rate of every state is known.
    fn differentiate(&mut self) {
        let mut begin = 0;
        for _ in 0..MAX_DIFFERENTIATIONS {
            let mut known = self.handles.iter().flatten();
            let is_complete = known.all(|handle| self.quantity(&handle.name, handle.order + 1).is_some());
            if is_complete {
                return;
            }
            let end = self.agenda.count();
            for index in begin..end {
                let Posed { residual, stated, .. } = self.agenda.equation(index);
                if residual.size() <= LONGEST {
                    let (stated, derivative) = (*stated, self.stated.differentiated(residual));
                    self.pose(stated, derivative);
                }
            }
            begin = end;
            self.supply_drives();
            self.propagate();
        }
    }

    /// Solves equations until none gives a further value.
    fn propagate(&mut self) {
        while let Some(index) = self.agenda.pop() {
            let found = self.block(index).unwrap_or_default();
            found.into_iter().for_each(|(symbol, known)| self.know(symbol, known));
        }
    }

    /// The values of the unknowns of an equation, from this equation and others that have no further unknowns. `None`
    /// if there are too few of them, or if they have no solution.
    fn block(&self, index: usize) -> Option<Vec<(Symbol, Known)>> {
        let block: Vec<&Posed> =
            self.agenda.block(index)?.into_iter().map(|index| self.agenda.equation(index)).collect();
        let symbols: Vec<Symbol> = block.first()?.unknowns.iter().copied().collect();
        let residuals = block.iter().map(|posed| posed.residual.clone()).collect();
        let roots = Roots::new(symbols.clone(), residuals);
        let found = self.starts(&symbols).into_iter().find_map(|start| self.root(&roots, start))?;
        let found = self.with_turns_of_wiring(&roots, found);
        let known = At { solution: self };
        let at = roots.with(&found, &known);
        let equations: Vec<usize> = block.iter().map(|posed| posed.stated).collect();
        let all: BTreeSet<Symbol> = block.iter().flat_map(|posed| posed.symbols.iter().copied()).collect();
        let values = symbols.iter().zip(&found).map(|(symbol, value)| {
            let sizes = block.iter().filter_map(|posed| self.size(posed, *symbol, &at));
            let size = sizes.fold(value.abs(), f64::max);
            let reads = all.iter().copied().filter(|other| !symbols.contains(other)).collect();
            let equations = equations.clone();
            (*symbol, Known { value: *value, size, origin: Origin::Equations, equations, reads })
        });
        Some(values.collect())
    }

    /// The sum of the sizes of an equation's terms, divided by the factor of an unknown. `None` if the equation does not
    /// determine it.
    fn size(&self, posed: &Posed, unknown: Symbol, at: &dyn Values) -> Option<f64> {
        let residual = &posed.residual;
        let slope = |symbol: Symbol| value(&partial_derivative(residual, symbol), at).abs();
        let mut deviation = 0.0;
        if residual.size() <= LONGEST {
            let known = posed.symbols.iter().filter_map(|symbol| Some((*symbol, self.values.get(symbol)?)));
            deviation = known.map(|(symbol, known)| slope(symbol) * known.size).sum();
        }
        let size = term_size(residual, at).max(deviation) / slope(unknown);
        size.is_finite().then_some(size)
    }

    /// The same values, but an angle that is only known up to whole turns has the turn that the wiring gives it.
    fn with_turns_of_wiring(&self, roots: &Roots, mut found: Vec<f64>) -> Vec<f64> {
        if let ([symbol], [equation]) = (roots.unknowns(), roots.expressions())
            && has_angle(equation)
            && let Some(wired) = self.wired_value(*symbol)
        {
            let turns = ((wired - found[0]) / TAU).round();
            let is_same_angle = (wired - found[0] - turns * TAU).abs() <= SAME_ANGLE;
            found[0] += if is_same_angle { turns * TAU } else { 0.0 };
        }
        found
    }

    /// Points at which an iteration can begin. The wiring is the first: if it is correct, it is the solution.
    fn starts(&self, symbols: &[Symbol]) -> [Vec<f64>; 3] {
        let wired = symbols.iter().map(|symbol| self.wired_value(*symbol).unwrap_or(1.0)).collect();
        [wired, vec![1.0; symbols.len()], vec![-1.0; symbols.len()]]
    }

    /// The values at which several equations are 0, by steps from a start. `None` if the steps do not end, or if a
    /// condition of the equations changes exactly there.
    fn root(&self, roots: &Roots, start: Vec<f64>) -> Option<Vec<f64>> {
        let known = At { solution: self };
        let found = roots.near(start, &known)?;
        let at = roots.with(&found, &known);
        let is_switching = roots.expressions().iter().any(|equation| is_at_switch(equation, &at));
        (!is_switching).then_some(found)
    }
}

/// Whether an expression contains the angle of a point.
fn has_angle(expression: &Fraction) -> bool {
    let angle = Operation::Call(CallOrder(Function::Atan2));
    !expression.functions_with(&|function| function.operation == angle).is_empty()
}

/// The values of the quantities that are known.
struct At<'a> {
    solution: &'a Solution<'a>,
}

impl Values for At<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        match self.solution.stated.symbols.entry(symbol).kind {
            SymbolKind::Pi => std::f64::consts::PI,
            SymbolKind::Parameter(index) => self.solution.wired.program.parameters()[index].value,
            SymbolKind::Time => self.solution.wired.point.time,
            SymbolKind::Variable | SymbolKind::Held => {
                self.solution.values.get(&symbol).map_or(f64::NAN, |known| known.value)
            }
        }
    }

    fn table(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn slope(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn delayed(&self, _expression: &Fraction, _time: f64) -> f64 {
        f64::NAN
    }
}
