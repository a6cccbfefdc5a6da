//! `patchcord panel`

use std::io;
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

use clap::Args;
use patchcord_server::{GivenPatch, Limits, Options, Server, ServerError};

use super::failure::Failure;
use super::files::path_text;
use super::panel_export::{Export, export};
use super::standard_streams::{STANDARD_INPUT_NAME, is_dash};
use super::{eprint, print};
use patchcord::document::{DocumentError, escape_controls, read_text, read_text_from};
use patchcord::output::io_reason;

/// What the panel may do.
const SAFETY: &str = "\
The panel is a page of a server on this computer. Its address has a token, without which nobody can use
the panel. Other users of the computer can see the address in the list of processes when a browser is
opened with it; --no-open avoids that. Patches and their tables are read only in the folder of the patch
and below it, and the server writes no files. Without a patch, that is the working directory. A browser
saves patches in its own folder for downloads.";

#[derive(Args)]
#[command(after_help = SAFETY)]
pub(super) struct Arguments {
    /// Patch file (JSON) on the panel, also with faults; - reads standard input. Without it, the page begins with the gallery
    patch: Option<PathBuf>,
    /// Port of the server; 0 selects any free port. The default is 1451, or the next one that is free
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Address at which the server listens. Any other one than the default lets other computers use the panel
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    address: IpAddr,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
    /// Stop after the last browser has closed the panel
    #[arg(long)]
    exit_when_closed: bool,
    /// Write the panel with the patch as one file, which a browser opens without a network, instead of starting a server.
    /// Tables of the patch become a part of it
    #[arg(
        long,
        value_name = "FILE.html",
        conflicts_with_all = ["port", "address", "no_open", "exit_when_closed"]
    )]
    export: Option<PathBuf>,
    /// Folder with the panel for --export, as crates/web/build-site makes it. Without it, the folder "site" is looked for
    /// next to the command and in the target folder of a build
    #[arg(long, value_name = "FOLDER", requires = "export")]
    site: Option<PathBuf>,
}

/// Writes the panel, or serves it until the command is interrupted or the last browser has closed it.
pub(super) fn panel(arguments: &Arguments) -> Result<(), Failure> {
    let path = arguments.patch.as_deref();
    let patch = path.map(given_patch).transpose()?;
    match &arguments.export {
        Some(file) => export(&Export {
            file,
            site: arguments.site.as_deref(),
            patch: path.zip(patch),
            folder: folder(path),
        }),
        None => serve(arguments, patch),
    }
}

/// Serves the panel with a patch.
fn serve(arguments: &Arguments, patch: Option<GivenPatch>) -> Result<(), Failure> {
    let options = Options {
        address: arguments.address,
        port: arguments.port,
        patch,
        folder: folder(arguments.patch.as_deref()),
        stops_when_closed: arguments.exit_when_closed,
        limits: Limits::default(),
    };
    let server = Server::bind(options).map_err(|error| failure(&error))?;
    if !arguments.address.is_loopback() {
        let folder = path_text(&folder(arguments.patch.as_deref()));
        eprint(&format!(
            "warning: other computers can reach {}: whoever has its address with the token can use the panel and \
             read the patches and tables below {folder}. The connection is not encrypted",
            server.address()
        ));
    }
    let url = server.url();
    print(&format!("The panel is at {url}\nCtrl-C stops it.\n"))?;
    if !arguments.no_open {
        open_browser(url);
    }
    server.run().map_err(|error| failure(&error))
}

/// The patch that the panel opens. Its text may have faults, which the panel shows.
///
/// # Errors
/// If it cannot be read.
fn given_patch(path: &Path) -> Result<GivenPatch, DocumentError> {
    if is_dash(path) {
        let text = read_text_from(io::stdin().lock(), STANDARD_INPUT_NAME)?;
        return Ok(GivenPatch { name: STANDARD_INPUT_NAME.to_owned(), text });
    }
    let name = path.file_name().unwrap_or_default().display().to_string();
    Ok(GivenPatch { name, text: read_text(path)? })
}

/// The folder of the panel, below which sessions read patches and tables: that of the patch, or the working directory.
fn folder(patch: Option<&Path>) -> PathBuf {
    let parent = patch.filter(|path| !is_dash(path)).and_then(Path::parent);
    parent.filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

/// The failure for an error of the server, with the option that helps.
fn failure(error: &ServerError) -> Failure {
    match error {
        ServerError::PortInUse(_) => {
            Failure::usage(format!("{error}: give another port with --port, or --port 0 for any free one"))
        }
        ServerError::Address { address, source } => Failure::usage(format!(
            "cannot listen at {address}: {}: give another --address or --port",
            io_reason(source)
        )),
        error => Failure::data(escape_controls(&error.to_string())),
    }
}

/// The program that opens an address in the user's browser, with its first arguments.
const OPENER: (&str, &[&str]) = if cfg!(target_os = "macos") {
    ("open", &[])
} else if cfg!(windows) {
    ("rundll32", &["url.dll,FileProtocolHandler"])
} else {
    ("xdg-open", &[])
};

/// Opens an address in the user's browser, on a thread of its own: some openers end only with the browser. If there is
/// no browser, the user has the printed address.
fn open_browser(url: String) {
    let (program, arguments) = OPENER;
    thread::spawn(move || {
        let mut opener = Command::new(program);
        opener.args(arguments).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if !opener.status().is_ok_and(|status| status.success()) {
            eprint("no browser could be opened: open the address in one");
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_in_the_folder_of_the_patch() {
        let cases = [
            (None, "."),
            (Some("-"), "."),
            (Some("spring.json"), "."),
            (Some("a/spring.json"), "a"),
            (Some("/a/b/spring.json"), "/a/b"),
        ];
        for (patch, expected) in cases {
            assert_eq!(folder(patch.map(Path::new)), Path::new(expected), "{patch:?}");
        }
    }
}
