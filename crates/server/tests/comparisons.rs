//! Comparisons with measured data: who may begin one, how a search reports its progress, and when it ends.

use std::net::TcpStream;
use std::time::{Duration, Instant};

use patchcord_server::{Limits, Options};
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::client::{NOTHING, Running, ask, options, start, start_with};

/// A patch that lacks an effect, and the data that show it.
const PATCH: &str = include_str!("../../../examples/05_missing_effect/spring.json");
/// See [`PATCH`].
const DATA: &str = include_str!("../../../examples/05_missing_effect/measured.csv");

/// The address of comparisons.
const COMPARE: &str = "/compare";

/// Rows of data with which a search takes about a minute.
const MANY_ROWS: u32 = 20_000;

/// The longest time until a closed comparison is free again, which is shorter than a search with [`MANY_ROWS`].
const FREEING_TIME: Duration = Duration::from_secs(10);

/// A request with one command.
fn request(id: u64, command: &Value) -> String {
    json!({"id": id, "commands": [command]}).to_string()
}

/// Sends a request, and returns the response, which has the event.
fn event(socket: &mut WebSocket<TcpStream>, command: &Value, name: &str) -> Value {
    let answer: Value = serde_json::from_str(&ask(socket, &request(1, command)).unwrap()).unwrap();
    let events = answer["events"].as_array().unwrap();
    let found = events.iter().find(|event| event["event"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {answer}")).clone()
}

/// The position of a mass on a spring with viscous friction, x'' = -16 x - 0.8 x', with a disturbance of at most 0.3 mm.
fn many_rows() -> String {
    let row = |index: u32| {
        let t = 8.0 * f64::from(index) / f64::from(MANY_ROWS);
        let disturbance = 0.3 * f64::from(index * index % 997).sin();
        format!("{t},{}\n", 50.0 * (-0.4 * t).exp() * (15.84_f64.sqrt() * t).cos() + disturbance)
    };
    (0..MANY_ROWS).map(row).fold("# t: s\n# x: mm\nt,x\n".to_owned(), |text, row| text + &row)
}

/// Compares the patch with data.
fn compare_with(socket: &mut WebSocket<TcpStream>, data: &str) {
    let begin = json!({
        "command": "begin",
        "patch": {"name": "spring.json", "text": PATCH},
        "data": {"name": "measured.csv", "text": data},
    });
    event(socket, &begin, "columns");
    let compare = json!({"command": "compare", "experiment": {"outputs": {"x": "x"}, "fit": ["k"]}});
    event(socket, &compare, "curves");
}

/// The next response of a search.
fn response(socket: &mut WebSocket<TcpStream>) -> Value {
    match socket.read() {
        Ok(Message::Text(text)) => serde_json::from_str(text.as_str()).unwrap(),
        other => panic!("{other:?}"),
    }
}

/// The command of a search.
fn search() -> Value {
    json!({"command": "search", "seed": 1})
}

#[test]
fn a_comparison_needs_the_token_and_the_page_of_the_panel() {
    let server = start(options());
    let right = format!("{COMPARE}?token={}", server.token);
    let page = format!("Origin: http://{}", server.address);
    for origin in ["Origin: http://evil.example", "Origin: null", "Accept: */*"] {
        assert_eq!(server.upgrade_status(&right, origin), 403, "{origin}");
    }
    for path in [COMPARE.to_owned(), format!("{COMPARE}?token="), format!("{right}0")] {
        assert_eq!(server.upgrade_status(&path, &page), 403, "{path}");
    }
    let answer = ask(&mut server.open_at(COMPARE), NOTHING).unwrap();
    assert!(answer.contains("\"id\":1") && answer.contains("\"frame\":false"), "{answer}");
}

#[test]
fn a_comparison_beyond_the_limit_is_refused_with_a_reason() {
    let server = start(options());
    let mut sockets = [(); 2].map(|()| server.open_at(COMPARE));
    assert!(sockets.iter_mut().all(|socket| ask(socket, NOTHING).is_ok()));
    let reason = ask(&mut server.open_at(COMPARE), NOTHING).unwrap_err().unwrap();
    assert_eq!(u16::from(reason.code), 1013);
    assert!(reason.reason.starts_with("2 panels compare measured data"), "{}", reason.reason);
    // Sessions have places of their own.
    assert!(ask(&mut server.open(), NOTHING).is_ok());
    assert!(sockets.iter_mut().all(|socket| ask(socket, NOTHING).is_ok()));
}

#[test]
fn a_search_reports_its_progress_before_its_outcome() {
    // A page that waits for a search sends nothing for longer than a silent one may stay.
    let server = start_with(Limits { silence: Duration::from_secs(1), ..Limits::default() });
    let mut socket = server.open_at(COMPARE);
    compare_with(&mut socket, DATA);
    socket.send(Message::text(request(8, &search()))).unwrap();
    let mut partial = 0;
    let last = loop {
        let response = response(&mut socket);
        assert_eq!(response["id"], 8, "{response}");
        if response["partial"] != true {
            break response;
        }
        assert_eq!(response["events"][0]["event"], "progress", "{response}");
        partial += 1;
    };
    assert!(partial > 0);
    let found = last["events"].as_array().unwrap().iter().find(|event| event["event"] == "found");
    let sentence = found.unwrap()["sentence"].as_str().unwrap();
    assert!(sentence.contains("viscous-friction"), "{last}");
    // The comparison continues.
    assert!(ask(&mut socket, NOTHING).is_ok());
}

/// A comparison in the only place, which becomes free when the thread of the closed one ends.
fn open_when_free(server: &Running) -> WebSocket<TcpStream> {
    let deadline = Instant::now() + FREEING_TIME;
    loop {
        let mut socket = server.open_at(COMPARE);
        if ask(&mut socket, NOTHING).is_ok() {
            return socket;
        }
        assert!(Instant::now() < deadline, "the comparison is not freed");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_search_ends_when_its_page_closes_the_connection() {
    let server = start_with(Limits { comparisons: 1, ..Limits::default() });
    let (data, mut socket) = (many_rows(), server.open_at(COMPARE));
    // A page that closes properly, one that vanishes, and one that does not wait for its other requests.
    for (is_closed, further) in [(true, 0), (false, 0), (false, 5)] {
        compare_with(&mut socket, &data);
        socket.send(Message::text(request(8, &search()))).unwrap();
        for _ in 0..further {
            socket.send(Message::text(NOTHING)).unwrap();
        }
        assert_eq!(response(&mut socket)["partial"], true);
        if is_closed {
            socket.close(None).unwrap();
        }
        drop(socket);
        socket = open_when_free(&server);
    }
}

#[test]
fn a_comparison_without_requests_ends() {
    let server = start_with(Limits { silence: Duration::from_millis(300), ..Limits::default() });
    let mut socket = server.open_at(COMPARE);
    assert!(ask(&mut socket, NOTHING).is_ok());
    let Ok(Message::Close(Some(reason))) = socket.read() else { panic!("the comparison does not end") };
    assert_eq!(u16::from(reason.code), 1001);
    assert!(reason.reason.contains("measured data were not in use"), "{}", reason.reason);
}

#[test]
fn a_message_to_a_comparison_has_a_limit_of_its_own() {
    let server = start_with(Limits { message: 100, comparison_message: 1000, ..Limits::default() });
    let mut socket = server.open_at(COMPARE);
    assert!(ask(&mut socket, &format!("{NOTHING}{}", " ".repeat(900))).is_ok());
    assert!(ask(&mut socket, &" ".repeat(1001)).is_err());
}

/// A page that shows measured data also has a session. Its comparison alone does not keep the server running.
#[test]
fn a_server_does_not_wait_for_comparisons() {
    let limits = Limits { reload: Duration::from_millis(200), ..Limits::default() };
    let server = start(Options { stops_when_closed: true, limits, ..options() });
    let mut comparison = server.open_at(COMPARE);
    compare_with(&mut comparison, &many_rows());
    comparison.send(Message::text(request(8, &search()))).unwrap();
    assert_eq!(response(&mut comparison)["partial"], true);
    let mut session = server.open();
    assert!(ask(&mut session, NOTHING).is_ok());
    drop(session);
    server.thread.join().unwrap();
}
