//! Effects wired into patches: they attach where dimensions fit, whatever the signs of the wiring, and follow their laws.

mod common;

use patchcord::circuit::Circuit;
use patchcord::gap::candidate::Candidate;
use patchcord::gap::effect::{Effect, Library};
use patchcord::gap::graft::{Attached, Role};
use patchcord::gap::reach::Largest;
use patchcord::gap::site::Sites;
use patchcord::patch::{Patch, Unit};
use patchcord::program::Program;
use patchcord::solve::{self, RunSettings};

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
    let told = |(name, role): (&'static str, Role<'_>)| {
        let end = 40.0 * role.per_volt();
        Largest::of(name, role.unit().clone(), [-end, end])
    };
    let times = [("sample", 0.01), ("record", 3.0)];
    let times = times.map(|(name, value)| Largest::of(name, Unit::parse("s").unwrap(), [0.0, value]));
    attached.place.roles().into_iter().map(told).chain(times).collect()
}

fn candidate(attached: &Attached<'_>, patch: &Patch) -> Candidate {
    let made = Candidate::new(attached, patch, &largest(attached), &[0.4]);
    made.unwrap_or_else(|error| panic!("{}: {error}", attached.effect.name)).unwrap()
}

fn library() -> Library {
    Library::shipped()
}

fn velocity(patch: &Patch, set: &[(String, f64)]) -> Vec<f64> {
    let circuit = Circuit::new(patch, set).unwrap_or_else(|report| panic!("{}\n{report}", patch.text()));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap();
    solve::run(&program, &settings).unwrap().values("v").unwrap()
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
    for system in std::fs::read_dir("tests/gap/systems").unwrap() {
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

/// The velocity with one effect at IV, its parameters set.
fn with(effect: &str, set: &[(&str, f64)]) -> Vec<f64> {
    let (patch, library) = (mass(false), library());
    let sites = sites(&patch);
    let attached = Attached::all(library.get(effect).unwrap(), &sites);
    let candidate = candidate(&attached[0], &patch);
    let set: Vec<_> = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    velocity(&candidate.graft.patch, &set)
}

#[test]
fn effects_follow_their_laws() {
    let free = with("constant-bias", &[("b", 0.0)]);
    let biased = with("constant-bias", &[("b", 0.8)]);
    let drifting = with("drift", &[("r", 0.2)]);
    let drag = with("viscous-friction", &[("c", 2.0)]);
    let (m, omega) = (2.0, 2.0 * std::f64::consts::PI);
    for (sample, free) in free.iter().enumerate() {
        let t = sample as f64 * 0.01;
        assert!((biased[sample] - free - 0.8 * t / m).abs() < 1e-9);
        assert!((drifting[sample] - free - 0.1 * t * t / m).abs() < 1e-9);
        // m v' + c v = 10 sin(omega t + 1), at rest at first.
        let (c, size) = (2.0, 10.0 / (m * omega).hypot(2.0));
        let lag = 1.0 - (m * omega / c).atan();
        let exact = size * ((omega * t + lag).sin() - lag.sin() * (-c * t / m).exp());
        assert!((drag[sample] - exact).abs() < 1e-8, "{t}: {} {exact}", drag[sample]);
    }
    let stuck = with("coulomb-friction", &[("Fc", 1.9)]);
    assert!(stuck.iter().zip(&free).any(|(stuck, free)| (stuck - free).abs() > 0.1));
}

/// Where the mass comes to rest it is held, until the force passes Fc + dF (1 - exp(-rest / Tg)); then friction is Fc at once.
#[test]
fn friction_that_grows_at_rest_is_torn_apart_as_it_slides() {
    let (fc, df, tg, m, omega) = (6.0, 3.0, 0.05, 2.0, 2.0 * std::f64::consts::PI);
    let velocity = with("static-friction-growth", &[("dF", df), ("Tg", tg), ("Fc", fc)]);
    let force = |sample: usize| 10.0 * (omega * sample as f64 * 0.01 + 1.0).sin();
    let rests: Vec<usize> = (1..velocity.len()).filter(|sample| velocity[*sample] == 0.0).collect();
    let rests: Vec<&[usize]> = rests.chunk_by(|one, next| one + 1 == *next).collect();
    assert!(rests.len() > 3, "{rests:?}");
    for rest in &rests[..rests.len() - 1] {
        let (first, last) = (rest[0], rest[rest.len() - 1]);
        let grown = |samples: usize| fc + df * (1.0 - (-(samples as f64) * 0.01 / tg).exp());
        assert!(force(last).abs() < grown(last - first + 1), "it is held as long as that");
        assert!(force(last + 1).abs() > grown(last - first), "and no longer");
        // m v' = F - Fc from the next sample on.
        let (from, to) = (last + 2, last + 6);
        let pushed = |sample: usize| -10.0 / omega * (omega * sample as f64 * 0.01 + 1.0).cos();
        let gained = pushed(to) - pushed(from) - fc * 0.04 * velocity[to].signum();
        assert!((m * (velocity[to] - velocity[from]) - gained).abs() < 1e-6, "{first} ... {last}");
    }
}

#[test]
fn an_effect_of_ones_own_is_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string("patches/effects/viscous-friction.json").unwrap();
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
    let good = std::fs::read_to_string("patches/effects/viscous-friction.json").unwrap();
    let wrong = [
        ("\"motion\"", "\"moton\"", "\"moton\" is none of motion, store, sum, drive, level, total"),
        ("\"range\": [", "\"range\": [9e9, ", "\"range\" takes two numbers, the second above the first"),
        ("\"reach\": \"", "\"reach\": \"+", "wrong.json:"),
    ];
    for (old, new, message) in wrong {
        assert!(good.contains(old));
        let found = told(&good.replacen(old, new, 1));
        assert!(found.contains(message) && found.contains("wrong.json:"), "{found}");
    }
}

#[test]
fn the_page_of_effects_is_fresh() {
    common::files::check_fresh("docs/effects.md", Library::shipped().markdown().as_bytes(), "graft");
}
