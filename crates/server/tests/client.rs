//! A server in this process, and clients for it.

use std::io::{Read as _, Write as _};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpStream};
use std::path::PathBuf;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use patchcord_server::{GivenPatch, Limits, Options, Server};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::protocol::CloseFrame;
use tungstenite::{Message, WebSocket};

/// The longest time that a test waits for an answer.
const PATIENCE: Duration = Duration::from_secs(20);

/// A server that runs.
pub(crate) struct Running {
    /// Where it listens.
    pub address: SocketAddr,
    /// Its token.
    pub token: String,
    /// Its thread, which ends only if the server stops.
    pub thread: JoinHandle<()>,
}

/// The options of a test: a free port and the usual limits.
pub(crate) fn options() -> Options {
    Options {
        address: IpAddr::V4(Ipv4Addr::LOCALHOST),
        port: Some(0),
        patch: Some(GivenPatch { name: "a \"b\".json".to_owned(), text: "{\"patchcord\": 1}".to_owned() }),
        folder: PathBuf::from("."),
        stops_when_closed: false,
        limits: Limits::default(),
    }
}

/// Starts a server.
pub(crate) fn start(options: Options) -> Running {
    let server = Server::bind(options).unwrap();
    let (address, token) = (server.address(), server.token().to_owned());
    assert_eq!(server.url(), format!("http://{address}/#token={token}"));
    Running { address, token, thread: thread::spawn(move || server.run().unwrap()) }
}

/// Starts a server with other limits.
pub(crate) fn start_with(limits: Limits) -> Running {
    start(Options { limits, ..options() })
}

/// A response.
pub(crate) struct Response {
    /// Its status.
    pub status: u16,
    /// Its headers in lower case, each with its line end.
    pub headers: String,
    /// Its content.
    pub body: Vec<u8>,
}

impl Running {
    /// A connection to the server.
    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// The response to these lines of a request, to which the end of the header is added.
    pub(crate) fn send(&self, lines: &[&str]) -> Response {
        let mut stream = self.connect();
        write!(stream, "{}\r\nConnection: close\r\n\r\n", lines.join("\r\n")).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        let headers = String::from_utf8(bytes[..end + 2].to_vec()).unwrap().to_lowercase();
        let status = headers.split(' ').nth(1).unwrap().parse().unwrap();
        Response { status, headers, body: bytes[end + 4..].to_vec() }
    }

    /// The response to a request for a path, with the name and port of the server.
    pub(crate) fn get(&self, path: &str) -> Response {
        self.send(&[&format!("GET {path} HTTP/1.1"), &format!("Host: {}", self.address)])
    }

    /// The status of the response to a WebSocket at this path with its query, with a header for its origin.
    pub(crate) fn upgrade_status(&self, path: &str, origin: &str) -> u16 {
        let lines: [&str; 6] = [
            &format!("GET {path} HTTP/1.1"),
            &format!("Host: {}", self.address),
            origin,
            "Upgrade: websocket",
            "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ];
        self.send(&lines).status
    }

    /// Begins a session as the page of the panel does.
    pub(crate) fn open(&self) -> WebSocket<TcpStream> {
        self.open_at("/session")
    }

    /// Opens the WebSocket at this path as the page of the panel does.
    pub(crate) fn open_at(&self, path: &str) -> WebSocket<TcpStream> {
        let url = format!("ws://{}{path}?token={}", self.address, self.token);
        let mut request = url.into_client_request().unwrap();
        request.headers_mut().insert("origin", format!("http://{}", self.address).parse().unwrap());
        tungstenite::client(request, self.connect()).unwrap().0
    }
}

/// Sends a request to a session and returns its answer. If the session was refused or has ended, it returns the reason.
pub(crate) fn ask(socket: &mut WebSocket<TcpStream>, request: &str) -> Result<String, Option<CloseFrame>> {
    // A refused socket may be closed already. Its reason can be read in any case.
    let _ = socket.send(Message::text(request));
    match socket.read() {
        Ok(Message::Text(text)) => Ok(text.to_string()),
        Ok(Message::Close(frame)) => Err(frame),
        Ok(other) => panic!("{other:?}"),
        Err(_) => Err(None),
    }
}

/// A request without commands, whose answer has no frame.
pub(crate) const NOTHING: &str = "{\"id\": 1, \"commands\": []}";
