//! Effects wired into patches: they attach where units agree, work with any signs of the wiring, and follow their laws.
//!
//! The laws are compared with closed solutions, or with solutions by the integrator of runge_kutta.rs.

use crate::runge_kutta::integrate;
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

/// Extents of the parameters at a place: every signal spans -40 ... 40 V, times 0.01 ... 3 s.
fn extents(attached: &EffectPlacement<'_>) -> Vec<QuantitySize> {
    let extent = |role: FormulaQuantity<'_>| Some(Extent::of([-40.0, 40.0]).times(role.per_volt()));
    attached.site.quantity_sizes(extent, 0.01, 3.0)
}

/// The candidate of an attached effect.
fn candidate(attached: &EffectPlacement<'_>, patch: &Patch) -> Candidate {
    let candidate = Candidate::new(attached, patch, &extents(attached), &[0.4]);
    candidate.unwrap_or_else(|error| panic!("{}: {error}", attached.effect.name)).unwrap()
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
        assert_eq!(junction.sum.signal.as_ref().map(|reading| reading.signal.as_str()), Some("net_force"));
        assert_eq!(
            (junction.sum.setting.as_deref(), junction.sum.gain),
            (Some("(force / velocity / m / 10)"), 10.0)
        );
        assert_eq!(
            junction.positions.iter().map(|reading| reading.signal.as_str()).collect::<Vec<_>>(),
            ["x"]
        );
        assert_eq!(junction.loads.iter().map(|reading| reading.signal.as_str()).collect::<Vec<_>>(), ["F"]);
    }
}

#[test]
fn every_effect_can_be_wired_into_every_system_with_parameters_at_the_ends_of_their_ranges() {
    let mut circuits = 0;
    for system in std::fs::read_dir("tests/systems").unwrap() {
        let patch = Patch::read(system.unwrap().path()).unwrap();
        let sites = sites(&patch);
        for effect in library().iter() {
            for attached in EffectPlacement::all(effect, &sites) {
                let candidate = candidate(&attached, &patch);
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
            let [upright, inverted] = [(plus, &patches[0]), (minus, &patches[1])].map(|(attached, patch)| {
                let candidate = candidate(attached, patch);
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

/// The velocity of the mass with the first form of an effect at the first place that it fits.
fn with_effect(effect: &str, set: &[(&str, f64)]) -> Vec<f64> {
    with_form(effect, "", set)
}

/// The same with the first form whose note contains `note`.
fn with_form(effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    samples_with(&mass(false), "v", effect, note, set)
}

/// The samples of a signal of a patch with an effect at the first place that it fits.
fn samples_with(patch: &Patch, signal: &str, effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    run_with(patch, effect, note, set).values(signal).unwrap()
}

/// Runs a patch with the first form of an effect whose note contains `note`, and with its parameters set.
fn run_with(patch: &Patch, effect: &str, note: &str, set: &[(&str, f64)]) -> Trace {
    let (library, sites) = (library(), sites(patch));
    let attachments = EffectPlacement::all(library.get(effect).unwrap(), &sites);
    let attached = attachments.iter().find(|attached| attached.form.note.contains(note)).unwrap();
    let candidate = candidate(attached, patch);
    let set: Vec<_> = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    run(&candidate.graft.patch, &set)
}

#[test]
fn bias_drift_and_viscous_friction_follow_their_laws() {
    let free = with_effect("constant-bias", &[("b", 0.0)]);
    let biased = with_effect("constant-bias", &[("b", 0.8)]);
    let drifting = with_effect("drift", &[("r", 0.2)]);
    let (end, tau) = (0.9, 0.7);
    let settling = with_form("drift", "settles", &[("end", end), ("T", tau)]);
    let drag = with_effect("viscous-friction", &[("c", 2.0)]);
    let (m, omega) = (2.0, 2.0 * std::f64::consts::PI);
    for (sample, free) in free.iter().enumerate() {
        let t = sample as f64 * 0.01;
        assert!((biased[sample] - free - 0.8 * t / m).abs() < 1e-9);
        assert!((drifting[sample] - free - 0.1 * t * t / m).abs() < 1e-9);
        let settled = end * (t - tau * (1.0 - (-t / tau).exp())) / m;
        assert!(
            (settling[sample] - free - settled).abs() < 1e-9,
            "{t}: {} {settled}",
            settling[sample] - free
        );
        // m v' + c v = 10 sin(omega t + 1), v(0) = 0.
        let (c, amplitude) = (2.0, 10.0 / (m * omega).hypot(2.0));
        let lag = 1.0 - (m * omega / c).atan();
        let exact = amplitude * ((omega * t + lag).sin() - lag.sin() * (-c * t / m).exp());
        assert!((drag[sample] - exact).abs() < 1e-8, "{t}: {} {exact}", drag[sample]);
    }
    let stuck = with_effect("coulomb-friction", &[("Fc", 1.9)]);
    assert!(stuck.iter().zip(&free).any(|(stuck, free)| (stuck - free).abs() > 0.1));
}

/// A summer of the effect saturates by design when the mass presses into the stop. Its overload lamp must be suppressed.
#[test]
fn a_compressed_stop_reports_no_overload() {
    let patch = mass(false);
    let maximum = |samples: &[f64]| samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let xs = 0.5 * maximum(&samples(&patch, &[], "x"));
    let stopped = run_with(&patch, "hard-stop", "upper", &[("xs", xs), ("k", 20.0), ("tau", 0.005)]);
    let depth = maximum(&stopped.values("x").unwrap()) - xs;
    assert!(depth > 0.12, "at 10 V/cm the summer must exceed 100 V: {depth} m");
    assert_eq!(
        stopped.overloads().map(|overload| &overload.element).collect::<Vec<_>>(),
        Vec::<&String>::new()
    );
}

/// The force of the drive in N at a time in s.
fn force(t: f64) -> f64 {
    10.0 * (2.0 * std::f64::consts::PI * t + 1.0).sin()
}

/// The exact velocity every 0.01 s, while it is not negative. The velocity is the first state.
fn forward_velocity<const N: usize>(
    initial: [f64; N],
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<f64> {
    let exact = integrate(initial, (0.01, 100), rates).into_iter().map(|state| state[0]);
    let velocity: Vec<f64> = exact.take_while(|velocity| *velocity >= 0.0).collect();
    assert!(velocity.len() > 20, "{velocity:?}");
    velocity
}

/// Asserts that the common samples of two sequences differ by less than `tolerance`.
fn assert_follows(found: &[f64], expected: &[f64], tolerance: f64) {
    for (sample, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < tolerance, "sample {sample}: {found} {expected}");
    }
}

#[test]
fn the_soft_dead_zone_and_bell_shaped_friction_follow_their_laws() {
    let (m, b) = (2.0, 2.5);
    let soft = with_form("drive-dead-zone", "soft", &[("b", b)]);
    let exact = forward_velocity([0.0], |t, _| [(force(t) - b * (force(t) / b).tanh()) / m]);
    // The tolerance is the error of the piecewise linear tanh.
    assert_follows(&soft, &exact, 2e-4);
    let (fc, df, vs, tc) = (1.0, 2.0, 0.3, 0.04);
    let level = |v: f64| fc + df * (-(v / vs).powi(2)).exp();
    let stribeck = [("Fc", fc), ("dF", df), ("Vs", vs)];
    let bell = with_form("stribeck-friction", "bell", &stribeck);
    assert_follows(&bell, &forward_velocity([0.0], |t, [v]| [(force(t) - level(v)) / m]), 1e-8);
    let lagged = with_form("friction-memory", "bell", &[stribeck.as_slice(), &[("Tc", tc)]].concat());
    let exact = forward_velocity([0.0, level(0.0)], |t, [v, f]| [(force(t) - f) / m, (level(v) - f) / tc]);
    assert_follows(&lagged, &exact, 1e-8);
}

/// Friction enters the integrator next to the sum of forces. The gain that contains the mass must change for both.
#[test]
fn a_changed_mass_also_applies_to_a_friction_effect() {
    let (mass, library) = (mass(false), library());
    let wired = |patch: &Patch, effect: &str| {
        let sites = sites(patch);
        candidate(&EffectPlacement::all(library.get(effect).unwrap(), &sites)[0], patch)
    };
    let with_friction = wired(&mass, "coulomb-friction");
    let with_both = wired(&with_friction.graft.patch, "mass-change");
    let (fc, r, t1) = (3.0, 0.7, 0.12);
    let set = [("Fc", fc), ("r", r), ("t1", t1)].map(|(name, value)| (name.to_owned(), value));
    let found = velocity(&with_both.graft.patch, &set);
    let rates = |t: f64, [_]: [f64; 1]| [(force(t) - fc) / (2.0 * if t < t1 - 1e-9 { 1.0 } else { 1.0 + r })];
    assert_follows(&found, &forward_velocity([0.0], rates), 1e-4);
    // After a fit, further starts have neighbouring values of the time t1 and the same r.
    let neighbours = with_both.neighbours(&[r, 1.0]);
    assert!(neighbours.len() >= 4);
    assert!(neighbours.iter().all(|start| start[0] == r && (start[1] - 1.0).abs() < 0.13));
    assert!(with_friction.neighbours(&[fc]).is_empty());
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

/// Water above the weir of the upper tank flows over it, and a share of it into the lower tank.
#[test]
fn the_overflow_weir_follows_its_law() {
    let tanks = Patch::read("tests/systems/tanks.json").unwrap();
    let (w, l, s) = (5e-3, 0.1, 0.6);
    let set = [("w", w), ("L", l), ("s", s)];
    let (ku, areas, resistance) = (2e-5, [0.02, 0.03], 1500.0);
    let rates = |t: f64, [upper, lower]: [f64; 2]| {
        let pump = ku * (5.0 + 4.0 * (0.02 * std::f64::consts::PI * t).sin());
        let overflow = w * (upper - l).max(0.0).powf(1.5);
        let outflow = upper / resistance;
        [(pump - outflow - overflow) / areas[0], (outflow - lower / resistance + s * overflow) / areas[1]]
    };
    let exact = integrate([0.0; 2], (1.0, 600), rates);
    for (tank, signal) in ["h1", "h2"].into_iter().enumerate() {
        let found = samples_with(&tanks, signal, "overflow", "weir, a share", &set);
        let exact: Vec<f64> = exact.iter().map(|levels| levels[tank]).collect();
        assert_follows(&found, &exact, 1e-6);
    }
}

/// The second effect is wired in front of the first one, so the first one acts on its output.
#[test]
fn two_effects_in_one_drive_act_in_series() {
    let (mass, library) = (mass(false), library());
    let wired = |patch: &Patch, effect: &str, note: &str| {
        let sites = sites(patch);
        let attachments = EffectPlacement::all(library.get(effect).unwrap(), &sites);
        candidate(attachments.iter().find(|attached| attached.form.note.contains(note)).unwrap(), patch)
    };
    let limited = wired(&mass, "saturation", "hard");
    let both = wired(&limited.graft.patch, "drive-dead-zone", "");
    let (l, b) = (4.0, 3.0);
    let set = [("L", l), ("b", b)].map(|(name, value)| (name.to_owned(), value));
    let found = velocity(&both.graft.patch, &set);
    let rates =
        |t: f64, [_]: [f64; 1]| [(force(t).signum() * (force(t).abs() - b).max(0.0)).clamp(-l, l) / 2.0];
    let exact: Vec<f64> =
        integrate([0.0], (0.01, 301), rates).into_iter().map(|[velocity]| velocity).collect();
    assert_follows(&found, &exact, 1e-3);
    let one_effect: Vec<f64> = velocity(&limited.graft.patch, &set[..1]);
    assert!(one_effect.iter().zip(&found).any(|(one, both)| (one - both).abs() > 0.05));
}

/// A parameter and a drive may have the same name. Rewiring the drive must not rename the parameter.
#[test]
fn a_setting_with_the_name_of_a_rewired_drive_is_unchanged() {
    let text = mass(true).text().replace(r#""x1": ["F"]"#, r#""x1": ["LF"]"#);
    let text = text.replace(r#""SF":"#, r#""LF": {"kind": "lag", "in": {"x1": ["F"]}, "time": "F"}, "SF":"#);
    let text = text.replace(r#""m": {"#, r#""F": {"value": 0.1, "unit": "s"}, "m": {"#);
    let patch = Patch::parse("same-name.json", &text).unwrap();
    let (sites, library) = (sites(&patch), library());
    let attachments = EffectPlacement::all(library.get("saturation").unwrap(), &sites);
    let wired = candidate(&attachments[0], &patch).graft.patch;
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

/// A friction level that only a parameter sets has the unit N, but it is not a force. A dead zone of it would be a bias.
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
        |readings: &[ScaledSignal]| readings.iter().map(|reading| reading.signal.clone()).collect::<Vec<_>>();
    let junction = &sites(&patch).junctions[0];
    assert_eq!((names(&junction.forces), names(&junction.loads)), (vec![], vec!["F".to_owned()]));
}

#[test]
fn static_friction_growth_follows_its_law_and_ends_when_the_mass_slides() {
    assert_friction_grows("settles, and is broken as soon", 3.0, |t| 1.0 - (-t).exp());
    assert_friction_grows("as a logarithm", 1.2, f64::ln_1p);
}

/// Asserts that the mass, once at rest, is held until the force exceeds Fc + dF s, and that friction is then Fc at once.
///
/// `share` is s as a function of the time at rest over Tg.
fn assert_friction_grows(note: &str, df: f64, share: impl Fn(f64) -> f64) {
    let (fc, tg, m, omega) = (6.0, 0.05, 2.0, 2.0 * std::f64::consts::PI);
    let velocity = with_form("static-friction-growth", note, &[("dF", df), ("Tg", tg), ("Fc", fc)]);
    let rests: Vec<usize> = (1..velocity.len()).filter(|sample| velocity[*sample] == 0.0).collect();
    let rests: Vec<&[usize]> = rests.chunk_by(|one, next| one + 1 == *next).collect();
    assert!(rests.len() > 3, "{note}: {rests:?}");
    for rest in &rests[..rests.len() - 1] {
        let (first, last) = (rest[0], rest[rest.len() - 1]);
        let level = |samples: usize| fc + df * share(samples as f64 * 0.01 / tg);
        let force_at = |sample: usize| force(sample as f64 * 0.01).abs();
        assert!(force_at(last) < level(last - first + 1), "{note}: the mass moves too late");
        assert!(force_at(last + 1) > level(last - first), "{note}: the mass moves too early");
        // m v' = F - Fc from the next sample on.
        let (from, to) = (last + 2, last + 6);
        let impulse = |sample: usize| -10.0 / omega * (omega * sample as f64 * 0.01 + 1.0).cos();
        let momentum = impulse(to) - impulse(from) - fc * 0.04 * velocity[to].signum();
        assert!((m * (velocity[to] - velocity[from]) - momentum).abs() < 1e-6, "{note}: {first} ... {last}");
    }
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
    let attached = EffectPlacement::all(library.get("treacle").unwrap(), &sites);
    let candidate = candidate(&attached[0], &patch);
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
