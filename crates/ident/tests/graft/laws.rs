//! The laws of effects: the velocity of a mass with an effect is compared with the exact solution.

use super::{assert_follows, candidate, library, mass, run, samples, sites, velocity};
use crate::runge_kutta::integrate;
use patchcord_core::patch::Patch;
use patchcord_core::trace::Trace;
use patchcord_ident::effects::attach::EffectPlacement;

/// The velocity of the mass with the first form of an effect at the first site that it fits.
fn with_effect(effect: &str, set: &[(&str, f64)]) -> Vec<f64> {
    with_form(effect, "", set)
}

/// The same with the first form whose note contains `note`.
fn with_form(effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    samples_with(&mass(false), "v", effect, note, set)
}

/// The samples of a signal of a patch with an effect at the first site that it fits.
fn samples_with(patch: &Patch, signal: &str, effect: &str, note: &str, set: &[(&str, f64)]) -> Vec<f64> {
    run_with(patch, effect, note, set).values(signal).unwrap()
}

/// Runs a patch with the first form of an effect whose note contains `note`, and with its parameters set.
fn run_with(patch: &Patch, effect: &str, note: &str, set: &[(&str, f64)]) -> Trace {
    let (library, sites) = (library(), sites(patch));
    let placements = EffectPlacement::all(library.get(effect).unwrap(), &sites);
    let placement = placements.iter().find(|placement| placement.form.note.contains(note)).unwrap();
    let candidate = candidate(placement, patch);
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

/// A summer of the effect saturates by design when the mass presses into the stop. Its overload lamp must be
/// suppressed.
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

#[test]
fn static_friction_growth_follows_its_law_and_ends_when_the_mass_slides() {
    assert_friction_grows("settles, and is broken as soon", 3.0, |t| 1.0 - (-t).exp());
    assert_friction_grows("as a logarithm", 1.2, f64::ln_1p);
}

/// Asserts that the mass, once at rest, is held until the force exceeds Fc + dF s, and that friction is then Fc at
/// once.
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

/// The second effect is wired in front of the first one, so the first one acts on its output.
#[test]
fn two_effects_in_one_drive_act_in_series() {
    let (mass, library) = (mass(false), library());
    let wired = |patch: &Patch, effect: &str, note: &str| {
        let sites = sites(patch);
        let placements = EffectPlacement::all(library.get(effect).unwrap(), &sites);
        candidate(placements.iter().find(|placement| placement.form.note.contains(note)).unwrap(), patch)
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
