//! Sessions: who may begin one, how it answers, and when it ends.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use patchcord_server::{Limits, Options};
use tungstenite::Message;

use crate::client::{NOTHING, ask, options, start, start_with};

#[test]
fn a_session_needs_the_token_and_the_page_of_the_panel() {
    let server = start(options());
    let port = server.address.port();
    let right = format!("/session?token={}", server.token);
    let page = format!("Origin: http://{}", server.address);
    let origins = [
        "Origin: http://evil.example".to_owned(),
        format!("Origin: http://evil.example:{port}"),
        format!("Origin: http://localhost:{port}"),
        format!("Origin: https://{}", server.address),
        "Origin: http://127.0.0.1".to_owned(),
        "Origin: null".to_owned(),
        "Accept: */*".to_owned(),
        format!("{page}\r\n{page}"),
    ];
    for origin in origins {
        assert_eq!(server.upgrade_status(&right, &origin), 403, "{origin}");
    }
    for path in ["/session", "/session?token=", "/session?token=0", &format!("{right}0")] {
        assert_eq!(server.upgrade_status(path, &page), 403, "{path}");
    }
    assert_eq!(ask(&mut server.open(), NOTHING).map(|answer| answer.contains("\"id\":1")), Ok(true));
}

#[test]
fn an_answer_is_a_text_and_a_frame_if_there_is_one() {
    let server = start(options());
    let mut socket = server.open();
    let advance = r#"{"id": 7, "commands": [{"command": "advance", "seconds": 0.01}]}"#;
    for _ in 0..3 {
        let answer = ask(&mut socket, advance).unwrap();
        assert!(answer.contains("\"id\":7") && answer.contains("\"frame\":true"), "{answer}");
        let Ok(Message::Binary(frame)) = socket.read() else { panic!("no frame after {answer}") };
        assert_eq!(frame[..4], *b"PCF1");
    }
    let answer = ask(&mut socket, NOTHING).unwrap();
    assert!(answer.contains("\"id\":1") && answer.contains("\"frame\":false"), "{answer}");
    // A request that cannot be read does not end the session.
    assert!(ask(&mut socket, "not JSON").unwrap().contains("\"id\":null"));
    assert!(ask(&mut socket, NOTHING).is_ok());
}

/// More requests than the server reads ahead.
#[test]
fn requests_that_do_not_wait_are_answered_in_order() {
    let server = start(options());
    let mut socket = server.open();
    for id in 0..200 {
        socket.send(Message::text(format!("{{\"id\": {id}, \"commands\": []}}"))).unwrap();
    }
    for id in 0..200 {
        let Ok(Message::Text(answer)) = socket.read() else { panic!("no answer to {id}") };
        assert!(answer.as_str().contains(&format!("\"id\":{id},")), "{id}: {answer}");
    }
}

#[test]
fn each_session_has_its_own_patch() {
    let server = start(options());
    let [mut first, mut second] = [server.open(), server.open()];
    let add = r#"{"id": 1, "commands": [{"command": "add-element", "kind": "integrator", "name": "A77"}]}"#;
    let text = r#"{"id": 2, "commands": [{"command": "text"}]}"#;
    ask(&mut first, add).unwrap();
    assert!(ask(&mut first, text).unwrap().contains("A77"));
    assert!(!ask(&mut second, text).unwrap().contains("A77"));
}

#[test]
fn a_session_reads_no_table_outside_its_folder() {
    let server = start(options());
    let mut socket = server.open();
    let patch = serde_json::json!({
        "patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "../../Cargo.toml"}}}
    });
    let open = serde_json::json!({"command": "open", "name": "/etc/p.json", "text": patch.to_string()});
    let answer = ask(&mut socket, &format!("{{\"id\": 1, \"commands\": [{open}]}}")).unwrap();
    assert!(answer.contains("is not below the folder from which tables may be read"), "{answer}");
}

#[test]
fn a_session_opens_patches_below_its_folder_only() {
    let lessons = PathBuf::from("../../patches/lessons");
    let server = start(Options { folder: lessons, ..options() });
    let mut socket = server.open();
    let mut answer = |name: &str| {
        let open = serde_json::json!({"command": "open-file", "name": name});
        ask(&mut socket, &format!("{{\"id\": 1, \"commands\": [{open}]}}")).unwrap()
    };
    assert!(answer("mathieu.json").contains("\"file\":\"mathieu.json\""));
    for name in ["../thesis/fig-8-16.json", "/etc/hostname.json", "%2e%2e/thesis/fig-8-16.json"] {
        let answer = answer(name);
        assert!(answer.contains("\"event\":\"refused\"") && !answer.contains("\"file\""), "{answer}");
    }
    // No address of the server has the file.
    assert_eq!(server.get("/mathieu.json").status, 404);
}

#[test]
fn a_session_beyond_the_limit_is_refused_with_a_reason() {
    let server = start(options());
    let mut sockets: Vec<_> = (0..Limits::default().sessions).map(|_| server.open()).collect();
    assert!(sockets.iter_mut().all(|socket| ask(socket, NOTHING).is_ok()));
    let reason = ask(&mut server.open(), NOTHING).unwrap_err().unwrap();
    assert_eq!(u16::from(reason.code), 1013);
    assert!(reason.reason.starts_with("16 panels are open"), "{}", reason.reason);
    assert!(sockets.iter_mut().all(|socket| ask(socket, NOTHING).is_ok()));

    // A closed browser frees its session: one that closes properly, and one that vanishes.
    sockets[0].close(None).unwrap();
    drop(sockets.drain(..2));
    let deadline = Instant::now() + Duration::from_secs(10);
    while sockets.len() < Limits::default().sessions {
        let mut socket = server.open();
        if ask(&mut socket, NOTHING).is_ok() {
            sockets.push(socket);
        }
        assert!(Instant::now() < deadline, "the sessions are not freed");
    }
}

#[test]
fn a_hundred_pages_do_no_harm() {
    let server = start(options());
    let mut sockets: Vec<_> = (0..100).map(|_| server.open()).collect();
    let answered = sockets.iter_mut().filter_map(|socket| ask(socket, NOTHING).ok()).count();
    assert_eq!(answered, Limits::default().sessions);
    assert_eq!(server.get("/host.json").status, 200);
}

#[test]
fn a_message_that_is_too_large_ends_the_session() {
    let server = start_with(Limits { message: 1000, ..Limits::default() });
    let mut socket = server.open();
    assert!(ask(&mut socket, &format!("{NOTHING}{}", " ".repeat(900))).is_ok());
    let large = ask(&mut socket, &" ".repeat(1001));
    let reason = large.unwrap_err();
    assert!(reason.is_none_or(|reason| u16::from(reason.code) == 1008));
    assert!(ask(&mut socket, NOTHING).is_err());
    assert!(ask(&mut server.open(), NOTHING).is_ok());
}

#[test]
fn a_session_without_requests_ends() {
    let server = start_with(Limits { silence: Duration::from_millis(300), ..Limits::default() });
    let mut socket = server.open();
    assert!(ask(&mut socket, NOTHING).is_ok());
    let Ok(Message::Close(Some(reason))) = socket.read() else { panic!("the session does not end") };
    assert_eq!(u16::from(reason.code), 1001);
    assert!(reason.reason.contains("was not in use"), "{}", reason.reason);
}

#[test]
fn a_server_stops_after_the_last_browser() {
    let limits = Limits { reload: Duration::from_millis(200), ..Limits::default() };
    let server = start(Options { stops_when_closed: true, limits, ..options() });
    let [mut first, mut second] = [server.open(), server.open()];
    assert!(ask(&mut first, NOTHING).is_ok() && ask(&mut second, NOTHING).is_ok());
    drop(first);
    std::thread::sleep(Duration::from_millis(500));
    assert!(ask(&mut second, NOTHING).is_ok() && !server.thread.is_finished());
    drop(second);
    server.thread.join().unwrap();
}
