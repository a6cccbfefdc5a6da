//! `patchcord panel`: its messages, and the server that it starts.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{FIG_8_16, code, errors, out, patchcord, path};

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
    /// Starts the command with a patch or an option.
    fn start(argument: &str) -> Panel {
        let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
        command.args(["panel", "--no-open", "--port", "0", argument]);
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
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
fn a_panel_for_other_computers_has_a_warning() {
    let mut panel = Panel::start("--address=0.0.0.0");
    let mut warning = String::new();
    BufReader::new(panel.process.stderr.take().unwrap()).read_line(&mut warning).unwrap();
    assert!(warning.starts_with("warning: other computers can reach 0.0.0.0:"), "{warning}");
    assert!(warning.contains("not encrypted"), "{warning}");
    // The address is one for this computer.
    assert!(panel.host.starts_with("127.0.0.1:"), "{}", panel.host);
    assert!(panel.get("/host.json").starts_with("HTTP/1.1 200 "));
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

/// A page as `crates/web/build-site` makes it, without most of its files.
const PAGE: &str =
    r#"<!doctype html><script type="text/plain" data-path="host.json">{"host": "worker"}</script>"#;

/// A folder with a page for `--export`, and a patch with this text.
fn site(page: &str, patch: &str) -> (TempDir, String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("patchcord.html"), page).unwrap();
    let file = path(&folder, "spring.json");
    fs::write(&file, patch).unwrap();
    let site = folder.path().to_str().unwrap().to_owned();
    (folder, site, file)
}

/// The document of the host in an exported page.
fn host(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"data-path="host.json">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_patch_is_exported_as_one_file() {
    // The panel also opens patches with faults.
    let hostile = "{\"patchcord\": 1, \"title\": \"</script><script>alert(1)</script>\"}\r\n";
    for text in [hostile, "no patch </script>"] {
        let (folder, site, patch) = site(PAGE, text);
        let file = path(&folder, "page.html");
        let ran = patchcord(&["panel", "--export", &file, "--site", &site, &patch]);
        assert_eq!((code(&ran), errors(&ran)), (0, String::new()));
        assert_eq!(out(&ran), format!("wrote {file}\nA browser opens it without a network.\n"));
        let page = fs::read_to_string(&file).unwrap();
        assert_eq!(host(&page), json!({ "host": "worker", "patch": "spring.json", "text": text }));
        assert_eq!(page.matches('<').count(), PAGE.matches('<').count());
    }
}

#[test]
fn a_page_without_a_patch_is_exported_as_it_is() {
    let (folder, site, _) = site(PAGE, "");
    let file = path(&folder, "page.html");
    assert_eq!(code(&patchcord(&["panel", "--export", &file, "--site", &site])), 0);
    assert_eq!(fs::read_to_string(&file).unwrap(), PAGE);
}

#[test]
fn tables_of_an_exported_patch_are_in_its_text() {
    let text = r#"{"patchcord": 1, "scales": {"V": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "table", "scale": "V", "points": {"csv": "u.csv"}}}}"#;
    let (folder, site, patch) = site(PAGE, text);
    let (file, table) = (path(&folder, "page.html"), path(&folder, "u.csv"));
    let export = || patchcord(&["panel", "--export", &file, "--site", &site, &patch]);
    let ran = export();
    assert_eq!(code(&ran), 1);
    assert!(errors(&ran).contains("bad-table") && errors(&ran).contains("u.csv"), "{}", errors(&ran));
    assert!(!fs::exists(&file).unwrap());

    fs::write(&table, "t,u\n0,0\n1,50\n").unwrap();
    assert_eq!(code(&export()), 0);
    let page = fs::read_to_string(&file).unwrap();
    let inside = text.replace(r#"{"csv": "u.csv"}"#, "[[0.0,0.0],[1.0,50.0]]");
    assert_eq!(host(&page)["text"], inside);

    let row = |index: usize| format!("{index},{}\n", 0.5 + 1.0 / (index + 3) as f64);
    fs::write(&table, format!("t,u\n{}", (0..60_000).map(row).collect::<String>())).unwrap();
    let message =
        "error: the patch with the points of its tables is larger than 1 MB, too large for the panel\n";
    let ran = export();
    assert_eq!((code(&ran), errors(&ran).as_str()), (1, message));
    assert_eq!(fs::read_to_string(&file).unwrap(), page, "the file stays as it was");
}

#[test]
fn a_page_that_cannot_be_exported_is_an_error() {
    let (folder, site, patch) = site("<!doctype html>", "{}");
    let file = path(&folder, "page.html");
    let export = |file: &str, site: &str| {
        let ran = patchcord(&["panel", "--export", file, "--site", site, &patch]);
        (code(&ran), errors(&ran))
    };
    let other = format!(
        "error: {site}/patchcord.html has a patch already, or is of another version of patchcord: make its \
         folder again with crates/web/build-site\n"
    );
    assert_eq!(export(&file, &site), (1, other));
    let empty = path(&folder, "empty");
    let missing = format!(
        "error: patchcord.html is not in {empty}: make the folder with crates/web/build-site, or name \
         another with --site\n"
    );
    assert_eq!(export(&file, &empty), (2, missing));
    let name = format!("error: the name of a page must end in .html, such as {patch}.html\n");
    assert_eq!(export(&patch, &site), (2, name));
    assert!(!fs::exists(&file).unwrap());
}

#[test]
fn an_export_does_not_overwrite_what_it_reads() {
    let (_folder, site, patch) = site(PAGE, "{}");
    let page = format!("{site}/patchcord.html");
    let ran = patchcord(&["panel", "--export", &page, "--site", &site, &patch]);
    let message =
        format!("error: {page} is the page to export itself: give another name or folder to write to\n");
    assert_eq!((code(&ran), errors(&ran)), (2, message));
    assert_eq!(fs::read_to_string(&page).unwrap(), PAGE);
}

#[test]
fn options_of_the_server_are_not_for_an_export() {
    for option in ["--port=0", "--address=127.0.0.1", "--no-open", "--exit-when-closed"] {
        let ran = patchcord(&["panel", "--export", "page.html", option]);
        assert_eq!(code(&ran), 2);
        assert!(errors(&ran).contains("cannot be used with"), "{}", errors(&ran));
    }
    assert_eq!(code(&patchcord(&["panel", "--site", "site"])), 2);
}
