//! The values of all quantities of the stated equations at a point.
//!
//! The test values of the states are known, and so are drives and parameters. Every equation with one unknown quantity
//! gives its value, and so do several equations with as many unknowns. If a derivative is still unknown, the equations
//! are differentiated: `v = x'` gives `v' = x''`. A quantity that no equation determines has the value of the wiring.

use std::collections::{BTreeMap, BTreeSet};

use super::handles::{Handle, is_stated};
use super::stated::Stated;
use super::wired::Wired;
use crate::symbolic::{Fraction, Roots, Symbol, SymbolKind, Values, is_at_switch, value};

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

/// Unknowns that several equations determine together, at most.
const MAX_BLOCK: usize = 6;
/// Times that the equations are differentiated at most.
const MAX_DIFFERENTIATIONS: usize = 2;
/// Longest equation that is differentiated, in terms.
const LONGEST: usize = 200;

/// The values of the quantities at a point.
pub(super) struct Solution<'a> {
    /// The equations with the names of all quantities.
    pub stated: Stated<'a>,
    /// For each state, the quantity by which the equations know it.
    pub handles: Vec<Option<Handle>>,
    wired: &'a Wired<'a>,
    values: BTreeMap<Symbol, (f64, Origin)>,
    /// The equations, each as an expression that is 0: first the stated ones, then their derivatives.
    equations: Vec<Fraction>,
    /// The quantities in the stated equations.
    named: BTreeSet<Symbol>,
}

impl<'a> Solution<'a> {
    /// Solves the equations of a circuit at a point. `handles` are the quantities that determine each state.
    /// `is_initial` is whether the point is the initial condition, so that stated initial values apply.
    pub(super) fn new(wired: &'a Wired<'a>, handles: &[Vec<Handle>], is_initial: bool) -> Self {
        let stated = Stated::new(wired.circuit, wired.program);
        let best = |of_state: &Vec<Handle>| {
            of_state.first().filter(|handle| is_stated(wired.circuit, &handle.name)).cloned()
        };
        let handles = handles.iter().map(best).collect();
        let equations: Vec<Fraction> =
            stated.residuals.iter().map(|(_, residual)| residual.clone()).collect();
        let named = stated.symbols.all().filter(|symbol| stated.varies(*symbol)).collect();
        let mut solution = Solution { stated, handles, wired, values: BTreeMap::new(), equations, named };
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

    /// The value of a quantity in SI with its origin. `None` if it is not known.
    pub(super) fn quantity(&self, name: &str, order: usize) -> Option<(f64, Origin)> {
        let symbol = self.stated.symbols.find(name, u8::try_from(order).ok()?)?;
        self.values.get(&symbol).copied()
    }

    /// The derivatives in the stated equations that the equations determine, each with its name and number of primes.
    pub(super) fn stated_derivatives(&self) -> Vec<(String, usize)> {
        let is_determined = |symbol: &&Symbol| {
            self.values.get(*symbol).is_some_and(|(_, origin)| *origin == Origin::Equations)
        };
        let entries = self.named.iter().filter(is_determined);
        let entries = entries.map(|symbol| self.stated.symbols.entry(*symbol));
        let derivatives = entries.filter(|entry| entry.primes > 0);
        derivatives.map(|entry| (entry.name.clone(), usize::from(entry.primes))).collect()
    }

    /// Adds the stated initial values.
    fn supply_initial_values(&mut self) {
        let solution = &*self;
        let at = At { solution };
        let values = solution.stated.initial.iter().map(|(symbol, initial)| (*symbol, value(initial, &at)));
        let values: Vec<(Symbol, f64)> = values.filter(|(_, value)| value.is_finite()).collect();
        self.values.extend(values.into_iter().map(|(symbol, value)| (symbol, (value, Origin::Equations))));
    }

    /// Adds the quantities that determine the states.
    fn supply_states(&mut self) {
        for handle in self.handles.clone().into_iter().flatten() {
            let symbol = self.stated.symbol(&handle.name, handle.order);
            if let Some(value) = self.wired.quantity(&handle.name, handle.order) {
                self.values.entry(symbol).or_insert((value, Origin::Test));
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
            Some((symbol, (value, Origin::Wiring)))
        });
        let drives: Vec<_> = drives.collect();
        self.values.extend(drives);
    }

    /// Adds quantities of the stated equations that remain unknown, with the values of the wiring: those with at most
    /// this number of derivatives. The equations are solved again after each of them.
    fn supply_from_wiring(&mut self, order: usize) {
        while let Some((symbol, value)) = self.next_from_wiring(order) {
            self.values.insert(symbol, (value, Origin::Wiring));
            self.propagate();
        }
    }

    /// The first unknown quantity in the order of derivatives and then of signal flow, with its value in the wiring.
    fn next_from_wiring(&self, order: usize) -> Option<(Symbol, f64)> {
        let place = |symbol: &Symbol| {
            let entry = self.stated.symbols.entry(*symbol);
            let register = self.wired.place(&entry.name).map(|(register, _)| register);
            (entry.primes, register, symbol.index)
        };
        let is_unknown = |symbol: &&Symbol| {
            !self.values.contains_key(*symbol)
                && usize::from(self.stated.symbols.entry(**symbol).primes) <= order
        };
        let mut unknown: Vec<Symbol> = self.named.iter().filter(is_unknown).copied().collect();
        unknown.sort_by_key(place);
        unknown.into_iter().find_map(|symbol| {
            let entry = self.stated.symbols.entry(symbol);
            let value = self.wired.quantity(&entry.name, usize::from(entry.primes))?;
            value.is_finite().then_some((symbol, value))
        })
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
            let end = self.equations.len();
            for index in begin..end {
                let equation = self.equations[index].clone();
                if equation.size() <= LONGEST {
                    let derivative = self.stated.differentiated(&equation);
                    self.equations.push(derivative);
                }
            }
            begin = end;
            self.propagate();
        }
    }

    /// Solves equations until none gives a further value.
    fn propagate(&mut self) {
        while self.solve_next() {}
    }

    /// Solves the first equation, or the first equations together, that can be solved. Returns whether there are any.
    fn solve_next(&mut self) -> bool {
        self.supply_drives();
        let unknowns: Vec<BTreeSet<Symbol>> =
            self.equations.iter().map(|equation| self.unknowns(equation)).collect();
        for size in 1..=MAX_BLOCK {
            for index in (0..unknowns.len()).filter(|index| unknowns[*index].len() == size) {
                if let Some(found) = self.block(index, &unknowns) {
                    let found = found.into_iter().map(|(symbol, value)| (symbol, (value, Origin::Equations)));
                    self.values.extend(found);
                    return true;
                }
            }
        }
        false
    }

    /// The unknown quantities of an expression.
    fn unknowns(&self, expression: &Fraction) -> BTreeSet<Symbol> {
        let mut found = BTreeSet::new();
        expression.contains(&mut |symbol| {
            if self.stated.varies(symbol) && !self.values.contains_key(&symbol) {
                found.insert(symbol);
            }
            false
        });
        found
    }

    /// The values of the unknowns of an equation, from this equation and others that have no further unknowns. `None`
    /// if there are too few of them, or if they have no solution.
    fn block(&self, index: usize, unknowns: &[BTreeSet<Symbol>]) -> Option<Vec<(Symbol, f64)>> {
        let own = &unknowns[index];
        let is_inside = |other: &usize| {
            *other != index && !unknowns[*other].is_empty() && unknowns[*other].is_subset(own)
        };
        let others = (0..unknowns.len()).filter(is_inside);
        let equations: Vec<Fraction> = std::iter::once(index)
            .chain(others)
            .take(own.len())
            .map(|index| self.equations[index].clone())
            .collect();
        if equations.len() < own.len() {
            return None;
        }
        let symbols: Vec<Symbol> = own.iter().copied().collect();
        let starts = self.starts(&symbols);
        let roots = Roots::new(symbols.clone(), equations);
        let found = starts.into_iter().find_map(|start| self.root(&roots, start))?;
        Some(symbols.into_iter().zip(found).collect())
    }

    /// Points at which an iteration can begin. The wiring is the first: if it is correct, it is the solution.
    fn starts(&self, symbols: &[Symbol]) -> [Vec<f64>; 3] {
        let wired = |symbol: &Symbol| {
            let entry = self.stated.symbols.entry(*symbol);
            self.wired.quantity(&entry.name, usize::from(entry.primes)).filter(|value| value.is_finite())
        };
        let wired = symbols.iter().map(|symbol| wired(symbol).unwrap_or(1.0)).collect();
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
                self.solution.values.get(&symbol).map_or(f64::NAN, |(value, _)| *value)
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
