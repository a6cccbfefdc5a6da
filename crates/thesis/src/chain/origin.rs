//! Where the numbers of the friction come from, and what other laws say.

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

/// A number that the circuit is set by, and what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// Its name in the patch.
    pub name: &'static str,
    /// Its value, in SI units.
    pub value: f64,
    /// Their text.
    pub unit: &'static str,
    /// The law that gave it.
    pub from: String,
    /// What another law says.
    pub other: Option<Other>,
}

/// What another law says of a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Other {
    /// The number, or why that law gives none.
    pub value: Result<f64, SlidewayError>,
    /// The law.
    pub from: &'static str,
}

/// All of them, in the order of [`Parameters::NAMES`].
pub(super) fn all(
    inputs: &Inputs,
    design: &Design,
    parameters: &Parameters,
    settings: &Settings,
) -> Vec<Origin> {
    let units = ["kg", "N/m", "N s/m", "N", "m/s", "s"];
    let origin = |((name, value), unit)| {
        let from = if settings.value(name).is_some() { "set" } else { law(name) };
        Origin { name, value, unit, from: from.to_owned(), other: other(name, inputs, design) }
    };
    parameters.named().into_iter().zip(units).map(origin).collect()
}

/// The law that gives a parameter.
fn law(name: &str) -> &'static str {
    match name {
        "M" => "the weight",
        "K" => "the drive",
        "f" => "the study's simulation (8.4)",
        "Fs" => "eq 12-9",
        "VcL" => "eq 11-9",
        _ => "eq 17-9 and 20-9, by weight",
    }
}

fn other(name: &str, inputs: &Inputs, design: &Design) -> Option<Other> {
    let (value, from) = match name {
        "f" => (drag(inputs, design), "drag of the oil where the ridges part, eq 171-7"),
        "Fs" => (static_friction(inputs), "chapter 7: ridges, metal and film, eq 85-7"),
        "VcL" => (limit(inputs), "chapter 7: between its two oils, eq 166-7 and 167-7"),
        "Tc" => (dry_memory(inputs), "chapter 7: dry iron that stiffens, eq 118-7"),
        _ => return None,
    };
    Some(Other { value, from })
}

fn joint(inputs: &Inputs) -> Result<Joint, SlidewayError> {
    Joint::of_surfaces(inputs.ridge, Material::GRADE_17_IRON, 2.0 * RangeProfile::OF_STUDY.fall)
}

fn static_friction(inputs: &Inputs) -> Result<f64, SlidewayError> {
    let film = if inputs.polar { BoundaryFilm::POLAR } else { BoundaryFilm::NON_POLAR };
    Ok(inputs.weight * joint(inputs)?.static_friction(inputs.pressure(), &film)?)
}

fn limit(inputs: &Inputs) -> Result<f64, SlidewayError> {
    let gap = RangeProfile { ridge: inputs.ridge, ..RangeProfile::OF_STUDY }.touching_gap()?;
    Oil::of_viscosity(inputs.viscosity)?.velocity(gap, inputs.pressure())
}

fn dry_memory(inputs: &Inputs) -> Result<f64, SlidewayError> {
    DryFriction::of_study(joint(inputs)?, inputs.pressure()).time_constant()
}

/// The drag of the film over the area by velocity, which it is proportional to.
fn drag(inputs: &Inputs, design: &Design) -> Result<f64, SlidewayError> {
    const SLOW: f64 = 1e-3;
    Ok(inputs.area * Oil::of_viscosity(inputs.viscosity)?.drag(SLOW, design.lift)? / SLOW)
}
