//! Effects wired into patches: they attach where units agree, and work with any signs of the wiring.

mod laws;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;
use patchcord_ident::effects::attach::{EffectPlacement, FormulaQuantity};
use patchcord_ident::effects::candidate::Candidate;
use patchcord_ident::effects::reach::{Extent, QuantitySize};
use patchcord_ident::effects::sites::{ScaledSignal, Sites};
use patchcord_ident::effects::{Effect, Library};

/// The patch of a mass of 2 kg under a force of 10 N sin(2 pi t + 1).
///
/// The output of its integrator is the velocity if `is_upright`, else the negative velocity.
fn mass(is_upright: bool) -> Patch {
    let (sum, velocity) = if is_upright {
        (r#""SF": {"kind": "summer", "in": {"x1": ["F"]}}"#, r#"{"kind": "inverter", "in": "IV"}"#)
    } else {
        (
            r#""SF": {"kind": "inverter", "in": "BF"}, "BF": {"kind": "inverter", "in": "F"}"#,
            r#"{"kind": "inverter", "in": "IV"}"#,
        )
    };
    let (at, minus) = if is_upright { ("IV", "BV") } else { ("BV", "IV") };
    let sign = if is_upright { -1 } else { 1 };
    let text = format!(
        r#"{{
  "patchcord": 1,
  "parameters": {{"m": {{"value": 2, "unit": "kg", "range": [1, 5]}}}},
  "scales": {{
    "force": {{"per_volt": 0.5, "unit": "N"}},
    "velocity": {{"per_volt": 0.1, "unit": "m/s"}},
    "position": {{"per_volt": 0.1, "unit": "m"}}
  }},
  "drives": {{"F": {{"kind": "sine", "scale": "force", "amplitude": 10, "frequency": 1, "phase": 1}}}},
  "elements": {{
    {sum},
    "PM": {{"kind": "pot", "in": "SF", "setting": "force / velocity / m / 10"}},
    "IV": {{"kind": "integrator", "in": {{"x10": ["PM"]}}}},
    "BV": {velocity},
    "PX": {{"kind": "pot", "in": "{minus}", "setting": "velocity / position / 10"}},
    "IX": {{"kind": "integrator", "in": {{"x10": ["PX"]}}}}
  }},
  "signals": {{
    "v": {{"at": "{at}", "scale": "velocity"}},
    "x": {{"at": "IX", "scale": "position"}},
    "net_force": {{"at": "SF", "scale": "force", "factor": {sign}}}
  }},
  "run": {{"for": 3, "step": 1e-3, "every": 1e-2}}
}}"#
    );
    Patch::parse("mass.json", &text).unwrap()
}

/// The sites of a patch where effects may attach.
fn sites(patch: &Patch) -> Sites {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
    Sites::of(&circuit, &drives)
}

/// Extents of the parameters at a site: every signal spans -40 ... 40 V, times 0.01 ... 3 s.
fn extents(placement: &EffectPlacement<'_>) -> Vec<QuantitySize> {
    let extent = |quantity: FormulaQuantity<'_>| Some(Extent::of([-40.0, 40.0]).times(quantity.per_volt()));
    placement.site.quantity_sizes(extent, 0.01, 3.0)
}

/// The candidate of an effect at a site.
fn candidate(placement: &EffectPlacement<'_>, patch: &Patch) -> Candidate {
    let candidate = Candidate::new(placement, patch, &extents(placement), &[0.4]);
    candidate.unwrap_or_else(|error| panic!("{}: {error}", placement.effect.name)).unwrap()
}

/// The shipped library.
fn library() -> Library {
    Library::shipped()
}

/// The samples of the signal v with some parameters set.
fn velocity(patch: &Patch, set: &[(String, f64)]) -> Vec<f64> {
    samples(patch, set, "v")
}

/// The samples of a signal with some parameters set.
fn samples(patch: &Patch, set: &[(String, f64)], signal: &str) -> Vec<f64> {
    run(patch, set).values(signal).unwrap()
}

/// Runs a patch with some parameters set, with the settings of the patch.
fn run(patch: &Patch, set: &[(String, f64)]) -> Trace {
    let circuit = Circuit::with_parameters(patch, set.iter().cloned())
        .unwrap_or_else(|report| panic!("{}\n{report}", patch.text()));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap();
    solve::run(&program, &settings).unwrap()
}

/// Asserts that the common samples of two sequences differ by less than `tolerance`.
fn assert_follows(found: &[f64], expected: &[f64], tolerance: f64) {
    for (sample, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < tolerance, "sample {sample}: {found} {expected}");
    }
}

#[test]
fn the_force_velocity_and_position_of_a_junction_are_identified() {
    for is_upright in [true, false] {
        let sites = sites(&mass(is_upright));
        let [junction] = sites.junctions.as_slice() else { panic!("{sites:?}") };
        assert_eq!(
            (junction.integrator.as_str(), junction.is_noninverted, junction.is_motion),
            ("IV", is_upright, true)
        );
        assert_eq!(junction.output.signal, "v");
        assert_eq!(junction.sum.signal.as_ref().map(|scaled| scaled.signal.as_str()), Some("net_force"));
        assert_eq!(
            (junction.sum.setting.as_deref(), junction.sum.gain),
            (Some("(force / velocity / m / 10)"), 10.0)
        );
        assert_eq!(junction.positions.iter().map(|scaled| scaled.signal.as_str()).collect::<Vec<_>>(), ["x"]);
        assert_eq!(junction.loads.iter().map(|scaled| scaled.signal.as_str()).collect::<Vec<_>>(), ["F"]);
    }
}

#[test]
fn every_effect_can_be_wired_into_every_system_with_parameters_at_the_ends_of_their_ranges() {
    let mut circuits = 0;
    for system in std::fs::read_dir("tests/systems").unwrap() {
        let patch = Patch::read(system.unwrap().path()).unwrap();
        let sites = sites(&patch);
        for effect in library().iter() {
            for placement in EffectPlacement::all(effect, &sites) {
                let candidate = candidate(&placement, &patch);
                let ends = |end: usize| {
                    let parameters = candidate.graft.parameters.iter();
                    parameters
                        .map(move |parameter| (parameter.name.clone(), parameter.range[end]))
                        .collect::<Vec<_>>()
                };
                for set in [Vec::new(), ends(0), ends(1)] {
                    let circuit = Circuit::with_parameters(&candidate.graft.patch, set);
                    let circuit =
                        circuit.unwrap_or_else(|report| panic!("{}\n{report}", candidate.graft.patch.text()));
                    Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
                    circuits += 1;
                }
            }
        }
    }
    assert!(circuits > 300, "{circuits}");
}

/// Each form that fits the mass runs with its last start values, in both patches.
#[test]
fn the_signs_of_the_wiring_do_not_change_the_effect() {
    let patches = [mass(true), mass(false)];
    let sites_of_both = patches.each_ref().map(sites);
    let without_effect = patches.each_ref().map(|patch| velocity(patch, &[]));
    let mut active = 0;
    for effect in library().iter() {
        let [plus, minus] = sites_of_both.each_ref().map(|sites| EffectPlacement::all(effect, sites));
        assert_eq!(plus.len(), minus.len());
        for (plus, minus) in plus.iter().zip(&minus) {
            let [upright, inverted] =
                [(plus, &patches[0]), (minus, &patches[1])].map(|(placement, patch)| {
                    let candidate = candidate(placement, patch);
                    let start = candidate.starts.last().unwrap();
                    let names = candidate.graft.parameters.iter().map(|parameter| parameter.name.clone());
                    velocity(&candidate.graft.patch, &names.zip(start.iter().copied()).collect::<Vec<_>>())
                });
            let difference = upright.iter().zip(&inverted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(difference < 1e-9, "{}: {difference}", effect.name);
            let influence =
                upright.iter().zip(&without_effect[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            active += usize::from(influence > 1e-4);
        }
    }
    assert!(active > 15, "{active}");
}

/// The pot in front of the integrator may drive other elements, too. Their input must stay the same.
#[test]
fn a_changed_mass_does_not_affect_other_elements_driven_by_the_same_pot() {
    let library = library();
    let effect = library.get("mass-change").unwrap();
    for jacks in [r#""x10": ["PM"]"#, r#""x10": ["PM"], "brake_x10": ["PB"]"#] {
        let text = mass(false).text().replace(r#""x10": ["PM"]"#, jacks);
        let text = text.replace(r#""force / velocity / m / 10""#, "0.25");
        let lag = r#""PB": {"kind": "pot", "in": "+100", "setting": 0.01},
            "LA": {"kind": "lag", "in": {"x1": ["PM"]}, "time": 0.1}, "BV":"#;
        let text = text.replace(r#""BV":"#, lag);
        let text = text.replace(r#""signals": {"#, r#""signals": {"lagged": {"at": "LA"}, "#);
        let patch = Patch::parse("lagged.json", &text).unwrap_or_else(|report| panic!("{report}"));
        let sites = sites(&patch);
        let heavier = candidate(&EffectPlacement::all(effect, &sites)[0], &patch).graft.patch;
        let set = [("r", 0.7), ("t1", 0.12)].map(|(name, value)| (name.to_owned(), value));
        assert_follows(&samples(&heavier, &set, "lagged"), &samples(&patch, &[], "lagged"), 1e-6);
        assert_ne!(velocity(&heavier, &set), velocity(&patch, &[]), "{jacks}");
    }
}

/// The input of a pot may be one name or a list with one name.
#[test]
fn a_changed_mass_is_wired_in_front_of_the_rate_pot_in_either_spelling() {
    let library = library();
    let effect = library.get("mass-change").unwrap();
    let braked = r#"{"x10": ["PM"], "brake_x10": ["PB"]}"#;
    for (input, brake) in [(r#""SF""#, r#""+100""#), (r#"["SF"]"#, r#"["+100"]"#)] {
        let text = mass(false).text().replace(r#"{"x10": ["PM"]}"#, braked);
        let text = text.replace(r#""in": "SF""#, &format!(r#""in": {input}"#));
        let brake = format!(r#""PB": {{"kind": "pot", "in": {brake}, "setting": 0.01}}, "BV":"#);
        let patch = Patch::parse("braked.json", &text.replace(r#""BV":"#, &brake)).unwrap();
        let sites = sites(&patch);
        let heavier = candidate(&EffectPlacement::all(effect, &sites)[0], &patch).graft.patch;
        let wired = &heavier.value()["elements"]["IV"]["in"];
        assert_eq!((&wired["x10"][0], &wired["brake_x10"][0]), (&"PM".into(), &"PB".into()), "{input}");
    }
}

/// A parameter and a drive may have the same name. Rewiring the drive must not rename the parameter.
#[test]
fn a_setting_with_the_name_of_a_rewired_drive_is_unchanged() {
    let text = mass(true).text().replace(r#""x1": ["F"]"#, r#""x1": ["LF"]"#);
    let text = text.replace(r#""SF":"#, r#""LF": {"kind": "lag", "in": {"x1": ["F"]}, "time": "F"}, "SF":"#);
    let text = text.replace(r#""m": {"#, r#""F": {"value": 0.1, "unit": "s"}, "m": {"#);
    let patch = Patch::parse("same-name.json", &text).unwrap();
    let (sites, library) = (sites(&patch), library());
    let placements = EffectPlacement::all(library.get("saturation").unwrap(), &sites);
    let wired = candidate(&placements[0], &patch).graft.patch;
    let lag = &wired.value()["elements"]["LF"];
    assert_eq!(lag["time"], "F");
    assert_ne!(lag["in"]["x1"][0], "F");
    assert!(Circuit::new(&wired).is_ok());
}

/// Two inverters that drive each other have no source. The search for one must end.
#[test]
fn a_ring_of_inverters_is_not_a_junction() {
    let text = mass(false).text().replace(
        r#""PM":"#,
        r#""R1": {"kind": "inverter", "in": "R2"}, "R2": {"kind": "inverter", "in": "R1"},
    "R3": {"kind": "inverter", "in": "R1"}, "IR": {"kind": "integrator", "in": {"x1": ["R3"]}}, "PM":"#,
    );
    let patch = Patch::parse("ring.json", &text).unwrap();
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let sites = Sites::of(&circuit, &["F"]);
    assert_eq!(
        sites.junctions.iter().map(|junction| junction.integrator.as_str()).collect::<Vec<_>>(),
        ["IV"]
    );
}

/// A friction level that only a parameter sets has the unit N, but it is not a force. A dead zone of it would be a
/// bias.
#[test]
fn a_signal_that_only_parameters_set_is_not_a_force() {
    let text = mass(true)
        .text()
        .replace(r#""PM":"#, r#""PF": {"kind": "pot", "in": "+100", "setting": 0.05}, "PM":"#);
    let level = r#""net_force": {"at""#;
    let text = text.replace(level, &format!(r#""level": {{"at": "PF", "scale": "force"}}, {level}"#));
    let patch = Patch::parse("level.json", &text).unwrap();
    assert!(patch.signals.contains_key("level"));
    let names =
        |readings: &[ScaledSignal]| readings.iter().map(|scaled| scaled.signal.clone()).collect::<Vec<_>>();
    let junction = &sites(&patch).junctions[0];
    assert_eq!((names(&junction.forces), names(&junction.loads)), (vec![], vec!["F".to_owned()]));
}

#[test]
fn a_file_adds_an_effect_to_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string("../../patches/effects/viscous-friction.json").unwrap();
    let text = text.replace("Viscous friction", "Treacle");
    std::fs::write(folder.path().join("treacle.json"), text).unwrap();
    let library = library().with_folder(folder.path()).unwrap();
    assert_eq!(library.iter().count(), Library::shipped().iter().count() + 1);
    let patch = mass(true);
    let sites = sites(&patch);
    let placements = EffectPlacement::all(library.get("treacle").unwrap(), &sites);
    let candidate = candidate(&placements[0], &patch);
    assert_eq!(candidate.graft.parameters[0].unit, "N s/m");
    assert!(Circuit::new(&candidate.graft.patch).is_ok());
}

#[test]
fn errors_of_an_effect_file_are_reported_with_their_positions() {
    let error_of = |text: &str| Effect::parse("wrong.json", text).unwrap_err().to_string();
    let found = error_of("{\"effect\": 1}");
    for key in ["title", "law", "physics", "source", "excitation", "forms"] {
        assert!(found.contains(&format!("an effect needs \"{key}\"")), "{found}");
    }
    assert!(error_of("{\"x\": 1}").contains("an effect needs \"effect\""));
    let good = std::fs::read_to_string("../../patches/effects/viscous-friction.json").unwrap();
    let parameter = |number: usize| {
        format!(r#""q{number}": {{"reach": "1", "range": [0, 1], "start": [1], "description": "q"}}, "#)
    };
    let many = format!("\"parameters\": {{{}", (0..12).map(parameter).collect::<String>());
    let wrong = [
        ("\"motion\"", "\"moton\"", "\"moton\" is not one of motion, store, sum, drive, level, total"),
        ("\"range\": [", "\"range\": [9e9, ", "\"range\" takes two numbers, the second above the first"),
        ("\"reach\": \"", "\"reach\": \"+", "wrong.json:"),
        ("\"at\": \"motion\",", "\"at\": \"motion\", \"free\": [\"A9\"],", "the form has no element A9"),
        ("\"parameters\": {", many.as_str(), "an effect may have at most 12 parameters"),
    ];
    for (old, new, message) in wrong {
        assert!(good.contains(old));
        let found = error_of(&good.replacen(old, new, 1));
        assert!(found.contains(message) && found.contains("wrong.json:"), "{found}");
    }
}

#[test]
fn the_effects_page_is_up_to_date() {
    crate::common::files::assert_up_to_date(
        "docs/effects.md",
        patchcord_ident::report::effect_page::library_markdown(&Library::shipped()).as_bytes(),
        "patchcord-ident",
    );
}
