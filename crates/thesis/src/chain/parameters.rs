//! The parameters of the circuit of Fig 8.16.

use super::document::rounded;
use crate::slideway::SlidewayError;
use crate::slideway::design::{Design, limit_velocity};
use crate::slideway::falling::FallingFriction;
use crate::slideway::simulated::memory_at_weight;
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::GRAVITY;

/// The parameters of a table, its drive and its friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Mass M of the table, in kg.
    pub mass: f64,
    /// Stiffness K of the drive, in N/m.
    pub stiffness: f64,
    /// Viscous coefficient f, in N s/m.
    pub damping: f64,
    /// Static friction Fs, in N.
    pub static_friction: f64,
    /// Velocity VcL from which solid friction is 0, in m/s.
    pub limit: f64,
    /// Time constant Tc with which solid friction follows velocity, in s.
    pub memory: f64,
}

impl Parameters {
    /// The parameters of a design by chapter 9: Fs by eq 12-9, VcL by eq 11-9, Tc by eq 17-9 and 20-9.
    ///
    /// The three belong together, because the thesis calculated Tc from measured critical velocities with this Fs and
    /// VcL. The viscous coefficient is that of the thesis's simulation. The slope at which oscillation ceases was
    /// found with it.
    ///
    /// # Errors
    /// If one of the laws does not hold.
    pub fn of_design(design: &Design) -> Result<Self, SlidewayError> {
        let pressure = design.weight / design.interface.area;
        Ok(Parameters {
            mass: design.weight / GRAVITY,
            stiffness: design.stiffness,
            damping: SIMULATED_DAMPING,
            static_friction: design.interface.static_friction(pressure)?,
            limit: limit_velocity(pressure, design.lift, design.viscosity)?,
            memory: memory_at_weight(design.weight, design.viscosity)?,
        })
    }

    /// The parameters rounded to six digits. A potentiometer cannot be set more finely.
    pub(super) fn rounded(mut self) -> Self {
        for (name, value) in self.named() {
            self.set(name, rounded(value));
        }
        self
    }

    /// The names of the parameters in the patch, in the order of the fields.
    pub const NAMES: [&'static str; 6] = ["M", "K", "f", "Fs", "VcL", "Tc"];

    /// Names and values, in the order of [`Parameters::NAMES`].
    pub fn named(&self) -> [(&'static str, f64); 6] {
        let Parameters { mass, stiffness, damping, static_friction, limit, memory } = *self;
        let values = [mass, stiffness, damping, static_friction, limit, memory];
        std::array::from_fn(|index| (Self::NAMES[index], values[index]))
    }

    /// Sets the parameter with this name in the patch. Returns false if no field has this name.
    pub(super) fn set(&mut self, name: &str, value: f64) -> bool {
        let field = match name {
            "M" => &mut self.mass,
            "K" => &mut self.stiffness,
            "f" => &mut self.damping,
            "Fs" => &mut self.static_friction,
            "VcL" => &mut self.limit,
            "Tc" => &mut self.memory,
            _ => return false,
        };
        *field = value;
        true
    }

    /// The table on its drive.
    pub fn table(&self) -> DrivenTable {
        let Parameters { mass, stiffness, damping, memory, .. } = *self;
        DrivenTable { mass, stiffness, damping, memory }
    }

    /// The solid friction of the slideway.
    pub fn friction(&self) -> FallingFriction {
        FallingFriction { static_friction: self.static_friction, limit: self.limit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_sets_its_own_value() {
        for (index, name) in Parameters::NAMES.into_iter().enumerate() {
            let mut parameters = Parameters::of_design(&Design::model(0.034, 45e6)).unwrap();
            assert!(parameters.set(name, 7.0));
            assert_eq!(parameters.named()[index], (name, 7.0));
            assert_eq!(parameters.named().iter().filter(|(_, value)| *value == 7.0).count(), 1);
            assert!(!parameters.set("v_rate", 7.0));
        }
    }
}
