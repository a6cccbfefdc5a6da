//! Whether oscillation ever begins at a higher command than it ends at (8.4): critical velocities of many settings, with noise for
//! falling commands to grow oscillation from.

use super::boundary::RATE;
use super::recipe::{Problem, Recipe, Record};
use crate::slideway::falling::stable_limit;
use crate::slideway::stability::DrivenTable;
use patchcord_analysis::instruments::{CriticalVelocity, NoCriticalVelocity};

/// The command turns back at this, in m/s; where oscillation goes on there, at the next.
const HIGHEST: [f64; 3] = [6e-3, 12e-3, 24e-3];

/// What many settings gave.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Tally {
    /// Settings in all.
    pub settings: usize,
    /// Those that oscillate as the command falls, from steady sliding.
    pub comparable: usize,
    /// Those of them at which oscillation begins at the higher command.
    pub reversed: usize,
    /// Of those the one at which it begins at the highest command beside that at which it ended: settings, and both commands in m/s.
    pub clearest: Option<(Vec<f64>, f64, f64)>,
    /// Those that still oscillate where the command turns back.
    pub not_ended: usize,
    /// Those that do not.
    pub quiet: usize,
}

impl Tally {
    /// One more setting, at which oscillation ended while the command rose, or never was.
    fn count(mut self, setting: &[f64], critical: &CriticalVelocity) -> Result<Tally, NoCriticalVelocity> {
        use NoCriticalVelocity::{NotBegun, Quiet};

        self.settings += 1;
        match (critical.rising, critical.falling) {
            (Ok(rising), Ok(falling)) => {
                self.comparable += 1;
                self.reversed += usize::from(falling >= rising);
                let clearer = self
                    .clearest
                    .as_ref()
                    .is_none_or(|(_, rising, falling)| falling / rising < ratio(critical));
                if falling >= rising && clearer {
                    self.clearest = Some((setting.to_vec(), rising, falling));
                }
            }
            // What never oscillated while the command rose, and does as it falls, is the clearest exception.
            (Err(Quiet), Ok(_)) => {
                self.comparable += 1;
                self.reversed += 1;
            }
            (Ok(_) | Err(Quiet), Err(Quiet | NotBegun)) => self.quiet += 1,
            (Err(error), _) | (_, Err(error)) => return Err(error),
        }
        Ok(self)
    }
}

fn ratio(critical: &CriticalVelocity) -> f64 {
    critical.falling.unwrap_or(0.0) / critical.rising.unwrap_or(f64::INFINITY)
}

/// What so many settings of the final circuit give with noise of this size on the command, rms in m/s.
pub(super) fn tally(settings: u64, noise: f64) -> Result<Tally, Problem> {
    let circuit = Recipe::of("fig-8-16").scaled(2.5).noisy(noise).recording(&["v_i", "v_o"]);
    let mut left = (0..settings).map(setting).collect::<Result<Vec<_>, _>>()?;
    let mut tally = Tally::default();
    for highest in HIGHEST {
        let recipe = circuit.clone().there_and_back(highest, RATE);
        let critical = recipe.each(&["K", "f", "Tc", "Fs", "M", "VcL"], &left, Record::critical)?;
        let mut goes_on = Vec::new();
        for (setting, critical) in left.into_iter().zip(&critical) {
            match critical.rising {
                Err(NoCriticalVelocity::NotEnded(_)) => goes_on.push(setting),
                _ => tally = tally.count(&setting, critical)?,
            }
        }
        left = goes_on;
    }
    Ok(Tally { settings: tally.settings + left.len(), not_ended: left.len(), ..tally })
}

/// K in N/m, f in N s/m, Tc in s, Fs in N and M in kg lie anywhere within the ranges of 8.4 and of table T9-2; VcL from the least of
/// the study's up to that from which on there is no oscillation, or its largest.
const RANGES: [(f64, f64); 5] =
    [(11e6, 45e6), (5e3, 21.4e3), (0.006, 0.025), (385.0, 1249.0), (217.0, 850.0)];
const LIMITS: (f64, f64) = (1.27e-3, 25.4e-3);

/// Settings by their number: a sequence that fills the ranges evenly, the multiples of powers of the root of x^7 = x + 1.
fn setting(number: u64) -> Result<Vec<f64>, Problem> {
    const ROOT: f64 = 1.112_775_684_278_706;
    let share = |place: usize| (0.5 + (number + 1) as f64 / ROOT.powi(place as i32 + 1)).fract();
    let between = |(low, high): (f64, f64), place: usize| low + share(place) * (high - low);
    let [stiffness, damping, memory, friction, mass] =
        [0, 1, 2, 3, 4].map(|place| between(RANGES[place], place));
    let table = DrivenTable { stiffness, damping, mass, ..DrivenTable::simulated(memory) };
    let limit = stable_limit(friction, table.critical_slope()?)?.min(LIMITS.1);
    Ok(vec![stiffness, damping, memory, friction, mass, between((LIMITS.0, limit), 5)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_fill_their_ranges() {
        let rows: Vec<_> = (0..200).map(|number| setting(number).unwrap()).collect();
        for (place, (low, high)) in RANGES.into_iter().enumerate() {
            let values = || rows.iter().map(|row| row[place]);
            let fifth = 0.2 * (high - low);
            assert!(values().all(|value| (low..high).contains(&value)));
            let within = |from: f64| values().filter(|value| (from..from + fifth).contains(value)).count();
            assert!((0..5).all(|part| (30..50).contains(&within(low + f64::from(part) * fifth))), "{place}");
        }
        assert!(rows.iter().all(|row| (LIMITS.0..LIMITS.1).contains(&row[5])));
    }

    #[test]
    fn what_oscillates_only_as_the_command_falls_is_an_exception() {
        let quiet = Err(NoCriticalVelocity::Quiet);
        let read = [(Ok(2.0), Ok(1.0)), (Ok(1.0), Ok(2.0)), (quiet, Ok(1.0)), (Ok(1.0), quiet)];
        let tally = read
            .into_iter()
            .map(|(rising, falling)| CriticalVelocity { rising, falling })
            .try_fold(Tally::default(), |tally, critical| tally.count(&[], &critical))
            .unwrap();
        assert_eq!(
            tally,
            Tally {
                settings: 4,
                comparable: 3,
                reversed: 2,
                clearest: Some((vec![], 1.0, 2.0)),
                not_ended: 0,
                quiet: 1
            }
        );
    }
}
