//! The input data of a designer: oil, table, drive and surfaces.

use super::document::rounded;
use super::error::ChainError;
use crate::slideway::Range;
use crate::slideway::design::{Design, Interface, LIFT, NON_POLAR, POLAR_ADDITIVE};
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_CM2, N_PER_MM, POISE, UM};
use crate::slideway::wedge::RangeProfile;
use patchcord_core::document::format_number;

const VISCOSITY: Range = Range::new("viscosity", "P", 1e-3, 1e3);
const WEIGHT: Range = Range::positive("weight", "kgf");
const AREA: Range = Range::positive("area", "cm2");
const STIFFNESS: Range = Range::positive("stiffness", "kN/mm");
/// The mean pressures for which the laws of chapter 7 hold.
const PRESSURE: Range = Range::new("weight / area", "kgf/cm2", 1e-4, 8.0);

/// The ranges of [`Ridge::WIDTHS`] and [`Ridge::HEIGHTS`] in um.
const RIDGE_WIDTH: Range = Range::new("width of a ridge", "um", 1e-3, 1e5);
const RIDGE_HEIGHT: Range = Range::new("height of a ridge", "um", 1e-3, 1e5);

/// Viscosities, weights and stiffnesses for which the thesis has measurements.
const MEASURED_VISCOSITY: Range = Range::new("oil", "P", 0.13, 0.595);
const MEASURED_WEIGHT: Range = Range::new("table", "kgf", 450.0, 850.0);
const MEASURED_STIFFNESS: Range = Range::new("drive", "kN/mm", 11.0, 45.0);

/// An input of the designer, as errors name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Viscosity of the oil.
    Viscosity,
    /// Weight of the table.
    Weight,
    /// Area of the slides.
    Area,
    /// Stiffness of the drive.
    Stiffness,
    /// Width of a ridge.
    RidgeWidth,
    /// Height of a ridge.
    RidgeHeight,
}

/// The input data of a slideway: oil, table, drive and surfaces.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::{Inputs, Parameters};
/// use patchcord_thesis::slideway::units::{KGF, KGF_PER_CM2, POISE};
///
/// let inputs = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 27.6e6);
/// assert!((inputs.pressure() / KGF_PER_CM2 - 450.0 / 697.0).abs() < 1e-9);
/// assert!(inputs.title().starts_with("Slideway: oil of 0.34 P, 450 kgf on 697 cm2"));
///
/// let parameters = Parameters::of_design(&inputs.design()?)?;
/// assert!((parameters.mass - 450.0).abs() < 1e-9);
/// assert_eq!(parameters.named()[1], ("K", 27.6e6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs {
    /// Viscosity of the oil, in Pa s: 0.0001 ... 100.
    pub viscosity: f64,
    /// Whether the oil has a polar additive.
    pub polar: bool,
    /// Weight of the table, in N, above 0.
    pub weight: f64,
    /// Apparent area of the slides, in m2, above 0. The mean pressure must be 1e-4 ... 8 kgf/cm2.
    pub area: f64,
    /// Stiffness of the drive, in N/m, above 0.
    pub stiffness: f64,
    /// The ridges of its surfaces.
    pub ridge: Ridge,
}

impl Inputs {
    /// A table on the thesis's slideway: 697 cm2 of ground cast iron, oil without polar additive (9.3).
    ///
    /// The viscosity is in Pa s, the weight in N, the stiffness in N/m.
    pub const fn of_thesis(viscosity: f64, weight: f64, stiffness: f64) -> Self {
        let area = Interface::MODEL.area;
        Inputs { viscosity, polar: false, weight, area, stiffness, ridge: Ridge::GROUND }
    }

    /// Mean pressure Pw, in Pa.
    pub fn pressure(&self) -> f64 {
        self.weight / self.area
    }

    /// The input of the design equation (eq 93-9).
    ///
    /// KLP follows from the oil and the tangent Z / B from the ridges. The lift Ho + hd is the gap at which the
    /// ranges of ridges just touch (eq 139-7).
    ///
    /// # Errors
    /// If an input is out of its range. The message uses the units of the thesis.
    pub fn design(&self) -> Result<Design, ChainError> {
        let checks: [(_, _, &'static [Input]); 7] = [
            (VISCOSITY, self.viscosity / POISE, &[Input::Viscosity]),
            (WEIGHT, self.weight / KGF, &[Input::Weight]),
            (AREA, self.area / CM2, &[Input::Area]),
            (STIFFNESS, self.kilonewtons(), &[Input::Stiffness]),
            (PRESSURE, self.pressure() / KGF_PER_CM2, &[Input::Weight, Input::Area]),
            (RIDGE_WIDTH, self.ridge.width / UM, &[Input::RidgeWidth]),
            (RIDGE_HEIGHT, self.ridge.height / UM, &[Input::RidgeHeight]),
        ];
        for (range, value, inputs) in checks {
            range.check(rounded(value)).map_err(|error| ChainError::Input { inputs, error })?;
        }
        let of_ridges = |error| ChainError::Input { inputs: &[Input::RidgeWidth, Input::RidgeHeight], error };
        let polar = if self.polar { POLAR_ADDITIVE } else { NON_POLAR };
        let profile = RangeProfile { ridge: self.ridge, ..RangeProfile::OF_THESIS };
        let lift = profile.touching_gap().and_then(|lift| LIFT.check(lift)).map_err(of_ridges)?;
        let interface = Interface { area: self.area, polar, flank: self.ridge.climb().map_err(of_ridges)? };
        Ok(Design {
            weight: self.weight,
            lift,
            viscosity: self.viscosity,
            stiffness: self.stiffness,
            interface,
        })
    }

    /// The slideway in one line of text.
    pub fn title(&self) -> String {
        let [oil, weight, area] =
            [self.viscosity / POISE, self.weight / KGF, self.area / CM2].map(format_number);
        let (kind, drive) =
            (if self.polar { ", polar additive" } else { "" }, format_number(self.kilonewtons()));
        format!("Slideway: oil of {oil} P{kind}, {weight} kgf on {area} cm2, drive of {drive} kN/mm")
    }

    /// Stiffness in kN/mm.
    fn kilonewtons(&self) -> f64 {
        self.stiffness / N_PER_MM / 1e3
    }

    /// Warnings for inputs outside the measured oils, tables and drives, for which the laws are extrapolated.
    pub(super) fn notes(&self) -> Vec<String> {
        let checks = [
            (MEASURED_VISCOSITY, self.viscosity / POISE, "..."),
            (MEASURED_WEIGHT, self.weight / KGF, "and"),
            (MEASURED_STIFFNESS, self.kilonewtons(), "..."),
        ];
        let checks = checks.map(|(range, value, to)| (range, rounded(value), to));
        let outside = checks.into_iter().filter(|(range, value, _)| range.check(*value).is_err());
        let mut notes: Vec<_> =
            outside.map(|(range, value, to)| extrapolation_note(range, value, to)).collect();
        if self.polar {
            notes.push(
                "no oil with polar additive was measured: Tc is that of an oil without additive".to_owned(),
            );
        }
        notes
    }
}

/// The warning that a value is outside the measured ones. `to` is "..." for a range and "and" for two single values.
fn extrapolation_note(Range { quantity, unit, low, high }: Range, value: f64, to: &str) -> String {
    format!(
        "{quantity} is {} {unit}, measured only at {low} {to} {high} {unit}: the result is extrapolated",
        format_number(value)
    )
}
