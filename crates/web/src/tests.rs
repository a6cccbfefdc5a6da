//! The functions of the module, called as the Worker calls them.

use super::*;

/// Sends a request as the Worker does, and returns the text and the frame of the answer.
fn send(request: unsafe extern "C" fn(*const u8, usize), text: &str) -> (String, Option<Vec<u8>>) {
    let pointer = allocate(text.len());
    // SAFETY: the memory has the length of the text, and is released once, after the request.
    unsafe {
        pointer.copy_from_nonoverlapping(text.as_ptr(), text.len());
        request(pointer, text.len());
        release(pointer, text.len());
    }
    // SAFETY: the pointers and lengths are those of the answer, which the next request replaces.
    let (text, frame) = unsafe {
        let frame = frame_pointer();
        let frame = (!frame.is_null()).then(|| slice::from_raw_parts(frame, frame_length()).to_vec());
        (slice::from_raw_parts(text_pointer(), text_length()).to_vec(), frame)
    };
    (String::from_utf8(text).unwrap(), frame)
}

#[test]
fn before_the_first_request_there_is_no_answer() {
    assert!(text_pointer().is_null() && frame_pointer().is_null());
    assert_eq!((text_length(), frame_length()), (0, 0));
}

#[cfg(feature = "panel")]
#[test]
fn requests_get_the_answers_of_one_session() {
    let (text, frame) = send(request, r#"{"id": 7, "commands": [{"command": "pause", "paused": true}]}"#);
    assert!(text.starts_with(r#"{"id":7,"#) && text.contains(r#""paused":true"#), "{text}");
    assert_eq!(frame, None);

    let (text, frame) = send(request, r#"{"id": 8, "commands": [{"command": "advance", "seconds": 0.02}]}"#);
    assert!(text.contains(r#""frame":true"#), "{text}");
    let frame = patchcord_panel::frame::decode(&frame.unwrap()).unwrap();
    assert!(frame.header.paused);
}

#[cfg(feature = "panel")]
#[test]
fn a_request_that_cannot_be_read_is_refused() {
    let (text, frame) = send(request, "no document: µ");
    assert!(text.contains("the request cannot be read") && frame.is_none(), "{text}");
}

#[cfg(feature = "panel")]
#[test]
fn the_host_gets_the_message_of_a_panic_with_its_place() {
    // The first request makes the host the receiver.
    send(request, "");
    assert!(std::panic::catch_unwind(|| panic!("no voltage")).is_err());
    let failures = host::FAILURES.lock().unwrap();
    let message = failures.iter().find(|message| message.contains("no voltage"));
    assert!(message.is_some_and(|message| message.contains("tests.rs:")), "{failures:?}");
}

/// A request with one command.
#[cfg(feature = "compare")]
fn one(command: &serde_json::Value) -> String {
    serde_json::json!({"id": 5, "commands": [command]}).to_string()
}

#[cfg(feature = "compare")]
#[test]
fn a_search_gives_partial_responses_before_the_final_one() {
    use serde_json::json;

    let begin = json!({
        "command": "begin",
        "patch": {
            "name": "spring.json",
            "text": include_str!("../../../examples/05_missing_effect/spring.json"),
        },
        "data": {
            "name": "measured.csv",
            "text": include_str!("../../../examples/05_missing_effect/measured.csv"),
        },
    });
    let (text, frame) = send(compare_request, &one(&begin));
    assert!(text.contains(r#""event":"columns""#) && frame.is_none(), "{text}");
    let compare = json!({"command": "compare", "experiment": {"outputs": {"x": "x"}, "fit": ["k"]}});
    let (text, _) = send(compare_request, &one(&compare));
    assert!(text.contains(r#""event":"curves""#), "{text}");
    assert!(host::PARTIAL.lock().unwrap().is_empty());

    let (text, _) = send(compare_request, &one(&json!({"command": "search", "seed": 1})));
    assert!(text.starts_with(r#"{"id":5,"#) && !text.contains(r#""partial":true"#), "{text}");
    assert!(text.contains(r#""event":"found""#) && text.contains("viscous-friction"), "{text}");
    let partial = host::PARTIAL.lock().unwrap();
    assert!(!partial.is_empty());
    for text in partial.iter() {
        assert!(text.starts_with(r#"{"id":5,"#) && text.contains(r#""partial":true"#), "{text}");
        assert!(text.contains(r#""event":"progress""#), "{text}");
    }
}
