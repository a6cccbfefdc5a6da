//! The parts of a circuit: elements, cords, steps of evaluation and recordable outputs.

use crate::document::{Placed, Span};
use crate::elements::Kind;
use crate::patch::Amount;

/// An element, a drive or a reference.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name, which cords use.
    pub name: String,
    /// Kind, from the table of elements.
    pub kind: &'static Kind,
    /// Settings, in the order of the kind's settings. `None` if the patch does not give the setting.
    pub settings: Vec<Option<Placed<Amount>>>,
    /// Index of the scale of a drive. `None` for elements and references.
    pub scale: Option<usize>,
    /// Position of the name in the document. `None` for references.
    pub span: Option<Span>,
}

/// A cord into an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cord {
    /// Index of the input among the kind's inputs.
    pub input: usize,
    /// Gain of the jack, such as 10 for "x10". It is 1 if the jack has no gain.
    pub gain: f64,
}

/// A step of the computation of all voltages at one instant.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::EvaluationStep;
///
/// let step = EvaluationStep::Loop { openers: vec![3], members: vec![4, 5, 3] };
/// assert_eq!(step.members(), [4, 5, 3]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum EvaluationStep {
    /// Computes the output of an element whose direct inputs are known.
    Element(usize),
    /// Solves a loop without an integrator.
    Loop {
        /// The elements that open the loop. Their outputs are the unknowns.
        openers: Vec<usize>,
        /// All elements of the loop, in an order in which each comes after the elements that drive it and do not open
        /// the loop.
        members: Vec<usize>,
    },
}

impl EvaluationStep {
    /// The elements of the step in order of evaluation.
    pub fn members(&self) -> &[usize] {
        match self {
            EvaluationStep::Element(element) => std::slice::from_ref(element),
            EvaluationStep::Loop { members, .. } => members,
        }
    }
}

/// An output that can be recorded, with the quantity that it represents.
///
/// The value of the signal is: voltage x value of the scale per volt x factor.
#[derive(Debug, Clone)]
pub struct SignalPoint {
    /// Name of the signal.
    pub name: String,
    /// Index of the element with the output.
    pub element: usize,
    /// Index of the scale. `None` if the signal is in volts.
    pub scale: Option<usize>,
    /// Factor for the scaled voltage, such as -1 behind an inverting summer.
    pub factor: f64,
}
