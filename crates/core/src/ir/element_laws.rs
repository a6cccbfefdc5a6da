//! The laws of the elements of a circuit, without the cords between them.
//!
//! A program has one wiring. To evaluate many wirings of the same elements, a caller needs the law of each element as a
//! function of the voltages at its own inputs. The amplifiers have no limits here.

use std::ops::Range;

use super::op::Sources;
use super::{Mode, Op, ParameterValue, Program, ProgramPoint, Register, SignalInfo, State};

/// The laws of all elements of a circuit, each as operations on the voltages at its own inputs.
///
/// All laws share one list of registers. The caller writes the voltages at the inputs of an element and evaluates the
/// operations of the element, which read no other element.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::ElementLaws;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let summer = ElementBuilder::new("summer").cords("x10", ["+100"]);
/// let circuit = Circuit::new(&PatchBuilder::new("sum").element("A1", summer).build()?)?;
/// let laws = ElementLaws::new(&circuit);
/// let coefficients = laws.coefficients(&[]);
/// let point = laws.initial_point(&coefficients);
/// // The summer is the element after the three references. Its only input gets 2 V in place of the cord.
/// let law = &laws.elements()[3];
/// let mut registers = laws.registers();
/// registers[law.inputs[0][0].index()] = 2.0;
/// laws.evaluate(law.output_operations.clone(), &point, &coefficients, &mut registers);
/// assert_eq!(registers[law.output.index()], -2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElementLaws {
    /// The operations and everything that they refer to. They are in no order of evaluation, so they are no program
    /// that can run.
    pub(crate) parts: Program,
    /// The laws, in the order of the circuit.
    pub(crate) elements: Vec<ElementLaw>,
}

/// The law of one element.
#[derive(Debug, Clone)]
pub struct ElementLaw {
    /// For each input of the kind, the registers of its voltages: one for each cord. Summing inputs have one register
    /// for the sum of all cords, each times its gain. An input without a cord has none.
    pub inputs: Vec<Vec<Register>>,
    /// The register of the output, without the limit of an amplifier.
    pub output: Register,
    /// The operations that compute the output. They read direct inputs only.
    pub output_operations: Range<usize>,
    /// The operations that compute the rate, the conditions of the modes and the stored value.
    pub memory_operations: Range<usize>,
}

impl ElementLaws {
    /// The laws of the references, drives and elements, in the order of the circuit.
    pub fn elements(&self) -> &[ElementLaw] {
        &self.elements
    }

    /// The operations; the index is the register of the result.
    pub fn operations(&self) -> &[Op] {
        &self.parts.lowered.body
    }

    /// The same laws with each operation replaced by `change(register, operation)`. A new operation may read only
    /// registers that the old one reads.
    #[must_use]
    pub fn with_operations(mut self, change: impl Fn(Register, Op) -> Op) -> ElementLaws {
        for (at, op) in self.parts.lowered_mut().body.iter_mut().enumerate() {
            *op = change(Register(at as u32), *op);
        }
        self
    }

    /// The states; the index is the one in [`Op::State`].
    pub fn states(&self) -> &[State] {
        &self.parts.lowered.states
    }

    /// The modes; the index is the one in [`Op::Mode`].
    pub fn modes(&self) -> &[Mode] {
        &self.parts.lowered.modes
    }

    /// The signals. Their registers are outputs of elements.
    pub fn signals(&self) -> &[SignalInfo] {
        &self.parts.lowered.signals
    }

    /// The parameters with their present values.
    pub fn parameters(&self) -> &[ParameterValue] {
        &self.parts.parameters
    }

    /// The coefficients for these values of the parameters in SI, which need not be in their ranges.
    ///
    /// # Panics
    /// If there are fewer values than parameters.
    pub fn coefficients(&self, parameters: &[f64]) -> Vec<f64> {
        self.parts.prepare(parameters)
    }

    /// The point with every state, mode and stored value as in initial condition, for these coefficients.
    pub fn initial_point(&self, coefficients: &[f64]) -> ProgramPoint {
        self.parts.initial_point_with(coefficients)
    }

    /// The registers before an evaluation: fixed numbers have their values, and all others are NaN.
    pub fn registers(&self) -> Vec<f64> {
        let value = |op: &Op| if let Op::Constant(value) = op { *value } else { f64::NAN };
        self.operations().iter().map(value).collect()
    }

    /// Evaluates the operations of one element. The registers of its inputs must have their voltages.
    ///
    /// # Panics
    /// If the range is not one of an [`ElementLaw`], or if a list of the point is too short.
    pub fn evaluate(
        &self,
        operations: Range<usize>,
        point: &ProgramPoint,
        coefficients: &[f64],
        registers: &mut [f64],
    ) {
        let from = Sources {
            parameters: &[],
            coefficients,
            states: &point.states,
            modes: &point.modes,
            time: point.time,
            tables: &self.parts.tables,
            delayed: &point.delayed,
            sampled: &point.sampled,
            levels: &point.levels,
        };
        for at in operations {
            registers[at] = self.operations()[at].apply(&from, |register| registers[register.index()]);
        }
    }
}
