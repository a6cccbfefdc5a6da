//! The stated equations as expressions of the quantities that they name, independent of the wiring.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::{Dimension, Equation, Expression, Node, split_primes};

use crate::compare::{Obstacle, intended::fraction};
use crate::derive::is_nonnegative;
use crate::notation::primed;
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols, derivative};

/// The stated equations of a circuit.
pub(crate) struct Stated<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    /// All quantities. Those that vary are [`SymbolKind::Variable`].
    pub symbols: Symbols,
    /// The equations between quantities, each as an expression that is 0, with its index among those of the patch.
    /// Equations that apply a table are left out.
    pub residuals: Vec<(usize, Fraction)>,
    /// The stated initial values, each after the index of its equation among those of the patch.
    pub initial: Vec<(usize, Symbol, Fraction)>,
}

impl<'a> Stated<'a> {
    /// Reads the equations of a circuit.
    pub(crate) fn new(circuit: &'a Circuit, program: &'a Program) -> Self {
        let (symbols, residuals, initial) = (Symbols::default(), Vec::new(), Vec::new());
        let mut stated = Stated { circuit, program, symbols, residuals, initial };
        for (index, placed) in circuit.equations().iter().enumerate() {
            let equation = &placed.value;
            if let Some(quantity) = equation.initial_quantity() {
                let value = stated.fraction(equation.right());
                let (base, order) = split_primes(quantity);
                let symbol = stated.symbol(base, order);
                stated.initial.extend(value.map(|value| (index, symbol, value)));
            } else if let Some(residual) = stated.residual(equation) {
                stated.residuals.push((index, residual));
            }
        }
        stated
    }

    /// The left side of an equation minus the right one. `None` if the equation applies a table.
    fn residual(&mut self, equation: &Equation) -> Option<Fraction> {
        let left = self.fraction(equation.left())?;
        Some(left.minus(&self.fraction(equation.right())?))
    }

    /// An expression of an equation. `None` if it applies a table.
    pub(crate) fn fraction(&mut self, node: &Node) -> Option<Fraction> {
        fraction(node, &mut |name| self.named(name)).ok()
    }

    /// A name of an equation, such as x'', k or t.
    fn named(&mut self, name: &str) -> Result<Fraction, Obstacle> {
        let (base, order) = split_primes(name);
        let symbol = match (name, self.program.parameter(name)) {
            ("pi", _) => self.constant(name, SymbolKind::Pi, Dimension::NONE, true),
            ("t", _) => self.constant(name, SymbolKind::Time, Dimension::TIME, true),
            _ if self.is_variable(base) => self.symbol(base, order),
            (_, Some(index)) => {
                let parameter = &self.program.parameters()[index];
                let (dimension, is_nonnegative) = (parameter.declared.dimension, is_nonnegative(parameter));
                self.constant(name, SymbolKind::Parameter(index), dimension, is_nonnegative)
            }
            _ => return Err(Obstacle::Unknown(name.to_owned())),
        };
        Ok(Fraction::symbol(symbol))
    }

    /// Whether a name without primes is that of a quantity that varies.
    pub(crate) fn is_variable(&self, base: &str) -> bool {
        let patch = self.circuit.patch();
        patch.signals.contains_key(base)
            || patch.drives.contains_key(base)
            || self.circuit.auxiliary_quantities().any(|auxiliary| auxiliary == base)
    }

    /// The symbol of a quantity that does not depend on the wiring.
    fn constant(
        &mut self,
        name: &str,
        kind: SymbolKind,
        dimension: Dimension,
        is_nonnegative: bool,
    ) -> Symbol {
        let entry = SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension };
        match self.symbols.find(name, 0) {
            Some(known) => known,
            None => self.symbols.add(entry, is_nonnegative),
        }
    }

    /// The symbol of a quantity with this number of derivatives.
    pub(crate) fn symbol(&mut self, base: &str, order: usize) -> Symbol {
        let primes = u8::try_from(order).unwrap_or(u8::MAX);
        match self.symbols.find(base, primes) {
            Some(known) => known,
            None => {
                let dimension = self.circuit.equation_dimension(&primed(base, order));
                self.symbols.variable(base, primes, dimension.unwrap_or(Dimension::NONE))
            }
        }
    }

    /// The derivative of an expression with respect to time. Derivatives of its quantities become quantities.
    pub(crate) fn differentiated(&mut self, value: &Fraction) -> Fraction {
        let symbols = &mut self.symbols;
        derivative(value, &mut |symbol| {
            let kind = symbols.entry(symbol).kind;
            match kind {
                SymbolKind::Time => Fraction::whole(1),
                SymbolKind::Variable => Fraction::symbol(symbols.derivative(symbol)),
                SymbolKind::Pi | SymbolKind::Parameter(_) | SymbolKind::Held => Fraction::zero(),
            }
        })
    }

    /// Whether a symbol is a quantity that varies.
    pub(crate) fn varies(&self, symbol: Symbol) -> bool {
        self.symbols.entry(symbol).kind == SymbolKind::Variable
    }
}

/// A name that an equation gives to a derivative, as `v = x'` does.
pub(crate) struct Alias<'a> {
    /// The name, such as v.
    pub name: &'a str,
    /// The quantity that is differentiated, such as x.
    pub of: &'a str,
    /// Number of derivatives, at least 1.
    pub order: usize,
    /// Index of the equation among those of the patch.
    pub index: usize,
}

/// The names that the equations of a circuit give to derivatives.
pub(crate) fn aliases(circuit: &Circuit) -> Vec<Alias<'_>> {
    let found = circuit.equations().iter().enumerate().filter_map(|(index, placed)| {
        let [left, right] = sides(&placed.value)?;
        match (split_primes(left), split_primes(right)) {
            ((name, 0), (of, order)) | ((of, order), (name, 0)) if order > 0 => {
                Some(Alias { name, of, order, index })
            }
            _ => None,
        }
    });
    found.collect()
}

/// Both sides of an equation, if each is a single name.
fn sides(equation: &Equation) -> Option<[&str; 2]> {
    match (&equation.left().expression, &equation.right().expression) {
        (Expression::Name(left), Expression::Name(right)) if equation.initial_quantity().is_none() => {
            Some([left.as_str(), right.as_str()])
        }
        _ => None,
    }
}
