//! Effects wired into patches: they attach where dimensions fit, whatever the signs of the wiring, and follow their laws.

use crate::integrated::integrated;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;
use patchcord_ident::effects::attach::{Attached, Role};
use patchcord_ident::effects::candidate::Candidate;
use patchcord_ident::effects::reach::{Extent, Largest};
use patchcord_ident::effects::sites::{Reading, Sites};
use patchcord_ident::effects::{Effect, Library};

/// A mass of 2 kg pushed by a force of 10 N times a sine of 1 Hz; its integrator gives velocity with one sign or the other.
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

fn sites(patch: &Patch) -> Sites {
    let circuit = Circuit::new(patch, &[]).unwrap_or_else(|report| panic!("{report}"));
    let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
    Sites::of(&circuit, &drives)
}

/// What is largest at a place, what 40 V stand for, and times.
fn largest(attached: &Attached<'_>) -> Vec<Largest> {
    let extent = |role: Role<'_>| Some(Extent::of([-40.0, 40.0]).times(role.per_volt()));
    attached.place.largest(extent, 0.01, 3.0)
}

fn candidate(attached: &Attached<'_>, patch: &Patch) -> Candidate {
    let made = Candidate::new(attached, patch, &largest(attached), &[0.4]);
    made.unwrap_or_else(|error| panic!("{}: {error}", attached.effect.name)).unwrap()
}

fn library() -> Library {
    Library::shipped()
}

fn velocity(patch: &Patch, set: &[(String, f64)]) -> Vec<f64> {
    track(patch, set, "v")
}

fn track(patch: &Patch, set: &[(String, f64)], signal: &str) -> Vec<f64> {
    ran(patch, set).values(signal).unwrap()
}

fn ran(patch: &Patch, set: &[(String, f64)]) -> Trace {
    let circuit = Circuit::new(patch, set).unwrap_or_else(|report| panic!("{}\n{report}", patch.text()));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap();
    solve::run(&program, &settings).unwrap()
}

#[test]
fn a_junction_knows_its_force_its_velocity_and_its_position() {
    for is_upright in [true, false] {
        let sites = sites(&mass(is_upright));
        let [junction] = sites.junctions.as_slice() else { panic!("{sites:?}") };
        assert_eq!(
            (junction.integrator.as_str(), junction.is_upright, junction.is_motion),
            ("IV", is_upright, true)
        );
        assert_eq!(junction.own.signal, "v");
        assert_eq!(junction.sum.of.as_ref().map(|of| of.signal.as_str()), Some("net_force"));
        assert_eq!(
            (junction.sum.setting.as_deref(), junction.sum.gain),
            (Some("(force / velocity / m / 10)"), 10.0)
        );
        assert_eq!(junction.positions.iter().map(|own| own.signal.as_str()).collect::<Vec<_>>(), ["x"]);
        assert_eq!(junction.loads.iter().map(|own| own.signal.as_str()).collect::<Vec<_>>(), ["F"]);
    }
}

#[test]
fn every_effect_fits_into_every_system_at_the_ends_of_its_ranges() {
    let mut fitted = 0;
    for system in std::fs::read_dir("tests/systems").unwrap() {
        let patch = Patch::read(&system.unwrap().path()).unwrap();
        let sites = sites(&patch);
        for effect in library().iter() {
            for attached in Attached::all(effect, &sites) {
                let candidate = candidate(&attached, &patch);
                let ends = |end: usize| {
                    let parameters = candidate.graft.parameters.iter();
                    parameters.map(move |own| (own.name.clone(), own.range[end])).collect::<Vec<_>>()
                };
                for set in [Vec::new(), ends(0), ends(1)] {
                    let circuit = Circuit::new(&candidate.graft.patch, &set);
                    let circuit =
                        circuit.unwrap_or_else(|report| panic!("{}\n{report}", candidate.graft.patch.text()));
                    Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
                    fitted += 1;
                }
            }
        }
    }
    assert!(fitted > 300, "{fitted}");
}

/// Effects of every form that fits a mass, at the first start: what they do must not depend on the signs of the wiring.
#[test]
fn the_signs_of_the_wiring_do_not_matter() {
    let patches = [mass(true), mass(false)];
    let both = patches.each_ref().map(sites);
    let free = patches.each_ref().map(|patch| velocity(patch, &[]));
    let mut seen = 0;
    for effect in library().iter() {
        let [plus, minus] = both.each_ref().map(|sites| Attached::all(effect, sites));
        assert_eq!(plus.len(), minus.len());
        for (plus, minus) in plus.iter().zip(&minus) {
            let [one, other] = [(plus, &patches[0]), (minus, &patches[1])].map(|(attached, patch)| {
                let candidate = candidate(attached, patch);
                let start = candidate.starts.last().unwrap();
                let names = candidate.graft.parameters.iter().map(|own| own.name.clone());
                velocity(&candidate.graft.patch, &names.zip(start.iter().copied()).collect::<Vec<_>>())
            });
            let gap = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(gap < 1e-9, "{}: {gap}", effect.name);
            let moved = one.iter().zip(&free[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            seen += usize::from(moved > 1e-4);
        }
    }
    assert!(seen > 15, "{seen}");
}

/// The velocity with the first form of an effect at IV, its parameters set.
fn with(effect: &str, set: &[(&str, f64)]) -> Vec<f64> {
    with_form(effect, "", set)
}

/// The same with the form of which its file says so.
fn with_form(effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    track_with(&mass(false), "v", effect, note, set)
}

/// A signal of a patch with an effect at the first place that it fits.
fn track_with(patch: &Patch, signal: &str, effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    ran_with(patch, effect, note, set).values(signal).unwrap()
}

fn ran_with(patch: &Patch, effect: &str, note: &str, set: &[(&str, f64)]) -> Trace {
    let (library, sites) = (library(), sites(patch));
    let all = Attached::all(library.get(effect).unwrap(), &sites);
    let attached = all.iter().find(|attached| attached.form.note.contains(note)).unwrap();
    let candidate = candidate(attached, patch);
    let set: Vec<_> = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    ran(&candidate.graft.patch, &set)
}

#[test]
fn effects_follow_their_laws() {
    let free = with("constant-bias", &[("b", 0.0)]);
    let biased = with("constant-bias", &[("b", 0.8)]);
    let drifting = with("drift", &[("r", 0.2)]);
    let (end, tau) = (0.9, 0.7);
    let settling = with_form("drift", "settles", &[("end", end), ("T", tau)]);
    let drag = with("viscous-friction", &[("c", 2.0)]);
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
        // m v' + c v = 10 sin(omega t + 1), at rest at first.
        let (c, size) = (2.0, 10.0 / (m * omega).hypot(2.0));
        let lag = 1.0 - (m * omega / c).atan();
        let exact = size * ((omega * t + lag).sin() - lag.sin() * (-c * t / m).exp());
        assert!((drag[sample] - exact).abs() < 1e-8, "{t}: {} {exact}", drag[sample]);
    }
    let stuck = with("coulomb-friction", &[("Fc", 1.9)]);
    assert!(stuck.iter().zip(&free).any(|(stuck, free)| (stuck - free).abs() > 0.1));
}

/// The summer for losses saturates in it by design.
#[test]
fn a_stop_that_is_pressed_lights_no_lamp() {
    let patch = mass(false);
    let most = |track: &[f64]| track.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let xs = 0.5 * most(&track(&patch, &[], "x"));
    let stopped = ran_with(&patch, "hard-stop", "upper", &[("xs", xs), ("k", 20.0), ("tau", 0.005)]);
    let pressed = most(&stopped.values("x").unwrap()) - xs;
    assert!(pressed > 0.12, "the summer, 10 V a centimetre, would come to more than 100 V: {pressed} m");
    assert_eq!(stopped.overloads().map(|own| &own.element).collect::<Vec<_>>(), Vec::<&String>::new());
}

/// The force of the drive.
fn push(t: f64) -> f64 {
    10.0 * (2.0 * std::f64::consts::PI * t + 1.0).sin()
}

/// The velocity, which comes first in a state, as long as the mass slides forth.
fn sliding<const N: usize>(first: [f64; N], rates: impl Fn(f64, [f64; N]) -> [f64; N]) -> Vec<f64> {
    let all = integrated(first, (0.01, 100), rates).into_iter().map(|state| state[0]);
    let velocity: Vec<f64> = all.take_while(|velocity| *velocity >= 0.0).collect();
    assert!(velocity.len() > 20, "{velocity:?}");
    velocity
}

fn assert_follows(found: &[f64], wanted: &[f64], within: f64) {
    for (sample, (found, wanted)) in found.iter().zip(wanted).enumerate() {
        assert!((found - wanted).abs() < within, "sample {sample}: {found} {wanted}");
    }
}

#[test]
fn soft_dead_zones_and_friction_that_falls_as_a_bell_follow_their_laws() {
    let (m, b) = (2.0, 2.5);
    let soft = with_form("drive-dead-zone", "soft", &[("b", b)]);
    let exact = sliding([0.0], |t, _| [(push(t) - b * (push(t) / b).tanh()) / m]);
    // As near as a curve of straight lines comes to tanh.
    assert_follows(&soft, &exact, 2e-4);
    let (fc, df, vs, tc) = (1.0, 2.0, 0.3, 0.04);
    let level = |v: f64| fc + df * (-(v / vs).powi(2)).exp();
    let falling = [("Fc", fc), ("dF", df), ("Vs", vs)];
    let bell = with_form("stribeck-friction", "bell", &falling);
    assert_follows(&bell, &sliding([0.0], |t, [v]| [(push(t) - level(v)) / m]), 1e-8);
    let late = with_form("friction-memory", "bell", &[falling.as_slice(), &[("Tc", tc)]].concat());
    let exact = sliding([0.0, level(0.0)], |t, [v, f]| [(push(t) - f) / m, (level(v) - f) / tc]);
    assert_follows(&late, &exact, 1e-8);
}

/// Where friction drives the integrator beside the sum of forces, what turns mass into velocity changes for both.
#[test]
fn a_changed_mass_is_slow_to_be_braked_too() {
    let (mass, library) = (mass(false), library());
    let wired = |patch: &Patch, effect: &str| {
        let sites = sites(patch);
        candidate(&Attached::all(library.get(effect).unwrap(), &sites)[0], patch)
    };
    let rough = wired(&mass, "coulomb-friction");
    let heavier = wired(&rough.graft.patch, "mass-change");
    let (fc, r, t1) = (3.0, 0.7, 0.12);
    let set = [("Fc", fc), ("r", r), ("t1", t1)].map(|(name, value)| (name.to_owned(), value));
    let found = velocity(&heavier.graft.patch, &set);
    let rates = |t: f64, [_]: [f64; 1]| [(push(t) - fc) / (2.0 * if t < t1 - 1e-9 { 1.0 } else { 1.0 + r })];
    assert_follows(&found, &sliding([0.0], rates), 1e-4);
    // Fits that ended at one time are tried from times beside it.
    let beside = heavier.beside(&[r, 1.0]);
    assert!(beside.len() >= 4 && beside.iter().all(|own| own[0] == r && (own[1] - 1.0).abs() < 0.13));
    assert!(rough.beside(&[fc]).is_empty());
}

/// What the potentiometer before an integrator drives besides goes on as before.
#[test]
fn a_changed_mass_leaves_alone_what_is_driven_beside_it() {
    let library = library();
    let effect = library.get("mass-change").unwrap();
    for jacks in [r#""x10": ["PM"]"#, r#""x10": ["PM"], "brake_x10": ["PB"]"#] {
        let text = mass(false).text().replace(r#""x10": ["PM"]"#, jacks);
        let text = text.replace(r#""force / velocity / m / 10""#, "0.25");
        let beside = r#""PB": {"kind": "pot", "in": "+100", "setting": 0.01},
            "LA": {"kind": "lag", "in": {"x1": ["PM"]}, "time": 0.1}, "BV":"#;
        let text = text.replace(r#""BV":"#, beside);
        let text = text.replace(r#""signals": {"#, r#""signals": {"beside": {"at": "LA"}, "#);
        let patch = Patch::parse("beside.json", &text).unwrap_or_else(|report| panic!("{report}"));
        let sites = sites(&patch);
        let heavier = candidate(&Attached::all(effect, &sites)[0], &patch).graft.patch;
        let set = [("r", 0.7), ("t1", 0.12)].map(|(name, value)| (name.to_owned(), value));
        assert_follows(&track(&heavier, &set, "beside"), &track(&patch, &[], "beside"), 1e-6);
        assert_ne!(velocity(&heavier, &set), velocity(&patch, &[]), "{jacks}");
    }
}

/// A potentiometer's only cord may stand in a list.
#[test]
fn a_changed_mass_stands_before_what_sets_the_rate_however_that_is_written() {
    let library = library();
    let effect = library.get("mass-change").unwrap();
    let braked = r#"{"x10": ["PM"], "brake_x10": ["PB"]}"#;
    for (input, brake) in [(r#""SF""#, r#""+100""#), (r#"["SF"]"#, r#"["+100"]"#)] {
        let text = mass(false).text().replace(r#"{"x10": ["PM"]}"#, braked);
        let text = text.replace(r#""in": "SF""#, &format!(r#""in": {input}"#));
        let brake = format!(r#""PB": {{"kind": "pot", "in": {brake}, "setting": 0.01}}, "BV":"#);
        let patch = Patch::parse("braked.json", &text.replace(r#""BV":"#, &brake)).unwrap();
        let sites = sites(&patch);
        let heavier = candidate(&Attached::all(effect, &sites)[0], &patch).graft.patch;
        let wired = &heavier.value()["elements"]["IV"]["in"];
        assert_eq!((&wired["x10"][0], &wired["brake_x10"][0]), (&"PM".into(), &"PB".into()), "{input}");
    }
}

/// What stands above the weir of the upper tank runs over, some of it into the lower one.
#[test]
fn a_weir_follows_its_law() {
    let tanks = Patch::read("tests/systems/tanks.json".as_ref()).unwrap();
    let (w, l, s) = (5e-3, 0.1, 0.6);
    let set = [("w", w), ("L", l), ("s", s)];
    let (ku, areas, resistance) = (2e-5, [0.02, 0.03], 1500.0);
    let rates = |t: f64, [upper, lower]: [f64; 2]| {
        let pump = ku * (5.0 + 4.0 * (0.02 * std::f64::consts::PI * t).sin());
        let over = w * (upper - l).max(0.0).powf(1.5);
        let falls = upper / resistance;
        [(pump - falls - over) / areas[0], (falls - lower / resistance + s * over) / areas[1]]
    };
    let exact = integrated([0.0; 2], (1.0, 600), rates);
    for (place, signal) in ["h1", "h2"].into_iter().enumerate() {
        let found = track_with(&tanks, signal, "overflow", "weir, a share", &set);
        let exact: Vec<f64> = exact.iter().map(|levels| levels[place]).collect();
        assert_follows(&found, &exact, 1e-6);
    }
}

/// What is wired into a drive is itself wired behind what comes into that drive later.
#[test]
fn two_effects_in_one_drive_both_act() {
    let (mass, library) = (mass(false), library());
    let wired = |patch: &Patch, effect: &str, note: &str| {
        let sites = sites(patch);
        let all = Attached::all(library.get(effect).unwrap(), &sites);
        candidate(all.iter().find(|own| own.form.note.contains(note)).unwrap(), patch)
    };
    let limited = wired(&mass, "saturation", "hard");
    let both = wired(&limited.graft.patch, "drive-dead-zone", "");
    let (l, b) = (4.0, 3.0);
    let set = [("L", l), ("b", b)].map(|(name, value)| (name.to_owned(), value));
    let found = velocity(&both.graft.patch, &set);
    let rates =
        |t: f64, [_]: [f64; 1]| [(push(t).signum() * (push(t).abs() - b).max(0.0)).clamp(-l, l) / 2.0];
    let exact: Vec<f64> =
        integrated([0.0], (0.01, 301), rates).into_iter().map(|[velocity]| velocity).collect();
    assert_follows(&found, &exact, 1e-3);
    let alone: Vec<f64> = velocity(&limited.graft.patch, &set[..1]);
    assert!(alone.iter().zip(&found).any(|(alone, both)| (alone - both).abs() > 0.05));
}

/// Parameters and drives have names of their own, so that one of each may be called alike.
#[test]
fn a_setting_with_the_name_of_a_cord_stays() {
    let text = mass(true).text().replace(r#""x1": ["F"]"#, r#""x1": ["LF"]"#);
    let text = text.replace(r#""SF":"#, r#""LF": {"kind": "lag", "in": {"x1": ["F"]}, "time": "F"}, "SF":"#);
    let text = text.replace(r#""m": {"#, r#""F": {"value": 0.1, "unit": "s"}, "m": {"#);
    let patch = Patch::parse("alike.json", &text).unwrap();
    let (sites, library) = (sites(&patch), library());
    let all = Attached::all(library.get("saturation").unwrap(), &sites);
    let wired = candidate(&all[0], &patch).graft.patch;
    let lag = &wired.value()["elements"]["LF"];
    assert_eq!(lag["time"], "F");
    assert_ne!(lag["in"]["x1"][0], "F");
    assert!(Circuit::new(&wired, &[]).is_ok());
}

/// Inverters that drive one another have no beginning; whoever looks for one comes back.
#[test]
fn inverters_in_a_ring_are_no_place_and_no_trap() {
    let text = mass(false).text().replace(
        r#""PM":"#,
        r#""R1": {"kind": "inverter", "in": "R2"}, "R2": {"kind": "inverter", "in": "R1"},
    "R3": {"kind": "inverter", "in": "R1"}, "IR": {"kind": "integrator", "in": {"x1": ["R3"]}}, "PM":"#,
    );
    let patch = Patch::parse("ring.json", &text).unwrap();
    let circuit = Circuit::new(&patch, &[]).unwrap_or_else(|report| panic!("{report}"));
    let sites = Sites::of(&circuit, &["F"]);
    assert_eq!(sites.junctions.iter().map(|own| own.integrator.as_str()).collect::<Vec<_>>(), ["IV"]);
}

/// A friction level that a parameter sets is in newtons, but nothing pushes with it: a dead zone that it drives would be a bias.
#[test]
fn what_parameters_alone_make_is_no_force() {
    let text = mass(true)
        .text()
        .replace(r#""PM":"#, r#""PF": {"kind": "pot", "in": "+100", "setting": 0.05}, "PM":"#);
    let level = r#""net_force": {"at""#;
    let text = text.replace(level, &format!(r#""level": {{"at": "PF", "scale": "force"}}, {level}"#));
    let patch = Patch::parse("level.json", &text).unwrap();
    assert!(patch.signals.contains_key("level"));
    let names = |readings: &[Reading]| readings.iter().map(|own| own.signal.clone()).collect::<Vec<_>>();
    let junction = &sites(&patch).junctions[0];
    assert_eq!((names(&junction.forces), names(&junction.loads)), (vec![], vec!["F".to_owned()]));
}

#[test]
fn friction_that_grows_at_rest_is_torn_apart_as_it_slides() {
    assert_grows("settles, torn apart as soon", 3.0, |t| 1.0 - (-t).exp());
    assert_grows("as a logarithm", 1.2, f64::ln_1p);
}

/// Where the mass comes to rest it is held, until the force passes Fc + dF s, s as grown since then; then friction is Fc at once.
fn assert_grows(note: &str, df: f64, share: impl Fn(f64) -> f64) {
    let (fc, tg, m, omega) = (6.0, 0.05, 2.0, 2.0 * std::f64::consts::PI);
    let velocity = with_form("static-friction-growth", note, &[("dF", df), ("Tg", tg), ("Fc", fc)]);
    let rests: Vec<usize> = (1..velocity.len()).filter(|sample| velocity[*sample] == 0.0).collect();
    let rests: Vec<&[usize]> = rests.chunk_by(|one, next| one + 1 == *next).collect();
    assert!(rests.len() > 3, "{note}: {rests:?}");
    for rest in &rests[..rests.len() - 1] {
        let (first, last) = (rest[0], rest[rest.len() - 1]);
        let grown = |samples: usize| fc + df * share(samples as f64 * 0.01 / tg);
        let force = |sample: usize| push(sample as f64 * 0.01).abs();
        assert!(force(last) < grown(last - first + 1), "{note}: it is held as long as that");
        assert!(force(last + 1) > grown(last - first), "{note}: and no longer");
        // m v' = F - Fc from the next sample on.
        let (from, to) = (last + 2, last + 6);
        let pushed = |sample: usize| -10.0 / omega * (omega * sample as f64 * 0.01 + 1.0).cos();
        let gained = pushed(to) - pushed(from) - fc * 0.04 * velocity[to].signum();
        assert!((m * (velocity[to] - velocity[from]) - gained).abs() < 1e-6, "{note}: {first} ... {last}");
    }
}

#[test]
fn an_effect_of_ones_own_is_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string("../../patches/effects/viscous-friction.json").unwrap();
    let text = text.replace("Viscous friction", "Treacle");
    std::fs::write(folder.path().join("treacle.json"), text).unwrap();
    let library = library().and_folder(folder.path()).unwrap();
    assert_eq!(library.iter().count(), Library::shipped().iter().count() + 1);
    let patch = mass(true);
    let sites = sites(&patch);
    let attached = Attached::all(library.get("treacle").unwrap(), &sites);
    let candidate = candidate(&attached[0], &patch);
    assert_eq!(candidate.graft.parameters[0].unit, "N s/m");
    assert!(Circuit::new(&candidate.graft.patch, &[]).is_ok());
}

#[test]
fn a_wrong_effect_is_told_with_its_places() {
    let told = |text: &str| Effect::parse("wrong.json", text).unwrap_err().to_string();
    let found = told("{\"effect\": 1}");
    for key in ["title", "law", "physics", "source", "excitation", "forms"] {
        assert!(found.contains(&format!("an effect needs \"{key}\"")), "{found}");
    }
    assert!(told("{\"x\": 1}").contains("an effect needs \"effect\""));
    let good = std::fs::read_to_string("../../patches/effects/viscous-friction.json").unwrap();
    let own = |number: usize| {
        format!(r#""q{number}": {{"reach": "1", "range": [0, 1], "start": [1], "description": "q"}}, "#)
    };
    let many = format!("\"parameters\": {{{}", (0..12).map(own).collect::<String>());
    let wrong = [
        ("\"motion\"", "\"moton\"", "\"moton\" is none of motion, store, sum, drive, level, total"),
        ("\"range\": [", "\"range\": [9e9, ", "\"range\" takes two numbers, the second above the first"),
        ("\"reach\": \"", "\"reach\": \"+", "wrong.json:"),
        ("\"at\": \"motion\",", "\"at\": \"motion\", \"free\": [\"A9\"],", "the form has no element A9"),
        ("\"parameters\": {", many.as_str(), "an effect has 12 parameters at most"),
    ];
    for (old, new, message) in wrong {
        assert!(good.contains(old));
        let found = told(&good.replacen(old, new, 1));
        assert!(found.contains(message) && found.contains("wrong.json:"), "{found}");
    }
}

#[test]
fn the_page_of_effects_is_fresh() {
    crate::common::files::check_fresh(
        "docs/effects.md",
        patchcord_ident::report::effect_page::library_markdown(&Library::shipped()).as_bytes(),
        "patchcord-ident",
    );
}
