//! The lessons of patches/lessons, compared with closed solutions and with independent numerical results.

mod bouncing_ball;
mod crossings;
mod driven_oscillator;
mod every_lesson;
mod heat_rod;
mod lorenz;
mod mass_and_spring;
mod mathieu;
mod page;
mod predator_and_prey;
mod projectile;
mod relay_thermostat;
mod square_root_and_division;
mod stick_slip;
mod two_phase_oscillator;
mod van_der_pol;
