//! Connections that do nothing, and ports.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpListener;
use std::time::{Duration, Instant};

use patchcord_server::{Limits, Options, Server, ServerError};

use crate::client::{options, start, start_with};

#[test]
fn a_hundred_idle_connections_do_no_harm() {
    let server = start(options());
    let mut idle: Vec<_> = (0..100).map(|_| server.connect()).collect();
    for stream in idle.iter_mut().step_by(2) {
        stream.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
    }
    let started = Instant::now();
    assert_eq!(server.get("/host.json").status, 200);
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", started.elapsed());
}

/// Whatever the client sends, the connection ends. A connection for which there is no place is served then.
#[test]
fn connections_without_a_complete_request_are_closed() {
    let limits = Limits { connections: 4, header: Duration::from_millis(300), ..Limits::default() };
    let server = start_with(limits);
    let idle: Vec<_> = ["", "GET / HT", "GET / HTTP/1.1\r\nHost: a\r\n", ""]
        .map(|begin| {
            let mut stream = server.connect();
            stream.write_all(begin.as_bytes()).unwrap();
            stream
        })
        .into();
    assert_eq!(server.get("/host.json").status, 200);
    for mut stream in idle {
        // The end of the connection, or its reset, but not the end of the test's patience.
        match stream.read_to_end(&mut Vec::new()) {
            Ok(_) => (),
            Err(error) => assert_eq!(error.kind(), ErrorKind::ConnectionReset),
        }
    }
}

#[test]
fn a_header_that_is_too_large_is_refused() {
    let server = start(options());
    let mut stream = server.connect();
    let header = format!("GET / HTTP/1.1\r\nHost: {}\r\nA: {}", server.address, "a".repeat(1 << 20));
    // The server may close the connection before it has everything.
    let _ = stream.write_all(header.as_bytes());
    let mut response = Vec::new();
    let _ = stream.read_to_end(&mut response);
    assert!(!response.starts_with(b"HTTP/1.1 200"));
    assert_eq!(server.get("/host.json").status, 200);
}

#[test]
fn a_port_in_use_is_reported() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = other.local_addr().unwrap().port();
    let refused = Server::bind(Options { port: Some(port), ..options() }).err();
    assert!(matches!(refused, Some(ServerError::PortInUse(in_use)) if in_use == port), "{refused:?}");
}

#[test]
fn servers_without_a_given_port_have_different_ones() {
    let servers = [(); 12].map(|()| Server::bind(Options { port: None, ..options() }).unwrap());
    let ports: std::collections::BTreeSet<u16> =
        servers.iter().map(|server| server.address().port()).collect();
    assert_eq!(ports.len(), 12);
}
