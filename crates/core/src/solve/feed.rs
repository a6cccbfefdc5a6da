//! Other points for the table of a drive, without reading or lowering the patch anew.

use crate::ir::Program;

/// Why a drive does not take points.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FeedError {
    /// A drive that does not exist.
    #[error("there is no drive {0}")]
    UnknownDrive(String),
    /// A drive that goes through no points.
    #[error("{0} is no table: only drives of kind \"table\" take points")]
    NotATable(String),
    /// No points.
    #[error("{0} needs at least one point")]
    NoPoints(String),
    /// A point that is none.
    #[error("point {place} for {drive} is not made of two finite numbers")]
    NotFinite {
        /// The drive.
        drive: String,
        /// Which point, counted from 0.
        place: usize,
    },
    /// A point that does not come after the one before it.
    #[error("point {place} for {drive} comes no later than the one before it: times must rise")]
    NotRising {
        /// The drive.
        drive: String,
        /// Which point, counted from 0.
        place: usize,
    },
}

/// Gives a drive of kind "table" other points, as if the patch had been read with them: [problem time in s, value in the unit
/// of the drive's scale], times rising.
///
/// Programs cloned from this one share its points, and run side by side ([`run_abreast`](super::run_abreast)); so feed first,
/// then clone.
///
/// # Errors
/// When there is no such drive, it is no table, there are no points, a number is not finite, or times do not rise; nothing is
/// changed then.
pub fn feed(program: &mut Program, drive: &str, points: Vec<[f64; 2]>) -> Result<(), FeedError> {
    let own = || drive.to_owned();
    let element = program.drive(drive).ok_or_else(|| FeedError::UnknownDrive(own()))?;
    let table = program.table_of(element).ok_or_else(|| FeedError::NotATable(own()))?;
    if points.is_empty() {
        return Err(FeedError::NoPoints(own()));
    }
    if let Some(place) = points.iter().position(|point| !point.iter().all(|number| number.is_finite())) {
        return Err(FeedError::NotFinite { drive: own(), place });
    }
    if let Some(before) = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        return Err(FeedError::NotRising { drive: own(), place: before + 1 });
    }
    program.put_points(table, points);
    Ok(())
}

/// Gives a function generator without symmetry other outputs at the inputs that its points have, in volts; false where there is
/// none of that name with as many points. Beyond the outermost points it goes on as before: its first two outputs must have been
/// equal, and stay so, and its last two.
pub fn bend(program: &mut Program, element: &str, outputs: &[f64]) -> bool {
    let table = program.element(element).and_then(|element| program.curve_of(element));
    let Some(table) = table.filter(|table| program.tables[*table].len() == outputs.len()) else {
        return false;
    };
    let points = program.tables[table].iter().zip(outputs).map(|(point, output)| [point[0], *output]);
    program.put_points(table, points.collect());
    true
}
