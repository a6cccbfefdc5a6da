//! The names of the server in requests.
//!
//! A page of another site can lead a browser to this server under a name of that site, whose address it changes after
//! the page was loaded. The browser then regards both as one site. Such a request has the other name in its header
//! `Host`, so it is refused.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

/// The names that lead to a loopback address on every computer.
const LOOPBACK: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// The port of addresses without a port.
const HTTP_PORT: u16 = 80;

/// The permitted values of the header `Host`.
pub(crate) struct Names {
    /// The address at which the server listens.
    address: SocketAddr,
}

impl Names {
    /// The names of a server that listens at this address.
    pub(crate) fn new(address: SocketAddr) -> Self {
        Names { address }
    }

    /// Whether a request with this header `Host` is for this server. If the server listens at all addresses of the
    /// computer, each of them is a name; addresses cannot be changed by another site.
    pub(crate) fn has(&self, host: &str) -> bool {
        let (name, port) = name_and_port(host);
        let is_loopback = LOOPBACK.iter().any(|known| known.eq_ignore_ascii_case(name));
        let is_own = address(name)
            .is_some_and(|named| self.address.ip().is_unspecified() || named == self.address.ip());
        port == Some(self.address.port()) && (is_loopback || is_own)
    }
}

/// The parts of a header `Host`. The port is `None` if it is not a number.
fn name_and_port(host: &str) -> (&str, Option<u16>) {
    match host.rsplit_once(':') {
        // The colon is in an address in brackets.
        Some((_, rest)) if rest.ends_with(']') => (host, Some(HTTP_PORT)),
        Some((name, port)) if port.bytes().all(|digit| digit.is_ascii_digit()) => (name, port.parse().ok()),
        Some((name, _)) => (name, None),
        None => (host, Some(HTTP_PORT)),
    }
}

/// The address in a header `Host`; `None` if it has a name.
fn address(name: &str) -> Option<IpAddr> {
    match name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(inside) => inside.parse::<Ipv6Addr>().ok().map(IpAddr::V6),
        None => name.parse::<Ipv4Addr>().ok().map(IpAddr::V4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of a server at an address.
    fn names(address: &str) -> Names {
        Names::new(address.parse().unwrap())
    }

    #[test]
    fn a_server_at_the_loopback_address_has_its_names_only() {
        let names = names("127.0.0.1:1451");
        for host in ["localhost:1451", "LocalHost:1451", "127.0.0.1:1451", "[::1]:1451"] {
            assert!(names.has(host), "{host}");
        }
        for host in [
            "",
            ":1451",
            "localhost",
            "localhost:",
            "localhost:80",
            "localhost:+1451",
            "localhost:1451:1451",
            "::1:1451",
            "192.168.0.1:1451",
            "example.org:1451",
            "localhost.example.org:1451",
            "127.0.0.1",
        ] {
            assert!(!names.has(host), "{host}");
        }
    }

    #[test]
    fn the_port_of_the_web_may_be_omitted() {
        let names = names("[::1]:80");
        assert!(names.has("localhost") && names.has("[::1]") && names.has("[::1]:80"));
        assert!(!names.has("[::1]:81") && !names.has("example.org"));
    }

    #[test]
    fn another_address_is_a_name_of_its_server() {
        let own = names("192.168.0.1:1451");
        assert!(own.has("192.168.0.1:1451") && !own.has("192.168.0.2:1451"));
        let all = names("0.0.0.0:1451");
        assert!(all.has("192.168.0.2:1451") && all.has("[fe80::1]:1451"));
        assert!(!all.has("example.org:1451") && !all.has("[example.org]:1451"));
    }
}
