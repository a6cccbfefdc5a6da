//! The names that the equations of a patch can use, with their dimensions.

use super::Auxiliaries;
use crate::document::TIME_SCALE;
use crate::patch::{Patch, Scale};
use patchcord_expr::{Dimension, Scope, split_initial, split_primes};

/// Name of the time in equations, in problem seconds.
pub(super) const TIME: &str = "t";

/// The names that the equations of a patch can use: signals, drives, auxiliary quantities, parameters and the time.
///
/// A name may have primes if it is that of a signal, a drive or an auxiliary quantity. Signals have initial values, such
/// as `x'(0)`. The scope has dimensions but no values.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_expr::{Dimension, Scope};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // All quantities are pure numbers, and so is the time.
/// let patch = PatchBuilder::new("decay")
///     .scale("number", 0.1, "1")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
///     .signal("x", "A1", "number", 1.0)
///     .equation("x' = -x")
///     .build()?;
/// let circuit = Circuit::new(&patch)?;
/// let scope = circuit.equation_scope();
/// assert_eq!(scope.names(), ["x", "t"]);
/// assert_eq!(scope.dimension("x''"), Some(Dimension::NONE));
/// assert_eq!(scope.dimension("x(0)"), Some(Dimension::NONE));
/// assert_eq!(scope.dimension("t(0)"), None);
/// assert!(circuit.is_time_dimensionless());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy)]
pub struct EquationScope<'a> {
    /// The patch, for its signals, drives, parameters and scales.
    patch: &'a Patch,
    /// The auxiliary quantities.
    auxiliaries: &'a Auxiliaries,
    /// Whether times count as pure numbers.
    is_time_dimensionless: bool,
}

impl<'a> EquationScope<'a> {
    /// The scope of a patch with these auxiliary quantities.
    pub(in crate::circuit) fn new(
        patch: &'a Patch,
        auxiliaries: &'a Auxiliaries,
        is_time_dimensionless: bool,
    ) -> Self {
        EquationScope { patch, auxiliaries, is_time_dimensionless }
    }

    /// Whether the name is that of a quantity that can have primes.
    pub(super) fn is_variable(&self, name: &str) -> bool {
        let patch = self.patch;
        patch.signals.contains_key(name)
            || patch.drives.contains_key(name)
            || self.auxiliaries.contains_key(name)
    }

    /// The dimension of a signal, a drive or an auxiliary quantity. A signal without a scale is in volts.
    ///
    /// `None` if the name is another one, or if its dimension is not known because of a fault.
    fn variable_dimension(&self, name: &str) -> Option<Dimension> {
        if let Some(signal) = self.patch.signals.get(name)
            && signal.scale.is_none()
        {
            return Some(Dimension::VOLTAGE);
        }
        match self.scale(name) {
            Some(scale) => Some(scale.unit.dimension()),
            None => *self.auxiliaries.get(name)?,
        }
    }

    /// The scale of a signal or a drive. `None` if it has none or the name is another one.
    fn scale(&self, name: &str) -> Option<&'a Scale> {
        let patch = self.patch;
        let of_signal = patch.signals.get(name).and_then(|signal| signal.scale.as_ref());
        let of_drive = || patch.drives.get(name).and_then(|drive| drive.scale.as_ref());
        patch.scales.get(&of_signal.or_else(of_drive)?.value)
    }
}

impl Scope for EquationScope<'_> {
    fn value(&self, _name: &str) -> Option<f64> {
        None
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let (base, order) = split_primes(name);
        if split_initial(name).is_some() && !self.patch.signals.contains_key(base) {
            return None;
        }
        if self.is_variable(base) {
            return Some(self.variable_dimension(base)?.over(self.time().power(order as f64)));
        }
        match base {
            _ if order > 0 => None,
            TIME => Some(self.time()),
            _ => Some(self.patch.parameters.get(base)?.unit.dimension()),
        }
    }

    /// The declared unit of a parameter, or the unit of the scale of a signal or a drive. A derivative has none, and an
    /// initial value has that of its signal.
    fn declared_unit(&self, name: &str) -> Option<&str> {
        let name = split_initial(name).unwrap_or(name);
        let unit = match self.scale(name) {
            Some(scale) => &scale.unit,
            None => &self.patch.parameters.get(name)?.unit,
        };
        Some(unit.text())
    }

    /// The dimensions of a table of a problem. A patch has no such tables.
    fn table(&self, name: &str) -> Option<(Dimension, Dimension)> {
        self.patch.problem_tables.as_ref()?.get(name).copied()
    }

    fn has_scales(&self) -> bool {
        false
    }

    fn time(&self) -> Dimension {
        if self.is_time_dimensionless { Dimension::NONE } else { Dimension::TIME }
    }

    /// The names that can be written in an equation. Names of signals and drives can have other characters.
    fn names(&self) -> Vec<&str> {
        let patch = self.patch;
        let variables = patch.signals.keys().chain(patch.drives.keys());
        let variables = variables.filter(|name| can_be_written(name));
        let quantities = variables.chain(self.auxiliaries.keys()).chain(patch.parameters.keys());
        quantities.map(String::as_str).chain([TIME]).collect()
    }
}

/// The parameters of a patch, as the names that an initial value can use. The scope is for hints only, so it has neither
/// values nor dimensions.
#[derive(Debug, Clone, Copy)]
pub(super) struct ParameterNames<'a>(pub &'a Patch);

impl Scope for ParameterNames<'_> {
    fn value(&self, _name: &str) -> Option<f64> {
        None
    }

    fn dimension(&self, _name: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        self.0.parameters.keys().map(String::as_str).collect()
    }
}

/// Whether a name consists of the letters, digits and `_` that names in equations have.
fn can_be_written(name: &str) -> bool {
    name.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'_')
}

/// Whether the patch has a part with this name, or the name has a fixed meaning. Such a name cannot become an auxiliary
/// quantity.
pub(super) fn is_taken(patch: &Patch, name: &str) -> bool {
    name == TIME
        || patch.signals.contains_key(name)
        || patch.drives.contains_key(name)
        || patch.parameters.contains_key(name)
        || is_element(patch, name)
        || is_scale(patch, name)
}

/// Whether the name is that of an element, of an instance of a macro, or of an output of an instance.
pub(super) fn is_element(patch: &Patch, name: &str) -> bool {
    patch.elements.contains_key(name)
        || patch.instances.contains_key(name)
        || patch.instance_outputs.contains_key(name)
}

/// Whether the name is that of a scale or of the time scale.
pub(super) fn is_scale(patch: &Patch, name: &str) -> bool {
    name == TIME_SCALE || patch.scales.contains_key(name)
}
