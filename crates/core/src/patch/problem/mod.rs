//! The problem: equations with parameters, quantities and drives, from which `patchcord scale` makes a patch.
//!
//! `decode` fills a [`Problem`] from its JSON tree, with the decoders of patches for parameters, drives, equations and
//! the run. `entries` decodes quantities and tables. `names` reports names that cannot be used. `check` compares the
//! parts with each other, and `initial` checks and evaluates initial values.
//!
//! A problem contains a patch without elements. Each quantity is a scale and a signal at ground
//! there. So the checks of circuits apply to the names and dimensions of a problem.

mod check;
mod decode;
mod entries;
mod initial;
mod key_synonyms;
mod names;

use std::path::Path;

use indexmap::IndexMap;

use super::{Patch, TableAccess, table_file};
use crate::document::file::{DocumentError, MAX_DOCUMENT_BYTES, document_too_large, read_text};
use crate::document::{Diagnostic, DocumentKind, Placed, Report, Span, tree};
use patchcord_expr::{Equation, Formula, Unit};

/// A problem: the equations of a system, with everything that is needed to make a patch that solves them.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::Problem;
///
/// let text = r#"{
///     "patchcord": 1,
///     "parameters": {"T": {"value": 2, "unit": "s"}},
///     "quantities": {"x": {"unit": "mm", "initial": 50, "maximum": 100}},
///     "equations": ["T x' = -x"],
///     "run": {"for": 10, "step": 0.01}
/// }"#;
/// let problem = Problem::parse("decay.json", text)?;
/// assert_eq!(problem.quantities["x"].unit.text(), "mm");
/// // The circuit reports all faults of the problem.
/// let circuit = Circuit::new(&problem.patch)?;
/// assert_eq!(circuit.equations()[0].value.names(), ["T", "x'", "x"]);
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Problem {
    /// A patch without elements: the texts, parameters, drives, equations and run of the problem. It has a scale of one
    /// unit per volt for each quantity without primes and for each drive. Each of these quantities is a signal at ground.
    ///
    /// The patch also has the faults of the problem, which [`Circuit::new`](crate::circuit::Circuit::new) reports.
    pub patch: Patch,
    /// The quantities by name. A name with primes is that of a derivative.
    pub quantities: IndexMap<String, ProblemQuantity>,
    /// The tables by name. Equations apply them as functions.
    pub tables: IndexMap<String, ProblemTable>,
}

/// A quantity of a problem, or the derivative of one.
#[derive(Debug, Clone)]
pub struct ProblemQuantity {
    /// The unit of the quantity, and of the numbers below.
    pub unit: Unit,
    /// The initial value: a number in `unit`, or a formula of parameters. `None` if the problem does not state it.
    pub initial: Option<Placed<Formula>>,
    /// The largest magnitude that is expected, in `unit`, above 0. `None` if it is not known.
    pub maximum: Option<Placed<f64>>,
    /// The prescribed value of one volt, in `unit`, above 0. `None` if the scale is to be chosen.
    pub per_volt: Option<Placed<f64>>,
    /// Description for the reader; empty if the document has none.
    pub description: String,
    /// Position of its name in the document.
    pub span: Span,
    /// Position of its unit in the document.
    unit_span: Span,
}

/// A function of one variable that is given by points.
#[derive(Debug, Clone)]
pub struct ProblemTable {
    /// The unit of the argument.
    pub input_unit: Unit,
    /// The unit of the value.
    pub output_unit: Unit,
    /// The points [argument, value] in these units, at least two. The arguments are strictly increasing, also in SI
    /// units.
    pub points: Vec<[f64; 2]>,
    /// Position of its name in the document.
    pub span: Span,
}

impl Problem {
    /// Reads a problem from a file.
    ///
    /// # Errors
    /// If the file cannot be read, is larger than 16 MB, or is not a problem. Faults inside the problem are reported by
    /// [`Circuit::new`](crate::circuit::Circuit::new) for its patch, all at once.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Problem;
    ///
    /// let problem = Problem::read("../../problems/lorenz.json")?;
    /// assert_eq!(problem.quantities.keys().collect::<Vec<_>>(), ["x", "y", "z"]);
    /// # Ok::<(), patchcord_core::document::DocumentError>(())
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Problem, DocumentError> {
        let path = path.as_ref();
        let text = read_text(path)?;
        let file = path.display().to_string();
        Ok(Problem::parse_in(path.parent().unwrap_or(Path::new("")), &file, &text)?)
    }

    /// Reads a problem from a text.
    ///
    /// Reports name the problem as `file`. Paths of tables in files are relative to the folder of `file`.
    ///
    /// # Errors
    /// If the text is not a problem, or is longer than 16 MB.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Problem;
    ///
    /// let report = Problem::parse("p.json", r#"{"patchcord": 1, "elements": {}}"#).unwrap_err();
    /// assert_eq!(report.findings[0].message, "this is a patch, where a problem is needed");
    /// ```
    pub fn parse(file: &str, text: &str) -> Result<Problem, Box<Report>> {
        Problem::parse_in(Path::new(file).parent().unwrap_or(Path::new("")), file, text)
    }

    /// Reads a problem from a text, with paths of tables in files relative to `folder`. A byte order mark at the
    /// beginning of the text is ignored.
    ///
    /// # Errors
    /// If the text is not a problem, or is longer than 16 MB.
    pub fn parse_in(folder: impl AsRef<Path>, file: &str, text: &str) -> Result<Problem, Box<Report>> {
        if text.len() > MAX_DOCUMENT_BYTES {
            return Err(document_too_large(file));
        }
        let text = without_byte_order_mark(text);
        let fail = |finding| Box::new(Report::new(file, text, vec![finding]));
        let root = tree::parse(text).map_err(|finding| fail(with_form(text, finding)))?;
        let patch = Patch::empty(file, text, TableAccess::Anywhere(folder.as_ref().to_owned()));
        let mut problem = Problem { patch, quantities: IndexMap::new(), tables: IndexMap::new() };
        decode::document(&root, &mut problem).map_err(fail)?;
        table_file::read_tables(&mut problem.patch);
        Ok(problem)
    }

    /// Whether an equation applies a table of the problem. A patch has no tables, so it cannot state such an equation.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Problem;
    ///
    /// let text = r#"{"patchcord": 1, "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1"}},
    ///     "tables": {"f": {"in": "1", "out": "1", "points": [[-1, 0], [1, 3]]}},
    ///     "equations": ["x' = -x", "y = 2 f(x)"], "run": {"for": 1, "step": 0.01}}"#;
    /// let problem = Problem::parse("table.json", text)?;
    /// let found = problem.patch.equations.iter().map(|placed| problem.applies_table(&placed.value));
    /// assert_eq!(found.collect::<Vec<_>>(), [false, true]);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn applies_table(&self, equation: &Equation) -> bool {
        self.tables.keys().any(|table| check::applies_table(equation, table))
    }

    /// Whether a text is a problem, possibly with faults: a document of patchcord with quantities and without elements, or
    /// with equations and without a section of a patch such as elements or signals.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Problem;
    ///
    /// assert!(Problem::is_problem(r#"{"patchcord": 1, "quantities": {}}"#));
    /// // Another word for quantities is a fault of a problem.
    /// assert!(Problem::is_problem(r#"{"patchcord": 1, "variables": {}}"#));
    /// assert!(!Problem::is_problem(r#"{"patchcord": 1, "elements": {}}"#));
    /// assert!(!Problem::is_problem("a text"));
    /// ```
    pub fn is_problem(text: &str) -> bool {
        let is_short = text.len() <= MAX_DOCUMENT_BYTES;
        let root = is_short.then(|| tree::parse(without_byte_order_mark(text)).ok()).flatten();
        root.is_some_and(|root| match DocumentKind::of(&root) {
            Some(DocumentKind::Problem) => true,
            Some(DocumentKind::Patch) => is_without_quantities(&root),
            _ => false,
        })
    }
}

/// The sections that are the substance of a patch.
const PATCH_SECTIONS: [&str; 5] = ["elements", "drives", "scales", "signals", "macros"];

/// Whether a document is a problem that lacks its quantities: it has equations, and nothing of a patch.
fn is_without_quantities(root: &tree::Node) -> bool {
    let has = |section: &str| root.child(section).is_some();
    has("equations") && !PATCH_SECTIONS.into_iter().any(has)
}

/// The diagnostic for a text that is not JSON. It describes the form of a problem if the text does not begin like one.
fn with_form(text: &str, finding: Diagnostic) -> Diagnostic {
    match text.trim_start().starts_with(['{', '[']) {
        true => finding,
        false => finding.hint(decode::DOCUMENT_HINT),
    }
}

/// A text without the byte order mark at its beginning.
fn without_byte_order_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

impl Patch {
    /// Whether this is the patch of a [`Problem`]. Its signals are the quantities of the problem.
    pub(crate) fn is_problem(&self) -> bool {
        self.problem_tables.is_some()
    }
}

#[cfg(test)]
mod tests;
