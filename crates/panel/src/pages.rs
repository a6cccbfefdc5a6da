//! The pages of the panel, as bytes in the program.

/// A file of the panel's pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its path in the folder `page`, which is its address below that of the panel: "js/main.js".
    pub path: &'static str,
    /// Its MIME type.
    pub kind: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

/// The row of a file.
macro_rules! page {
    ($path:literal, $kind:expr) => {
        Page { path: $path, kind: $kind, bytes: include_bytes!(concat!("../page/", $path)) }
    };
}

/// Type of pictures.
const PICTURE: &str = "image/svg+xml";

/// All pages, in alphabetical order of their paths.
pub const PAGES: &[Page] = &[page!("icon.svg", PICTURE)];

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
    fn types_follow_from_the_endings() {
        for page in PAGES {
            let expected = match page.path.rsplit_once('.').unwrap().1 {
                "css" => "text/css; charset=utf-8",
                "html" => "text/html; charset=utf-8",
                "js" => "text/javascript; charset=utf-8",
                "json" => "application/json",
                "svg" => "image/svg+xml",
                ending => panic!("no type for {ending}: {}", page.path),
            };
            assert_eq!(page.kind, expected, "{}", page.path);
        }
    }
}
