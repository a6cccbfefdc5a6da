//! The functions of the module, called as the Worker calls them.

use super::*;

/// Sends a request as the Worker does, and returns the text and the frame of the answer.
fn send(text: &str) -> (String, Option<Vec<u8>>) {
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

#[test]
fn requests_get_the_answers_of_one_session() {
    let (text, frame) = send(r#"{"id": 7, "commands": [{"command": "pause", "paused": true}]}"#);
    assert!(text.starts_with(r#"{"id":7,"#) && text.contains(r#""paused":true"#), "{text}");
    assert_eq!(frame, None);

    let (text, frame) = send(r#"{"id": 8, "commands": [{"command": "advance", "seconds": 0.02}]}"#);
    assert!(text.contains(r#""frame":true"#), "{text}");
    let frame = patchcord_panel::frame::decode(&frame.unwrap()).unwrap();
    assert!(frame.header.paused);
}

#[test]
fn a_request_that_cannot_be_read_is_refused() {
    let (text, frame) = send("no document: µ");
    assert!(text.contains("the request cannot be read") && frame.is_none(), "{text}");
}

#[test]
fn the_message_of_a_panic_has_its_place() {
    send("");
    let message = std::panic::catch_unwind(|| panic!("no voltage")).unwrap_err();
    assert_eq!(message.downcast_ref(), Some(&"no voltage"));
}
