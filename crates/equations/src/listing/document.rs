//! The JSON document of a listing.

use serde::Serialize;

use super::{EquationListing, ModeDescription, TableDescription};
use crate::notation::{EquationDocument, WrittenEquation, latex, text};

/// The JSON document of a listing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListingDocument {
    /// The equations of states and signals.
    pub equations: Vec<EquationDocument>,
    /// The values at t = 0.
    pub initial: Vec<InitialDocument>,
    /// The drives as functions of time.
    pub drives: Vec<EquationDocument>,
    /// The modes.
    pub modes: Vec<ModeDescription>,
    /// The tables.
    pub tables: Vec<TableDescription>,
    /// What is not an equation.
    pub remarks: Vec<String>,
}

/// An initial value in a JSON document.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct InitialDocument {
    /// The quantity, such as "x'".
    pub quantity: String,
    /// Its value at t = 0, as an expression.
    pub value: String,
    /// "quantity = value" in LaTeX.
    pub latex: String,
}

impl EquationListing {
    /// The equations as a document for programs.
    pub fn document(&self) -> ListingDocument {
        let documents =
            |equations: &[WrittenEquation]| equations.iter().map(EquationDocument::from).collect();
        let initial = self.initial.iter().map(|entry| InitialDocument {
            quantity: text(&entry.quantity),
            value: text(&entry.value),
            latex: format!("{} = {}", latex(&entry.quantity), latex(&entry.value)),
        });
        ListingDocument {
            equations: documents(&self.equations),
            initial: initial.collect(),
            drives: documents(&self.drives),
            modes: self.modes.clone(),
            tables: self.tables.clone(),
            remarks: self.remarks.iter().map(|remark| remark.text.clone()).collect(),
        }
    }
}
