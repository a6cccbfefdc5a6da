//! Recognises problems in pure numbers, in which the time is a pure number as well.

use super::Patch;
use patchcord_expr::Dimension;

/// Whether times count as pure numbers in the equations of a patch: no unit of a parameter or a scale contains a time.
///
/// The volt does not count. It is the unit of the machine, and problems in pure numbers have scales in volts too.
pub(crate) fn is_time_dimensionless(patch: &Patch) -> bool {
    let of_parameters = patch.parameters.values().map(|parameter| &parameter.unit);
    let of_scales = patch.scales.values().map(|scale| &scale.unit);
    let mut dimensions = of_parameters.chain(of_scales).map(|unit| unit.dimension());
    !dimensions.any(|dimension| dimension.contains_time() && dimension != Dimension::VOLTAGE)
}

/// Whether a dimension is that of a time in the formulas of a patch. If times count as pure numbers, a pure number is one.
pub(crate) fn is_time(patch: &Patch, dimension: Dimension) -> bool {
    dimension == Dimension::TIME || (dimension.is_dimensionless() && is_time_dimensionless(patch))
}
