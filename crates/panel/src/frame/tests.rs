use proptest::prelude::*;

use super::*;
use crate::scope::Display;

/// The frame that the page's test decodes, too.
const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/frame.bin");

/// A header with a different value in every field.
fn header() -> FrameHeader {
    FrameHeader {
        revision: 7,
        time: 3.0,
        factor: 0.5,
        mode: 3,
        moves: true,
        paused: false,
        stopped: false,
        first_lamp: Some(2),
        repetitions: 5,
        meter: Some(-12.5),
        null_meter: None,
    }
}

/// A scope with probes at these outputs.
fn scope(display: Display, outputs: [Option<&str>; CHANNELS]) -> Scope {
    let mut scope = Scope::new();
    let mut controls = scope.controls().clone();
    controls.display = display;
    for (channel, output) in controls.channels.iter_mut().zip(outputs) {
        channel.output = output.map(str::to_owned);
    }
    scope.set_controls(controls).unwrap();
    scope
}

/// A ramp with a jump against time, and a curve with corners.
fn scopes() -> [Scope; SCOPES] {
    let mut ramp = scope(Display::Time, [Some("A1"), None]);
    ramp.begin_run(1000.0);
    for (time, volts) in [(0.0, 0.0), (3.0, 30.0), (3.0, -30.0)] {
        ramp.point(time, [volts, f64::NAN]);
    }
    let mut curve = scope(Display::Plane, [Some("A1"), Some("A2")]);
    curve.begin_run(2.0);
    for (time, volts) in [(0.0, [0.0, 0.0]), (1.0, [10.0, 0.0]), (2.0, [10.0, 10.0]), (2.0, [0.0, 10.0])] {
        curve.point(time, volts);
    }
    [ramp, curve]
}

/// The frame of `scopes`.
fn example() -> Vec<u8> {
    encode(&header(), &[100.0, -100.0, 0.25], &[false, false, true], &mut scopes())
}

#[test]
fn a_frame_has_everything() {
    let ramp = TimePicture {
        generation: 2,
        left: 0.0,
        column_seconds: 1.0,
        reached: 4,
        channels: [Some(vec![[0.0, 10.0], [10.0, 20.0], [20.0, 30.0], [-30.0, 30.0]]), None],
    };
    let curve = PlanePicture {
        generation: 4,
        first: 0,
        points: vec![[0.0, 0.0, -1.0], [10.0, 0.0, 1.0], [10.0, 10.0, 1.0], [0.0, 10.0, 0.0]],
    };
    let frame = Frame {
        header: header(),
        overload: true,
        volts: vec![100.0, -100.0, 0.25],
        lamps: vec![false, false, true],
        scopes: [Picture::Time(ramp), Picture::Plane(curve)],
    };
    assert_eq!(decode(&example()), Ok(frame));
}

#[test]
fn the_bytes_are_those_that_the_page_is_tested_with() {
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        std::fs::write(EXAMPLE, example()).unwrap();
    }
    assert!(std::fs::read(EXAMPLE).unwrap() == example(), "PATCHCORD_BLESS=1 rewrites {EXAMPLE}");
}

#[test]
fn empty_columns_are_nan() {
    let mut scopes = scopes();
    scopes[0].erase();
    scopes[0].point(5.5, [-30.0, f64::NAN]);
    let frame = decode(&encode(&FrameHeader::default(), &[], &[], &mut scopes)).unwrap();
    let Picture::Time(picture) = &frame.scopes[0] else { panic!("{frame:?}") };
    let channel = picture.channels[0].as_ref().unwrap();
    assert!(channel[..3].iter().flatten().all(|volts| volts.is_nan()));
    assert_eq!(channel[3..], [[-30.0, -30.0]; 3]);
}

#[test]
fn a_lamp_with_a_large_number_is_no_first_lamp() {
    let header = FrameHeader { first_lamp: Some(70_000), ..FrameHeader::default() };
    let frame = decode(&encode(&header, &[0.0], &[true], &mut scopes())).unwrap();
    assert_eq!((frame.header.first_lamp, frame.overload), (None, true));
}

#[test]
fn wrong_bytes_are_refused() {
    let example = example();
    assert_eq!(decode(b"PNG"), Err(FrameError::OtherFormat));
    assert_eq!(decode(&[0; 100]), Err(FrameError::OtherFormat));
    for length in 4..example.len() {
        assert_eq!(decode(&example[..length]), Err(FrameError::TooShort { length }));
    }
    let longer = [&example[..], &[0; 3][..]].concat();
    assert_eq!(decode(&longer), Err(FrameError::TooLong { extra: 3 }));
    let changed = |at: usize, byte: u8| {
        let mut bytes = example.clone();
        bytes[at] = byte;
        decode(&bytes).unwrap_err().to_string()
    };
    assert_eq!(changed(24, 9), "the frame has the mode 9, which this version does not know");
    assert_eq!(changed(68, 2), "the frame has the display 2, which this version does not know");
    assert_eq!(changed(100, 3), "the frame has the channels in use 3, which this version does not know");
}

proptest! {
    #[test]
    fn any_bytes_are_decoded_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let framed = [&MAGIC.to_le_bytes()[..], &bytes[..]].concat();
        prop_assert!(decode(&framed).is_err() || framed.len() >= 76);
    }

    #[test]
    fn changed_frames_are_decoded_without_a_panic(
        changes in prop::collection::vec((4..160_usize, any::<u8>()), 1..8)
    ) {
        let mut bytes = example();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        if let Ok(frame) = decode(&bytes) {
            prop_assert_eq!(frame.volts.len(), frame.lamps.len());
        }
    }
}
