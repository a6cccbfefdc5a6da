//! The sites of a circuit at which an effect may attach: junctions, drives that data feed, and friction levels.
//!
//! A junction is an integrator with the sum that drives it. To find the quantity and the unit of that sum, the search
//! goes back from the integrator's jacks through inverters and potentiometers, which only multiply. The farthest named
//! signal is the sum. Only the dimensions of the signals decide what a junction is: a velocity, a level, a temperature.
//!
//! Example: an integrator A1 with the output v in mm/s is driven through the potentiometer P1 by a summer whose signal
//! is a force in N. The junction is A1, its sum is that force, and `setting` is the formula of P1. Viscous friction can
//! then be wired to the sum in N.

mod finder;

use crate::data::experiment::MeasuredDrive;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Report;
use patchcord_core::patch::Patch;
use patchcord_expr::Unit;

use finder::SiteFinder;

/// A quantity of a circuit: the output that carries it, and its scale there.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaledSignal {
    /// The name of the signal, or of the drive if no signal names it.
    pub signal: String,
    /// The element or drive whose output carries it.
    pub element: String,
    /// Whether a positive voltage means a positive quantity.
    pub is_noninverted: bool,
    /// The magnitude of one volt as a formula of the patch's scales.
    pub scale: String,
    /// The magnitude of one volt as a number of `unit`.
    pub per_volt: f64,
    /// The unit of the quantity.
    pub unit: Unit,
}

/// An integrator and the sum that drives it. An unknown force or flow can act on that sum.
///
/// The integrator, its sum and the signals that a form may read there. Names are those of the patch.
#[derive(Debug, Clone)]
pub struct Junction {
    /// The name of the integrator.
    pub integrator: String,
    /// The quantity that the integrator computes, at a noninverted output if there is one.
    pub output: ScaledSignal,
    /// Whether a positive voltage at the integrator itself means a positive quantity.
    pub is_noninverted: bool,
    /// The sum that drives the integrator.
    pub sum: InputSum,
    /// Whether the output is a velocity: its time integral is a length or an angle.
    pub is_motion: bool,
    /// Signals with the dimension of the output's time integral.
    pub positions: Vec<ScaledSignal>,
    /// The forces, and all drives in the unit of the sum.
    pub loads: Vec<ScaledSignal>,
    /// Signals in the unit of the sum that can change in a run. Drives are not among them.
    pub forces: Vec<ScaledSignal>,
}

/// The sum that drives an integrator, and the path from its signal to the integrator.
#[derive(Debug, Clone)]
pub struct InputSum {
    /// The signal or drive of the sum. `None` if none is named; then the unit is that of the output's rate.
    pub signal: Option<ScaledSignal>,
    /// The value of one volt as a formula of scales or a number of `unit`.
    pub scale: String,
    /// The value of one volt as a number of `unit`.
    pub per_volt: f64,
    /// The unit of the sum.
    pub unit: Unit,
    /// The product of the potentiometer settings on the path, as a formula. `None` if there is no potentiometer.
    pub setting: Option<String>,
    /// The gain of the integrator's jack at the end of the path.
    pub gain: f64,
    /// The cord that carries the whole sum. `None` if the integrator has further inputs, or the sum drives something
    /// else on its path.
    pub total_cord: Option<TotalCord>,
}

/// A cord that carries everything that drives an integrator.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct TotalCord {
    /// The element at whose output the cord starts.
    pub from: String,
    /// The element at whose input the cord ends.
    pub to: String,
}

/// All sites of a circuit at which an effect may attach.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
/// use patchcord_ident::effects::sites::Sites;
///
/// let patch = Patch::read("../../examples/05_missing_effect/spring.json")?;
/// let sites = Sites::fed(&patch, &[])?;
///
/// // A2 only integrates the velocity to a position, so no force acts on it.
/// assert_eq!(sites.junctions.len(), 1);
/// assert_eq!((sites.junctions[0].integrator.as_str(), sites.junctions[0].is_motion), ("A1", true));
/// assert_eq!(sites.junctions[0].output.signal, "v");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Sites {
    /// The junctions, in the order of the circuit. Integrators within macros, and those that only integrate a velocity
    /// to a position, are not among them.
    pub junctions: Vec<Junction>,
    /// The drives that data feed.
    pub drives: Vec<ScaledSignal>,
    /// Named signals on the path to a brake or to the bias of a dead zone.
    pub levels: Vec<ScaledSignal>,
    /// Integrators of the patch, not of its macros, whose output no signal gives a scale. No effect can act there,
    /// because the unit of its parameters is unknown.
    pub unscaled_integrators: Vec<String>,
}

impl Sites {
    /// The sites of a patch. `drives` are those that the data feed.
    ///
    /// # Errors
    /// If the patch cannot be wired.
    pub fn fed(patch: &Patch, drives: &[MeasuredDrive]) -> Result<Sites, Box<Report>> {
        let fed: Vec<&str> = drives.iter().map(|measured| measured.drive.as_str()).collect();
        Ok(Sites::of(&Circuit::new(patch)?, &fed))
    }

    /// The sites of a circuit. `fed` are the names of the drives that the data feed.
    pub fn of(circuit: &Circuit, fed: &[&str]) -> Sites {
        let finder = SiteFinder::of(circuit);
        let integrators: Vec<usize> = finder.of_kind("integrator").collect();
        let is_unscaled = |element: &&usize| finder.output(**element).is_none();
        let unscaled = integrators.iter().filter(is_unscaled).map(|element| finder.name(*element).to_owned());
        let drives = fed.iter().filter_map(|name| finder.drive(finder.named(name)?));
        Sites {
            junctions: integrators.iter().filter_map(|element| finder.junction(*element)).collect(),
            unscaled_integrators: unscaled.filter(|name| !name.contains('.')).collect(),
            drives: drives.collect(),
            levels: finder.levels(),
        }
    }
}
