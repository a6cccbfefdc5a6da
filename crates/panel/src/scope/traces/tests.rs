use super::*;

/// A trigger of the first channel at 10 V.
fn trigger(rising: bool) -> Trigger {
    Trigger { mode: TriggerMode::Level, channel: 0, level: 10.0, rising }
}

/// A sample with a free second channel.
fn sample(time: f64, volts: f64) -> Sample {
    Sample { time, volts: [volts, f64::NAN] }
}

/// The time at which a line from 8 V at 1 s to 16 V at 3 s triggers, for screens of 0.5 s.
fn crossing(rising: bool, start: f64) -> Option<f64> {
    let trigger = trigger(rising);
    Timing { trigger: &trigger, screen: 0.5 }.crossing(&sample(1.0, 8.0), &sample(3.0, 16.0), start)
}

#[test]
fn a_line_triggers_once_in_its_direction() {
    assert_eq!(crossing(true, 1.0), Some(1.5));
    assert_eq!(crossing(true, 1.5), Some(1.5));
    assert_eq!(crossing(true, 1.6), None);
    assert_eq!(crossing(false, 1.0), None);
}

#[test]
fn a_jump_triggers_at_its_time() {
    let trigger = trigger(false);
    let timing = Timing { trigger: &trigger, screen: 0.5 };
    assert_eq!(timing.crossing(&sample(2.0, 11.0), &sample(2.0, 9.0), 2.0), Some(2.0));
    assert_eq!(timing.crossing(&sample(2.0, 10.0), &sample(2.0, 9.0), 2.0), None);
    assert_eq!(timing.crossing(&sample(2.0, f64::NAN), &sample(2.0, 9.0), 2.0), None);
}

#[test]
fn screens_follow_each_other_from_time_0() {
    let trigger = trigger(true);
    let timing = Timing { trigger: &trigger, screen: 0.5 };
    assert_eq!(timing.screen_edge(0.0, 0.1), 0.0);
    assert_eq!(timing.screen_edge(0.0, 0.5), 0.0);
    assert_eq!(timing.screen_edge(0.5, 0.501), 0.5);
    assert_eq!(timing.screen_edge(0.5, 7.2), 7.0);
}
