//! Pages and documents: who gets them, with which headers.

use patchcord_panel::pages::PAGES;
use patchcord_panel::patches::{DATA, PATCHES, gallery};

use crate::client::{options, start};

/// Every address that has an answer; one page and one patch stand for all of them.
const ADDRESSES: [&str; 7] =
    ["/", "/host.json", "/gallery.json", "/patches/lessons/lorenz.json", "/patch", "/session", "/compare"];

#[test]
fn requests_that_name_another_server_are_refused() {
    let server = start(options());
    let port = server.address.port();
    let names = ["evil.example", "localhost.evil.example", "192.168.0.1", "evil.example:80:localhost"];
    let wrong = names.iter().map(|name| format!("Host: {name}:{port}"));
    let wrong =
        wrong.chain(["Host: localhost".to_owned(), "Host: localhost:1".to_owned(), "A: b".to_owned()]);
    for host in wrong {
        for path in ADDRESSES {
            let response = server.send(&[&format!("GET {path} HTTP/1.1"), &host]);
            // The library itself refuses a request without the header.
            assert!([400, 403].contains(&response.status), "{host} {path}: {}", response.status);
            assert!(!response.headers.contains("ws://"), "{}", response.headers);
        }
    }
    for name in ["localhost", "LocalHost", "127.0.0.1", "[::1]"] {
        let host = format!("Host: {name}:{port}");
        assert_eq!(server.send(&["GET /host.json HTTP/1.1", &host]).status, 200, "{host}");
    }
    let host = format!("Host: localhost:{port}");
    assert_ne!(server.send(&["GET /host.json HTTP/1.1", &host, "Host: evil.example"]).status, 200);
}

#[test]
fn all_pages_are_served_with_their_types() {
    let server = start(options());
    for page in PAGES {
        let response = server.get(&format!("/{}", page.path));
        assert_eq!(
            (response.status, response.body.as_slice()),
            (200, page.content().as_bytes()),
            "{}",
            page.path
        );
        let kind = format!("\r\ncontent-type: {}\r\n", page.kind());
        assert!(response.headers.contains(&kind), "{}: {}", page.path, response.headers);
    }
    let first = PAGES.iter().find(|page| page.path == "index.html").unwrap();
    assert_eq!(server.get("/").body, first.content().as_bytes());
    assert_eq!(server.get("/?patch=a.json").body, first.content().as_bytes());
}

#[test]
fn the_gallery_and_its_patches_are_served_without_the_token() {
    let server = start(options());
    let response = server.get("/gallery.json");
    assert_eq!((response.status, response.body.as_slice()), (200, gallery().to_string().as_bytes()));
    assert!(response.headers.contains("\r\ncontent-type: application/json\r\n"), "{}", response.headers);
    for patch in PATCHES {
        let response = server.get(&format!("/patches/{}", patch.path));
        assert_eq!(
            (response.status, response.body.as_slice()),
            (200, patch.text.as_bytes()),
            "{}",
            patch.path
        );
        assert!(response.headers.contains("\r\ncontent-type: application/json\r\n"), "{}", response.headers);
    }
    for data in DATA {
        let response = server.get(&format!("/patches/{}", data.path));
        assert_eq!((response.status, response.body.as_slice()), (200, data.text.as_bytes()), "{}", data.path);
        let kind = "\r\ncontent-type: text/csv; charset=utf-8\r\n";
        assert!(response.headers.contains(kind), "{}", response.headers);
    }
}

#[test]
fn only_pages_are_served() {
    let server = start(options());
    let paths = [
        "/no-such-page",
        "/index.html/",
        "//index.html",
        "/../Cargo.toml",
        "/js/../../Cargo.toml",
        "/%2e%2e/Cargo.toml",
        "/..%2fCargo.toml",
        "/..\\Cargo.toml",
        "//etc/passwd",
        "/src/lib.rs",
        "/lessons/lorenz.json",
        "/patches/",
        "/patches/lessons/",
        "/patches/lessons/lorenz.json/",
        "/patches/lessons/../lessons/lorenz.json",
        "/patches/../Cargo.toml",
        "/patches/%2e%2e/Cargo.toml",
        "/patches/measured/emps.experiment.json",
        "/patches/examples/05_missing_effect/main.rs",
        "/examples/05_missing_effect/measured.csv",
    ];
    for path in paths {
        let response = server.get(path);
        assert!([400, 404].contains(&response.status), "{path}: {}", response.status);
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        for path in ADDRESSES {
            let host = format!("Host: {}", server.address);
            let response = server.send(&[&format!("{method} {path} HTTP/1.1"), &host, "Content-Length: 0"]);
            assert_eq!(response.status, 405, "{method} {path}");
        }
    }
}

#[test]
fn every_response_has_the_policy() {
    let server = start(options());
    let policy = format!(
        "\r\ncontent-security-policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
         img-src 'self' data: blob:; connect-src 'self' ws://{}; worker-src 'self'; font-src 'self'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'\r\n",
        server.address
    );
    for path in ADDRESSES.into_iter().chain(["/no-such-page"]) {
        let headers = server.get(path).headers;
        assert!(headers.contains(&policy), "{path}: {headers}");
        for header in [
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
            "cross-origin-opener-policy: same-origin",
            "cross-origin-resource-policy: same-origin",
        ] {
            assert!(headers.contains(&format!("\r\n{header}\r\n")), "{path}: {headers}");
        }
        assert!(!headers.contains("access-control-allow"), "{path}: {headers}");
    }
}

#[test]
fn the_patch_needs_the_token() {
    let server = start(options());
    for query in ["", "?token=", "?token=00000000000000000000000000000000"] {
        assert_eq!(server.get(&format!("/patch{query}")).status, 403, "{query}");
    }
    let response = server.get(&format!("/patch?token={}", server.token));
    assert_eq!((response.status, response.body.as_slice()), (200, &b"{\"patchcord\": 1}"[..]));
    let document = server.get("/host.json").body;
    assert_eq!(document, br#"{"host":"server","patch":"a \"b\".json"}"#);

    let empty = start(patchcord_server::Options { patch: None, ..options() });
    assert_eq!(empty.get("/host.json").body, br#"{"host":"server","patch":null}"#);
    assert_eq!(empty.get(&format!("/patch?token={}", empty.token)).status, 404);
}
