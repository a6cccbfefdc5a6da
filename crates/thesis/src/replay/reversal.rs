//! Tests a statement of 8.4: with a falling command, oscillation begins at a lower command than the one at which it
//! ends with a rising command.
//!
//! Many settings of the final circuit are run with a command that rises and falls back. Settings that still oscillate
//! at the highest command are run again up to a higher one. Noise is added so that oscillation can grow when the
//! command falls.

use super::boundary::RATE;
use super::recipe::{BoxError, Recipe};
use super::run_record::RunRecord;
use crate::slideway::falling::stable_limit;
use crate::slideway::stability::DrivenTable;
use patchcord_analysis::instruments::{CriticalVelocity, CriticalVelocityError};

/// The commands at which a profile turns back, in m/s. A setting that still oscillates at one of them is run up to
/// the next.
const TURNING_COMMANDS: [f64; 3] = [6e-3, 12e-3, 24e-3];

/// Counts over many settings.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ReversalTally {
    /// All settings.
    pub settings: usize,
    /// Settings that begin to oscillate as the command falls, from steady sliding.
    pub comparable: usize,
    /// Of the comparable settings, those that contradict the statement: oscillation begins at a command at least as
    /// high as the one at which it ended.
    pub reversed: usize,
    /// The clearest contradiction, with the largest ratio of falling to rising critical velocity: the setting, and
    /// the rising and falling critical velocities in m/s. `None` if there is no contradiction.
    pub clearest: Option<(Vec<f64>, f64, f64)>,
    /// Settings that still oscillate where the command turns back, even at the highest one.
    pub not_ended: usize,
    /// Settings that do not oscillate as the command falls.
    pub quiet: usize,
}

impl ReversalTally {
    /// Counts one setting. Its oscillation ended while the command rose, or did not occur.
    ///
    /// # Errors
    /// If the run is not a profile, or if oscillation had not ended where the command turned.
    fn add(
        mut self,
        setting: &[f64],
        critical: &CriticalVelocity,
    ) -> Result<ReversalTally, CriticalVelocityError> {
        use CriticalVelocityError::{NoOscillation, NotBegun};

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
            // A setting that oscillates only as the command falls contradicts the statement most clearly. It has no
            // rising critical velocity, so it cannot be `clearest`.
            (Err(NoOscillation), Ok(_)) => {
                self.comparable += 1;
                self.reversed += 1;
            }
            (Ok(_) | Err(NoOscillation), Err(NoOscillation | NotBegun)) => self.quiet += 1,
            (Err(error), _) | (_, Err(error)) => return Err(error),
        }
        Ok(self)
    }
}

/// Falling divided by rising critical velocity; 0 if one of them is missing.
fn ratio(critical: &CriticalVelocity) -> f64 {
    critical.falling.unwrap_or(0.0) / critical.rising.unwrap_or(f64::INFINITY)
}

/// Runs `settings` settings of the final circuit with noise on the command (rms in m/s), and counts the results.
/// Scales are 2.5 times as large, because the motion exceeds the machine range of the thesis.
pub(super) fn count_reversals(settings: u64, noise: f64) -> Result<ReversalTally, BoxError> {
    let circuit = Recipe::new("fig-8-16").scale_by(2.5).command_noise(noise).record(&["v_i", "v_o"]);
    let mut pending = (0..settings).map(setting).collect::<Result<Vec<_>, _>>()?;
    let mut tally = ReversalTally::default();
    for highest in TURNING_COMMANDS {
        let recipe = circuit.clone().triangle_command(highest, RATE);
        let critical =
            recipe.run_rows(&["K", "f", "Tc", "Fs", "M", "VcL"], &pending, RunRecord::critical_velocity)?;
        let mut not_ended = Vec::new();
        for (setting, critical) in pending.into_iter().zip(&critical) {
            match critical.rising {
                Err(CriticalVelocityError::NotEnded(_)) => not_ended.push(setting),
                _ => tally = tally.add(&setting, critical)?,
            }
        }
        pending = not_ended;
    }
    Ok(ReversalTally { settings: tally.settings + pending.len(), not_ended: pending.len(), ..tally })
}

/// Ranges of K in N/m, f in N s/m, Tc in s, Fs in N and M in kg, in this order. They are the ranges of 8.4 and of
/// table T9-2.
const RANGES: [(f64, f64); 5] =
    [(11e6, 45e6), (5e3, 21.4e3), (0.006, 0.025), (385.0, 1249.0), (217.0, 850.0)];
/// Range of VcL in m/s. The upper end of a setting is the VcL above which it cannot oscillate, if that is lower.
const LIMIT_RANGE: (f64, f64) = (1.27e-3, 25.4e-3);

/// Returns the setting of a number: K, f, Tc, Fs, M and VcL, in SI units. The sequence fills the ranges evenly. It is
/// an additive recurrence whose steps are powers of the inverse root of x^7 = x + 1.
fn setting(number: u64) -> Result<Vec<f64>, BoxError> {
    /// The root of x^7 = x + 1 that exceeds 1.
    const ROOT: f64 = 1.112_775_684_278_706;
    let share = |index: usize| (0.5 + (number + 1) as f64 / ROOT.powi(index as i32 + 1)).fract();
    let between = |(low, high): (f64, f64), index: usize| low + share(index) * (high - low);
    let [stiffness, damping, memory, friction, mass] =
        [0, 1, 2, 3, 4].map(|index| between(RANGES[index], index));
    let table = DrivenTable { stiffness, damping, mass, ..DrivenTable::simulated(memory) };
    let limit = stable_limit(friction, table.critical_slope()?)?.min(LIMIT_RANGE.1);
    Ok(vec![stiffness, damping, memory, friction, mass, between((LIMIT_RANGE.0, limit), 5)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_fill_their_ranges_evenly() {
        let rows: Vec<_> = (0..200).map(|number| setting(number).unwrap()).collect();
        for (index, (low, high)) in RANGES.into_iter().enumerate() {
            let values = || rows.iter().map(|row| row[index]);
            let fifth = 0.2 * (high - low);
            assert!(values().all(|value| (low..high).contains(&value)));
            let within = |from: f64| values().filter(|value| (from..from + fifth).contains(value)).count();
            assert!((0..5).all(|part| (30..50).contains(&within(low + f64::from(part) * fifth))), "{index}");
        }
        assert!(rows.iter().all(|row| (LIMIT_RANGE.0..LIMIT_RANGE.1).contains(&row[5])));
    }

    #[test]
    fn oscillation_only_as_the_command_falls_is_a_contradiction() {
        let quiet = Err(CriticalVelocityError::NoOscillation);
        let read = [(Ok(2.0), Ok(1.0)), (Ok(1.0), Ok(2.0)), (quiet, Ok(1.0)), (Ok(1.0), quiet)];
        let tally = read
            .into_iter()
            .map(|(rising, falling)| CriticalVelocity { rising, falling })
            .try_fold(ReversalTally::default(), |tally, critical| tally.add(&[], &critical))
            .unwrap();
        assert_eq!(
            tally,
            ReversalTally {
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
