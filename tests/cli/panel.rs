//! `patchcord panel`: its messages, and the server that it starts.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};

use super::{FIG_8_16, code, errors, patchcord, path};

/// A panel that runs until this is dropped.
struct Panel {
    /// The command.
    process: Child,
    /// The name and port of its server.
    host: String,
    /// The token of its address.
    token: String,
}

impl Panel {
    /// Starts the command with a patch.
    fn start(patch: &str) -> Panel {
        let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
        command.args(["panel", "--no-open", "--port", "0", patch]).stdout(Stdio::piped());
        let mut process = command.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let url = line.trim_end().strip_prefix("The panel is at http://").unwrap();
        let (host, token) = url.split_once("/#token=").unwrap();
        Panel { process, host: host.to_owned(), token: token.to_owned() }
    }

    /// The response to a request for this path.
    fn get(&self, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.host).unwrap();
        let mut response = String::new();
        stream.read_to_string(&mut response).unwrap();
        response
    }
}

impl Drop for Panel {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

#[test]
fn the_panel_serves_its_patch() {
    let panel = Panel::start(FIG_8_16);
    assert!(panel.host.starts_with("127.0.0.1:"), "{}", panel.host);
    assert!(panel.get("/host.json").ends_with("{\"host\":\"server\",\"patch\":\"fig-8-16.json\"}"));
    let response = panel.get(&format!("/patch?token={}", panel.token));
    let (_, text) = response.split_once("\r\n\r\n").unwrap();
    assert_eq!(text, fs::read_to_string(FIG_8_16).unwrap());
    assert!(panel.get("/patch").starts_with("HTTP/1.1 403 "));
}

#[test]
fn a_patch_with_faults_is_served() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "wrong.json");
    fs::write(&file, "{\"patchcord\": 1, \"elements\": 3").unwrap();
    let panel = Panel::start(&file);
    let response = panel.get(&format!("/patch?token={}", panel.token));
    assert!(response.ends_with("\r\n\r\n{\"patchcord\": 1, \"elements\": 3"), "{response}");
}

#[test]
fn a_patch_that_cannot_be_read_is_an_error() {
    let ran = patchcord(&["panel", "--no-open", "--port", "0", "no-such-file.json"]);
    assert_eq!(code(&ran), 1);
    assert!(errors(&ran).starts_with("error: cannot read no-such-file.json: "), "{}", errors(&ran));
}

#[test]
fn a_port_in_use_is_a_usage_error() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = other.local_addr().unwrap().port().to_string();
    let ran = patchcord(&["panel", "--no-open", "--port", &port]);
    let message = format!(
        "error: port {port} is in use: give another port with --port, or --port 0 for any free one\n"
    );
    assert_eq!((code(&ran), errors(&ran)), (2, message));
}

#[test]
fn an_address_of_another_computer_is_a_usage_error() {
    let ran = patchcord(&["panel", "--no-open", "--address", "203.0.113.1"]);
    assert_eq!(code(&ran), 2);
    assert!(errors(&ran).contains("give another --address or --port"), "{}", errors(&ran));
}
