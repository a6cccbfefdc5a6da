//! The laws that give the parameters of the circuit, and the values of other laws for comparison.

use super::inputs::Inputs;
use super::parameters::Parameters;
use super::settings::Settings;
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::design::Design;
use crate::slideway::dry_friction::DryFriction;
use crate::slideway::joint::Joint;
use crate::slideway::material::Material;
use crate::slideway::oil::Oil;
use crate::slideway::wedge::RangeProfile;

/// A parameter of the circuit with the law that gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// Name in the patch, one of [`Parameters::NAMES`].
    pub name: &'static str,
    /// Value in SI units.
    pub value: f64,
    /// SI unit as text.
    pub unit: &'static str,
    /// The law that gave the value, or "set" if the user set it.
    pub from: String,
    /// The value by another law. `None` if the thesis has no other law for it.
    pub other: Option<AlternativeValue>,
}

/// The value of a parameter by another law.
#[derive(Debug, Clone, PartialEq)]
pub struct AlternativeValue {
    /// The value in SI units, or the reason why the law gives none.
    pub value: Result<f64, SlidewayError>,
    /// The law, in words.
    pub from: &'static str,
}

/// The origins of all parameters, in the order of [`Parameters::NAMES`].
pub(super) fn all(
    inputs: &Inputs,
    design: &Design,
    parameters: &Parameters,
    settings: &Settings,
) -> Vec<Origin> {
    let units = ["kg", "N/m", "N s/m", "N", "m/s", "s"];
    let origin = |((name, value), unit)| {
        let from = if settings.value(name).is_some() { "set" } else { law(name) };
        Origin { name, value, unit, from: from.to_owned(), other: alternative(name, inputs, design) }
    };
    parameters.named().into_iter().zip(units).map(origin).collect()
}

/// The law that gives a parameter.
fn law(name: &str) -> &'static str {
    match name {
        "M" => "the weight",
        "K" => "the drive",
        "f" => "the thesis's simulation (8.4)",
        "Fs" => "eq 12-9",
        "VcL" => "eq 11-9",
        _ => "eq 17-9 and 20-9, by weight",
    }
}

/// The value of a parameter by another law than that of [`Parameters`].
fn alternative(name: &str, inputs: &Inputs, design: &Design) -> Option<AlternativeValue> {
    let (value, from) = match name {
        "f" => (drag(inputs, design), "drag of the oil when the ridges part, eq 171-7"),
        "Fs" => (static_friction(inputs), "chapter 7: ridges, metal and film, eq 85-7"),
        "VcL" => (limit(inputs), "chapter 7: interpolated between its two oils, eq 166-7 and 167-7"),
        "Tc" => (dry_memory(inputs), "chapter 7: stiffening of dry iron, eq 118-7"),
        _ => return None,
    };
    Some(AlternativeValue { value, from })
}

fn joint(inputs: &Inputs) -> Result<Joint, SlidewayError> {
    Joint::of_surfaces(inputs.ridge, Material::GRADE_17_IRON, 2.0 * RangeProfile::OF_THESIS.fall)
}

fn static_friction(inputs: &Inputs) -> Result<f64, SlidewayError> {
    let film = if inputs.polar { BoundaryFilm::POLAR } else { BoundaryFilm::NON_POLAR };
    Ok(inputs.weight * joint(inputs)?.static_friction(inputs.pressure(), &film)?)
}

fn limit(inputs: &Inputs) -> Result<f64, SlidewayError> {
    let gap = RangeProfile { ridge: inputs.ridge, ..RangeProfile::OF_THESIS }.touching_gap()?;
    Oil::of_viscosity(inputs.viscosity)?.velocity(gap, inputs.pressure())
}

fn dry_memory(inputs: &Inputs) -> Result<f64, SlidewayError> {
    DryFriction::of_thesis(joint(inputs)?, inputs.pressure()).time_constant()
}

/// The viscous coefficient of the oil film in N s/m: its drag over the whole area divided by velocity. The drag is
/// proportional to velocity, so any small velocity serves.
fn drag(inputs: &Inputs, design: &Design) -> Result<f64, SlidewayError> {
    /// Velocity at which the drag is calculated, in m/s.
    const SLOW: f64 = 1e-3;
    Ok(inputs.area * Oil::of_viscosity(inputs.viscosity)?.drag(SLOW, design.lift)? / SLOW)
}
