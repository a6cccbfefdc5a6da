//! Chapter 7: surfaces and friction.

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_CM2, MM};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "ridge-radius", run: ridge_radius },
    Check { name: "table-pressure", run: table_pressure },
];

/// Radius of the arc that stands in for a ridge, in mm.
fn ridge_radius(given: &Given) -> Result<Finding, CheckError> {
    let ground = Ridge::GROUND;
    let ridge =
        Ridge { width: given.number_or("B", ground.width)?, height: given.number_or("Z", ground.height)? };
    Ok(Finding::Number(ridge.radius()? / MM))
}

/// Mean pressure of a table of W kgf on A cm2, in kgf/cm2.
fn table_pressure(given: &Given) -> Result<Finding, CheckError> {
    let (weight, area) = (given.number("W")? * KGF, given.number("A")? * CM2);
    Ok(Finding::Number(weight / area / KGF_PER_CM2))
}
