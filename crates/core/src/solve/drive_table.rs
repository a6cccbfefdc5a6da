//! New points for the tables of a program, without reading or lowering its patch again.

use crate::ir::Program;

/// Why a drive does not take points.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DriveTableError {
    /// No drive has this name.
    #[error("there is no drive {0}")]
    UnknownDrive(String),
    /// The drive is not a table.
    #[error("{0} is not a table: only drives of kind \"table\" take points")]
    NotATable(String),
    /// The list of points is empty.
    #[error("{0} needs at least one point")]
    NoPoints(String),
    /// A number of a point is not finite.
    #[error("point {place} for {drive} must be two finite numbers")]
    NotFinite {
        /// The drive.
        drive: String,
        /// Index of the point, from 0.
        place: usize,
    },
    /// A point is not later than the point before it.
    #[error(
        "point {place} for {drive} must be later than the point before it: times must be strictly increasing"
    )]
    NotRising {
        /// The drive.
        drive: String,
        /// Index of the point, from 0.
        place: usize,
    },
}

/// Sets the points of a drive of kind "table", as if the patch had been read with them. A point is [problem time in s,
/// value in the unit of the drive's scale]; times are strictly increasing.
///
/// Programs cloned from this one share its points and can run side by side
/// ([`run_abreast`](super::run_abreast)). So set the points first, and clone after.
///
/// # Errors
/// If no drive has this name, it is not a table, there are no points, a number is not finite, or times do not increase.
/// Nothing is changed then.
pub fn set_drive_table(
    program: &mut Program,
    drive: &str,
    points: Vec<[f64; 2]>,
) -> Result<(), DriveTableError> {
    let own = || drive.to_owned();
    let element = program.drive(drive).ok_or_else(|| DriveTableError::UnknownDrive(own()))?;
    let table = program.table_of(element).ok_or_else(|| DriveTableError::NotATable(own()))?;
    if points.is_empty() {
        return Err(DriveTableError::NoPoints(own()));
    }
    if let Some(place) = points.iter().position(|point| !point.iter().all(|number| number.is_finite())) {
        return Err(DriveTableError::NotFinite { drive: own(), place });
    }
    if let Some(before) = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        return Err(DriveTableError::NotRising { drive: own(), place: before + 1 });
    }
    program.put_points(table, points);
    Ok(())
}

/// Sets the outputs of a function generator without symmetry at the inputs of its points, in volts. Returns false, and
/// changes nothing, if no such element has this name and this number of points.
///
/// Beyond the outermost points the curve continues as before. So the first two outputs must have been equal and must
/// stay equal, and the last two likewise.
pub fn set_curve(program: &mut Program, element: &str, outputs: &[f64]) -> bool {
    let table = program.element(element).and_then(|element| program.curve_of(element));
    let Some(table) = table.filter(|table| program.tables[*table].len() == outputs.len()) else {
        return false;
    };
    let points = program.tables[table].iter().zip(outputs).map(|(point, output)| [point[0], *output]);
    program.put_points(table, points.collect());
    true
}
