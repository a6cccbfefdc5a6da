//! The server: an address, and running until it stops.

use std::io::{self, ErrorKind};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;

use crate::browsers::Browsers;
use crate::connections::accept;
use crate::host::{GivenPatch, Host};
use crate::limits::Limits;
use crate::names::Names;
use crate::routes::router;
use crate::service::{Purpose, Service};
use crate::token::Token;

/// The port that is tried first, after the Solartron 1451.
pub const FIRST_PORT: u16 = 1451;

/// How many ports are tried in order before the system selects one.
const TRIED_PORTS: u16 = 10;

/// How a server is started.
#[derive(Debug, Clone)]
pub struct Options {
    /// The address at which it listens.
    pub address: IpAddr,
    /// The port; 0 for any free one. `None` for [`FIRST_PORT`], or the next one that is free.
    pub port: Option<u16>,
    /// The patch that the panel opens first.
    pub patch: Option<GivenPatch>,
    /// The folder below which sessions read patches, and sessions and comparisons read tables.
    pub folder: PathBuf,
    /// Whether the server stops after the last panel was closed.
    pub stops_when_closed: bool,
    /// The limits.
    pub limits: Limits,
}

/// Why a server cannot run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServerError {
    /// Another program has the port.
    #[error("port {0} is in use")]
    PortInUse(u16),
    /// The system does not permit the address or the port.
    #[error("cannot listen at {address}: {source}")]
    Address {
        /// The address and the port.
        address: SocketAddr,
        /// The error of the system.
        source: io::Error,
    },
    /// The system has no random numbers, so there is no token.
    #[error("the system has no random numbers: {0}")]
    NoRandomNumbers(String),
    /// The system does not permit threads or events.
    #[error("cannot start the server: {0}")]
    Start(#[from] io::Error),
}

/// A server that listens. Requests wait until it runs.
pub struct Server {
    /// Where it listens.
    listener: TcpListener,
    /// The address at which it listens, with its port.
    address: SocketAddr,
    /// What requests share.
    host: Arc<Host>,
    /// Whether it stops after the last panel was closed.
    stops_when_closed: bool,
}

impl Server {
    /// A server that listens at its address.
    ///
    /// # Errors
    /// If the port is in use, if the address does not belong to this computer, or if there is no randomness.
    pub fn bind(options: Options) -> Result<Server, ServerError> {
        let listener = listen(options.address, options.port)?;
        let address = listener.local_addr()?;
        let token = Token::random().map_err(|error| ServerError::NoRandomNumbers(error.to_string()))?;
        let host = Host {
            names: Names::new(address),
            token,
            patch: options.patch,
            folder: options.folder,
            sessions: Service::new(Purpose::Session, &options.limits),
            comparisons: Service::new(Purpose::Comparison, &options.limits),
            limits: options.limits,
            browsers: Arc::new(Browsers::new()),
        };
        Ok(Server { listener, address, host: Arc::new(host), stops_when_closed: options.stops_when_closed })
    }

    /// The address at which the server listens, with its port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The token that sessions and comparisons need.
    pub fn token(&self) -> &str {
        self.host.token.text()
    }

    /// The address of the panel for a browser on this computer, with the token. Browsers do not send the part after #
    /// to servers.
    pub fn url(&self) -> String {
        let ip = match self.address.ip() {
            IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
            IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
            ip => ip,
        };
        format!("http://{}/#token={}", SocketAddr::new(ip, self.address.port()), self.token())
    }

    /// Answers requests. Without `stops_when_closed`, it does not end.
    ///
    /// # Errors
    /// If the system does not permit the threads or events that a server needs.
    pub fn run(self) -> Result<(), ServerError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        Ok(runtime.block_on(self.serve())?)
    }

    /// Answers requests.
    async fn serve(self) -> io::Result<()> {
        self.listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(self.listener)?;
        let router = router(Arc::clone(&self.host));
        let accepting = tokio::spawn(accept(listener, router, self.host.limits.clone()));
        if self.stops_when_closed {
            self.host.browsers.all_closed(self.host.limits.reload).await;
            return Ok(());
        }
        Ok(accepting.await?)
    }
}

/// Listens at an address.
fn listen(address: IpAddr, port: Option<u16>) -> Result<TcpListener, ServerError> {
    let outcome = match port {
        Some(port) => TcpListener::bind((address, port)),
        None => listen_at_free_port(address),
    };
    let port = port.unwrap_or(FIRST_PORT);
    outcome.map_err(|source| match source.kind() {
        ErrorKind::AddrInUse => ServerError::PortInUse(port),
        _ => ServerError::Address { address: SocketAddr::new(address, port), source },
    })
}

/// Listens at the first port that can be opened, in order from [`FIRST_PORT`]. A port that no program uses can still be
/// refused, because some systems reserve ranges of ports.
fn listen_at_free_port(address: IpAddr) -> io::Result<TcpListener> {
    let mut ports = FIRST_PORT..FIRST_PORT + TRIED_PORTS;
    match ports.find_map(|port| TcpListener::bind((address, port)).ok()) {
        Some(listener) => Ok(listener),
        None => TcpListener::bind((address, 0)),
    }
}
