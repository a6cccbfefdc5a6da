//! The values that the controls of a scope permit.

use super::{CHANNELS, ScopeControls};
use crate::limits::check_range;

/// Permitted seconds per division, apart from 0.
const SECONDS_PER_DIVISION: [f64; 2] = [1e-9, 1e9];
/// Permitted volts per division.
const VOLTS_PER_DIVISION: [f64; 2] = [1e-6, 1e6];
/// Permitted volts of a level and of the centre of the screen.
const VOLTS: [f64; 2] = [-1e6, 1e6];
/// Permitted seconds of persistence.
const PERSISTENCE: [f64; 2] = [0.0, 3600.0];

/// Checks that every control has a permitted value. The error is a message for the user.
pub(super) fn check(controls: &ScopeControls) -> Result<(), String> {
    for (index, channel) in controls.channels.iter().enumerate() {
        let number = index + 1;
        let volts = format!("the volts per division of channel {number}");
        check_range(&volts, channel.volts_per_division, VOLTS_PER_DIVISION)?;
        check_range(&format!("the centre of channel {number}"), channel.centre, VOLTS)?;
    }
    if controls.seconds_per_division != 0.0 {
        check_range("the seconds per division", controls.seconds_per_division, SECONDS_PER_DIVISION)
            .map_err(|message| format!("{message}; a value of 0 selects a tenth of the sweep"))?;
    }
    if controls.trigger.channel >= CHANNELS {
        let number = controls.trigger.channel;
        return Err(format!("the channel that triggers must be 0 or 1, not {number}"));
    }
    check_range("the trigger level", controls.trigger.level, VOLTS)?;
    check_range("the persistence in seconds", controls.persistence, PERSISTENCE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scope::Scope;

    /// The message about controls in which one value was changed.
    fn message(change: impl FnOnce(&mut ScopeControls)) -> String {
        let mut controls = Scope::new().controls().clone();
        change(&mut controls);
        check(&controls).unwrap_err()
    }

    #[test]
    fn initial_controls_are_permitted() {
        assert_eq!(check(Scope::new().controls()), Ok(()));
    }

    #[test]
    fn messages_name_the_control_and_the_range() {
        assert_eq!(
            message(|controls| controls.channels[1].volts_per_division = 0.0),
            "the volts per division of channel 2 must be from 1e-6 to 1000000, not 0"
        );
        assert_eq!(
            message(|controls| controls.channels[0].centre = f64::NAN),
            "the centre of channel 1 must be from -1000000 to 1000000, not NaN"
        );
        assert_eq!(
            message(|controls| controls.seconds_per_division = -1.0),
            "the seconds per division must be from 1e-9 to 1e9, not -1; a value of 0 selects a tenth of the sweep"
        );
        assert_eq!(
            message(|controls| controls.trigger.channel = 2),
            "the channel that triggers must be 0 or 1, not 2"
        );
        assert_eq!(
            message(|controls| controls.trigger.level = f64::INFINITY),
            "the trigger level must be from -1000000 to 1000000, not inf"
        );
        assert_eq!(
            message(|controls| controls.persistence = -0.5),
            "the persistence in seconds must be from 0 to 3600, not -0.5"
        );
    }
}
