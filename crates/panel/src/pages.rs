//! The pages of the panel, as bytes in the program.

mod script;

/// The MIME type of scripts.
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A file of the panel's pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its path in the folder `page`, which is its address below that of the panel: "js/main.js".
    pub path: &'static str,
    /// Its text, as it is in the folder.
    text: &'static str,
}

impl Page {
    /// Its content as it is sent: style sheets without lines of comments and without indentation, and scripts also
    /// without other comments, and without the blanks and ends of lines that separate nothing.
    ///
    /// No text in them spans lines, which a test asserts, so this changes nothing else.
    pub fn content(&self) -> String {
        if self.kind() == SCRIPT {
            script::shortened(&code_lines(self.text))
        } else if self.path.ends_with(".css") {
            code_lines(self.text).iter().flat_map(|line| [*line, "\n"]).collect()
        } else {
            self.text.to_owned()
        }
    }

    /// Its MIME type, which follows from the ending of its path.
    pub fn kind(&self) -> &'static str {
        match self.path.rsplit_once('.').map_or("", |(_, ending)| ending) {
            "css" => "text/css; charset=utf-8",
            "html" => "text/html; charset=utf-8",
            "js" => SCRIPT,
            "json" => "application/json",
            "svg" => "image/svg+xml",
            _ => "application/octet-stream",
        }
    }
}

/// The lines of a script or of a style sheet without indentation, and without those that are blank or comments.
fn code_lines(text: &str) -> Vec<&str> {
    let (mut lines, mut is_comment) = (Vec::new(), false);
    for line in text.lines().map(str::trim) {
        is_comment |= line.starts_with("/*");
        if !is_comment && !line.is_empty() && !line.starts_with("//") {
            lines.push(line);
        }
        is_comment &= !line.ends_with("*/");
    }
    lines
}

/// The table of files with these paths.
macro_rules! pages {
    ($($path:literal),* $(,)?) => {
        &[$(Page { path: $path, text: include_str!(concat!("../page/", $path)) }),*]
    };
}

/// All pages, in alphabetical order of their paths.
pub const PAGES: &[Page] = pages![
    "css/board.css",
    "css/equations.css",
    "css/gallery.css",
    "css/knobs.css",
    "css/measured.css",
    "css/panel.css",
    "css/schematic.css",
    "css/scope.css",
    "faceplates/index.json",
    "faceplates/plain.json",
    "faceplates/solartron-1451.json",
    "faceplates/the-analog-thing.json",
    "icon.svg",
    "index.html",
    "js/autosave.js",
    "js/board-tools.js",
    "js/board.js",
    "js/check.js",
    "js/controls.js",
    "js/cords.js",
    "js/dial.js",
    "js/dom.js",
    "js/equations.js",
    "js/faceplate.js",
    "js/files.js",
    "js/frame.js",
    "js/gallery.js",
    "js/keys.js",
    "js/knobs.js",
    "js/lamps.js",
    "js/link.js",
    "js/loop.js",
    "js/main.js",
    "js/measured-plot.js",
    "js/measured-search.js",
    "js/measured.js",
    "js/messages.js",
    "js/meters.js",
    "js/patching.js",
    "js/probes.js",
    "js/resources.js",
    "js/schematic.js",
    "js/scope-controls.js",
    "js/scope-export.js",
    "js/scope-grid.js",
    "js/scope-screen.js",
    "js/scope-trace.js",
    "js/scope.js",
    "js/share.js",
    "js/state.js",
    "js/theme.js",
    "js/zoom.js",
    "pictures/examples/05_missing_effect/slide.svg",
    "pictures/examples/05_missing_effect/spring.svg",
    "pictures/lessons/bouncing-ball.svg",
    "pictures/lessons/driven-oscillator.svg",
    "pictures/lessons/heat-rod.svg",
    "pictures/lessons/lorenz.svg",
    "pictures/lessons/mass-and-spring.svg",
    "pictures/lessons/mathieu.svg",
    "pictures/lessons/predator-and-prey.svg",
    "pictures/lessons/projectile.svg",
    "pictures/lessons/relay-thermostat.svg",
    "pictures/lessons/square-root-and-division.svg",
    "pictures/lessons/stick-slip.svg",
    "pictures/lessons/two-phase-oscillator.svg",
    "pictures/lessons/van-der-pol.svg",
    "pictures/measured/cascaded-tanks.svg",
    "pictures/measured/emps-asymmetric.svg",
    "pictures/measured/emps-friction.svg",
    "pictures/measured/emps.svg",
    "pictures/others/nakashima.svg",
    "pictures/others/singh.svg",
    "pictures/problems/bouncing-ball.svg",
    "pictures/problems/dry-friction.svg",
    "pictures/problems/relay-oscillator.svg",
    "pictures/problems/saturated-integrator.svg",
    "pictures/problems/three-masses.svg",
    "pictures/thesis/fig-4-07.svg",
    "pictures/thesis/fig-8-04.svg",
    "pictures/thesis/fig-8-05.svg",
    "pictures/thesis/fig-8-06.svg",
    "pictures/thesis/fig-8-07.svg",
    "pictures/thesis/fig-8-09.svg",
    "pictures/thesis/fig-8-11.svg",
    "pictures/thesis/fig-8-14.svg",
    "pictures/thesis/fig-8-15.svg",
    "pictures/thesis/fig-8-16-both.svg",
    "pictures/thesis/fig-8-16-coulomb.svg",
    "pictures/thesis/fig-8-16-lag-last.svg",
    "pictures/thesis/fig-8-16.svg",
    "pictures/thesis/fig-8-17.svg",
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
    fn comments_and_indentation_are_not_sent() {
        let text = "/** Adds. */\n  const a = 1; // one\n\n/*\n * b\n */\n// c\nadd(/** @type {any} */ a);\n";
        assert_eq!(Page { path: "a.js", text }.content(), "const a=1;add(a);");
        assert_eq!(Page { path: "a.json", text }.content(), text);
        let text = "/* Colours. */\n.a { color: red; }\n\n  /* b */\n  .b { top: 0; }\n";
        assert_eq!(Page { path: "a.css", text }.content(), ".a { color: red; }\n.b { top: 0; }\n");
    }

    #[test]
    fn no_text_of_a_script_spans_lines() {
        for page in PAGES.iter().filter(|page| page.path.ends_with(".js")) {
            for (number, line) in page.text.lines().enumerate() {
                let quotes = line.replace("\\`", "").matches('`').count();
                assert!(quotes % 2 == 0, "{}:{}", page.path, number + 1);
            }
        }
    }

    /// Whether a module imports another one.
    fn imports(page: &Page, other: &Page) -> bool {
        let name = other.path.trim_start_matches("js/");
        ["from", "import"].iter().any(|word| page.text.contains(&format!("{word} './{name}'")))
    }

    #[test]
    fn modules_do_not_import_each_other() {
        // In the page that is one file (crates/web/one_file.py), each module follows those that it imports.
        let mut rest: Vec<&Page> = PAGES.iter().filter(|page| page.path.starts_with("js/")).collect();
        while let Some(next) = rest.iter().position(|page| !rest.iter().any(|other| imports(page, other))) {
            rest.remove(next);
        }
        let paths: Vec<&str> = rest.iter().map(|page| page.path).collect();
        assert!(paths.is_empty(), "{paths:?}");
    }

    #[test]
    fn one_module_reads_the_files_of_the_page() {
        let fetching = PAGES.iter().filter(|page| page.text.contains("fetch("));
        let paths: Vec<&str> = fetching.map(|page| page.path).collect();
        assert_eq!(paths, ["js/resources.js", "worker/engine.js"]);
    }

    #[test]
    fn all_scripts_together_are_small() {
        let scripts = PAGES.iter().filter(|page| page.path.ends_with(".js"));
        let bytes: usize = scripts.map(|page| page.content().len()).sum();
        assert!(bytes <= 150_000, "{bytes} bytes");
    }

    #[test]
    fn every_page_has_a_type() {
        for page in PAGES {
            assert_ne!(page.kind(), "application/octet-stream", "{}", page.path);
        }
    }
}
