//! Sets new points in the tables of a program, without reading or lowering its patch again.
//!
//! [`set_drive_table`] replaces the points of a drive, for example by measured data. [`set_curve`] replaces the outputs
//! of a function generator, for example in a fit of a curve.

use crate::ir::Program;

/// Why the points of a drive cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveTableError {
    /// No drive has this name. The field is the name.
    #[error("there is no drive {0}; choose a drive of kind \"table\"")]
    UnknownDrive(String),
    /// The drive is not a table. The field is its name.
    #[error("{0} is not a table: only drives of kind \"table\" have points")]
    NotATable(String),
    /// The list of points is empty. The field is the name of the drive.
    #[error("{0} needs at least one point")]
    NoPoints(String),
    /// A number of a point is not finite.
    #[error("point {} for {drive} must be two finite numbers", .index + 1)]
    NotFinite {
        /// Name of the drive.
        drive: String,
        /// Index of the point in the list, from 0. The message counts from 1.
        index: usize,
    },
    /// A point is not later than the point before it.
    #[error(
        "point {} for {drive} must be later than the point before it: times must be strictly increasing",
        .index + 1
    )]
    NotRising {
        /// Name of the drive.
        drive: String,
        /// Index of the point in the list, from 0. The message counts from 1.
        index: usize,
    },
}

/// Why the outputs of a function generator cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// No element has this name. The field is the name.
    #[error("there is no element {0}; choose an element of kind \"function-generator\"")]
    UnknownElement(String),
    /// The element does not look up a curve. The field is its name.
    #[error("{0} has no curve: only elements of kind \"function-generator\" have one")]
    NotACurve(String),
    /// The number of outputs differs from the number of points.
    #[error("the curve of {element} has {points} points, but {outputs} outputs were given")]
    WrongCount {
        /// Name of the element.
        element: String,
        /// Number of points of its curve.
        points: usize,
        /// Number of outputs that were given.
        outputs: usize,
    },
}

/// Sets the points of a drive of kind "table", as if the patch had been read with them. A point is [problem time in s,
/// value in the unit of the drive's scale]; times are strictly increasing.
///
/// Programs that are cloned afterwards share the points, so they can run as a batch ([`run_batch`](super::run_batch)).
/// Programs whose points are set one by one cannot.
///
/// # Errors
/// If no drive has this name, it is not a table, there are no points, a number is not finite, or times do not increase.
/// Nothing is changed then.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{Machine, set_drive_table};
/// use serde_json::json;
///
/// let table = ElementBuilder::new("table").set("points", json!([[0, 0], [1, 10]]));
/// let patch = PatchBuilder::new("replay").scale("volt", 1, "V").drive("u", "volt", table);
/// let inverter = ElementBuilder::new("inverter").cord("in", "u");
/// let patch = patch.element("S1", inverter).build()?;
/// let mut program = Program::new(&Circuit::new(&patch)?)?;
/// set_drive_table(&mut program, "u", vec![[0.0, 5.0], [1.0, 7.0]])?;
/// assert!((Machine::new(&program, 1e-3)?.voltage("S1")? + 5.0).abs() < 1e-12);
/// let error = set_drive_table(&mut program, "u", Vec::new()).unwrap_err();
/// assert_eq!(error.to_string(), "u needs at least one point");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn set_drive_table(
    program: &mut Program,
    drive: &str,
    points: Vec<[f64; 2]>,
) -> Result<(), DriveTableError> {
    let name = || drive.to_owned();
    let element = program.drive(drive).ok_or_else(|| DriveTableError::UnknownDrive(name()))?;
    let table = program.drive_table(element).ok_or_else(|| DriveTableError::NotATable(name()))?;
    if points.is_empty() {
        return Err(DriveTableError::NoPoints(name()));
    }
    if let Some(index) = points.iter().position(|point| !point.iter().all(|number| number.is_finite())) {
        return Err(DriveTableError::NotFinite { drive: name(), index });
    }
    if let Some(earlier) = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        return Err(DriveTableError::NotRising { drive: name(), index: earlier + 1 });
    }
    program.set_points(table, points);
    Ok(())
}

/// Sets the outputs of a function generator without symmetry, in volts and in the order of its points. The inputs of
/// the points stay.
///
/// Outside the outermost points the curve still continues with its previous end segments. So the first two outputs must
/// have been equal and must stay equal, and the last two likewise.
///
/// # Errors
/// If no element has this name, it has no curve, or its curve does not have this number of points. Nothing is changed
/// then.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{Machine, set_curve};
/// use serde_json::json;
///
/// let points = json!([[-20, -5], [-10, -5], [10, 5], [20, 5]]);
/// let curve = ElementBuilder::new("function-generator").cord("in", "+100").set("points", points);
/// let patch = PatchBuilder::new("curve").element("F1", curve).build()?;
/// let mut program = Program::new(&Circuit::new(&patch)?)?;
/// set_curve(&mut program, "F1", &[-8.0, -8.0, 8.0, 8.0])?;
/// assert!((Machine::new(&program, 1e-3)?.voltage("F1")? - 8.0).abs() < 1e-12);
/// let error = set_curve(&mut program, "F1", &[0.0, 1.0]).unwrap_err();
/// assert_eq!(error.to_string(), "the curve of F1 has 4 points, but 2 outputs were given");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn set_curve(program: &mut Program, element: &str, outputs: &[f64]) -> Result<(), CurveError> {
    let name = || element.to_owned();
    let index = program.element(element).ok_or_else(|| CurveError::UnknownElement(name()))?;
    let table = program.element_curve(index).ok_or_else(|| CurveError::NotACurve(name()))?;
    let points = &program.tables[table];
    if points.len() != outputs.len() {
        return Err(CurveError::WrongCount { element: name(), points: points.len(), outputs: outputs.len() });
    }
    let points = points.iter().zip(outputs).map(|(point, output)| [point[0], *output]).collect();
    program.set_points(table, points);
    Ok(())
}
