//! The pages of the panel, as bytes in the program.

/// A file of the panel's pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its path in the folder `page`, which is its address below that of the panel: "js/main.js".
    pub path: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

impl Page {
    /// Its MIME type, which follows from the ending of its path.
    pub fn kind(&self) -> &'static str {
        match self.path.rsplit_once('.').map_or("", |(_, ending)| ending) {
            "css" => "text/css; charset=utf-8",
            "html" => "text/html; charset=utf-8",
            "js" => "text/javascript; charset=utf-8",
            "json" => "application/json",
            "svg" => "image/svg+xml",
            _ => "application/octet-stream",
        }
    }
}

/// The table of files with these paths.
macro_rules! pages {
    ($($path:literal),* $(,)?) => {
        &[$(Page { path: $path, bytes: include_bytes!(concat!("../page/", $path)) }),*]
    };
}

/// All pages, in alphabetical order of their paths.
pub const PAGES: &[Page] = pages![
    "css/knobs.css",
    "css/panel.css",
    "css/scope.css",
    "icon.svg",
    "index.html",
    "js/controls.js",
    "js/dial.js",
    "js/dom.js",
    "js/files.js",
    "js/frame.js",
    "js/keys.js",
    "js/knobs.js",
    "js/lamps.js",
    "js/link.js",
    "js/loop.js",
    "js/main.js",
    "js/messages.js",
    "js/meters.js",
    "js/scope-controls.js",
    "js/scope-export.js",
    "js/scope-grid.js",
    "js/scope-marks.js",
    "js/scope-screen.js",
    "js/scope-trace.js",
    "js/scope.js",
    "js/state.js",
    "js/theme.js",
    "worker/engine.js",
];

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// The paths of the files below a folder, relative to `root`, with / between their parts.
    fn files(root: &Path, folder: &Path, found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                files(root, &path, found);
            } else {
                let inside = path.strip_prefix(root).unwrap();
                let parts: Vec<&str> = inside.iter().map(|part| part.to_str().unwrap()).collect();
                found.push(parts.join("/"));
            }
        }
    }

    #[test]
    fn the_table_has_all_files_of_the_folder() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        let mut found = Vec::new();
        files(&root, &root, &mut found);
        found.sort();
        let listed: Vec<&str> = PAGES.iter().map(|page| page.path).collect();
        assert_eq!(listed, found);
    }

    #[test]
    fn every_page_has_a_type() {
        for page in PAGES {
            assert_ne!(page.kind(), "application/octet-stream", "{}", page.path);
        }
    }
}
