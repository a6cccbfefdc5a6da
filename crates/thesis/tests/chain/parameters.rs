//! Tests that inputs, parameters and potentiometer settings of the design chain agree with the text.

use super::{assert_close, chain, inputs};
use patchcord_analysis::instruments::CriticalVelocityError;
use patchcord_thesis::chain::{AdviceVerdict, Chain, Inputs, Parameters};
use patchcord_thesis::slideway::ridge::Ridge;
use patchcord_thesis::slideway::units::{CM2, KGF, POISE, UM};

/// The value of a parameter by another law.
fn alternative(chain: &Chain, name: &str) -> f64 {
    let origin = chain.origins.iter().find(|origin| origin.name == name).unwrap();
    origin.other.clone().unwrap().value.unwrap()
}

#[test]
fn parameters_agree_with_their_equations() {
    let chain = chain(&inputs(20.0), &[]);
    let parameters = chain.simulation.parameters;
    let pressure: f64 = 450.0 / 697.0;
    assert_close(
        parameters.static_friction,
        6970.0 * (0.009705 * pressure.powf(0.82) * 22.8 + pressure * 0.05),
        1e-5,
    );
    let lift: f64 = 5.47875;
    let base = pressure * lift.powf(2.478) / (18.7 * 0.34f64.powf(0.181));
    assert_close(parameters.limit, 0.01 * base.powf(1.515), 1e-5);
    assert_close(parameters.memory, 11.16e-3 * 0.34f64.powf(0.236), 1e-5);
    assert_eq!((parameters.mass, parameters.stiffness, parameters.damping), (450.0, 20e6, 10.7e3));
    assert_close(alternative(&chain, "Fs"), 450.0 * KGF * 0.2914, 2e-3);
    assert_close(alternative(&chain, "VcL"), 57.93e-3, 1e-3);
    assert_close(alternative(&chain, "Tc"), 0.0318, 5e-3);
    assert_close(alternative(&chain, "f"), 0.034 * 0.0697 * 0.51 * 5.47875f64.powf(0.23) / 5.47875e-6, 1e-3);
    assert!(chain.notes.is_empty(), "{:?}", chain.notes);
}

/// With the thesis's printed pressure, 0.615 kgf/cm2, eq 13-9 and 14-9 give the printed values.
#[test]
fn printed_pressure_gives_the_printed_values() {
    let area = 450.0 / 0.615 * CM2;
    let parameters = Parameters::of_design(&Inputs { area, ..inputs(20.0) }.design().unwrap()).unwrap();
    assert_close(parameters.static_friction * 697.0 / (450.0 / 0.615), 1249.0, 1e-3);
    // Eq 14-9 rounds its base to 2.23.
    assert_close(parameters.limit, 45.31e-3, 4e-3);
}

#[test]
fn surfaces_and_oil_enter_as_in_the_text() {
    let rough = Inputs { ridge: Ridge { width: 50.0 * UM, height: 3.0 * UM }, ..inputs(20.0) };
    let (ground, rough) = (inputs(20.0).design().unwrap(), rough.design().unwrap());
    assert_close(rough.interface.flank, 0.06, 1e-12);
    // By eq 137-7 a rise of Z by 0.5 um raises the lift by (2 l - B) / (2 l) times 0.5 um.
    assert_close(rough.lift - ground.lift, (2.0 - 0.005) / 2.0 * 0.5 * UM, 1e-9);
    let polar = Inputs { polar: true, ..inputs(20.0) };
    assert_close(polar.design().unwrap().interface.polar / ground.interface.polar, 7.87 / 22.8, 1e-12);
    let chain = chain(&Inputs { stiffness: 27.6e6, ..polar }, &[]);
    assert_eq!(chain.simulation.critical.rising, Err(CriticalVelocityError::NoOscillation));
    assert!(chain.predictions.printed.is_err() && chain.predictions.stability.is_err());
    assert!(chain.advice.iter().all(|advice| advice.verdict == AdviceVerdict::NothingToLower));
    assert!(chain.notes[0].contains("polar"), "{:?}", chain.notes);
}

#[test]
fn pots_are_set_as_in_the_text() {
    let (inputs, set) = (
        Inputs::of_thesis(0.34 * POISE, 433.0 * KGF, 45e6),
        [("VcL", 2.54e-3), ("Tc", 0.0065), ("Fs", 771.0)],
    );
    let chain = chain(&inputs, &set);
    assert_eq!(chain.simulation.multiple, 1.0);
    let pots = chain.simulation.pots();
    let setting = |name: &str| pots.iter().find(|pot| pot.name == name).unwrap().setting;
    for (name, expected) in [
        ("PC5", 0.252),
        ("PA3", 0.4124),
        ("PA4", 0.0599),
        ("PC2", 0.1),
        ("PA1", 0.1538),
        ("PC1", 0.5f64.sqrt()),
    ] {
        assert_close(setting(name), expected, 1e-3);
    }
    assert_close(setting("PB1, PB2"), 771.0 / (771.0 + 50.0 * 45.36), 1e-9);
    // Fig 8.24 ends at 4.54 mm/s (docs/compromise.md).
    assert_close(chain.simulation.critical.rising.unwrap(), 4.54e-3, 0.02);
}
