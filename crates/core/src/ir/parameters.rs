//! The parameters of a program, and the one way to set them.
//!
//! A program keeps every parameter in SI units. [`Program::set_parameters`] takes values in the declared units, checks
//! them against their ranges, calculates the coefficients that follow, and checks these too. Machines, sweeps and fits
//! all set parameters by the functions of this module.

use std::sync::Arc;

use super::{InvalidCoefficient, Program, SettingFault};
use crate::document::{ParameterRangeError, parameter_in_si, suggestion};
use patchcord_expr::Dimension;

/// A parameter of the patch with its present value.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let ramp = ElementBuilder::new("integrator").cords("x1", ["+100"]);
/// let patch = PatchBuilder::new("ramp").parameter("x", 2.5, "mm", [0.0, 10.0]);
/// let patch = patch.element("A1", ramp).build()?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let x = &program.parameters()[0];
/// assert_eq!((x.declared.name.as_str(), x.declared.unit.as_str()), ("x", "mm"));
/// assert!((x.value - 2.5e-3).abs() < 1e-12);
/// assert_eq!(x.in_si(20.0).unwrap_err().to_string(), "x = 20 mm is outside its range 0 ... 10 mm");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParameterValue {
    /// The value for this run, in SI units.
    pub value: f64,
    /// The declaration, which copies of a program share.
    pub declared: Arc<ParameterDeclaration>,
}

/// The declaration of a parameter in the patch, which is independent of its value.
#[derive(Debug, Clone)]
pub struct ParameterDeclaration {
    /// Name of the parameter.
    pub name: String,
    /// Size of the declared unit in SI units.
    pub per_unit: f64,
    /// Least and largest value allowed, in the declared unit.
    pub range: Option<(f64, f64)>,
    /// Text of the declared unit.
    pub unit: String,
    /// Dimension of the declared unit. Formulas of a run are checked with it.
    pub dimension: Dimension,
}

impl ParameterValue {
    /// A value in the declared unit, converted to SI units, if the parameter may have it.
    ///
    /// # Errors
    /// If the value is not finite in SI units, or is outside the range.
    pub fn in_si(&self, value: f64) -> Result<f64, ParameterRangeError> {
        parameter_in_si(
            &self.declared.name,
            value,
            (&self.declared.unit, self.declared.per_unit),
            self.declared.range,
        )
    }
}

/// Why a parameter, or a setting that follows from it, cannot have a value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingError {
    /// No parameter has this name.
    #[error("there is no parameter {name}; {}", hint.as_deref().unwrap_or("the patch has none"))]
    UnknownParameter {
        /// The name that was given.
        name: String,
        /// A similar name or the list of names; `None` if the program has no parameters.
        hint: Option<String>,
    },
    /// A value outside the range of its parameter.
    #[error(transparent)]
    OutsideRange(#[from] ParameterRangeError),
    /// A setting of an element that its element does not take, such as a potentiometer above 1.
    #[error("{setting} is {}, {}", fault.value_text(*value), fault.describe(*value))]
    Unfit {
        /// Element and setting, such as "PC5 setting".
        setting: String,
        /// The value that follows from the parameters.
        value: f64,
        /// The rule that the value breaks.
        fault: SettingFault,
    },
}

impl SettingError {
    /// A stable name for programs that read failures: "unknown-parameter", "outside-range", "not-whole" or
    /// "out-of-order".
    pub fn code(&self) -> &'static str {
        match self {
            SettingError::UnknownParameter { .. } => "unknown-parameter",
            SettingError::OutsideRange(_) => "outside-range",
            SettingError::Unfit { fault, .. } => match fault {
                SettingFault::Range { .. } => "outside-range",
                SettingFault::NotWhole => "not-whole",
                SettingFault::Order { .. } => "out-of-order",
            },
        }
    }
}

impl From<InvalidCoefficient<'_>> for SettingError {
    fn from(unfit: InvalidCoefficient<'_>) -> Self {
        let InvalidCoefficient { coefficient, value, fault } = unfit;
        SettingError::Unfit { setting: coefficient.label.clone(), value, fault }
    }
}

/// Parameters of which some were changed, with everything that follows from them.
#[derive(Debug, Clone)]
pub(crate) struct ChangedParameters {
    /// All parameters in SI units, in the order of the program.
    pub parameters: Vec<f64>,
    /// The coefficients that follow from them.
    pub coefficients: Vec<f64>,
    /// Index of the parameter of every change, in the order of the changes.
    pub changed: Vec<usize>,
}

impl Program {
    /// Index of the parameter with this name in [`Program::parameters`]; `None` if there is none. Every look-up of a
    /// parameter by name uses this method.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let ramp = ElementBuilder::new("integrator").cords("x1", ["+100"]);
    /// let patch = PatchBuilder::new("ramp").parameter("x", 2.5, "mm", [0.0, 10.0]);
    /// let patch = patch.element("A1", ramp).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// assert_eq!((program.parameter("x"), program.parameter("q")), (Some(0), None));
    /// let error = program.parameter_index("q").unwrap_err();
    /// assert_eq!(error.code(), "unknown-parameter");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.declared.name == name)
    }

    /// Index of the parameter with this name, like [`Program::parameter`], with an error that suggests a name.
    ///
    /// # Errors
    /// If no parameter has this name.
    pub fn parameter_index(&self, name: &str) -> Result<usize, SettingError> {
        self.parameter(name).ok_or_else(|| {
            let known: Vec<_> =
                self.parameters.iter().map(|parameter| parameter.declared.name.as_str()).collect();
            SettingError::UnknownParameter { name: name.to_owned(), hint: suggestion(name, &known) }
        })
    }

    /// Parameters in SI units with some changes, given in their declared units. Later changes of one parameter replace
    /// earlier ones. The program itself stays as it is.
    ///
    /// # Errors
    /// If a name is unknown, a value is outside its range, or a setting that follows does not fit.
    pub(crate) fn changed_parameters(
        &self,
        parameters: &[f64],
        changes: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
    ) -> Result<ChangedParameters, SettingError> {
        let (mut parameters, mut changed) = (parameters.to_vec(), Vec::new());
        for (name, value) in changes {
            let index = self.parameter_index(name.as_ref())?;
            parameters[index] = self.parameters[index].in_si(value)?;
            changed.push(index);
        }
        let coefficients = self.prepare(&parameters);
        match self.first_invalid_coefficient(&coefficients) {
            Some(unfit) => Err(unfit.into()),
            None => Ok(ChangedParameters { parameters, coefficients, changed }),
        }
    }

    /// Sets parameters before a run, in their declared units. The program is then the same as if its circuit had been
    /// made with these values.
    ///
    /// # Errors
    /// If a name is unknown, a value is outside its range, or a setting that follows does not fit. The program then
    /// stays as it was.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// let patch = patch.element("A1", decay).element("P1", pot).build()?;
    /// let mut program = Program::new(&Circuit::new(&patch)?)?;
    /// program.set_parameters([("k", 0.25)])?;
    /// assert_eq!(program.parameters()[0].value, 0.25);
    /// let error = program.set_parameters([("k", 2.0)]).unwrap_err();
    /// assert_eq!(error.to_string(), "k = 2 is outside its range 0 ... 1");
    /// assert_eq!(error.code(), "outside-range");
    /// assert_eq!(program.parameters()[0].value, 0.25);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_parameters(
        &mut self,
        changes: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
    ) -> Result<(), SettingError> {
        let before: Vec<f64> = self.parameters.iter().map(|parameter| parameter.value).collect();
        let changed = self.changed_parameters(&before, changes)?;
        for (parameter, value) in self.parameters.iter_mut().zip(changed.parameters) {
            parameter.value = value;
        }
        Ok(())
    }
}
