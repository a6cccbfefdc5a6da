//! The values that the controls of a scope permit.

use std::ops::RangeInclusive;

use super::{CHANNELS, ScopeControls};

/// Permitted seconds per division, apart from 0.
const SECONDS_PER_DIVISION: RangeInclusive<f64> = 1e-9..=1e9;
/// Permitted volts per division.
const VOLTS_PER_DIVISION: RangeInclusive<f64> = 1e-6..=1e6;
/// Permitted volts of a level and of the centre of the screen.
const VOLTS: RangeInclusive<f64> = -1e6..=1e6;
/// Permitted seconds of persistence.
const PERSISTENCE: RangeInclusive<f64> = 0.0..=3600.0;

/// Checks that every control has a permitted value. The error is a message for the user.
pub(super) fn check(controls: &ScopeControls) -> Result<(), String> {
    for (index, channel) in controls.channels.iter().enumerate() {
        let number = index + 1;
        check_value(
            &format!("The volts per division of channel {number}"),
            channel.volts_per_division,
            &VOLTS_PER_DIVISION,
        )?;
        check_value(&format!("The centre of channel {number}"), channel.centre, &VOLTS)?;
    }
    if controls.seconds_per_division != 0.0 {
        check_value("The seconds per division", controls.seconds_per_division, &SECONDS_PER_DIVISION)
            .map_err(|message| format!("{message} A value of 0 selects a tenth of the sweep."))?;
    }
    if controls.trigger.channel >= CHANNELS {
        let number = controls.trigger.channel;
        return Err(format!("The channel that triggers must be 0 or 1, not {number}."));
    }
    check_value("The trigger level", controls.trigger.level, &VOLTS)?;
    check_value("The persistence in seconds", controls.persistence, &PERSISTENCE)
}

/// Checks that a value is in a range. `name` begins the message.
fn check_value(name: &str, value: f64, range: &RangeInclusive<f64>) -> Result<(), String> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(format!("{name} must be from {} to {}, not {value}.", range.start(), range.end()))
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
            "The volts per division of channel 2 must be from 0.000001 to 1000000, not 0."
        );
        assert_eq!(
            message(|controls| controls.channels[0].centre = f64::NAN),
            "The centre of channel 1 must be from -1000000 to 1000000, not NaN."
        );
        assert_eq!(
            message(|controls| controls.seconds_per_division = -1.0),
            "The seconds per division must be from 0.000000001 to 1000000000, not -1. A value of 0 selects a \
             tenth of the sweep."
        );
        assert_eq!(
            message(|controls| controls.trigger.channel = 2),
            "The channel that triggers must be 0 or 1, not 2."
        );
        assert_eq!(
            message(|controls| controls.trigger.level = f64::INFINITY),
            "The trigger level must be from -1000000 to 1000000, not inf."
        );
        assert_eq!(
            message(|controls| controls.persistence = -0.5),
            "The persistence in seconds must be from 0 to 3600, not -0.5."
        );
    }
}
