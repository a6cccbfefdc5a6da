//! The decision for another time scale: all voltages stay, and what acts on integrators changes.

use super::decision::{Decided, Decision};
use super::gains::{Settings, gains_behind_pots, has_few_digits, nearest_gain, pot_gain};
use super::values::Values;
use super::wiring::Wiring;

/// Rounding of a setting.
const ROUNDING: f64 = 1e-11;
/// Decades by which the gains behind a pot with several cords can change, the smallest change first.
const DECADES: [i32; 7] = [0, 1, -1, 2, -2, 3, -3];

/// The decision with which the machine needs `time` seconds for each of its present seconds.
///
/// Pots in front of integrators are turned. A cord without a pot gets another gain if the machine has it and if it has no
/// more digits than before, and otherwise a new pot.
///
/// # Errors
/// The message if a gain would have to be larger than the machine's largest one.
pub(super) fn time_decision(wiring: &Wiring<'_>, old: &Values<'_>, time: f64) -> Result<Decision, String> {
    let mut decision = Decision { time, ..Decision::none(wiring) };
    for pot in (0..wiring.len()).filter(|element| is_before_integrators(wiring, *element)) {
        turn(wiring, old, pot, &mut decision)?;
    }
    for element in (0..wiring.len()).filter(|element| wiring.integrates(*element)) {
        for cord in (0..wiring.cords[element].len()).filter(|cord| wiring.has_gain(element, *cord)) {
            let (from, own) = wiring.cords[element][cord];
            // The pot in front of this cord is turned.
            if wiring.is_ground(from) || decision.factors[from] != 1.0 {
                continue;
            }
            let wanted = own.gain / time;
            let behind_pot =
                gains_behind_pots(wiring, element, own.gain).into_iter().find(|gain| *gain >= wanted);
            let is_readable = |gain: f64| has_few_digits(gain) || !has_few_digits(own.gain);
            match (nearest_gain(wiring, element, wanted), behind_pot) {
                (Ok(gain), Some(_)) if is_readable(gain) => decision.gains[element][cord] = gain,
                (_, Some(gain)) => {
                    decision.gains[element][cord] = gain;
                    decision.added.insert((element, cord), wanted / gain);
                }
                (found, None) => decision.gains[element][cord] = found?,
            }
        }
    }
    Ok(decision)
}

/// The part of a circuit behind an output in which all voltages are rates.
#[derive(Default)]
struct Rates {
    /// The cords with gains into integrators: the element and the index of the cord.
    cords: Vec<(usize, usize)>,
    /// The inverters in front of them.
    inverters: Vec<usize>,
}

/// What an output leads to, if it drives integrators only, directly or through inverters. `None` otherwise, and if a
/// signal is read there.
fn rates(wiring: &Wiring<'_>, output: usize) -> Option<Rates> {
    let mut found = Rates::default();
    let mut open = vec![output];
    while let Some(element) = open.pop() {
        if wiring.has_signal[element] || wiring.readers[element].is_empty() {
            return None;
        }
        for (reader, cord) in &wiring.readers[element] {
            let is_new_inverter =
                wiring.kind(*reader).name == "inverter" && !found.inverters.contains(reader);
            if wiring.integrates(*reader) && wiring.has_gain(*reader, *cord) {
                found.cords.push((*reader, *cord));
            } else if is_new_inverter {
                found.inverters.push(*reader);
                open.push(*reader);
            } else {
                return None;
            }
        }
    }
    Some(found)
}

/// Whether an element is a pot that drives integrators only, directly or through inverters, and no signal is read there.
/// In a macro, this holds for all instances or does not count.
pub(super) fn is_before_integrators(wiring: &Wiring<'_>, element: usize) -> bool {
    wiring.is_pot(element) && wiring.twins(element).all(|twin| rates(wiring, twin).is_some())
}

/// Turns a pot that drives integrators only, and changes the gains behind it if the pot would be above 1 or below 0.1.
/// If the gains behind several cords cannot change together, the pot stays.
///
/// # Errors
/// The message if the largest gain is too small.
fn turn(wiring: &Wiring<'_>, old: &Values<'_>, pot: usize, decision: &mut Decision) -> Result<(), String> {
    if let Some((reader, cord)) = wiring.gain_behind(pot) {
        let decided = Decided { wiring, old, decision };
        let (gain, factor) = pot_gain(&decided, pot, (reader, cord), 1.0)?;
        decision.gains[reader][cord] = gain;
        decision.factors[pot] = factor;
        return Ok(());
    }
    let Some(rates) = rates(wiring, pot) else { return Ok(()) };
    let settings = Settings::of(wiring, old, pot);
    let gains = |decade: i32| {
        let gains = rates.cords.iter().map(|(reader, cord)| {
            let gain = wiring.cords[*reader][*cord].1.gain * 10f64.powi(decade);
            nearest_gain(wiring, *reader, gain).ok()
        });
        gains.collect::<Option<Vec<f64>>>()
    };
    let factor = |decade: i32| 1.0 / decision.time / 10f64.powi(decade);
    let find = |largest: f64, must_be_accurate: bool| {
        DECADES.into_iter().find(|decade| {
            largest * factor(*decade) <= 1.0 + ROUNDING
                && (!must_be_accurate || settings.are_accurate(factor(*decade)))
                && gains(*decade).is_some()
        })
    };
    let possible = || settings.are_possible().then(|| find(settings.most, false)).flatten();
    let found = find(settings.most, true).or_else(possible);
    let found = found.or_else(|| find(settings.now, true)).or_else(|| find(settings.now, false));
    let Some(decade) = found else { return Ok(()) };
    let chosen = gains(decade).unwrap_or_default();
    let factor = factor(decade);
    for element in rates.inverters.iter().chain([&pot]) {
        decision.factors[*element] = factor;
    }
    for ((reader, cord), gain) in rates.cords.iter().zip(chosen) {
        decision.gains[*reader][*cord] = gain;
    }
    Ok(())
}
