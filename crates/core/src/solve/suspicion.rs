//! What comes and goes within a step: looked for at its stages.

use super::machine::Machine;
use super::turn::Samples;

impl Machine<'_> {
    /// Where in the step looked at something may come and go that its end does not show: where a stage shows it, or
    /// where a watched voltage turns just before it would.
    pub(super) fn suspicion(&self) -> Option<f64> {
        let stages = self.method.glances.iter().map(|stage| self.method.stages[*stage].at);
        let mut seen = stages.zip(&self.glances);
        let shown = seen.find(|(_, voltages)| self.event_at(voltages).is_some());
        shown.map(|(share, _)| share).or_else(|| self.grazed())
    }

    fn grazed(&self) -> Option<f64> {
        let ends = [&self.registers, &self.trial_registers].map(Vec::as_slice);
        let guards = self.open_transitions().filter_map(|open| {
            let samples = self.samples(ends, |voltages| open.guard.excess(voltages))?;
            turn_towards(&samples, |_, to| to >= 0.0)
        });
        let kinks = self.kinks().filter_map(|kink| {
            let samples = self.samples(ends, |voltages| kink.value(voltages))?;
            turn_towards(&samples, |from, to| kink.crossed(&self.program.tables, from, to).is_some())
        });
        guards.chain(kinks).reduce(f64::min)
    }

    /// What a voltage is at both ends of the step last looked at, and at the stages between; nothing of a method that
    /// looks at fewer than two.
    pub(super) fn samples(
        &self,
        [begin, end]: [&[f64]; 2],
        voltage: impl Fn(&[f64]) -> f64,
    ) -> Option<Samples> {
        let ([near, far], [early, late]) = (self.method.glances, self.glances.as_slice()) else {
            return None;
        };
        let share = |stage: &usize| self.method.stages[*stage].at;
        let values = [begin, early, late, end].map(voltage);
        Some(Samples { shares: [0.0, share(near), share(far), 1.0], values })
    }
}

/// Where a voltage turns that would have met something with a little more swing.
fn turn_towards(samples: &Samples, meets: impl Fn(f64, f64) -> bool) -> Option<f64> {
    samples.turns().find(|turn| meets(samples.values[0], samples.beyond(turn))).map(|turn| turn.share)
}
