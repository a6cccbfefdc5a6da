//! Equations and wiring of patchcord.
//!
//! [`EquationListing`] derives the equations that the wiring of a patch solves, with exact numbers, in the signals,
//! parameters and units of the patch. [`Notation`] is an expression as it is written, and [`text`] and [`latex`] write
//! it.
//!
//! # Examples
//!
//! ```
//! use patchcord_core::circuit::Circuit;
//! use patchcord_core::ir::Program;
//! use patchcord_core::patch::Patch;
//! use patchcord_equations::{Detail, EquationListing};
//!
//! let patch = Patch::read("../../patches/lessons/lorenz.json")?;
//! let circuit = Circuit::new(&patch)?;
//! let listing = EquationListing::new(&circuit, &Program::new(&circuit)?, Detail::Signals);
//! let equations: Vec<String> = listing.equations.iter().map(|equation| equation.text()).collect();
//! assert_eq!(equations, ["x' = sigma (y - x)", "y' = rho x - y - x z", "z' = x y - beta z"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod compare;
mod derive;
mod findings;
mod fixes;
mod graph;
mod listing;
mod notation;
mod operating_point;
mod peaks;
mod plan;
mod positions;
mod rescale;
mod scaled;
mod scaling_audit;
mod static_check;
mod symbolic;
mod synthesis;
#[cfg(test)]
mod testing;
mod writing;

pub use compare::{Agreement, ComparedEquation, compare_equations};
pub use findings::{codes, equation_findings, equation_fixes, findings_with_fixes};
pub use fixes::{Fix, find_fixes};
pub use listing::{
    Detail, EquationListing, InitialDocument, InitialValue, ListingDocument, ModeChange, ModeDescription,
    Remark, TableDescription,
};
pub use notation::{
    Comparison, Condition, EquationDocument, LINE_WIDTH, Notation, Relation, WrittenEquation, document,
    equation_latex, equation_text, latex, text,
};
pub use rescale::{
    ChangedSetting, RescaleError, RescaleOptions, RescaledOutput, RescaledPatch, RescaledScale, rescale_patch,
};
pub use scaled::{
    NarrowedRange, OutputPeak, ScaleError, ScaleOptions, ScaledDrive, ScaledProblem, ScaledQuantity,
    scale_problem,
};
pub use scaling_audit::{AuditedGain, GainDecision, audit_scaling};
pub use static_check::{
    RowQuantity, RowSource, StaticCheck, StaticRow, TestError, TestValue, TestValues, static_check, test_unit,
};
