//! The equations of well-known patches read as in a textbook.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{Detail, EquationListing};

/// Patches with their equations, by hand.
const FORMS: [(&str, &[&str]); 4] = [
    (
        "thesis/fig-8-04",
        &[
            "x_error = x_i - x_o",
            "x_o' = v_o - v_i",
            "spring_force = K x_error",
            "v_o' = a_o",
            "net_force = spring_force - f v_o",
            "a_o = net_force/M",
            "friction_level = 0",
        ],
    ),
    (
        "thesis/fig-8-16",
        &[
            "x_error' = v_i - v_o + x_i'",
            "spring_force = K x_error",
            "v_o' = a_o",
            "a_o = (max(spring_force - friction_level, 0) + min(spring_force + friction_level, 0))/M - (f/M) v_o",
            "friction_level = Fs max(memory, 0)^2",
            "memory' = (max(1 - abs(v_o)/VcL, 0) - memory)/Tc",
        ],
    ),
    ("lessons/van-der-pol", &["x' = v", "v' = mu (1 - x^2) v - x"]),
    ("lessons/lorenz", &["x' = sigma (y - x)", "y' = rho x - y - x z", "z' = x y - beta z"]),
];

#[test]
fn well_known_equations_have_their_usual_form() {
    for (file, expected) in FORMS {
        let patch = Patch::read(format!("../../patches/{file}.json")).unwrap();
        let circuit = Circuit::new(&patch).unwrap();
        let listing = EquationListing::new(&circuit, &Program::new(&circuit).unwrap(), Detail::Signals);
        let found: Vec<String> = listing.equations.iter().map(|equation| equation.text()).collect();
        assert_eq!(found, expected, "{file}");
    }
}
