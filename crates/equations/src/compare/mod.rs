//! Compares the equations that a patch states with those that its wiring solves.
//!
//! Both sides of a stated equation are expressed by the states, drives and parameters of the wiring. If the difference is
//! 0 in normal form, the wiring solves the equation. Otherwise the equation is solved for the highest derivative on its
//! left, and compared with the wiring term by term for the present values of the parameters.

mod conditions;
mod expansions;
pub(crate) mod intended;
mod model;
mod points;
mod terms;
mod wording;

use std::collections::{BTreeSet, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::{Equation, split_primes};

use crate::derive::LawKind;
use crate::notation::{Notation, text};
use crate::symbolic::{Atom, Fraction, Symbol, SymbolKind, partial_derivative};
use crate::writing::Writer;
use intended::fraction;
use model::{Model, Obstacle};
use points::{ParameterValues, Point, equal_at_points};
use terms::{TermDifference, differences};
use wording::clause;

/// A stated equation, compared with the wiring.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedEquation {
    /// Its index among the equations of the patch.
    pub index: usize,
    /// Whether the wiring solves it.
    pub agreement: Agreement,
}

/// Whether the wiring solves a stated equation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Agreement {
    /// The wiring solves it.
    Solved,
    /// The wiring solves it while the inputs of its squaring networks and logarithms are within their range, and its
    /// integrators within their limits. Each condition is a text, such as "u >= 0".
    SolvedIf(Vec<String>),
    /// The wiring solves it for the present values of these parameters, but not for others: a setting is a number, or
    /// lacks a parameter.
    SolvedAt(Vec<String>),
    /// The wiring solves another equation.
    Different {
        /// The differences, each as a clause, such as "the sign of (k/m) x is wrong".
        differences: Vec<String>,
        /// The equation that the wiring solves, for the same quantity.
        wired: String,
    },
    /// The comparison is not possible; the text says why.
    Undecided(String),
}

/// Compares every stated equation of a patch with its wiring, in the order of the patch.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{Agreement, compare_equations};
///
/// let text = r#"{"patchcord": 1, "equations": ["x' = -2 x"],
///   "scales": {"length": {"per_volt": 1, "unit": "1"}},
///   "elements": {"P1": {"kind": "pot", "in": "A1", "setting": 0.2},
///                "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50}},
///   "signals": {"x": {"at": "A1", "scale": "length"}}}"#;
/// let circuit = Circuit::new(&Patch::parse("decay.json", text)?)?;
/// let compared = compare_equations(&circuit, &Program::new(&circuit)?);
/// let Agreement::Different { differences, wired } = &compared[0].agreement else { panic!("0.2 is not 2") };
/// assert_eq!(differences, &["the term -2 x is 10 times too small"]);
/// assert_eq!(wired, "x' = -0.2 x");
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
pub fn compare_equations(circuit: &Circuit, program: &Program) -> Vec<ComparedEquation> {
    if circuit.equations().is_empty() {
        return Vec::new();
    }
    let comparison = |stays_in_range| {
        let model = Model::new(circuit, program, stays_in_range);
        Comparison { circuit, program, coefficients: program.coefficient_values(), model }
    };
    let (mut exact, mut in_range) = (comparison(false), None);
    let mut agreement = |equation: &Equation| {
        let found = exact.agreement(equation)?;
        let limits = exact.limit_conditions();
        match found {
            Agreement::Solved if !limits.is_empty() => Ok(Agreement::SolvedIf(limits)),
            Agreement::Different { .. } if !exact.model.system.margins.is_empty() => {
                let in_range = in_range.get_or_insert_with(|| comparison(true));
                if in_range.agreement(equation)? != Agreement::Solved {
                    return Ok(found);
                }
                Ok(Agreement::SolvedIf([exact.range_conditions(equation), limits].concat()))
            }
            _ => Ok(found),
        }
    };
    let compared = circuit.equations().iter().enumerate().map(|(index, placed)| ComparedEquation {
        index,
        agreement: agreement(&placed.value)
            .unwrap_or_else(|obstacle: Obstacle| Agreement::Undecided(obstacle.text())),
    });
    compared.collect()
}

/// For each signal of a patch, whether it varies: whether it depends on a state, a drive or time.
pub(crate) fn varying_signals(circuit: &Circuit, program: &Program) -> Vec<bool> {
    let mut model = Model::new(circuit, program, false);
    let none = HashSet::new();
    let varies = |name: &String| {
        let value = model.quantity(name, 0, &none);
        value.is_ok_and(|value| !value.is_constant())
    };
    circuit.patch().signals.keys().map(varies).collect()
}

/// A comparison in progress.
struct Comparison<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    /// Values of the coefficients of the program.
    coefficients: Vec<f64>,
    model: Model<'a>,
}

impl Comparison<'_> {
    /// Whether the wiring solves an equation. It may name drives or write out their laws of time.
    fn agreement(&mut self, equation: &Equation) -> Result<Agreement, Obstacle> {
        self.model.limited.clear();
        let found = self.agreement_with_drives(equation);
        if matches!(found, Ok(Agreement::Solved | Agreement::SolvedAt(_)))
            || self.circuit.patch().drives.is_empty()
        {
            return found;
        }
        self.model.expands_drives = true;
        let expanded = self.agreement_with_drives(equation);
        self.model.expands_drives = false;
        // A drive that is 0 at present would hide a cord that is missing, so equality for the present parameters is not
        // enough here.
        match (&found, &expanded) {
            (_, Ok(Agreement::Solved)) | (Ok(Agreement::Undecided(_)) | Err(_), Ok(_)) => expanded,
            _ => found,
        }
    }

    /// Whether the wiring solves an equation, with drives as the model takes them.
    fn agreement_with_drives(&mut self, equation: &Equation) -> Result<Agreement, Obstacle> {
        if let Some(initial) = equation.initial_quantity() {
            return self.initial_agreement(equation, initial);
        }
        let none = HashSet::new();
        let [left, right] = [equation.left(), equation.right()]
            .map(|side| fraction(side, &mut |name| self.model.named(name, &none)));
        let (left, right) = (left?, right?);
        let residual = left.minus(&right);
        if residual.is_zero() || self.is_implicit_law(&residual) {
            return Ok(Agreement::Solved);
        }
        let Some((name, stated)) = self.solved(equation)? else {
            if let Some(name) = self.implicit_quantity(&residual) {
                return Err(Obstacle::Implicit(name));
            }
            return Ok(match self.are_equal(ParameterValues::Present, [&left, &right]) {
                Some(true) => self.solved_generally([&left, &right]),
                Some(false) => self.unequal(&left, &right),
                None => Agreement::Undecided("it has no value at most voltages".to_owned()),
            });
        };
        let kept = self.kept(equation, &name);
        let (stated, wired) = (self.model.expanded_fraction(&stated, &kept), self.model.named(&name, &kept)?);
        let found = self.differences(ParameterValues::Present, [&stated, &wired]);
        if found.is_empty() {
            return Ok(self.solved_generally([&stated, &wired]));
        }
        // Signals in the equation are wired correctly or not; a difference that remains without them is in this one.
        let none = HashSet::new();
        let full_stated = self.model.expanded_fraction(&stated, &none);
        let full_wired = self.model.named(&name, &none)?;
        let sides = [&full_stated, &full_wired];
        if self.differences(ParameterValues::Present, sides).is_empty()
            || self.are_equal(ParameterValues::Present, sides) == Some(true)
        {
            return Ok(self.solved_generally(sides));
        }
        Ok(self.different(&name, &found, &wired))
    }

    /// Whether an expression is 0 because a loop of the wiring makes it 0: it is a constant times the residual of the
    /// loop.
    fn is_implicit_law(&mut self, residual: &Fraction) -> bool {
        let implicit = self.model.system.laws.iter().filter_map(|law| match &law.kind {
            LawKind::Implicit(value) => Some(value.clone()),
            _ => None,
        });
        let implicit: Vec<Fraction> = implicit.collect();
        let none = HashSet::new();
        implicit.iter().any(|law| {
            let ratio = residual.over(&self.model.expanded_fraction(law, &none));
            ratio.is_constant()
        })
    }

    /// The name of a quantity in an expression that a loop without a formula determines.
    fn implicit_quantity(&self, value: &Fraction) -> Option<String> {
        let system = &self.model.system;
        let mut found = None;
        value.contains(&mut |symbol| {
            let is_implicit = matches!(system.law(symbol), Some(LawKind::Implicit(_)));
            if is_implicit {
                found = Some(system.symbols.entry(symbol).name.clone());
            }
            is_implicit
        });
        found
    }

    /// Whether a quantity has its stated initial value.
    fn initial_agreement(&mut self, equation: &Equation, name: &str) -> Result<Agreement, Obstacle> {
        let (base, primes) = split_primes(name);
        let none = HashSet::new();
        let stated = fraction(equation.right(), &mut |name| self.model.named(name, &none))?;
        let wired = self.model.initial(base, primes)?;
        if self.differences(ParameterValues::Present, [&stated, &wired]).is_empty() {
            return Ok(self.solved_generally([&stated, &wired]));
        }
        let dimension = self.circuit.equation_dimension(name);
        let writer = Writer::new(self.circuit, &self.model.system);
        let [stated, wired] = [stated, wired].map(|value| text(&writer.expression(&value, dimension)));
        let differences = vec![format!("{name} is {wired} at t = 0, and should be {stated}")];
        Ok(Agreement::Different { differences, wired: format!("{name}(0) = {wired}") })
    }

    /// The name for which an equation is solved, and its value in the names of the equation. It is the name with the
    /// most primes on the left. `None` if the equation is not linear in it.
    fn solved(&mut self, equation: &Equation) -> Result<Option<(String, Fraction)>, Obstacle> {
        let mut names = equation.names();
        names.retain(|name| self.is_variable(name));
        names.sort_by_key(|name| std::cmp::Reverse(split_primes(name).1));
        let Some(name) = names.first().map(|name| (*name).to_owned()) else { return Ok(None) };
        let dimension = patchcord_expr::Dimension::NONE;
        let unknown = self.model.system.symbols.variable(&name, 0, dimension);
        let kept = self.kept(equation, &name);
        let [left, right] = [equation.left(), equation.right()].map(|side| {
            fraction(side, &mut |other| {
                if other == name { Ok(Fraction::symbol(unknown)) } else { self.model.named(other, &kept) }
            })
        });
        let difference = left?.minus(&right?);
        let slope = partial_derivative(&difference, unknown);
        if slope.is_zero() || slope.contains(&mut |symbol| symbol == unknown) {
            return Ok(None);
        }
        let value = Fraction::symbol(unknown).minus(&difference.over(&slope));
        Ok((!value.contains(&mut |symbol| symbol == unknown)).then_some((name, value)))
    }

    /// Whether a name of an equation is a quantity that varies.
    fn is_variable(&self, name: &str) -> bool {
        let base = split_primes(name).0;
        let patch = self.circuit.patch();
        patch.signals.contains_key(base)
            || (self.model.expands_drives && patch.drives.contains_key(base))
            || self.circuit.auxiliary_quantities().any(|auxiliary| auxiliary == base)
    }

    /// The signals of an equation that follow from others: they stay in the comparison under their names, except the
    /// one for which the equation is solved.
    fn kept(&self, equation: &Equation, solved: &str) -> HashSet<Symbol> {
        let solved = split_primes(solved).0;
        let names = equation.names().into_iter().filter(|name| *name != solved && split_primes(name).1 == 0);
        let found = names.filter_map(|name| self.model.symbol(name, 0));
        found.filter(|symbol| self.is_expression(*symbol)).collect()
    }

    /// Whether a signal follows from others, and is not only another name for one of them.
    fn is_expression(&self, signal: Symbol) -> bool {
        let Some(LawKind::Definition(value)) = self.model.system.law(signal) else { return false };
        let is_constant = |atom: &Atom| matches!(atom, Atom::Symbol(symbol) if symbol.is_constant);
        let factors =
            value.numerator().as_term().map(|(product, _)| product.only(|atom, _| !is_constant(atom)));
        !factors.is_some_and(|product| matches!(product.factors(), [(Atom::Symbol(_), 1)]))
    }

    /// The terms in which a stated and a wired expression differ.
    fn differences(
        &self,
        parameters: ParameterValues,
        [stated, wired]: [&Fraction; 2],
    ) -> Vec<TermDifference> {
        differences(stated, wired, &self.point(parameters))
    }

    /// Whether two expressions are equal at points; see [`equal_at_points`].
    fn are_equal(&self, parameters: ParameterValues, sides: [&Fraction; 2]) -> Option<bool> {
        equal_at_points(self.point(parameters), sides)
    }

    /// A point with these values of the parameters.
    fn point(&self, parameters: ParameterValues) -> Point<'_> {
        let (system, program, coefficients) = (&self.model.system, self.program, &self.coefficients);
        Point { system, program, coefficients, parameters, index: 0 }
    }

    /// The agreement of two sides that are equal for the present values of the parameters: also for others, or not.
    fn solved_generally(&self, sides: [&Fraction; 2]) -> Agreement {
        if self.differences(ParameterValues::Other, sides).is_empty()
            || self.are_equal(ParameterValues::Other, sides) == Some(true)
        {
            return Agreement::Solved;
        }
        let mut names = BTreeSet::new();
        for side in sides {
            side.contains(&mut |symbol| {
                let entry = self.model.system.symbols.entry(symbol);
                if matches!(entry.kind, SymbolKind::Parameter(_)) {
                    names.insert(entry.name.clone());
                }
                false
            });
        }
        Agreement::SolvedAt(names.into_iter().collect())
    }

    /// The agreement of an equation that is not solved for a quantity and has unequal sides.
    fn unequal(&self, left: &Fraction, right: &Fraction) -> Agreement {
        let writer = Writer::new(self.circuit, &self.model.system);
        let [left, right] = [left, right].map(|side| text(&writer.expression(side, writer.dimension(side))));
        let differences =
            vec![format!("in the wiring, the left side is {left} and the right side is {right}")];
        Agreement::Different { differences, wired: format!("{left} = {right} at some instants only") }
    }

    /// The agreement for a quantity whose terms differ.
    fn different(&self, name: &str, found: &[TermDifference], wired: &Fraction) -> Agreement {
        let dimension = self.circuit.equation_dimension(name);
        let writer = Writer::new(self.circuit, &self.model.system);
        let write = |value: &Fraction| text(&writer.expression(value, dimension));
        let time_scale = self.circuit.time_scale();
        let clauses = found.iter().map(|difference| clause(difference, time_scale, &write));
        let (base, primes) = split_primes(name);
        let left = Notation::Name { name: base.to_owned(), primes: u8::try_from(primes).unwrap_or(u8::MAX) };
        Agreement::Different {
            differences: clauses.collect(),
            wired: format!("{} = {}", text(&left), write(wired)),
        }
    }
}

#[cfg(test)]
mod tests;
