//! `patchcord equations`

use super::{code, errors, json, out, patchcord};

/// The text on standard output of a command that succeeds.
fn printed(arguments: &[&str]) -> String {
    let output = patchcord(arguments);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    out(&output)
}

#[test]
fn equations_are_printed_as_text() {
    let text = printed(&["equations", "patches/lessons/lorenz.json", "--set", "rho=20"]);
    let (heading, equations) = text.split_once("\n\n").unwrap();
    assert!(heading.starts_with("Lorenz's equations") && heading.contains("rho 20"), "{heading}");
    assert_eq!(
        equations,
        "x' = sigma (y - x)\ny' = rho x - y - x z\nz' = x y - beta z\n\nat t = 0: x = x0, y = y0, z = z0\n"
    );
}

#[test]
fn every_element_has_an_equation_on_request() {
    let text = printed(&["equations", "patches/lessons/lorenz.json", "--all"]);
    for line in ["P1 = 0.04 sigma x", "B1 = -4 x", "x' = -25 P1 - 25 P2"] {
        assert!(text.lines().any(|own| own == line), "{line} is missing:\n{text}");
    }
}

#[test]
fn equations_are_printed_in_latex() {
    let text = printed(&["equations", "patches/lessons/van-der-pol.json", "--latex"]);
    assert!(text.starts_with("\\begin{align}\n") && text.ends_with("\\end{align}\n"), "{text}");
    assert!(text.contains("\\dot{v} &= \\mu\\,\\left(1 - x^{2}\\right)\\,v - x"), "{text}");
}

#[test]
fn the_json_document_has_both_forms() {
    let document = json(&patchcord(&["equations", "patches/lessons/relay-thermostat.json", "--json"]));
    assert_eq!(document["ok"], true);
    assert_eq!(document["equations"][0]["text"], "T' = heater/C - (h/C) T");
    assert_eq!(document["equations"][1]["right"], "{0 if K1 is released; P otherwise}");
    assert_eq!(document["modes"][0]["changes"][0]["when"], "T <= T_set - 0.5 width");
    assert_eq!(document["initial"][0]["value"], "0");
}

#[test]
fn latex_and_json_exclude_each_other() {
    let output = patchcord(&["equations", "patches/lessons/lorenz.json", "--json", "--latex"]);
    assert_eq!(code(&output), 2);
    assert!(errors(&output).contains("cannot be used with"), "{}", errors(&output));
}
